//! Merges result folders: shards of an experiment, or several machines.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::{Path, PathBuf};

use anyhow::{Context, bail, ensure};
use serde_json::Value;

use crate::record::column::COLUMNS;
use crate::record::faults::{self, Damaged};
use crate::record::folder;
use crate::record::folder::ledger::{self, Ledger};
use crate::record::folder::{done, file};
use crate::record::id::{CellId, Projection};
use crate::record::origin::machines::{Labels, Machine, described};
use crate::record::origin::provenance;
use crate::record::outcome::Pass;
use crate::record::row::{Measurement, Row};

const NAME: &str = "name a result folder, as contactbench run writes them";

/// Returns a hint that names the last result folder inside this one.
fn within(folder: &Path) -> String {
    let folders = std::fs::read_dir(folder).into_iter().flatten();
    let paths = folders.filter_map(|entry| Some(entry.ok()?.path()));
    let last = paths.filter(|path| file::exists(&path.join(file::FILE))).max();
    last.map_or_else(String::new, |path| format!(", such as {}", path.display()))
}

pub struct Part {
    pub folder: PathBuf,
    pub rows: Vec<Row>,
    pub warnings: Vec<String>,
    pub experiments: BTreeMap<String, String>,
    pub provenance: Option<Value>,
    /// Provenance of the folder's parts, and of runs that resumed it.
    pub others: Vec<Value>,
    pub ledger: Ledger,
    pub bytes: u64,
}

impl Part {
    pub fn read(folder: &Path) -> anyhow::Result<Part> {
        ensure!(folder.exists(), "there is no folder {}; {NAME}", folder.display());
        ensure!(
            file::exists(&folder.join(file::FILE)),
            "{} has no {}; {NAME}{}",
            folder.display(),
            file::FILE,
            within(folder)
        );
        folder::sound(folder)?;
        let record = file::read(&folder.join(file::FILE))?;
        let place = folder.join(folder::EXPERIMENTS);
        std::fs::read_dir(&place).with_context(|| {
            format!("{} is not a result folder: cannot read {}", folder.display(), place.display())
        })?;
        let read = |(name, path): (String, PathBuf)| {
            let text = std::fs::read_to_string(&path)
                .with_context(|| format!("cannot read {}", path.display()))?;
            Ok((name, text))
        };
        let copies = folder::experiments(folder);
        let experiments = copies.into_iter().map(read).collect::<anyhow::Result<_>>()?;
        let part = Part {
            folder: folder.to_path_buf(),
            rows: record.rows,
            warnings: record.warnings,
            experiments,
            provenance: provenance::of_folder(folder),
            others: provenance::of_others(folder),
            ledger: Ledger::read(folder),
            bytes: record.bytes,
        };
        let provenances: Vec<&Value> = part.provenances().collect();
        for (name, fault) in [
            (ledger::FILE, faults::deleted(&part.rows, &part.ledger)),
            (provenance::FILE, faults::origin(&part.rows, &part.ledger, &provenances)),
        ] {
            fault.map_or(Ok(()), |what| Err(Damaged::new(&folder.join(name), what)))?;
        }
        Ok(part)
    }

    pub fn machine(&self, name: &str) -> Machine {
        let known = self.provenances().flat_map(described).find(|(label, _)| label == name);
        known.map_or_else(|| Machine { name: name.into(), ..Machine::default() }, |(_, it)| it)
    }

    pub fn provenances(&self) -> impl Iterator<Item = &Value> {
        self.provenance.iter().chain(&self.others)
    }
}

pub struct Merged {
    pub rows: Vec<Row>,
    pub repeated: usize,
    /// Number of rows with new block numbers, because the machine had measured their scene before.
    pub renumbered: usize,
    pub provenance: Value,
}

