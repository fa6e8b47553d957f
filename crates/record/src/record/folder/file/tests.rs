use super::*;
use crate::record::folder::ledger::{self, Entry, Process};
use crate::record::outcome::{Outcome, Pass};
use crate::record::role::Role;
use crate::record::row::Course;
use contactbench_terms::errors::{Causes, Errors};
use contactbench_terms::moved::Moved;

fn full() -> Row {
    let missed = Errors { missed: 3, ..Errors::default() };
    let course = Course { builds: 2, first_wrong: Some(1), wrong_frames: 1, ..Course::default() };
    let mut row = Row {
        role: Role::Twin("nbs".into()),
        outcome: Outcome::Wrong,
        errors: Some(missed),
        causes: Some(Causes { search: missed, ..Causes::default() }),
        time_ns: Some(7),
        calls: Some(2),
        elapsed_ns: Some(15),
        pass: Pass::Time,
        block: 3,
        process: Some("01234567".into()),
        rounds_ns: vec![1, 2],
        processor: Some(1),
        course: Some(Course { worst_missed: 3, ..course }),
        moved: Some(Moved { frames: 2, ..Moved::default() }),
        ..Row::default()
    };
    row.id = row.id.with_threads(2).with_subject("streamed-nbs:level=avx2");
    (row.id.experiment, row.id.machine) = ("e".into(), Some("here".into()));
    (row.id.dim, row.id.seed) = (2, u64::MAX);
    row.id.params.insert("s".into(), 0.5.into());
    row
}

fn line(row: &Row) -> serde_json::Value {
    serde_json::to_value(Line { schema: SCHEMA, row }).unwrap()
}

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let id = full().process.unwrap();
    let process = Entry::Process(Process { id, ..Process::default() });
    ledger::Writer::append(folder.path()).unwrap().write(&process).unwrap();
    folder
}

#[test]
fn a_row_is_read_as_it_was_written() {
    let folder = folder();
    let path = folder.path().join(FILE);
    let id = full().id.with_subject("nbs");
    let plain = Row { id, outcome: Outcome::Lossy, ..Row::default() };
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
fn a_compressed_record_is_read_and_never_appended_to() {
    use flate2::{Compression, write::GzEncoder};
    let (folder, text) = (folder(), seal::sealed(&line(&full()).to_string()) + "\n");
    let path = folder.path().join(FILE);
    let pack = |text: &str, cut: usize| {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
        encoder.write_all(text.as_bytes()).unwrap();
        let bytes = encoder.finish().unwrap();
        std::fs::write(packed(&path), &bytes[..bytes.len() - cut]).unwrap();
    };
    let refusal = |path: &Path| read(path).err().unwrap().to_string();
    assert!(!exists(&path) && unpacked(&path).is_ok());
    pack(&text, 0);
    assert!(exists(&path) && !path.exists());
    assert!(unpacked(&path).unwrap_err().to_string().contains("unpack it with gunzip"));
    for path in [&path, &packed(&path)] {
        let record = read(path).unwrap();
        assert_eq!((record.rows, record.bytes), (vec![full()], text.len() as u64));
    }
    pack(&text.replace("\"e\"", "\"f\""), 0);
    assert!(refusal(&path).contains("samples.jsonl.gz:1: its check does not match"));
    pack(&text, 9);
    assert!(refusal(&path).contains("samples.jsonl.gz: it cannot be unpacked: "));
    // A small file that unpacks to one line of 20 MiB.
    pack(&"0".repeat(20 << 20), 0);
    assert!(refusal(&path).contains("samples.jsonl.gz:1: it is longer than a row"));
    std::fs::write(&path, &text).unwrap();
    assert!(refusal(&path).contains("samples.jsonl.gz both exist; delete one of them"));
}
