//! A run stopped anywhere and resumed gets all its rows, and results are never overwritten.

use std::collections::{BTreeMap, BTreeSet};
use std::process::Stdio;
use std::sync::OnceLock;
use std::time::{Duration, Instant};

use contactbench::record::origin::provenance;
use contactbench::record::row::{self, Measurement};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::common::{self, PROGRAM, Place, Template, answers, fake, program, runner};

/// Exit code of a whole run of [`experiment`], in which two runners crash in every scene.
pub const WHOLE: i32 = 1;

const RUN: &str = "run t.toml --out result";
const RESUME: &str = "run t.toml --out result --resume";
const RECORD: &str = "result/samples.jsonl";

const HEAD: &str = "name = \"t\"\ntitle = \"t\"\nquestion = \"?\"\nreading = \"-\"\nblocks = 2\n";

/// Returns an experiment with cells that succeed, are refused, belong to a control, crash in a
/// timed pass, crash at once, or cannot start.
pub fn experiment() -> String {
    format!(
        "{HEAD}memory-limit-mib = 1\ndetectors = [\"nbs\", \"screening\", \
         \"nothing\"]\n[[scene]]\nname = \"pack-c\"\nn = 100\ns = [2, 3000]\n{}{}{}",
        runner("late", "sh", &answers(&[("sample", "exit 3")])),
        runner("early", "sh", &fake(&[("load", "exit 4")])),
        runner("absent", "/no/such/program", "")
    )
}

/// Number of rows. In each of two scenes nbs, its twin and nothing have 4, and late, early and
/// absent have 3. screening has 4 in one scene and 3 in the other.
const ROWS: usize = 2 * (4 + 4 + 4 + 3 + 3 + 3) + 4 + 3;

pub fn steady(at: &Place) -> BTreeMap<Measurement, String> {
    common::steady(&at.rows("result"))
}

/// Returns a copy of an undisturbed run, its rows and its duration; it runs once for all tests.
fn undisturbed() -> (Place, BTreeMap<Measurement, String>, Duration) {
    static RUN_ONCE: OnceLock<(Template, Duration)> = OnceLock::new();
    let (template, took) = RUN_ONCE.get_or_init(|| {
        let mut took = Duration::ZERO;
        let template = Template::new(|at| {
            at.file("t.toml", experiment());
            let began = Instant::now();
            at.ends(WHOLE, RUN, &[]);
            took = began.elapsed();
        });
        (template, took)
    });
    let at = template.place();
    let rows = steady(&at);
    assert_eq!(rows.len(), ROWS, "{rows:#?}");
    (at, rows, *took)
}

#[test]
fn a_record_that_was_cut_is_completed() {
    let (at, expected, _) = undisturbed();
    let whole = at.read(RECORD);
    let lines: Vec<&str> = whole.split_inclusive('\n').collect();
    // Cutting after every eleventh row reaches all passes and outcomes.
    for kept in (0..lines.len()).step_by(11) {
        let torn = &lines[kept][..lines[kept].len() / 2];
        at.file(RECORD, lines[..kept].concat() + torn);
        if kept == 0 {
            // As if killed between the copies of the experiments and the provenance.
            std::fs::remove_file(at.path("result/provenance.json")).unwrap();
        }
        let line = format!("line {} is torn", kept + 1);
        at.ends(WHOLE, RESUME, &[&line, &format!("resuming: {kept} rows are there already")]);
        assert!(at.read(RECORD).starts_with(&lines[..kept].concat()), "rows stay as they are");
        assert_eq!(steady(&at), expected, "after {kept} rows");
    }
    let before = at.read(RECORD);
    at.ends(WHOLE, RESUME, &[]);
    assert_eq!(at.read(RECORD), before, "a complete run has nothing to resume");
}