/// Merges rows. Times of different machines keep their `machine`; a second run on the same machine
/// adds blocks. Fails if the experiments differ, or if answers, counts or bytes contradict each
/// other.
pub fn merge(parts: &[Part]) -> anyhow::Result<Merged> {
    let [first, others @ ..] = parts else {
        bail!("nothing to merge: name at least one result folder")
    };
    others.iter().try_for_each(|part| same_experiments(first, part))?;
    let (mut labels, mut seen) = (Labels::default(), HashSet::new());
    let (mut rows, mut repeated, mut renumbered) = (Vec::new(), 0, 0);
    let mut known: HashMap<Measurement, Vec<Row>> = HashMap::new();
    // The last block of each scene on each machine.
    let mut last: HashMap<Projection, u32> = HashMap::new();
    for part in parts {
        let mut fresh = labelled(part, &mut labels);
        let all = fresh.len();
        fresh.retain(|row| seen.insert(sample(row)));
        repeated += all - fresh.len();
        let of_machine = |row: &Row| {
            let before = known.get(&row.anywhere());
            before.is_some_and(|all| all.iter().any(|it| it.id.machine == row.id.machine))
        };
        let again = fresh.iter().filter(|row| is_block(row) && of_machine(row));
        let again: HashSet<Projection> = again.map(|row| done::scene(&row.id)).collect();
        let start = rows.len();
        for mut row in fresh {
            let before = known.get(&row.anywhere()).filter(|_| !is_block(&row));
            for before in before.into_iter().flatten() {
                agree(before, &row, &part.folder)?;
            }
            if before.is_some() && of_machine(&row) {
                repeated += 1;
                continue;
            }
            let scene = done::scene(&row.id);
            if is_block(&row) && again.contains(&scene) {
                row.block = row.block.saturating_add(last.get(&scene).copied().unwrap_or(0));
                renumbered += 1;
            }
            rows.push(row);
        }
        // The maps grow after the folder is read, because its rows do not repeat each other.
        for row in &rows[start..] {
            let block = last.entry(done::scene(&row.id)).or_default();
            *block = row.block.max(*block);
            known.entry(row.anywhere()).or_default().push(row.clone());
        }
    }
    if let Some((k, what)) = faults::between(&rows) {
        bail!("a row of {} cannot be merged: {what}", rows[k].id.subject());
    }
    let provenance = labels.provenance(parts);
    Ok(Merged { rows, repeated, renumbered, provenance })
}

fn labelled(part: &Part, labels: &mut Labels) -> Vec<Row> {
    let mut known: HashMap<&str, String> = HashMap::new();
    let mut rows = Vec::new();
    for row in &part.rows {
        let name = row.id.machine.as_deref().unwrap_or("");
        let label = known.entry(name).or_insert_with(|| labels.label(part.machine(name), name));
        let id = CellId { machine: Some(label.clone()), ..row.id.clone() };
        rows.push(Row { id, ..row.clone() });
    }
    rows
}

/// Identifies a row. The block number of a time is left out, because merging changes it.
fn sample(row: &Row) -> String {
    let block = if is_block(row) && row.elapsed_ns.is_some() { 0 } else { row.block };
    serde_json::to_string(&Row { block, ..row.clone() }).unwrap_or_default()
}

fn is_block(row: &Row) -> bool {
    matches!(row.pass, Pass::Time | Pass::Ceiling) && row.block > 0
}

fn same_experiments(a: &Part, b: &Part) -> anyhow::Result<()> {
    let names = |part: &Part| part.experiments.keys().cloned().collect::<Vec<_>>().join(", ");
    let (first, second) = (a.folder.display(), b.folder.display());
    ensure!(
        a.experiments.keys().eq(b.experiments.keys()),
        "{first} has the experiments {}, {second} has {}: only results of the same experiments \
         can be merged",
        names(a),
        names(b)
    );
    for (name, text) in &a.experiments {
        ensure!(
            b.experiments.get(name) == Some(text),
            "the experiment {name} is not the same in {first} and {second}: only results of the \
             same experiments can be merged; see experiments/{name}.toml in both"
        );
    }
    Ok(())
}

/// Fails if two rows give different answers for a measurement. Rows of two machines may differ in
/// their outcome, and those of foreign code in their bytes.
fn agree(a: &Row, b: &Row, folder: &Path) -> anyhow::Result<()> {
    let apart = a.id.machine != b.id.machine;
    if apart && !(a.role.is_ours() && [a, b].iter().all(|row| row.outcome.is_good())) {
        return Ok(());
    }
    let column = COLUMNS.iter().find(|it| it.repeats() && it.read(a) != it.read(b));
    let differs = [
        ("the scene", a.stats.scene_hash != b.stats.scene_hash),
        ("the outcome", a.outcome != b.outcome),
        ("the fingerprint of the pairs", a.digest != b.digest),
        ("the count of operations", a.counts != b.counts),
        (column.map_or("", |column| &column.name), column.is_some()),
    ];
    let Some((what, _)) = differs.into_iter().find(|(_, differs)| *differs) else { return Ok(()) };
    bail!(
        "{what} of {} ({}, {}) with N = {} in {} differs from an earlier folder: were they runs of \
         different versions? Compare them instead",
        a.id.subject(),
        a.id.arithmetic,
        a.id.scene,
        a.id.n,
        folder.display()
    );
}
