//! What the tests of the program share: running it, and files for it.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::{Mutex, Once, PoisonError};

use contactbench::record::row::{self, Measurement, Row};
use serde_json::Value;

/// The program under test.
pub const PROGRAM: &str = env!("CARGO_BIN_EXE_contactbench");

/// A run of the program that has ended.
pub struct Ended {
    pub code: Option<i32>,
    pub stdout: String,
    pub stderr: String,
}

/// The program with arguments, in `folder`, which also takes what a killed program leaves behind.
/// Colours, width, and the locale of programs that it starts are not the user's.
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

/// Runs the program to its end.
pub fn run(folder: &Path, arguments: &[&str]) -> Ended {
    ended(program(folder, arguments).output().unwrap())
}

/// A folder of its own, in which the program runs.
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

    /// Runs the program with the arguments of a line as a shell would split it.
    pub fn run(&self, line: &str) -> Ended {
        let words = shlex::split(line).unwrap_or_else(|| panic!("a quote is open in {line}"));
        run(self.root(), &words.iter().map(String::as_str).collect::<Vec<_>>())
    }

    /// A run that ends with this code; all these words are in what it printed.
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

    /// Runs a shell script.
    pub fn shell(&self, script: &str) -> Ended {
        let mut shell = Command::new("sh");
        shell.args(["-c", script]).current_dir(self.root()).env("TMPDIR", self.root());
        ended(shell.stdin(Stdio::null()).output().unwrap())
    }

    /// Returns what a run prints as JSON; its exit code must be 0 or 1.
    pub fn json(&self, line: &str) -> Value {
        let ended = self.run(&format!("{line} --json"));
        assert!(matches!(ended.code, Some(0 | 1)), "{line}: {}", ended.stderr);
        serde_json::from_str(&ended.stdout).unwrap_or_else(|_| panic!("{line}: {}", ended.stdout))
    }

    /// The rows of a record, which is whole.
    pub fn rows(&self, folder: &str) -> Vec<Row> {
        let record = row::read(&self.path(folder).join(row::FILE)).unwrap();
        assert!(record.warnings.is_empty(), "{:?}", record.warnings);
        record.rows
    }
}

/// What a process has left.
pub fn ended(output: Output) -> Ended {
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    Ended { code: output.status.code(), stdout: text(output.stdout), stderr: text(output.stderr) }
}

/// A file in `folder`.
pub fn file(folder: &Path, name: &str, text: impl AsRef<[u8]>) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    path
}

/// Files that several tests begin with, made once.
pub struct Template(Vec<(PathBuf, Vec<u8>)>);

impl Template {
    /// What `make` leaves in a folder.
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

