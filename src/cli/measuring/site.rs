//! `contactbench site` makes one static site of all records in a folder.

use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, ensure};

use crate::cli::measuring::report;
use crate::cli::shared::terminal;
use contactbench_detectors::table;
use contactbench_record::record::origin::provenance;
use contactbench_record::record::row;
use contactbench_report::site::{self, About, Given};
use contactbench_run::run::machine::interrupt;
use contactbench_terms::number::plural;

#[derive(clap::Args)]
pub struct Site {
    /// Folder that contains records, at any depth
    folder: PathBuf,
    /// Folder to write: absent, empty, or an earlier site, which is replaced
    #[arg(short, long, value_name = "FOLDER")]
    out: PathBuf,
    /// Address of FOLDER on the web; the pages link to its raw data
    #[arg(long, value_name = "URL")]
    address: Option<String>,
}

pub fn site(options: &Site) -> anyhow::Result<()> {
    interrupt::end_runners_too().context("cannot listen to Ctrl-C")?;
    let Site { folder, out, address } = options;
    let holds = std::fs::read_dir(out).is_ok_and(|mut entries| entries.next().is_some());
    ensure!(
        !holds || out.join(site::FILE).is_file(),
        "{} is not empty and not a site; choose another folder with --out",
        out.display()
    );
    let (mut given, mut links) = (Vec::new(), Vec::new());
    find(folder, folder, &mut given, &mut links)?;
    links.iter().for_each(|link| say!("{} is a link and is left out", link.display()));
    ensure!(
        !given.is_empty(),
        "found no record in {} or its folders; a record is a folder with the file {}",
        folder.display(),
        row::FILE
    );
    let mut notes = copies(&mut given);
    let (pages, left_out) = site::write(out, &given, address.as_deref(), &about)?;
    notes.extend(left_out);
    notes.iter().for_each(|note| say!("{note}"));
    let pages = pages.iter().filter(|page| page.extension().is_some_and(|it| it == "html"));
    let (pages, records) = (plural(pages.count(), "page"), plural(given.len(), "record"));
    let index = out.join("index.html");
    writeln!(terminal::out(), "{pages} of {records}: {}", index.display())?;
    Ok(())
}

/// Removes records that are equal to an earlier one, and returns a note on each.
fn copies(given: &mut Vec<Given>) -> Vec<String> {
    let (mut kept, mut notes) = (Vec::<Given>::new(), Vec::new());
    let origin = |record: &Given| std::fs::read(record.folder.join(provenance::FILE)).ok();
    for record in std::mem::take(given) {
        let same = |it: &&Given| it.rows == record.rows && origin(it) == origin(&record);
        match kept.iter().find(same) {
            Some(known) => notes.push(format!(
                "{} is a copy of {} and is left out",
                record.folder.display(),
                known.folder.display()
            )),
            None => kept.push(record),
        }
    }
    *given = kept;
    notes
}

/// Reads the records in `folder` and below, sorted by path, and finds links to folders.
fn find(
    root: &Path,
    folder: &Path,
    found: &mut Vec<Given>,
    links: &mut Vec<PathBuf>,
) -> anyhow::Result<()> {
    if row::exists(&folder.join(row::FILE)) {
        let (record, experiments) = report::read(folder)?;
        let name = folder.strip_prefix(root).unwrap_or(folder).display().to_string();
        let (name, folder) = (if name.is_empty() { "record".into() } else { name }, folder.into());
        found.push(Given { name, folder, experiments, rows: record.rows });
        return Ok(());
    }
    let entries = std::fs::read_dir(folder)
        .with_context(|| format!("cannot read the folder {}", folder.display()))?;
    let paths = entries.flatten().map(|entry| entry.path());
    let mut folders: Vec<PathBuf> = paths.filter(|path| path.is_dir()).collect();
    folders.sort();
    // A link to a folder could lead back to it.
    links.extend(folders.extract_if(.., |it| it.is_symlink()));
    folders.iter().try_for_each(|folder| find(root, folder, found, links))
}

fn about(name: &str) -> Option<About> {
    let summary = match (table::find(name), name) {
        (Some(entry), _) => entry.summary,
        (None, "every-step") => "searches in every step, without a neighbour list",
        (None, "verlet") => "keeps a neighbour list with a skin, and builds it again by a rule",
        (None, name) if name.starts_with("contactbench") => "this program, called from Python",
        _ => return None,
    };
    Some(About { summary: summary.into(), ours: true })
}
