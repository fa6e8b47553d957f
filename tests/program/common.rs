//! Helpers for tests of the program: they run it and make files for it.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::{Mutex, Once, PoisonError};

use contactbench::record::row::{self, Measurement, Row};
use serde_json::Value;

pub const PROGRAM: &str = env!("CARGO_BIN_EXE_contactbench");

pub struct Ended {
    pub code: Option<i32>,
    pub stdout: String,
    pub stderr: String,
}

/// Returns a command that runs the program in `folder`, which is also its temporary folder.
/// Colours, width and locale do not depend on the user.
pub fn program(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(PROGRAM);
    command
        .env_remove("CLICOLOR_FORCE")
        .env_remove("COLUMNS")
        .env("LC_ALL", "C.UTF-8")
        .args(arguments)
        .current_dir(folder)
        .env("TMPDIR", folder)
        .stdin(Stdio::null());
    command
}

pub fn run(folder: &Path, arguments: &[&str]) -> Ended {
    ended(program(folder, arguments).output().unwrap())
}

pub struct Place(tempfile::TempDir);

impl Place {
    pub fn new() -> Place {
        Place(tempfile::tempdir().unwrap())
    }

    pub fn root(&self) -> &Path {
        self.0.path()
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.root().join(name)
    }

    pub fn file(&self, name: &str, text: impl AsRef<[u8]>) -> PathBuf {
        file(self.root(), name, text)
    }

    pub fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    pub fn remove(&self, name: &str) {
        let path = self.path(name);
        if path.is_dir() { std::fs::remove_dir_all(path) } else { std::fs::remove_file(path) }
            .unwrap();
    }

    /// Runs the program with the arguments in `line`, split as in a shell.
    pub fn run(&self, line: &str) -> Ended {
        let words = shlex::split(line).unwrap_or_else(|| panic!("a quote is open in {line}"));
        run(self.root(), &words.iter().map(String::as_str).collect::<Vec<_>>())
    }

    /// Like [`Place::run`], for a terminal of this many columns.
    pub fn run_wide(&self, line: &str, columns: usize) -> Ended {
        let words = shlex::split(line).unwrap_or_else(|| panic!("a quote is open in {line}"));
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        let mut program = program(self.root(), &words);
        ended(program.env("COLUMNS", columns.to_string()).output().unwrap())
    }

    /// Runs the program; fails unless it has this exit code and prints all these words.
    pub fn ends(&self, code: i32, line: &str, words: &[&str]) -> Ended {
        let ended = self.run(line);
        let said = format!("{}{}", ended.stdout, ended.stderr);
        assert_eq!(ended.code, Some(code), "{line}: {said}");
        words.iter().for_each(|word| assert!(said.contains(word), "{line}: no '{word}' in {said}"));
        ended
    }

    pub fn good(&self, line: &str) -> Ended {
        self.ends(0, line, &[])
    }

    pub fn shell(&self, script: &str) -> Ended {
        let mut shell = Command::new("sh");
        shell.args(["-c", script]).current_dir(self.root()).env("TMPDIR", self.root());
        ended(shell.stdin(Stdio::null()).output().unwrap())
    }

    /// Returns the JSON that a run prints; the exit code must be 0 or 1.
    pub fn json(&self, line: &str) -> Value {
        let ended = self.run(&format!("{line} --json"));
        assert!(matches!(ended.code, Some(0 | 1)), "{line}: {}", ended.stderr);
        serde_json::from_str(&ended.stdout).unwrap_or_else(|_| panic!("{line}: {}", ended.stdout))
    }

    /// Returns the rows of a record; fails if reading it gives warnings.
    pub fn rows(&self, folder: &str) -> Vec<Row> {
        let record = row::read(&self.path(folder).join(row::FILE)).unwrap();
        assert!(record.warnings.is_empty(), "{:?}", record.warnings);
        record.rows
    }
}

pub fn ended(output: Output) -> Ended {
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    Ended { code: output.status.code(), stdout: text(output.stdout), stderr: text(output.stderr) }
}

pub fn file(folder: &Path, name: &str, text: impl AsRef<[u8]>) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    path
}

pub struct Template(Vec<(PathBuf, Vec<u8>)>);

impl Template {
    /// Runs `make` in a folder and keeps its files.
    pub fn new(make: impl FnOnce(&Place)) -> Template {
        let place = Place::new();
        make(&place);
        let (mut files, mut folders) = (Vec::new(), vec![place.root().to_path_buf()]);
        while let Some(next) = folders.pop() {
            for entry in std::fs::read_dir(next).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    folders.push(path);
                } else {
                    let name = path.strip_prefix(place.root()).unwrap().to_path_buf();
                    files.push((name, std::fs::read(path).unwrap()));
                }
            }
        }
        Template(files)
    }

    pub fn place(&self) -> Place {
        let place = Place::new();
        for (name, bytes) in &self.0 {
            let path = place.root().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, bytes).unwrap();
        }
        place
    }
}

/// Returns an npy file, version 1, of little-endian doubles.
pub fn npy(rows: &[Vec<f64>]) -> Vec<u8> {
    let columns = rows.first().map_or(2, Vec::len);
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    let mut header = format!(
        "{{'descr': '<f8', 'fortran_order': False, 'shape': ({}, {columns}), }}",
        rows.len()
    );
    // The data of an npy file begin at a multiple of 64 bytes; 10 bytes precede the header.
    while (10 + header.len() + 1) % 64 != 0 {
        header.push(' ');
    }
    header.push('\n');
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    rows.iter().flatten().for_each(|x| bytes.extend(x.to_le_bytes()));
    bytes
}

