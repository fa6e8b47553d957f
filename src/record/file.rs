//! The record as a file: one JSON line per measurement, appended and never edited.

use std::fs::{File, OpenOptions};
use std::io::{self, BufRead, BufReader, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::record::faults::{self, Fault};
use crate::record::ledger::Ledger;
use crate::record::provenance;
use crate::record::row::Row;
use crate::record::seal::{self, Flaw};

/// The name of the record in a result folder.
pub const FILE: &str = "samples.jsonl";

/// The version of the record's schema, the field `schema` of every row: see docs/RECORD.md. 3 had no
/// check of the line.
pub const SCHEMA: u32 = 4;
/// The oldest schema that is read.
const OLDEST: u32 = 3;
/// From this schema on every line ends with a check of itself.
pub const SEALED: u32 = 4;

/// A line of the record.
#[derive(Serialize)]
struct Line<'a> {
    schema: u32,
    #[serde(flatten)]
    row: &'a Row,
}

/// A row that could not be written. The record ends with the row before it.
#[derive(Debug, thiserror::Error)]
#[error(
    "cannot write to {}: {cause}; the {rows} rows before stand there and are whole",
    path.display()
)]
pub struct WriteError {
    /// The record.
    pub path: PathBuf,
    /// Its rows.
    pub rows: u64,
    /// Why.
    pub cause: io::Error,
}

/// Appends rows to a record; each is written, as one whole line, before the next is measured: a
/// killed run loses at most one.
pub struct Writer {
    file: File,
    path: PathBuf,
    /// The bytes of the whole lines.
    end: u64,
    rows: u64,
}

