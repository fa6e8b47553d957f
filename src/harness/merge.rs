//! Several result folders become one record: those of the shards of a sweep, or of several machines.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::{Path, PathBuf};

use anyhow::{Context, bail, ensure};
use serde_json::{Value, json};

use super::index::Index;
use super::provenance;
use super::record::{self, Pass, Row};

/// A result folder as read.
pub struct Part {
    /// Where it is.
    pub folder: PathBuf,
    /// Its rows.
    pub rows: Vec<Row>,
    /// Sentences about lines left out.
    pub warnings: Vec<String>,
    /// Name and text of its experiments.
    pub experiments: BTreeMap<String, String>,
    /// Its provenance, if it has one.
    pub provenance: Option<Value>,
}

/// A machine, as far as a provenance describes it: the name alone may be that of many.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Machine {
    /// Its name.
    pub name: String,
    /// The processor's model.
    pub cpu: Option<String>,
    /// Its cores.
    pub cores: Option<u64>,
}

impl Part {
    /// Reads a result folder.
    pub fn read(folder: &Path) -> anyhow::Result<Part> {
        let record = record::read(&folder.join(record::FILE))?;
        let place = folder.join("experiments");
        let files = std::fs::read_dir(&place)
            .with_context(|| format!("{} is no result folder: cannot read {}", folder.display(), place.display()))?;
        let mut experiments = BTreeMap::new();
        for file in files {
            let path = file.with_context(|| format!("cannot read {}", place.display()))?.path();
            if path.extension().is_some_and(|ending| ending == "toml") {
                let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
                experiments.insert(name, std::fs::read_to_string(&path).with_context(|| format!("cannot read {}", path.display()))?);
            }
        }
        let provenance = provenance::of_folder(folder);
        Ok(Part { folder: folder.to_path_buf(), rows: record.rows, warnings: record.warnings, experiments, provenance })
    }

    /// What the provenance says about the machine of this name.
    pub fn machine(&self, name: &str) -> Machine {
        let own = self.provenance.as_ref().filter(|fields| fields.get("machine").and_then(Value::as_str) == Some(name));
        let listed = || self.provenance.as_ref()?.get("machines")?.get(name);
        let fields = own.or_else(listed);
        let field = |field: &str| fields.and_then(|fields| fields.get(field));
        let cpu = field("cpu").and_then(Value::as_str).map(String::from);
        // In a merged folder its own name may stand behind a label.
        let name = field("name").and_then(Value::as_str).unwrap_or(name);
        Machine { name: name.into(), cpu, cores: field("cores").and_then(Value::as_u64) }
    }
}

impl Machine {
    /// May the two be one? What is not known of one of them does not tell them apart.
    pub fn may_be(&self, other: &Machine) -> bool {
        let alike = |a: Option<&str>, b: Option<&str>| a.is_none() || b.is_none() || a == b;
        let cores = self.cores.is_none() || other.cores.is_none() || self.cores == other.cores;
        self.name == other.name && alike(self.cpu.as_deref(), other.cpu.as_deref()) && cores
    }
}

/// What came of a merge.
pub struct Merged {
    /// All rows.
    pub rows: Vec<Row>,
    /// Rows left out because they stood there already.
    pub repeated: usize,
    /// Timed rows of a machine that had measured the same before: their blocks have new numbers.
    pub renumbered: usize,
    /// The provenance of the whole.
    pub provenance: Value,
}

/// Puts the rows of result folders together. Times of different machines stay apart by the rows' `machine`; a second run of the same on the same machine adds
/// blocks. An error if the experiments are not the same, or the answers contradict each other.
pub fn merge(parts: &[Part]) -> anyhow::Result<Merged> {
    let Some(first) = parts.first() else { bail!("nothing to merge: name at least one result folder") };
    for part in &parts[1..] {
        same_experiments(first, part)?;
    }
    let (mut labels, mut rows) = (Labels::default(), Vec::new());
    let (mut known, mut last) = (HashMap::<String, Row>::new(), HashMap::<String, u32>::new());
    // The fingerprint of each scene, and the first folder with it.
    let mut scenes: HashMap<String, (String, usize)> = HashMap::new();
    let (mut seen, mut repeated, mut renumbered) = (HashSet::new(), 0, 0);
    // Samples of the folders before: one that was merged before calls their blocks by other numbers.
    let mut samples: HashSet<String> = HashSet::new();
    for (k, part) in parts.iter().enumerate() {
        let mut fresh = Vec::new();
        for row in &part.rows {
            let row = Row { machine: labels.of(part, &row.machine), ..row.clone() };
            let known = sample(&row)?.is_some_and(|sample| samples.contains(&sample));
            if seen.insert(serde_json::to_string(&row)?) && !known {
                fresh.push(row);
            } else {
                repeated += 1;
            }
        }
        let again: HashSet<String> = fresh.iter().filter(|row| is_block(row) && known.contains_key(&key(row))).map(scene).collect();
        let mut here = Vec::new();
        for mut row in fresh {
            let hash = row.stats.scene_hash.clone();
            let (before, at) = scenes.entry(Index::scene(&row)).or_insert((hash.clone(), k));
            ensure!(
                *before == hash || hash.is_empty() || before.is_empty(),
                "the scene {} with N = {} is not the same in {} and {}: they ran different files or versions; compare them instead",
                row.scene,
                row.n,
                parts[*at].folder.display(),
                part.folder.display()
            );
            if is_block(&row) && again.contains(&scene(&row)) {
                row.block += last.get(&scene(&row)).copied().unwrap_or(0);
                renumbered += 1;
            } else if let Some(before) = known.get(&key(&row)) {
                agree(before, &row, &part.folder)?;
                repeated += 1;
                continue;
            }
            here.push(row);
        }
        // What this folder adds can be met again in the next only.
        for row in &here {
            let block = last.entry(scene(row)).or_default();
            *block = row.block.max(*block);
            known.insert(key(row), row.clone());
            samples.extend(sample(row)?);
        }
        rows.extend(here);
    }
    let provenance = labels.provenance(parts);
    Ok(Merged { rows, repeated, renumbered, provenance })
}

