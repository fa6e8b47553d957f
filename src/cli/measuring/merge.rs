use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::{Context, ensure};
use serde_json::Value;

use crate::cli::measuring::report::finish;
use crate::cli::shared::ci::Outputs;
use crate::cli::shared::terminal;
use contactbench_record::experiment::shard::Shard;
use contactbench_record::record::folder::ledger;
use contactbench_record::record::folder::ledger::Ledger;
use contactbench_record::record::merge::Part;
use contactbench_record::record::origin::provenance;
use contactbench_record::record::row::Writer;
use contactbench_record::record::{merge, row};
use contactbench_run::run::machine::disk;
use contactbench_terms::number::plural;

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
    ensure!(
        !row::exists(&path),
        "{} exists already; choose another folder with --out",
        path.display()
    );
    let parts = options
        .folders
        .iter()
        .map(|folder| Part::read(folder))
        .collect::<anyhow::Result<Vec<_>>>()?;
    let merged = merge::merge(&parts)?;
    ensure!(!merged.rows.is_empty(), "the records have no rows; run the experiment first");
    let experiments = options.out.join("experiments");
    let other = "choose another folder with --out";
    std::fs::create_dir_all(&experiments)
        .with_context(|| format!("cannot make the folder {}; {other}", experiments.display()))?;
    let bytes = parts.iter().map(|part| part.bytes).sum();
    disk::ensure(&options.out, bytes, "the record", &format!("make room, or {other}"))?;
    for (name, text) in &parts[0].experiments {
        write(experiments.join(format!("{name}.toml")), text)?;
    }
    let mut provenance = merged.provenance;
    provenance["command"] = provenance::command(std::env::args().skip(1)).into();
    write(options.out.join(provenance::FILE), &provenance::text(&provenance)?)?;
    for (k, fields) in parts.iter().flat_map(Part::provenances).enumerate() {
        let path = options.out.join(format!("provenance-part-{}.json", k + 1));
        write(path, &provenance::text(fields)?)?;
    }
    let mut entries = Ledger::default();
    parts.iter().for_each(|part| entries.join(part.ledger.clone()));
    if entries != Ledger::default() {
        write(options.out.join(ledger::FILE), &entries.text())?;
    }
    // Rows go to a temporary name, so that a half-written record is not taken for a whole one.
    let half = options.out.join(".samples.jsonl.part");
    let cannot = || format!("cannot write {}; {other}", path.display());
    if half.exists() {
        std::fs::remove_file(&half).with_context(cannot)?;
    }
    let mut record = Writer::append(&half).with_context(cannot)?;
    for row in &merged.rows {
        record.write(row)?;
    }
    drop(record);
    std::fs::rename(&half, &path).with_context(cannot)?;
    let mut out = terminal::out();
    for warning in parts.iter().flat_map(|part| &part.warnings) {
        writeln!(out, "note:    {warning}")?;
    }
    // Missing shards are not reported if a folder is not a shard, because it may hold their rows.
    let shard = |fields: &Value| fields.get("shard")?.as_str()?.parse().ok();
    let all = |part: &Part| part.provenances().filter_map(shard).collect::<Vec<Shard>>();
    let present: Vec<Vec<Shard>> = parts.iter().map(all).collect();
    if !present.iter().any(Vec::is_empty)
        && let Some((count, first)) = Shard::missing(&present.into_iter().flatten().collect())
    {
        writeln!(
            out,
            "note:    missing: {}, the first is {first}; run the missing shards, then merge all",
            plural(count, "part")
        )?;
    }
    writeln!(
        out,
        "merged:  {} rows of {} folders; {} duplicates dropped",
        merged.rows.len(),
        parts.len(),
        merged.repeated
    )?;
    if merged.renumbered > 0 {
        writeln!(
            out,
            "note:    {} samples of the same machine are further blocks",
            merged.renumbered
        )?;
    }
    finish(&options.out, &options.ci)
}

fn write(path: PathBuf, text: &str) -> anyhow::Result<()> {
    std::fs::write(&path, text).with_context(|| format!("cannot write {}", path.display()))
}
