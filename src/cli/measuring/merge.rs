use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context, ensure};
use serde_json::Value;

use crate::cli::measuring::report::finish;
use crate::cli::shared::ci::Outputs;
use crate::cli::shared::terminal;
use contactbench_record::experiment::shard::Shard;
use contactbench_record::record::folder::ledger::{self, Ledger};
use contactbench_record::record::merge::{self, Part};
use contactbench_record::record::origin::provenance;
use contactbench_record::record::row::{self, Row, Writer};
use contactbench_terms::number::plural;

const OTHER: &str = "choose another folder with --out";

#[derive(clap::Args)]
pub struct Merge {
    /// Result folders of the same experiments
    #[arg(value_name = "FOLDER", required = true)]
    folders: Vec<PathBuf>,
    /// Result folder to make
    #[arg(short, long, value_name = "FOLDER")]
    out: PathBuf,
    #[command(flatten)]
    ci: Outputs,
}

pub fn merge(options: &Merge) -> anyhow::Result<ExitCode> {
    let path = options.out.join(row::FILE);
    let folder = path.display();
    ensure!(!row::exists(&path), "{folder} exists already; choose another folder with --out");
    let parts = options.folders.iter().map(|folder| Part::read(folder));
    let parts = parts.collect::<anyhow::Result<Vec<_>>>()?;
    let merged = merge::merge(&parts)?;
    ensure!(!merged.rows.is_empty(), "the records have no rows; run the experiment first");
    beside(&options.out, &parts, merged.provenance)?;
    save(&path, &merged.rows)?;
    let mut out = terminal::out();
    for warning in parts.iter().flat_map(|part| &part.warnings) {
        writeln!(out, "note:    {warning}")?;
    }
    if let Some((count, first)) = missing(&parts) {
        let count = plural(count, "part");
        let then = "run the missing shards, then merge all";
        writeln!(out, "note:    missing: {count}, the first is {first}; {then}")?;
    }
    let (rows, folders, repeated) = (merged.rows.len(), parts.len(), merged.repeated);
    writeln!(out, "merged:  {rows} rows of {folders} folders; {repeated} duplicates dropped")?;
    if merged.renumbered > 0 {
        let samples = merged.renumbered;
        writeln!(out, "note:    {samples} samples of the same machine are further blocks")?;
    }
    finish(&options.out, &options.ci)
}

/// Writes the files beside the record: experiments, provenance, processes and spans.
fn beside(out: &Path, parts: &[Part], mut provenance: Value) -> anyhow::Result<()> {
    let experiments = out.join("experiments");
    std::fs::create_dir_all(&experiments)
        .with_context(|| format!("cannot make the folder {}; {OTHER}", experiments.display()))?;
    for (name, text) in &parts[0].experiments {
        write(experiments.join(format!("{name}.toml")), text)?;
    }
    provenance["command"] = provenance::command(std::env::args().skip(1)).into();
    write(out.join(provenance::FILE), &provenance::text(&provenance)?)?;
    for (k, fields) in parts.iter().flat_map(Part::provenances).enumerate() {
        let path = out.join(format!("provenance-part-{}.json", k + 1));
        write(path, &provenance::text(fields)?)?;
    }
    let mut entries = Ledger::default();
    parts.iter().for_each(|part| entries.join(part.ledger.clone()));
    if entries != Ledger::default() {
        write(out.join(ledger::FILE), &entries.text())?;
    }
    Ok(())
}

/// Writes rows to a temporary name first, so that a half-written record is not taken for a whole
/// one.
fn save(path: &Path, rows: &[Row]) -> anyhow::Result<()> {
    let half = path.with_file_name(".samples.jsonl.part");
    let cannot = || format!("cannot write {}; {OTHER}", path.display());
    if half.exists() {
        std::fs::remove_file(&half).with_context(cannot)?;
    }
    let mut record = Writer::append(&half).with_context(cannot)?;
    for row in rows {
        record.write(row)?;
    }
    drop(record);
    std::fs::rename(&half, path).with_context(cannot)
}

/// Returns the number of missing shards and the first of them; `None` if a folder is not a shard,
/// because it may hold their rows.
fn missing(parts: &[Part]) -> Option<(usize, Shard)> {
    let shard = |fields: &Value| fields.get("shard")?.as_str()?.parse().ok();
    let of = |part: &Part| part.provenances().filter_map(shard).collect::<Vec<Shard>>();
    let present: Vec<Vec<Shard>> = parts.iter().map(of).collect();
    let all = !present.iter().any(Vec::is_empty);
    Shard::missing(&present.into_iter().flatten().collect()).filter(|_| all)
}

fn write(path: PathBuf, text: &str) -> anyhow::Result<()> {
    std::fs::write(&path, text).with_context(|| format!("cannot write {}", path.display()))
}
