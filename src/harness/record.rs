//! The record: one JSON line per measurement, appended and never edited. It is a wall: left of it nothing knows about figures, right
//! of it nothing runs a detector.

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::{self, BufRead, BufReader, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::provenance;

/// The name of the record in a result folder.
pub const FILE: &str = "samples.jsonl";

/// The version of the record's schema, the field `schema` of every row: see docs/RECORD.md. 1 had neither this field nor `machine`.
pub const SCHEMA: u32 = 2;

/// Which quantity a row measured. Each is taken in a pass of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Pass {
    /// Wall time, with a silent probe.
    Time,
    /// Exact operation counts.
    Count,
    /// Heap bytes and allocations, without the output.
    Memory,
    /// Wall time of one of as many copies as the row has threads, with one thread each, while the others do the same: what the machine
    /// lets that many threads gain if they share nothing.
    Ceiling,
}

impl Pass {
    /// The passes of every cell. (Ceilings are measured beside cells with several threads, where the experiment asks for them.)
    pub const ALL: [Pass; 3] = [Pass::Count, Pass::Memory, Pass::Time];
}

/// How a planned measurement ended. Every planned cell has a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Outcome {
    /// The answer was right.
    Ok,
    /// Contacts were lost, as textbook filters may: the answer is what was asked for, and its error stands in the row.
    Lossy,
    /// The answer was wrong: its time means nothing.
    Wrong,
    /// A control that reports nothing on purpose.
    Control,
    /// It took longer than the limit.
    Timeout,
    /// It hit the memory limit.
    OutOfMemory,
    /// The detector will not work on this scene, and says why.
    Refused,
    /// The runner could not be started.
    Unavailable,
    /// The runner died.
    Crashed,
}

impl Outcome {
    /// Did the detector do what it is there for?
    pub fn is_good(self) -> bool {
        matches!(self, Outcome::Ok | Outcome::Lossy | Outcome::Control)
    }

    /// The word in the record.
    pub fn name(self) -> &'static str {
        match self {
            Outcome::Ok => "ok",
            Outcome::Lossy => "lossy",
            Outcome::Wrong => "wrong",
            Outcome::Control => "control",
            Outcome::Timeout => "timeout",
            Outcome::OutOfMemory => "out-of-memory",
            Outcome::Refused => "refused",
            Outcome::Unavailable => "unavailable",
            Outcome::Crashed => "crashed",
        }
    }
}

/// What the scene turned out to be.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Stats {
    /// Volume of the bodies over the volume of the box around them; overlaps count twice.
    pub packing_fraction: f64,
    /// Contacts per element: twice the number of touching pairs over the number of elements. Exact arithmetic.
    pub coordination: f64,
    /// Largest over smallest radius; 1 when all are equal, absent when the smallest is zero.
    pub radius_ratio: Option<f64>,
    /// Edges of the box around the centres, in units of the largest diameter; absent when that is zero.
    pub box_diameters: Option<Vec<f64>>,
    /// Fingerprint of the exact coordinates and radii, in order: `0x` and 16 hexadecimal digits.
    pub scene_hash: String,
}

/// A set of pairs against another that is taken for true.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Errors {
    /// Touching pairs not reported.
    pub missed: u64,
    /// Reported pairs, of two elements, that do not touch.
    pub spurious: u64,
    /// Pairs reported again.
    pub duplicate: u64,
    /// Elements reported as touching themselves.
    #[serde(default)]
    pub self_pairs: u64,
    /// Of the pairs missed, the largest overlap, in mean radii of the couple; 0 where all missed pairs are exactly tangent.
    #[serde(default)]
    pub deepest_miss: f64,
    /// Of the spurious pairs, the widest gap, in mean radii of the couple.
    #[serde(default)]
    pub widest_false: f64,
}

impl std::fmt::Display for Errors {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} missed, {} spurious, {} duplicate", self.missed, self.spurious, self.duplicate)?;
        if self.self_pairs > 0 {
            write!(f, ", {} with itself", self.self_pairs)?;
        }
        if self.deepest_miss > 0.0 {
            write!(f, ", deepest miss {:.1e} r", self.deepest_miss)?;
        }
        if self.widest_false > 0.0 {
            write!(f, ", widest gap {:.1e} r", self.widest_false)?;
        }
        Ok(())
    }
}

