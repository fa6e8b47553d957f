//! Processes and spans that rows point to: the programs that answered, and the machine's load while
//! they were timed. Each is one JSON line beside the record, appended and never edited.
//!
//! A process is written before the first row that points to it, a span after its last row. A killed
//! run leaves rows without their span, and the load is then unknown.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::{File, OpenOptions};
use std::io::{self, Write};
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::record::faults::Damaged;
use crate::record::folder::{copies, file, seal};
use contactbench_terms::must;

pub const FILE: &str = "provenance.jsonl";

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "entry", rename_all = "lowercase")]
pub enum Entry {
    Process(Process),
    Span(Span),
}

/// A program. All its processes with the same libraries and instruction sets share one entry.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Process {
    pub id: String,
    /// The program, and files that its command names, such as a script.
    pub files: Vec<Executed>,
    /// Version of the program or of the library behind it; may be empty.
    #[serde(default)]
    pub version: String,
    /// Further properties: features, instruction set level, compiler, libraries.
    #[serde(default)]
    pub build: BTreeMap<String, String>,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Executed {
    pub name: String,
    /// The SHA-256 in hexadecimal; `None` if the file cannot be read.
    pub sha256: Option<String>,
}

/// The load of the machine while the blocks of one scene were timed.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Span {
    pub id: String,
    pub scene: String,
    /// Number of rows that were written during the span; `None` in older records.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rows: Option<u64>,
    /// Number of rows that had been deleted when a run was resumed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub deleted: Option<u64>,
    pub seconds: f64,
    pub cores: u64,
    /// Processor time of the harness and its runners, in seconds.
    pub own_s: f64,
    pub others_s: f64,
    /// Seconds in which a core was ready but the host ran another virtual machine on it.
    pub stolen_s: f64,
    /// Load average of the minute before the span, including the run's own processes.
    pub load_before: Option<f64>,
    pub load_after: Option<f64>,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ledger {
    pub processes: BTreeMap<String, Process>,
    pub spans: BTreeMap<String, Span>,
}

impl Ledger {
    /// Reads the entries of a folder; older records have none. Invalid lines are skipped;
    /// [`sound`] refuses them.
    pub fn read(folder: &Path) -> Ledger {
        let text = std::fs::read(folder.join(FILE)).unwrap_or_default();
        let mut ledger = Ledger::default();
        lines(&text).filter_map(|(_, entry)| entry.ok()).for_each(|entry| ledger.add(entry));
        ledger
    }

    pub fn join(&mut self, other: Ledger) {
        self.processes.extend(other.processes);
        self.spans.extend(other.spans);
    }

    pub fn text(&self) -> String {
        let processes = self.processes.values().cloned().map(Entry::Process);
        let entries = processes.chain(self.spans.values().cloned().map(Entry::Span));
        entries.filter_map(|entry| line(&entry).ok()).collect()
    }

    fn add(&mut self, entry: Entry) {
        match entry {
            Entry::Process(it) => _ = self.processes.insert(it.id.clone(), it),
            Entry::Span(it) => _ = self.spans.insert(it.id.clone(), it),
        }
    }
}

fn line(entry: &Entry) -> serde_json::Result<String> {
    Ok(seal::sealed(&serde_json::to_string(entry)?) + "\n")
}

/// The lines of a ledger with their numbers. Text after the last newline is from a killed run and
/// ignored.
fn lines(text: &[u8]) -> impl Iterator<Item = (usize, Result<Entry, String>)> {
    let lines = text.split_inclusive(|&byte| byte == b'\n').enumerate();
    lines.filter(|(_, line)| line.ends_with(b"\n")).map(|(k, line)| {
        let entry = serde_json::from_slice(line)
            .map_err(|e| format!("it is not an entry of a process or a span: {e}"));
        let sealed = seal::verify(line);
        (k + 1, entry.and_then(|entry| sealed.map(|()| entry)))
    })
}

pub fn sound(path: &Path) -> Result<(), Damaged> {
    let text = std::fs::read(path).unwrap_or_default();
    let mut spans = BTreeMap::new();
    lines(&text).try_for_each(|(k, entry)| {
        let sound = entry.and_then(|entry| possible(entry, &mut spans));
        sound.map_err(|what| Damaged::at_line(path, k, &what))
    })
}

