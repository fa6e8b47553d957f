use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{bail, ensure};

use crate::cli::shared::terminal;
use contactbench_record::cells;
use contactbench_record::experiment::{MapAxes, Where, claims};
use contactbench_record::findings::map;
use contactbench_record::findings::trust::conditions::Conditions;
use contactbench_record::record::merge::{self, Part};
use contactbench_record::record::origin::provenance;
use contactbench_record::record::row::Row;
use contactbench_report::figure::style::Styles;
use contactbench_report::table::csv;
use contactbench_report::{document, figure, sections};
use contactbench_run::plan;

#[derive(clap::Args)]
pub struct Map {
    /// Result folders
    #[arg(value_name = "FOLDER", required = true)]
    folders: Vec<PathBuf>,
    /// Axis across: n, dim, threads, density, or any parameter
    #[arg(long, value_name = "AXIS")]
    x: String,
    /// Axis upwards: the same choices
    #[arg(long, value_name = "AXIS")]
    y: String,
    /// Only cells with this, as in 'n>=1000' (repeatable)
    #[arg(long = "where", value_name = "FILTER")]
    filters: Vec<String>,
    /// Map as a .svg or .csv file [default: a table on stdout]
    #[arg(short, long, value_name = "FILE")]
    out: Option<PathBuf>,
}

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
        let title = format!("Fastest detector: {y} against {x}");
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
        _ => bail!("{}: the file name of a map must end in .svg or .csv", path.display()),
    }
}

/// Returns the rows of all folders, merged if their experiments are the same, and doubts about
/// them.
fn rows(folders: &[PathBuf]) -> anyhow::Result<(Vec<Row>, Vec<String>)> {
    let mut warnings = Vec::new();
    let mut groups: Vec<Vec<Part>> = Vec::new();
    for folder in folders {
        let part = Part::read(folder)?;
        let doubts = Conditions::new(&provenance::all(folder), &part.ledger, &part.rows);
        let said =
            part.warnings.iter().cloned().chain(sections::trust::conditions::sentence(&doubts));
        warnings.extend(said.map(|warning| format!("{}: {warning}", folder.display())));
        let same = |group: &&mut Vec<Part>| group[0].experiments == part.experiments;
        match groups.iter_mut().find(same) {
            Some(group) => group.push(part),
            None => {
                let mut others = groups.iter().flat_map(|group| &group[0].experiments);
                let other = others.find(|(name, _)| part.experiments.contains_key(*name));
                if let Some((name, _)) = other {
                    bail!(
                        "{}: the experiment {name} differs from that of the folders before; name \
                         folders with the same experiments/{name}.toml",
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
    ensure!(!rows.is_empty(), "the records have no rows; run the experiment first");
    Ok((rows, warnings))
}