impl Writer {
    /// Opens a record for appending. A torn last line (of a killed run) is cut off. Fails where
    /// another process is writing to it.
    pub fn append(path: &Path) -> io::Result<Writer> {
        let mut file =
            OpenOptions::new().create(true).read(true).write(true).truncate(false).open(path)?;
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
        let failed = |writer: &Writer, cause| WriteError {
            path: writer.path.clone(),
            rows: writer.rows,
            cause,
        };
        let object = serde_json::to_string(&Line { schema: SCHEMA, row })
            .map_err(|e| failed(self, e.into()))?;
        let line = seal::sealed(&object) + "\n";
        if let Err(cause) = self.file.write_all(line.as_bytes()) {
            // Should this fail, too, the torn line is cut off when the run is resumed.
            let _ = self
                .file
                .set_len(self.end)
                .and_then(|()| self.file.seek(SeekFrom::Start(self.end)));
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

/// The version of a line; 0 where it has none.
#[derive(Deserialize)]
struct Version {
    #[serde(default)]
    schema: u32,
}

/// Reads a record of this schema or an earlier one. A torn last line is reported and left out. A
/// line of a later schema is an error; lines that are damaged, or that contradict themselves or
/// others, are a `faults::Damaged` record, which names them all.
pub fn read(path: &Path) -> anyhow::Result<Record> {
    let text = std::fs::read(path)
        .map_err(|e| anyhow::anyhow!("cannot read the record {}: {e}", path.display()))?;
    let mut beside = None;
    let (mut rows, mut lines, mut warnings) = (Vec::new(), Vec::new(), Vec::new());
    let (mut found, mut newest) = (Vec::new(), 0);
    for (number, line) in text.split_inclusive(|&b| b == b'\n').enumerate() {
        let at = || format!("{}: line {}", path.display(), number + 1);
        if !line.ends_with(b"\n") {
            warnings.push(format!(
                "{} is torn (the run was killed while writing it) and was ignored",
                at()
            ));
        } else if !line.trim_ascii().is_empty() {
            // What is no JSON is damaged, not old.
            let schema = serde_json::from_slice(line).map_or(SCHEMA, |it: Version| it.schema);
            if schema > SCHEMA || schema < OLDEST && newest == 0 {
                let or = if schema > SCHEMA { ", or a later one" } else { "" };
                anyhow::bail!(
                    "{} has record schema {schema}, and this contactbench ({}) reads schemas \
                     {OLDEST} to {SCHEMA}: take the version that wrote it{or}",
                    at(),
                    env!("CARGO_PKG_VERSION")
                );
            }
            newest = schema.max(newest);
            match whole(line, schema, newest) {
                Ok(row) => {
                    rows.push(row);
                    lines.push(number + 1);
                }
                Err(what) => found.push((number + 1, what)),
            }
        }
    }
    for row in rows.iter_mut().filter(|row: &&mut Row| row.id.machine.is_none()) {
        let machine = beside.get_or_insert_with(|| provenance::machine_of(path.parent()));
        row.id.machine.clone_from(machine);
    }
    let ledger = Ledger::read(path.parent().unwrap_or(Path::new(".")));
    found.extend(faults::faults(&rows, &ledger).into_iter().map(|(k, what)| (lines[k], what)));
    found.sort();
    let fault = |(line, what)| Fault { place: format!("{}:{line}", path.display()), what };
    faults::sound(found.into_iter().map(fault).collect())?;
    Ok(Record { rows, warnings })
}

/// The row of a line that is as it was written; or what is wrong with it.
fn whole(line: &[u8], schema: u32, newest: u32) -> Result<Row, String> {
    let row = serde_json::from_slice(line).map_err(|e| format!("it is not a row: {e}"))?;
    if schema < OLDEST || schema < newest && newest >= SEALED {
        return Err(format!("its schema is {schema}, after lines of schema {newest}"));
    }
    // A check is verified wherever there is one: an edit can make a line look older.
    match seal::verify(line) {
        Err(Flaw::Absent) if schema < SEALED => Ok(row),
        verified => verified.map(|()| row).map_err(|flaw| flaw.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::record::id::CellId;
    use crate::record::ledger::{self, Entry, Process};
    use crate::record::outcome::{Outcome, Pass};
    use crate::record::role::Role;
    use crate::record::row::Course;
    use contactbench_terms::errors::{Causes, Errors};
    use contactbench_terms::moved::Moved;

    /// A row with something in every field.
    fn full() -> Row {
        let mut row = Row {
            id: CellId {
                machine: Some("here".into()),
                experiment: "e".into(),
                dim: 2,
                params: [("s".to_string(), 0.5.into())].into(),
                seed: u64::MAX,
                ..CellId::default()
            },
            role: Role::Twin("nbs".into()),
            outcome: Outcome::Wrong,
            errors: Some(Errors { missed: 3, ..Errors::default() }),
            causes: Some(Causes {
                search: Errors { missed: 3, ..Errors::default() },
                ..Causes::default()
            }),
            time_ns: Some(7),
            calls: Some(2),
            elapsed_ns: Some(15),
            pass: Pass::Time,
            block: 3,
            process: Some("01234567".into()),
            span: Some("89abcdef".into()),
            rounds_ns: vec![1, 2],
            alone_ns: Some(1),
            began_ms: Some(1_700_000_000_000),
            pulse_ns: Some(5),
            processor: Some(1),
            building_ns: Some(1),
            median_step_ns: Some(6),
            worst_step_ns: Some(8),
            course: Some(Course {
                builds: 2,
                first_wrong: Some(1),
                wrong_frames: 1,
                worst_missed: 3,
                ..Course::default()
            }),
            moved: Some(Moved { frames: 2, uncounted: Some("far".into()), ..Moved::default() }),
            ..Row::default()
        };
        row.id = row.id.with_threads(2).with_contender("streamed-nbs:level=avx2");
        row
    }

    fn line(row: &Row) -> serde_json::Value {
        serde_json::to_value(Line { schema: SCHEMA, row }).unwrap()
    }

    /// A folder with the process of the full row.
    fn folder() -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        let id = full().process.unwrap();
        let process = Entry::Process(Process { id, ..Process::default() });
        ledger::Writer::append(folder.path()).unwrap().write(&process).unwrap();
        folder
    }

    fn read_text(text: &str) -> anyhow::Result<Record> {
        let folder = folder();
        std::fs::write(folder.path().join(FILE), text).unwrap();
        read(&folder.path().join(FILE))
    }

    #[test]
    fn a_row_is_read_as_it_was_written() {
        let folder = folder();
        let path = folder.path().join(FILE);
        let plain = Row { id: full().id.with_contender("nbs"), ..Row::default() };
        let mut writer = Writer::append(&path).unwrap();
        writer.write(&full()).unwrap();
        writer.write(&plain).unwrap();
        assert_eq!(read(&path).unwrap().rows, [full(), plain.clone()]);
        assert_eq!(line(&full())["resources"], serde_json::json!({"threads": 2}));
        assert_eq!(line(&full())["role"], serde_json::json!({"twin": "nbs"}));
        assert_eq!(line(&full())["detector_params"], serde_json::json!({"level": "avx2"}));
        assert_eq!(line(&plain).get("detector_params"), None);
    }

    #[test]
    fn rows_of_other_schemas_are_refused() {
        for (schema, words) in [
            ("", "has record schema 0"),
            ("\"schema\": 2,", "record schema 2, and this contactbench"),
            ("\"schema\": 5,", "reads schemas 3 to 4: take the version that wrote it, or a later"),
        ] {
            let mut fields = line(&full());
            fields.as_object_mut().unwrap().remove("schema");
            let text = fields.to_string().replacen('{', &format!("{{{schema}"), 1) + "\n";
            let error = read_text(&text).err().unwrap().to_string();
            assert!(error.contains(words), "{error}");
        }
    }

    #[test]
    fn every_committed_record_is_read() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let old = std::fs::read_dir(root.join("tests/records")).unwrap();
        let folders = old.map(|entry| entry.unwrap().path()).chain(crate::committed::committed());
        let mut rows = 0;
        for folder in folders {
            let path = folder.join(FILE);
            if path.exists() {
                let record = read(&path).unwrap();
                assert!(record.warnings.is_empty(), "{:?}", record.warnings);
                let known = |row: &Row| row.id.threads() > 0 && row.id.machine.is_some();
                assert!(record.rows.iter().all(known), "{}", path.display());
                assert!(record.rows.iter().any(|row| row.role == Role::Detector));
                rows += record.rows.len();
            }
        }
        assert!(rows > 10_000, "{rows}");
    }

    /// Every field of a row has a line in docs/RECORD.md, and none has that is not there.
    #[test]
    fn the_page_on_the_record_names_every_field() {
        let page = include_str!("../../docs/RECORD.md");
        let documented: BTreeSet<String> = page
            .split("\n## Columns\n")
            .next()
            .into_iter()
            .flat_map(str::lines)
            .filter_map(|line| line.strip_prefix("| `")?.split('`').next())
            .map(String::from)
            .collect();
        let mut fields = BTreeSet::from([seal::NAME.to_string()]);
        for (name, value) in line(&full()).as_object().unwrap() {
            let nested = ["stats", "errors", "causes", "course", "moved"].contains(&name.as_str());
            for (inner, value) in value.as_object().filter(|_| nested).into_iter().flatten() {
                let of_way = value.as_object().filter(|_| inner == "way");
                match of_way {
                    Some(way) => {
                        fields.extend(way.keys().map(|key| format!("{name}.{inner}.{key}")));
                    }
                    None => drop(fields.insert(format!("{name}.{inner}"))),
                }
            }
            fields.insert(name.clone());
        }
        assert_eq!(documented, fields);
        assert!(page.contains(&format!("**schema {SCHEMA}**")));
    }
}