    /// The same files in a folder of their own.
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

/// An npy file, version 1, of little-endian doubles.
pub fn npy(rows: &[Vec<f64>]) -> Vec<u8> {
    let columns = rows.first().map_or(2, Vec::len);
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    let mut header = format!(
        "{{'descr': '<f8', 'fortran_order': False, 'shape': ({}, {columns}), }}",
        rows.len()
    );
    // The data begin at a multiple of 64 bytes, after magic, version, length (10 bytes) and a
    // newline.
    while (10 + header.len() + 1) % 64 != 0 {
        header.push(' ');
    }
    header.push('\n');
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    rows.iter().flatten().for_each(|x| bytes.extend(x.to_le_bytes()));
    bytes
}

/// The pairs in an npy file of the program: the data are what follows the newline that ends the
/// header.
pub fn pairs(path: &Path) -> Vec<[u32; 2]> {
    let bytes = std::fs::read(path).unwrap();
    assert!(String::from_utf8_lossy(&bytes[..64]).contains("'descr': '<u4'"));
    let start = bytes.iter().position(|&b| b == b'\n').unwrap() + 1;
    let words: Vec<u32> =
        bytes[start..].chunks_exact(4).map(|b| u32::from_le_bytes(b.try_into().unwrap())).collect();
    words.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect()
}

/// The shell command of a runner that says hello in f64 arithmetic and answers requests with shell
/// code, and all others as unsupported.
pub fn fake(answers: &[(&str, &str)]) -> String {
    let hello = say(r#"{"reply":"hello","protocol":4,"detector":"fake","arithmetic":"f64"}"#);
    let cases: String = answers
        .iter()
        .map(|(request, code)| format!("*'\"request\":\"{request}\"'*) {code} ;;\n"))
        .collect();
    // Silence would be waited for.
    let rest = say(r#"{"reply":"unsupported"}"#);
    format!("{hello}\nwhile read -r line; do\ncase \"$line\" in\n{cases}*) {rest} ;;\nesac\ndone")
}

/// Shell code that answers with a line.
pub fn say(line: &str) -> String {
    format!("echo '{line}'")
}

/// A runner that loads, gives these answers, and has neither counts, memory nor pairs otherwise.
pub fn answers(answers: &[(&str, &str)]) -> String {
    let loaded = say(r#"{"reply":"loaded"}"#);
    fake(&[answers, &[("load", &*loaded)]].concat())
}

/// Shell code that answers with a sample of a time that can be.
pub fn sample(contacts: u32, digest: &str) -> String {
    let times = r#""reply":"sample","time_ns":300000,"calls":1,"elapsed_ns":300000"#;
    let line = format!(r#"{{{times},"contacts":{contacts},"digest":"{digest}"}}"#);
    format!("sleep 0.002; {}", say(&line))
}

/// A runner in an experiment file: `program` and one shell script.
pub fn runner(name: &str, program: &str, script: &str) -> String {
    format!(
        "[[runner]]\nname = \"{name}\"\ncommand = [\"{program}\", \"-c\", \
         '''\n{script}''']\ninstall = \"apt install it\"\n"
    )
}

/// What could not be tested here, and why.
static UNTESTED: Mutex<BTreeMap<String, String>> = Mutex::new(BTreeMap::new());

unsafe extern "C" {
    fn atexit(callback: extern "C" fn()) -> std::ffi::c_int;
}

/// Notes that `what` cannot be tested here because `missing` is not there. The test passes; one
/// line after the results of all tests says what was left out.
pub fn untested(what: &str, missing: &str) {
    static AT_EXIT: Once = Once::new();
    let mut untested = UNTESTED.lock().unwrap_or_else(PoisonError::into_inner);
    untested.insert(what.to_string(), missing.to_string());
    // SAFETY: `atexit` may be called at any time before the end of the process, and `summary` may
    // be called from C: it takes nothing, gives nothing, and does not unwind.
    AT_EXIT.call_once(|| assert_eq!(unsafe { atexit(summary) }, 0));
}

extern "C" fn summary() {
    let untested = UNTESTED.lock().unwrap_or_else(PoisonError::into_inner);
    let all: Vec<String> =
        untested.iter().map(|(what, missing)| format!("{what} (no {missing})")).collect();
    eprintln!("NOT TESTED HERE, {} in all: {}\n", all.len(), all.join("; "));
}

/// Runs a test of programs of others: one test at a time, because several MPI programs that start
/// together fail. `test` gives the reason if a program could not start. It is then run once more,
/// and after that left out: the closing summary names it with the reason.
pub fn foreign(what: &str, test: impl Fn() -> Result<(), String>) {
    static ALONE: Mutex<()> = Mutex::new(());
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    if let Err(reason) = test().or_else(|_| test()) {
        untested(what, &format!("start in two tries: {reason}"));
    }
}

/// The reason why MPI could not start, if that is why a program failed.
pub fn not_started(stderr: &str) -> Option<String> {
    let signs = ["ompi_mpi_init", "MPI_Init", "MPI_INIT", "unable to start a daemon", "orte_init"];
    let of_start = |line: &&str| {
        signs.iter().any(|sign| line.to_ascii_lowercase().contains(&sign.to_ascii_lowercase()))
    };
    stderr.lines().find(of_start).map(|line| line.trim().to_string())
}

/// Whether a program can be started with this option, and ends well.
pub fn starts(program: &str, option: &str) -> bool {
    let mut command = Command::new(program);
    command.arg(option).current_dir(std::env::temp_dir()).stdin(Stdio::null());
    command.output().is_ok_and(|output| output.status.success())
}

/// Is there such a program? If not, the test passes, and is named among those left out.
pub fn has(program: &'static str) -> bool {
    let there = starts(program, "--version");
    if !there {
        untested(&format!("runners that need {program}"), program);
    }
    there
}

/// What must be the same whether a run was disturbed, resumed or repeated: everything but the times.
/// Fails if a measurement stands twice.
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
