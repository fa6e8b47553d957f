//! The record as a file: one JSON line per measurement, appended and never edited.

use std::fs::{File, OpenOptions};
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use flate2::read::MultiGzDecoder;
use serde::{Deserialize, Serialize};

use crate::record::faults::{self, Fault};
use crate::record::ledger::Ledger;
use crate::record::provenance;
use crate::record::row::Row;
use crate::record::seal::{self, Flaw};

pub const FILE: &str = "samples.jsonl";

const PACKED: &str = ".gz";
/// Bytes of a line that is too long to be a row.
const LONGEST: u64 = 1 << 24;
/// Damaged lines after which the rest of a record is not read.
const MOST_FAULTS: usize = 10_000;
/// Bytes, unpacked, after which the rest of a record is not read.
const MOST_BYTES: u64 = 4 << 30;

/// The version of the record's schema, the field `schema` of every row: see docs/RECORD.md. 3 had
/// no check of the line.
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
    pub path: PathBuf,
    pub rows: u64,
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

#[derive(Default)]
pub struct Record {
    pub rows: Vec<Row>,
    /// Sentences about lines that were left out.
    pub warnings: Vec<String>,
    /// Its length in bytes, unpacked.
    pub bytes: u64,
}

/// The version of a line; 0 where it has none.
#[derive(Deserialize)]
struct Version {
    #[serde(default)]
    schema: u32,
}

fn packed(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(PACKED);
    name.into()
}

/// Returns whether the record is there, compressed or not.
pub fn exists(path: &Path) -> bool {
    path.exists() || packed(path).exists()
}

/// Fails if there is a compressed record at `path`: rows cannot be appended to it.
pub fn unpacked(path: &Path) -> anyhow::Result<()> {
    let packed = packed(path);
    anyhow::ensure!(
        !packed.exists(),
        "{} is a compressed record, to which nothing is appended; unpack it with gunzip, or choose \
         another folder with --out",
        packed.display()
    );
    Ok(())
}

/// The file of a record, and its text, unpacked.
fn text(path: &Path) -> anyhow::Result<(PathBuf, Box<dyn BufRead>)> {
    let named = path.to_string_lossy().ends_with(PACKED);
    let plain = if named { path.with_extension("") } else { path.to_path_buf() };
    let packed = packed(&plain);
    let open = |path: &Path| {
        let cannot = |e| anyhow::anyhow!("cannot read the record {}: {e}", path.display());
        File::open(path).map_err(cannot)
    };
    if !packed.exists() {
        let file = open(&plain)?;
        return Ok((plain, Box::new(BufReader::new(file))));
    }
    anyhow::ensure!(
        !plain.exists(),
        "{} and {} are both there; delete one of them",
        plain.display(),
        packed.display()
    );
    let unpacked = MultiGzDecoder::new(open(&packed)?);
    Ok((packed, Box::new(BufReader::new(unpacked))))
}

/// Reads a record of this schema or an earlier one, compressed or not. A torn last line is reported
/// and left out. A line of a later schema is an error; lines that are damaged, or that contradict
/// themselves or others, are a `faults::Damaged` record, which names them all.
pub fn read(path: &Path) -> anyhow::Result<Record> {
    let (path, mut text) = text(path)?;
    let (mut beside, mut bytes, mut line) = (None, 0, Vec::new());
    let (mut rows, mut lines, mut warnings) = (Vec::new(), Vec::new(), Vec::new());
    let (mut found, mut newest) = (Vec::new(), 0);
    for number in 1.. {
        let length = next_line(&mut *text, &path, &mut line)?;
        bytes += length;
        if length == 0 {
            break;
        }
        let at = || format!("{}: line {number}", path.display());
        // A few bytes may unpack to one endless line, or to very many.
        let why = match () {
            () if length == LONGEST => Some("it is longer than a row"),
            () if found.len() == MOST_FAULTS => Some("too many faults"),
            () if bytes > MOST_BYTES => Some("the record is longer than 4 GiB"),
            () => None,
        };
        if let Some(why) = why {
            found.push((number, format!("{why}: the rest is not read")));
            break;
        } else if !line.ends_with(b"\n") {
            warnings.push(format!(
                "{} is torn (the run was killed while writing it) and was ignored",
                at()
            ));
        } else if !line.trim_ascii().is_empty() {
            let schema = schema_of(&line, newest, at)?;
            newest = schema.max(newest);
            match whole(&line, schema, newest) {
                Ok(row) => {
                    rows.push(row);
                    lines.push(number);
                }
                Err(what) => found.push((number, what)),
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
    Ok(Record { rows, warnings, bytes })
}

/// Reads the next line of a record; one of `LONGEST` bytes is only the beginning of a line.
fn next_line(text: &mut dyn BufRead, path: &Path, line: &mut Vec<u8>) -> anyhow::Result<u64> {
    line.clear();
    match text.take(LONGEST).read_until(b'\n', line) {
        Ok(length) => Ok(length as u64),
        Err(e) if path.to_string_lossy().ends_with(PACKED) => {
            let what = format!("it cannot be unpacked: {e}");
            Err(faults::Damaged(vec![Fault { place: path.display().to_string(), what }]).into())
        }
        Err(e) => anyhow::bail!("cannot read the record {}: {e}", path.display()),
    }
}

/// The schema of a line, which must be one that is read.
fn schema_of(line: &[u8], newest: u32, at: impl Fn() -> String) -> anyhow::Result<u32> {
    // A line that is not JSON is damaged, and has no schema.
    let version = serde_json::from_slice(line).map(|it: Version| it.schema);
    let schema = version.unwrap_or(newest.max(OLDEST));
    let or = if schema > SCHEMA { ", or a later one" } else { "" };
    anyhow::ensure!(
        (OLDEST..=SCHEMA).contains(&schema) || schema < OLDEST && newest > 0,
        "{} has record schema {schema}, and this contactbench ({}) reads schemas {OLDEST} to \
         {SCHEMA}: take the version that wrote it{or}",
        at(),
        env!("CARGO_PKG_VERSION")
    );
    Ok(schema)
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
mod tests;
