//! Reads and writes the record file: one JSON line per measurement, appended and never edited.

use std::fs::{File, OpenOptions};
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use flate2::read::MultiGzDecoder;
use serde::{Deserialize, Serialize};

use crate::record::faults::{self, Damaged};
use crate::record::folder::ledger::Ledger;
use crate::record::folder::{regular, seal};
use crate::record::row::Row;

pub const FILE: &str = "samples.jsonl";

const PACKED: &str = ".gz";
const LONGEST: u64 = 1 << 24;
/// Number of unpacked bytes after which reading stops.
const MOST_BYTES: u64 = 4 << 30;

/// Version of the record's schema, the field `schema` of every row; see docs/RECORD.md.
pub const SCHEMA: u32 = 4;

#[derive(Serialize)]
struct Line<'a> {
    schema: u32,
    #[serde(flatten)]
    row: &'a Row,
}

/// Appends rows to a record. Each is written as one line before the next is measured, so a killed
/// run loses at most one row.
pub struct Writer {
    file: File,
    path: PathBuf,
    end: u64,
    rows: u64,
}

impl Writer {
    /// Opens a record for appending, and cuts off an incomplete last line of a killed run. Fails if
    /// another process is writing to it.
    pub fn append(path: &Path) -> io::Result<Writer> {
        let mut file =
            OpenOptions::new().create(true).read(true).write(true).truncate(false).open(path)?;
        // File systems without locks are accepted.
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

    /// Writes one row. If that fails, for example because the disk is full, the partial line is
    /// removed.
    pub fn write(&mut self, row: &Row) -> io::Result<()> {
        let object = serde_json::to_string(&Line { schema: SCHEMA, row })?;
        let line = seal::sealed(&object) + "\n";
        if let Err(cause) = self.file.write_all(line.as_bytes()) {
            let whole = self.file.set_len(self.end);
            let _ = whole.and_then(|()| self.file.seek(SeekFrom::Start(self.end)));
            let (path, rows) = (self.path.display(), self.rows);
            let words = format!("the {rows} rows before it are complete");
            let words = format!("cannot write to {path}: {cause}; {words}");
            return Err(io::Error::new(cause.kind(), words));
        }
        self.end += line.len() as u64;
        self.rows += 1;
        Ok(())
    }
}

/// The length of all whole lines, and the number of those that are not blank.
pub(super) fn whole_lines(file: &File) -> io::Result<(u64, u64)> {
    let (mut end, mut rows, mut line) = (0, 0, Vec::new());
    let mut reader = BufReader::new(file);
    while reader.read_until(b'\n', &mut line)? > 0 && line.ends_with(b"\n") {
        end += line.len() as u64;
        rows += u64::from(!line.trim_ascii().is_empty());
        line.clear();
    }
    Ok((end, rows))
}

#[derive(Default)]
pub struct Record {
    pub rows: Vec<Row>,
    pub warnings: Vec<String>,
    pub bytes: u64,
}

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

/// Whether there is a record, compressed or not.
pub fn exists(path: &Path) -> bool {
    path.exists() || packed(path).exists()
}

/// Fails if the record is compressed, because rows cannot be appended to it.
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

fn text(path: &Path) -> anyhow::Result<(PathBuf, Box<dyn BufRead>)> {
    let named = path.to_string_lossy().ends_with(PACKED);
    let plain = if named { path.with_extension("") } else { path.to_path_buf() };
    let packed = packed(&plain);
    let open = |path: &Path| {
        let cannot = |e| anyhow::anyhow!("cannot read the record {}: {e}", path.display());
        regular(path)?;
        File::open(path).map_err(cannot)
    };
    if !packed.exists() {
        let file = open(&plain)?;
        return Ok((plain, Box::new(BufReader::new(file))));
    }
    anyhow::ensure!(
        !plain.exists(),
        "{} and {} both exist; delete one of them",
        plain.display(),
        packed.display()
    );
    let unpacked = MultiGzDecoder::new(open(&packed)?);
    Ok((packed, Box::new(BufReader::new(unpacked))))
}

/// Reads a record, compressed or not. An incomplete last line is left out with a warning. A line of
/// another schema is an error. The first damaged or contradictory line is reported as [`Damaged`].
pub fn read(path: &Path) -> anyhow::Result<Record> {
    let (path, mut text) = text(path)?;
    let (mut record, mut line, mut lines) = (Record::default(), Vec::new(), Vec::new());
    for number in 1.. {
        let length = next_line(&mut *text, &path, &mut line)?;
        record.bytes += length;
        if length == 0 {
            break;
        }
        let damaged = |what: &str| Damaged::at_line(&path, number, what);
        let at = || format!("{}: line {number}", path.display());
        anyhow::ensure!(length < LONGEST, damaged("it is longer than a row"));
        anyhow::ensure!(record.bytes <= MOST_BYTES, damaged("the record is longer than 4 GiB"));
        if !line.ends_with(b"\n") {
            record.warnings.push(format!(
                "{} is torn (the run was killed while writing it) and was ignored",
                at()
            ));
        } else if !line.trim_ascii().is_empty() {
            // A line that is not JSON is damaged, and has no schema.
            let schema = serde_json::from_slice(&line).map_or(SCHEMA, |it: Version| it.schema);
            anyhow::ensure!(
                schema == SCHEMA,
                "{} has record schema {schema}, and this contactbench ({}) reads schema {SCHEMA}: \
                 use the version that wrote it",
                at(),
                env!("CARGO_PKG_VERSION")
            );
            record.rows.push(whole(&line).map_err(|what| damaged(&what))?);
            lines.push(number);
        }
    }
    let ledger = Ledger::read(path.parent().unwrap_or(Path::new(".")));
    match faults::fault(&record.rows, &ledger) {
        Some((k, what)) => Err(Damaged::at_line(&path, lines[k], &what).into()),
        None => Ok(record),
    }
}

/// Reads the next line. A length of `LONGEST` means that the line is longer.
fn next_line(text: &mut dyn BufRead, path: &Path, line: &mut Vec<u8>) -> anyhow::Result<u64> {
    line.clear();
    match text.take(LONGEST).read_until(b'\n', line) {
        Ok(length) => Ok(length as u64),
        Err(e) if path.to_string_lossy().ends_with(PACKED) => {
            Err(Damaged::new(path, format!("it cannot be unpacked: {e}")).into())
        }
        Err(e) => anyhow::bail!("cannot read the record {}: {e}", path.display()),
    }
}

fn whole(line: &[u8]) -> Result<Row, String> {
    let row = serde_json::from_slice(line).map_err(|e| format!("it is not a row: {e}"))?;
    seal::verify(line)?;
    Ok(row)
}

#[cfg(test)]
mod tests;