impl Errors {
    /// Pairs that are there and should not be, or should be and are not.
    pub fn wrong(&self) -> u64 {
        self.missed + self.spurious + self.duplicate + self.self_pairs
    }
}

/// The three causes of error, each against the step before it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Causes {
    /// Storing the scene: exact decisions on the scene as stored, against exact decisions on the scene as given.
    pub input: Errors,
    /// Deciding: the arithmetic's own contact test on all pairs, against exact decisions, both on the scene as stored.
    pub arithmetic: Errors,
    /// Looking: the detector's pairs, against the arithmetic's own contact test on all pairs.
    pub algorithm: Errors,
    /// Deciding and looking together, which may cancel: the detector's pairs, against exact decisions on the scene as stored.
    pub stored: Errors,
}

/// One measurement.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Where it was measured: the machine's name. In schema 1 it stands in the provenance beside the record, and is taken from there.
    #[serde(default)]
    pub machine: String,
    /// The experiment's name.
    pub experiment: String,
    /// The generator (or `file`).
    pub scene: String,
    /// The generator's parameters, as used.
    pub params: BTreeMap<String, serde_json::Value>,
    /// 2 for discs, 3 for spheres.
    pub dim: u32,
    /// Elements.
    pub n: u64,
    /// The scene's seed.
    pub seed: u64,
    /// Order of the elements: shuffled, generated or morton.
    pub order: String,
    /// The detector's name.
    pub detector: String,
    /// f32, f32-cell, textbook, f64 or exact.
    pub arithmetic: String,
    /// Threads given to the detector.
    pub threads: u32,
    /// What was measured.
    pub pass: Pass,
    /// Number of the paired block; 0 for counts and memory, and for copies that did not start.
    pub block: u32,
    /// Nanoseconds per detection, from raw coordinates to the complete list of pairs; of several copies the harmonic mean.
    pub time_ns: Option<u64>,
    /// Detections in this sample.
    pub calls: Option<u64>,
    /// Nanoseconds of the whole sample.
    pub elapsed_ns: Option<u64>,
    /// How it ended.
    pub outcome: Outcome,
    /// Why, when it is not `ok`.
    pub reason: String,
    /// Pairs reported.
    pub contacts: Option<u64>,
    /// Order-free fingerprint of the pairs reported.
    pub digest: Option<String>,
    /// Operation counts; empty except in counting passes.
    pub counts: BTreeMap<String, u64>,
    /// Most heap bytes held at one time above the input.
    pub peak_bytes: Option<u64>,
    /// Heap bytes held after the detection.
    pub live_bytes: Option<u64>,
    /// Heap allocations of the first detection.
    pub allocations: Option<u64>,
    /// Heap allocations of a second detection of the same scene.
    pub warm_allocations: Option<u64>,
    /// Bytes by the detector's declared formula.
    pub formula_bytes: Option<u64>,
    /// Against exact decisions on the scene as given, where that was compared: all causes together.
    pub errors: Option<Errors>,
    /// The same by cause.
    #[serde(default)]
    pub causes: Option<Causes>,
    /// The scene as realised.
    pub stats: Stats,
}

impl Row {
    /// What makes a measurement the same measurement: rows with equal keys are repetitions of one another.
    pub fn key(&self) -> String {
        let params = serde_json::to_string(&self.params).unwrap_or_default();
        format!(
            "{}|{}|{params}|{}|{}|{}|{}|{}|{}|{}|{:?}|{}",
            self.experiment,
            self.scene,
            self.dim,
            self.n,
            self.seed,
            self.order,
            self.detector,
            self.arithmetic,
            self.threads,
            self.pass,
            self.block
        )
    }
}

/// A line of the record.
#[derive(Serialize)]
struct Line<'a> {
    schema: u32,
    #[serde(flatten)]
    row: &'a Row,
}

/// A row that could not be written. The record ends with the row before it.
#[derive(Debug, thiserror::Error)]
#[error("cannot write to {}: {cause}; the {rows} rows before stand there and are whole", path.display())]
pub struct WriteError {
    /// The record.
    pub path: PathBuf,
    /// Its rows.
    pub rows: u64,
    /// Why.
    pub cause: io::Error,
}

/// Appends rows to a record; each is written, as one whole line, before the next is measured: a killed run loses at most one.
pub struct Writer {
    file: File,
    path: PathBuf,
    /// The bytes of the whole lines.
    end: u64,
    rows: u64,
}