/// Fails if the id of a process is not the start of the SHA-256 of its other fields, if a number of
/// a span is impossible, or if an earlier span with the same id differs. A resumed run repeats
/// spans with other numbers of rows.
fn possible(entry: Entry, known: &mut BTreeMap<String, Span>) -> Result<(), String> {
    let span = match entry {
        Entry::Span(span) => Span { rows: None, deleted: None, ..span },
        Entry::Process(process) => {
            let (id, unnamed) = (process.id.clone(), Process { id: String::new(), ..process });
            let sum = copies::sha256(&serde_json::to_vec(&unnamed).unwrap_or_default());
            let is_sum = id.len() == 8 && sum.starts_with(&id);
            must!(is_sum, "its id is {id}, and its fields have {sum}");
            return Ok(());
        }
    };
    // The system's clocks have coarse ticks.
    let most = span.cores as f64 * (1.1 * span.seconds + 0.1);
    for (name, value, least, most) in [
        ("seconds", span.seconds, 0.0, 1e9),
        ("cores", span.cores as f64, 1.0, 1e6),
        ("own_s", span.own_s, 0.0, most),
        ("others_s", span.others_s, 0.0, most),
        ("stolen_s", span.stolen_s, 0.0, most),
    ] {
        let is_possible = (least..=most).contains(&value);
        must!(is_possible, "its {name} is {value}: from {least} to {most} is possible");
    }
    let before = known.entry(span.id.clone()).or_insert_with(|| span.clone());
    must!(*before == span, "it differs from an earlier span with the id {}", span.id);
    Ok(())
}

pub struct Writer {
    file: File,
    known: BTreeSet<String>,
}

impl Writer {
    /// Opens the file for appending, and cuts off an incomplete line of a killed run.
    pub fn append(folder: &Path) -> io::Result<Writer> {
        let known = Ledger::read(folder).processes.into_keys().collect();
        let path = folder.join(FILE);
        let file = OpenOptions::new().create(true).read(true).append(true).open(path)?;
        file.set_len(file::whole_lines(&file)?.0)?;
        Ok(Writer { file, known })
    }

    pub fn write(&mut self, entry: &Entry) -> io::Result<()> {
        if let Entry::Process(process) = entry
            && !self.known.insert(process.id.clone())
        {
            return Ok(());
        }
        self.file.write_all(line(entry)?.as_bytes())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_are_read_as_they_were_written_and_torn_ones_are_left_out() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(Ledger::read(folder.path()), Ledger::default());
        let file = Executed { name: "nbs".into(), sha256: Some("00".into()) };
        let build = [("level".to_string(), "avx2".to_string())].into();
        let id = "2b575a36".into();
        let process = Process { id, files: vec![file], build, ..Process::default() };
        let span = Span { id: "b".into(), seconds: 0.1, cores: 2, ..Span::default() };
        let span = Span { load_before: Some(1.5), ..span };
        for _ in 0..2 {
            let mut writer = Writer::append(folder.path()).unwrap();
            writer.write(&Entry::Process(process.clone())).unwrap();
            writer.write(&Entry::Span(span.clone())).unwrap();
            writer.file.write_all(b"{\"entry\":\"spa\xc3").unwrap();
            assert_eq!(sound(&folder.path().join(FILE)), Ok(()));
        }
        let read = Ledger::read(folder.path());
        assert_eq!(read.processes.values().collect::<Vec<_>>(), [&process]);
        assert_eq!(read.spans.values().collect::<Vec<_>>(), [&span]);
        let text = std::fs::read(folder.path().join(FILE)).unwrap();
        let text = String::from_utf8_lossy(&text);
        assert_eq!(text.matches("\"process\"").count(), 1, "{text}");
        let mut joined = read.clone();
        joined.join(read.clone());
        assert_eq!(joined, read);
        let path = folder.path().join(FILE);
        std::fs::write(&path, read.text()).unwrap();
        assert_eq!(Ledger::read(folder.path()), read);
        assert_eq!(sound(&path), Ok(()));
        let busy = read.text().replace("\"others_s\":0.0", "\"others_s\":1.0");
        std::fs::write(&path, busy).unwrap();
        let what = sound(&path).unwrap_err().to_string();
        assert!(what.contains(".jsonl:2: ") && what.contains("edited"), "{what}");
    }
}