/// A measurement on a machine.
fn key(row: &Row) -> String {
    format!("{}|{}", row.machine, row.key())
}

/// A scene on a machine: the unit of blocks.
fn scene(row: &Row) -> String {
    format!("{}|{}", row.machine, Index::scene(row))
}

/// A timed row, whatever the number of its block.
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
        "{first} has the experiments {}, {second} has {}: only results of the same experiments can be merged",
        names(a),
        names(b)
    );
    for (name, text) in &a.experiments {
        ensure!(
            b.experiments.get(name) == Some(text),
            "the experiment {name} is not the same in {first} and {second}: only results of the same experiments can be merged; see experiments/{name}.toml in both"
        );
    }
    Ok(())
}

/// The same machine cannot have two answers to one question.
fn agree(a: &Row, b: &Row, folder: &Path) -> anyhow::Result<()> {
    let bytes = |row: &Row| [row.peak_bytes, row.live_bytes, row.allocations, row.warm_allocations, row.formula_bytes];
    let what = if a.outcome != b.outcome {
        "the outcome"
    } else if a.digest != b.digest || a.contacts != b.contacts {
        "the pairs"
    } else if a.counts != b.counts {
        "the counts"
    } else if bytes(a) != bytes(b) {
        "the bytes"
    } else {
        return Ok(());
    };
    bail!(
        "{what} of {} ({}, {}) with N = {} in {} {} another than in a folder before, on the same machine: were they runs of different versions? Compare them instead",
        a.detector,
        a.arithmetic,
        a.scene,
        a.n,
        folder.display(),
        if what == "the outcome" { "is" } else { "are" }
    );
}

/// A name for every machine: its own; where another has it already, a number is added.
#[derive(Default)]
struct Labels(Vec<(Machine, String)>);

impl Labels {
    fn of(&mut self, part: &Part, name: &str) -> String {
        let machine = part.machine(name);
        if let Some((known, label)) = self.0.iter_mut().find(|(known, _)| known.may_be(&machine)) {
            // What is learnt of it tells later ones from it.
            known.cpu = known.cpu.take().or(machine.cpu);
            known.cores = known.cores.or(machine.cores);
            return label.clone();
        }
        let taken = |label: &str| self.0.iter().any(|(_, known)| known == label);
        let numbered = (2..).map(|k| format!("{name}-{k}"));
        let label = std::iter::once(name.to_string()).chain(numbered).find(|label| !taken(label)).unwrap_or_default();
        self.0.push((machine, label.clone()));
        label
    }

    /// Of one machine it is that of the first folder; of several it has a list of them.
    fn provenance(&self, parts: &[Part]) -> Value {
        let mut all = match &self.0[..] {
            [] | [_] => parts.iter().find_map(|part| part.provenance.clone()).filter(Value::is_object).unwrap_or_else(|| json!({})),
            several => {
                let machines = several
                    .iter()
                    .map(|(machine, label)| (label.clone(), json!({"name": machine.name, "cpu": machine.cpu, "cores": machine.cores})));
                json!({"machines": machines.collect::<serde_json::Map<_, _>>()})
            }
        };
        let of = |name: &str| {
            let values = parts.iter().filter_map(|part| Some(part.provenance.as_ref()?.get(name)?.as_str()?.to_string()));
            let mut values: Vec<String> = values.collect();
            values.sort();
            values.dedup();
            values
        };
        for name in ["revision", "profile", "contactbench", "rustc"] {
            match &of(name)[..] {
                [] => {}
                [one] => all[name] = json!(one),
                several => all[name] = json!(several.join(", ")),
            }
        }
        all["record_schema"] = json!(record::SCHEMA);
        all["merged_from"] = json!(parts.iter().map(|part| part.folder.display().to_string()).collect::<Vec<_>>());
        if let Some(fields) = all.as_object_mut() {
            fields.remove("shard");
        }
        all
    }
}
