//! Merges result folders: shards of an experiment, or several machines.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::{Path, PathBuf};

use anyhow::{Context, bail, ensure};
use serde_json::Value;

use crate::record::column::COLUMNS;
use crate::record::folder;
use crate::record::folder::done::Began;
use crate::record::folder::ledger::Ledger;
use crate::record::folder::{done, file};
use crate::record::id::Projection;
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
        let (provenance, others) =
            (provenance::of_folder(folder), provenance::of_others(folder, ""));
        Ok(Part {
            folder: folder.to_path_buf(),
            rows: record.rows,
            warnings: record.warnings,
            experiments,
            provenance,
            others,
            ledger: Ledger::read(folder),
            bytes: record.bytes,
        })
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
/// adds blocks. Fails if the experiments differ or the answers contradict each other.
pub fn merge(parts: &[Part]) -> anyhow::Result<Merged> {
    let Some(first) = parts.first() else {
        bail!("nothing to merge: name at least one result folder")
    };
    for part in &parts[1..] {
        same_experiments(first, part)?;
    }
    let (mut labels, mut rows) = (Labels::default(), Vec::new());
    let mut known: HashMap<Measurement, Row> = HashMap::new();
    // The last block of each scene on each machine.
    let mut last: HashMap<Projection, u32> = HashMap::new();
    // The fingerprint of each scene, and the first folder with it.
    let mut scenes: HashMap<Projection, (String, usize)> = HashMap::new();
    let (mut seen, mut repeated, mut renumbered) = (HashSet::new(), 0, 0);
    // Samples of earlier folders. Their block numbers are left out, because merging changes them.
    let mut samples: HashSet<String> = HashSet::new();
    let mut begun: HashMap<Began, (Row, usize)> = HashMap::new();
    for (k, part) in parts.iter().enumerate() {
        let (mut fresh, mut here) = (Vec::new(), HashMap::new());
        for row in &part.rows {
            let mut row = row.clone();
            let name = row.id.machine.as_deref().unwrap_or("");
            let label = here.entry(name.to_string());
            let label = label.or_insert_with(|| labels.label(part.machine(name), name));
            row.id.machine = Some(label.clone());
            if let Some(began) = done::began(&row) {
                let (before, at) = begun.entry(began).or_insert_with(|| (row.clone(), k));
                let folders = [&parts[*at].folder, &part.folder].map(|folder| folder.display());
                one_sample(before, &row)
                    .with_context(|| format!("in {} and {}", folders[0], folders[1]))?;
            }
            let known = sample(&row)?.is_some_and(|sample| samples.contains(&sample));
            if seen.insert(serde_json::to_string(&row)?) && !known {
                fresh.push(row);
            } else {
                repeated += 1;
            }
        }
        let again: HashSet<Projection> = fresh
            .iter()
            .filter(|row| is_block(row) && known.contains_key(&row.measurement()))
            .map(|row| done::scene(&row.id))
            .collect();
        let mut here = Vec::new();
        for mut row in fresh {
            let hash = row.stats.scene_hash.clone();
            let anywhere = done::scene(&row.id.clone().anywhere());
            let (before, at) = scenes.entry(anywhere).or_insert((hash.clone(), k));
            ensure!(
                *before == hash || hash.is_empty() || before.is_empty(),
                "the scene {} with N = {} is not the same in {} and {}: they ran different files \
                 or versions; compare them instead",
                row.id.scene,
                row.id.n,
                parts[*at].folder.display(),
                part.folder.display()
            );
            let scene = done::scene(&row.id);
            if is_block(&row) && again.contains(&scene) {
                row.block += last.get(&scene).copied().unwrap_or(0);
                renumbered += 1;
            } else if let Some(before) = known.get(&row.measurement()) {
                agree(before, &row, &part.folder)?;
                repeated += 1;
                continue;
            }
            here.push(row);
        }
        // The maps grow after the folder is read, because its rows do not repeat each other.
        for row in &here {
            let block = last.entry(done::scene(&row.id)).or_default();
            *block = row.block.max(*block);
            known.insert(row.measurement(), row.clone());
            samples.extend(sample(row)?);
        }
        rows.extend(here);
    }
    let provenance = labels.provenance(parts);
    Ok(Merged { rows, repeated, renumbered, provenance })
}

/// Fails if rows of one sample differ. A processor takes one sample at a time.
fn one_sample(a: &Row, b: &Row) -> anyhow::Result<()> {
    let ns = |row: &Row| row.time_ns.unwrap_or(0);
    ensure!(
        done::times(a) == done::times(b),
        "the sample of {} ({}) with N = {} that began at {} ms on {} is there twice, with {} and \
         {} ns: one of them was edited",
        a.id.subject(),
        a.id.scene,
        a.id.n,
        a.began_ms.unwrap_or(0),
        a.id.machine.as_deref().unwrap_or("its machine"),
        ns(a),
        ns(b)
    );
    Ok(())
}

fn sample(row: &Row) -> anyhow::Result<Option<String>> {
    let timed = is_block(row) && row.elapsed_ns.is_some();
    Ok(if timed { Some(serde_json::to_string(&Row { block: 0, ..row.clone() })?) } else { None })
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

/// Fails if two rows of one machine give different answers for a measurement.
fn agree(a: &Row, b: &Row, folder: &Path) -> anyhow::Result<()> {
    let mut repeating = COLUMNS.iter().filter(|column| column.repeats());
    let what = if a.outcome != b.outcome {
        "the outcome"
    } else if a.digest != b.digest {
        "the fingerprint of the pairs"
    } else if a.counts != b.counts {
        "the count of operations"
    } else if let Some(column) = repeating.find(|column| column.read(a) != column.read(b)) {
        &column.name
    } else {
        return Ok(());
    };
    bail!(
        "{what} of {} ({}, {}) with N = {} in {} differs from an earlier folder of the same \
         machine: were they runs of different versions? Compare them instead",
        a.id.subject(),
        a.id.arithmetic,
        a.id.scene,
        a.id.n,
        folder.display()
    );
}
