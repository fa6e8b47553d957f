//! `contactbench map`.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{bail, ensure};

use crate::cli::shared::terminal;
use contactbench_record::cells;
use contactbench_record::experiment::{MapAxes, Where, claims};
use contactbench_record::findings::conditions::Conditions;
use contactbench_record::findings::map;
use contactbench_record::record::merge::{self, Part};
use contactbench_record::record::provenance;
use contactbench_record::record::row::{self, Row};
use contactbench_report::figure::style::Styles;
use contactbench_report::table::csv;
use contactbench_report::{document, figure, sections};
use contactbench_run::plan;

#[derive(clap::Args)]
pub struct Map {
    /// Result folders, as `run` and `merge` write them
    #[arg(required = true)]
    folders: Vec<PathBuf>,
    /// Across: n, dim, threads, a parameter of the scenes or of the detectors (size-ratio, speed,
    /// skin), or what was measured of the scenes (density, coordination)
    #[arg(long)]
    x: String,
    /// Upwards: the same
    #[arg(long)]
    y: String,
    /// Only cells of which this holds: scene=packed,loose or 'n>=1000' (quoted, for the shell); may
    /// be given several times
    #[arg(long = "where", value_name = "EXPR")]
    filters: Vec<String>,
    /// Where the map goes: a .svg or .csv file (default: a table on the terminal)
    #[arg(short, long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// Draws the map, or prints it.
pub fn map(options: &Map) -> anyhow::Result<ExitCode> {
    let svg = options.out.as_deref().map(is_svg).transpose()?;
    let mut filter: Where = claims::parse_where(&options.filters)?;
    plan::resolve(&mut filter).map_err(anyhow::Error::msg)?;
    let axes = MapAxes::new(&options.x, &options.y);
    let (rows, warnings) = rows(&options.folders)?;
    let cells = cells::cells(&rows);
    let found = map::Map::new(&axes, &filter, &cells)?;
    warnings.iter().for_each(|warning| say!("warning: {warning}"));
    let (Some(svg), Some(path)) = (svg, &options.out) else {
        let blocks = sections::map::blocks(&found);
        let mut out = terminal::out();
        write!(out, "{}", document::plain(&blocks, terminal::width()))?;
        return Ok(ExitCode::SUCCESS);
    };
    let name = format!("{} x {}", axes.x, axes.y);
    let text = if svg {
        let [x, y] = axes.labels();
        let title = format!("Who is the fastest: {y} against {x}");
        figure::map::drawn(&title, &axes, &found, &Styles::new(cells.iter()))
    } else {
        csv(&[sections::map::rows(&name, &found)])
    };
    terminal::save(path, text.as_bytes(), "--out")?;
    say!("{name}: {} ({})", path.display(), crate::cli::bytes(text.len() as u64));
    Ok(ExitCode::SUCCESS)
}

fn is_svg(path: &Path) -> anyhow::Result<bool> {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
    match ending.as_deref() {
        Some("svg") => Ok(true),
        Some("csv") => Ok(false),
        _ => bail!("{}: the ending of a map must be .svg or .csv", path.display()),
    }
}

/// The rows of all folders, merged where their experiments are the same, as `merge` does; and what
/// is doubtful about them.
fn rows(folders: &[PathBuf]) -> anyhow::Result<(Vec<Row>, Vec<String>)> {
    let mut warnings = Vec::new();
    let mut groups: Vec<Vec<Part>> = Vec::new();
    for folder in folders {
        ensure!(
            row::exists(&folder.join(row::FILE)),
            "{} has no {}, the record of a run; name a result folder, as `contactbench run` \
             writes them",
            folder.display(),
            row::FILE
        );
        let part = Part::read(folder)?;
        let doubts = Conditions::new(&provenance::all(folder), &part.ledger, &part.rows);
        let said = part.warnings.iter().cloned().chain(sections::conditions::sentence(&doubts));
        warnings.extend(said.map(|warning| format!("{}: {warning}", folder.display())));
        let same = |group: &&mut Vec<Part>| group[0].experiments == part.experiments;
        match groups.iter_mut().find(same) {
            Some(group) => group.push(part),
            None => {
                let mut others = groups.iter().flat_map(|group| &group[0].experiments);
                let other = others.find(|(name, _)| part.experiments.contains_key(*name));
                if let Some((name, _)) = other {
                    bail!(
                        "{}: the experiment {name} is another there than in the folders before it; \
                         name folders whose experiments/{name}.toml are the same",
                        folder.display()
                    );
                }
                groups.push(vec![part]);
            }
        }
    }
    let mut rows = Vec::new();
    for mut group in groups {
        match &mut *group {
            [part] => rows.append(&mut part.rows),
            parts => rows.extend(merge::merge(parts)?.rows),
        }
    }
    ensure!(!rows.is_empty(), "the records hold no rows yet; run the experiment first");
    Ok((rows, warnings))
}