impl Writer {
    /// Opens a record for appending. A torn last line (of a killed run) is cut off. Fails where another process is writing to it.
    pub fn append(path: &Path) -> io::Result<Writer> {
        let mut file = OpenOptions::new().create(true).read(true).write(true).truncate(false).open(path)?;
        // Two would write over each other. Where a file system knows no locks, nothing can be said.
        if let Err(std::fs::TryLockError::WouldBlock) = file.try_lock() {
            return Err(io::Error::new(io::ErrorKind::WouldBlock, "another run is writing to it"));
        }
        let (end, rows) = whole_lines(&file)?;
        file.set_len(end)?;
        file.seek(SeekFrom::Start(end))?;
        Ok(Writer { file, path: path.to_path_buf(), end, rows })
    }

    /// Whole rows in the record.
    pub fn rows(&self) -> u64 {
        self.rows
    }

    /// Writes one row. Where that fails (the disk is full), what was written of it is taken back.
    pub fn write(&mut self, row: &Row) -> Result<(), WriteError> {
        let failed = |writer: &Writer, cause| WriteError { path: writer.path.clone(), rows: writer.rows, cause };
        let mut line = serde_json::to_vec(&Line { schema: SCHEMA, row }).map_err(|e| failed(self, e.into()))?;
        line.push(b'\n');
        if let Err(cause) = self.file.write_all(&line) {
            // Should this fail, too, the torn line is cut off when the run is resumed.
            let _ = self.file.set_len(self.end).and_then(|()| self.file.seek(SeekFrom::Start(self.end)));
            return Err(failed(self, cause));
        }
        self.end += line.len() as u64;
        self.rows += 1;
        Ok(())
    }
}

/// The length of the file up to its last newline, and the number of its lines.
fn whole_lines(file: &File) -> io::Result<(u64, u64)> {
    let (mut end, mut rows, mut position, mut line) = (0, 0, 0, Vec::new());
    let mut reader = BufReader::new(file);
    loop {
        line.clear();
        let read = reader.read_until(b'\n', &mut line)?;
        if read == 0 {
            return Ok((end, rows));
        }
        position += read as u64;
        if line.ends_with(b"\n") {
            end = position;
            rows += u64::from(!line.trim_ascii().is_empty());
        }
    }
}

/// A record as read, with what was wrong with it.
pub struct Record {
    /// The rows, in the order written.
    pub rows: Vec<Row>,
    /// Sentences about lines that were left out.
    pub warnings: Vec<String>,
}

/// The version of a line; lines of the first schema do not say.
#[derive(Deserialize)]
struct Version {
    #[serde(default = "first")]
    schema: u32,
}

fn first() -> u32 {
    1
}

/// Reads a record of this schema or an earlier one. A torn last line is reported and left out; any other line that is not a row is an error,
/// and so is a line of a later schema.
pub fn read(path: &Path) -> anyhow::Result<Record> {
    let text = std::fs::read(path).map_err(|e| anyhow::anyhow!("cannot read the record {}: {e}", path.display()))?;
    let mut beside = None;
    let (mut rows, mut warnings) = (Vec::new(), Vec::new());
    for (number, line) in text.split_inclusive(|&b| b == b'\n').enumerate() {
        let at = || format!("{}: line {}", path.display(), number + 1);
        if !line.ends_with(b"\n") {
            warnings.push(format!("{} is torn (the run was killed while writing it) and was ignored", at()));
        } else if !line.trim_ascii().is_empty() {
            if let Ok(Version { schema }) = serde_json::from_slice(line)
                && schema > SCHEMA
            {
                let known = format!("this contactbench ({}) reads schemas 1 to {SCHEMA}", env!("CARGO_PKG_VERSION"));
                anyhow::bail!("{} has record schema {schema}, and {known}: take the version that wrote it, or a later one", at());
            }
            let mut row: Row = serde_json::from_slice(line).map_err(|e| anyhow::anyhow!("{} is not a row: {e}", at()))?;
            if row.machine.is_empty() {
                row.machine.clone_from(beside.get_or_insert_with(|| provenance::machine_of(path.parent())));
            }
            rows.push(row);
        }
    }
    Ok(Record { rows, warnings })
}