/// Returns the pairs in an npy file written by the program.
pub fn pairs(path: &Path) -> Vec<[u32; 2]> {
    let bytes = std::fs::read(path).unwrap();
    assert!(String::from_utf8_lossy(&bytes[..64]).contains("'descr': '<u4'"));
    let start = bytes.iter().position(|&b| b == b'\n').unwrap() + 1;
    let words: Vec<u32> =
        bytes[start..].chunks_exact(4).map(|b| u32::from_le_bytes(b.try_into().unwrap())).collect();
    words.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect()
}

/// Returns the shell script of a runner in f64 arithmetic. It answers the listed requests with
/// shell code, and replies `unsupported` to all others.
pub fn fake(answers: &[(&str, &str)]) -> String {
    let hello = say(r#"{"reply":"hello","protocol":4,"detector":"fake","arithmetic":"f64"}"#);
    let cases: String = answers
        .iter()
        .map(|(request, code)| format!("*'\"request\":\"{request}\"'*) {code} ;;\n"))
        .collect();
    // The program would wait for a runner that does not reply.
    let rest = say(r#"{"reply":"unsupported"}"#);
    format!("{hello}\nwhile read -r line; do\ncase \"$line\" in\n{cases}*) {rest} ;;\nesac\ndone")
}

pub fn say(line: &str) -> String {
    format!("echo '{line}'")
}

/// Returns a runner that loads scenes, gives these answers, and replies `unsupported` to all else.
pub fn answers(answers: &[(&str, &str)]) -> String {
    let loaded = say(r#"{"reply":"loaded"}"#);
    fake(&[answers, &[("load", &*loaded)]].concat())
}

/// Returns shell code that answers with a sample of a plausible time.
pub fn sample(contacts: u32, digest: &str) -> String {
    let times = r#""reply":"sample","time_ns":300000,"calls":1,"elapsed_ns":300000"#;
    let line = format!(r#"{{{times},"contacts":{contacts},"digest":"{digest}"}}"#);
    format!("sleep 0.002; {}", say(&line))
}

/// Returns the table of a runner in an experiment: `program` and a shell script.
pub fn runner(name: &str, program: &str, script: &str) -> String {
    format!(
        "[[runner]]\nname = \"{name}\"\ncommand = [\"{program}\", \"-c\", \
         '''\n{script}''']\ninstall = \"apt install it\"\n"
    )
}

static UNTESTED: Mutex<BTreeMap<String, String>> = Mutex::new(BTreeMap::new());

unsafe extern "C" {
    fn atexit(callback: extern "C" fn()) -> std::ffi::c_int;
}

/// Notes that the test `what` is skipped because `missing` is not installed. The test passes, and a
/// line after all tests names it.
pub fn untested(what: &str, missing: &str) {
    static AT_EXIT: Once = Once::new();
    let mut untested = UNTESTED.lock().unwrap_or_else(PoisonError::into_inner);
    untested.insert(what.to_string(), missing.to_string());
    // SAFETY: `atexit` may be called at any time before the end of the process; `summary` takes
    // nothing and does not unwind.
    AT_EXIT.call_once(|| assert_eq!(unsafe { atexit(summary) }, 0));
}

extern "C" fn summary() {
    let untested = UNTESTED.lock().unwrap_or_else(PoisonError::into_inner);
    let all: Vec<String> =
        untested.iter().map(|(what, missing)| format!("{what} (no {missing})")).collect();
    eprintln!("NOT TESTED HERE, {} in all: {}\n", all.len(), all.join("; "));
}

/// Runs a test of a foreign program, one at a time because several MPI programs cannot start
/// together. If `test` fails twice with a reason, the test is skipped for this reason.
pub fn foreign(what: &str, test: impl Fn() -> Result<(), String>) {
    static ALONE: Mutex<()> = Mutex::new(());
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    if let Err(reason) = test().or_else(|_| test()) {
        untested(what, &format!("start in two tries: {reason}"));
    }
}

/// Returns the first line of the errors that shows that MPI could not start.
pub fn not_started(stderr: &str) -> Option<String> {
    let signs = ["ompi_mpi_init", "MPI_Init", "MPI_INIT", "unable to start a daemon", "orte_init"];
    let of_start = |line: &&str| {
        signs.iter().any(|sign| line.to_ascii_lowercase().contains(&sign.to_ascii_lowercase()))
    };
    stderr.lines().find(of_start).map(|line| line.trim().to_string())
}

pub fn starts(program: &str, option: &str) -> bool {
    let mut command = Command::new(program);
    command.arg(option).current_dir(std::env::temp_dir()).stdin(Stdio::null());
    command.output().is_ok_and(|output| output.status.success())
}

/// Returns whether a program is installed; if not, notes that its tests are skipped.
pub fn has(program: &'static str) -> bool {
    let there = starts(program, "--version");
    if !there {
        untested(&format!("runners that need {program}"), program);
    }
    there
}

/// Returns the rows without their times, by measurement; fails if a measurement has two rows.
pub fn steady(rows: &[Row]) -> BTreeMap<Measurement, String> {
    let of = |row: &Row| {
        let row = Row {
            time_ns: None,
            first_ns: None,
            calls: None,
            elapsed_ns: None,
            span: None,
            processor: None,
            began_ms: None,
            pulse_ns: None,
            rounds_ns: Vec::new(),
            ..row.clone()
        };
        (row.measurement(), format!("{row:?}"))
    };
    let steady: BTreeMap<Measurement, String> = rows.iter().map(of).collect();
    assert_eq!(steady.len(), rows.len(), "a measurement stands there twice");
    steady
}