#[test]
fn a_run_killed_at_random_moments_is_completed() {
    let (_at, expected, took) = undisturbed();
    // This command repeats a failure: `CONTACTBENCH_SEED=7 cargo test --test program resume`.
    let given = std::env::var("CONTACTBENCH_SEED").ok().and_then(|text| text.parse().ok());
    let now = || std::time::UNIX_EPOCH.elapsed().map_or(1, |since| since.subsec_nanos().into());
    let seed: u64 = given.unwrap_or_else(now);
    eprintln!("CONTACTBENCH_SEED={seed}, an undisturbed run takes {took:?}");
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut cut_short = 0;
    // The run is killed three times, or more often until one kill interrupts it.
    for kill in 1..=20 {
        if kill > 3 && cut_short > 0 {
            break;
        }
        let what = format!("kill {kill} of seed {seed}");
        let at = Place::new();
        at.file("t.toml", experiment());
        // Kills the program after a random time.
        let mut killed = |line: &str| {
            let words: Vec<&str> = line.split(' ').collect();
            let mut program = program(at.root(), &words);
            let mut child = program.stderr(Stdio::null()).stdout(Stdio::null()).spawn().unwrap();
            std::thread::sleep(took.mul_f64(random.random::<f64>()));
            child.kill().unwrap();
            child.wait().unwrap();
            let path = at.path(RECORD);
            let read = || row::read(&path).unwrap_or_else(|error| panic!("{what}: {error}"));
            if path.exists() { read().rows.len() } else { 0 }
        };
        let rows = killed(RUN);
        cut_short += usize::from(rows > 0 && rows < ROWS);
        // Every second run is also killed while it resumes.
        assert!(kill % 2 == 1 || killed(RESUME) >= rows, "{what}: rows were lost");
        at.ends(WHOLE, RESUME, &[]);
        assert_eq!(steady(&at), expected, "{what}: {rows} rows were there");
    }
    assert!(cut_short > 0, "no kill fell into the run: the test shows nothing");
}

#[test]
fn a_full_disk_costs_no_row() {
    let (_at, expected, _) = undisturbed();
    let at = Place::new();
    at.file("t.toml", experiment());
    // The signal is ignored, so beyond 8 KiB a file cannot be written, as on a full disk.
    let ended = at.shell(&format!("trap '' XFSZ; ulimit -f 16; exec {PROGRAM} {RUN}"));
    assert_eq!(ended.code, Some(2), "{}", ended.stderr);
    let rows = at.rows("result").len();
    assert!((3..ROWS).contains(&rows), "{rows}");
    let last = ended.stderr.lines().last().unwrap();
    let stand = format!("{rows} rows");
    for words in ["contactbench run t.toml --resume --out result", "result/samples.jsonl: ", &stand]
    {
        assert!(last.contains(words), "no '{words}' in: {last}");
    }
    at.ends(WHOLE, RESUME, &[]);
    assert_eq!(steady(&at), expected);
}

#[test]
fn a_resumed_run_remembers_which_detector_was_too_slow() {
    let at = Place::new();
    let hangs = runner("hangs", "sh", &answers(&[("count", "exec sleep 60")]));
    let scene = "[[scene]]\nname = \"packed\"\nn = [10, 20]\n";
    at.file("t.toml", format!("{HEAD}time-limit-s = 0.5\ndetectors = [\"nbs\"]\n{scene}{hangs}"));
    at.good(RUN);
    let expected = steady(&at);
    let text = at.read(RECORD);
    let first = text.split_inclusive('\n').filter(|line| line.contains("\"n\":10,"));
    let first: String = first.collect();
    assert!(first.contains("timeout") && first.lines().count() < expected.len());
    at.file(RECORD, first);
    at.good(RESUME);
    assert_eq!(steady(&at), expected, "the reason says that it was not tried");
}

/// Two virtual machines have the same name but different processors.
#[test]
fn a_run_resumed_on_other_hardware_of_the_same_name_is_of_another_machine() {
    let (at, ..) = undisturbed();
    let text = at.read(RECORD);
    let half = text.lines().count() / 2;
    let begun = at.read("result/provenance.json");
    let mut fields: serde_json::Value = serde_json::from_str(&begun).unwrap();
    let here = fields["machine"].as_str().unwrap().to_string();
    assert!(fields["cpu_features"].is_array() || !cfg!(target_arch = "x86_64"), "{fields}");
    fields["caches"]["L3"] = "300M".into();
    at.file("result/provenance.json", provenance::text(&fields).unwrap());
    for kept in [half, half + 2] {
        at.file(RECORD, text.split_inclusive('\n').take(kept).collect::<String>());
        at.ends(WHOLE, RESUME, &[&format!("{here}-2")]);
        let rows = at.rows("result");
        let machines: BTreeSet<&str> =
            rows.iter().map(|row| row.id.machine.as_deref().unwrap()).collect();
        assert_eq!(machines, BTreeSet::from([&*here, &*format!("{here}-2")]));
    }
}

#[test]
fn a_result_is_never_written_over() {
    let (at, ..) = undisturbed();
    let files = || {
        [RECORD, "result/provenance.json", "result/experiments/t.toml"].map(|name| at.read(name))
    };
    let before = files();
    at.file("t.toml", experiment().replace("blocks = 2", "blocks = 1"));
    let ended = at.ends(2, RUN, &["--resume", "--out"]);
    assert_eq!(ended.stderr.lines().count(), 1, "{}", ended.stderr);
    assert!(before == files());
    // A torn line is repaired only if it is the last.
    at.file(RECORD, format!("not a row\n{}", before[0]));
    at.ends(1, RESUME, &["samples.jsonl:1: "]);
}
