//! Cut records, killed runs, a full disk.

use std::process::{Command, Stdio};
use std::time::Duration;

use contactbench::record::row;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::{ROWS, WHOLE, experiment, start, steady, undisturbed};
use crate::common::file;

#[test]
fn a_record_that_was_cut_is_completed() {
    let (folder, expected, _) = undisturbed();
    let path = folder.path().join("result/samples.jsonl");
    let whole = std::fs::read_to_string(&path).unwrap();
    let lines: Vec<&str> = whole.split_inclusive('\n').collect();
    // Every seventh row meets all passes and outcomes.
    for kept in (0..lines.len()).step_by(7) {
        let torn = &lines[kept][..lines[kept].len() / 2];
        std::fs::write(&path, lines[..kept].concat() + torn).unwrap();
        let ended = start(folder.path(), &["--resume"]);
        assert_eq!(ended.code, WHOLE, "{}", ended.stderr);
        assert!(ended.stderr.contains(&format!("line {} is torn", kept + 1)), "{}", ended.stderr);
        assert!(
            ended.stderr.contains(&format!("resuming: {kept} rows are there already")),
            "{}",
            ended.stderr
        );
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(
            text.starts_with(&lines[..kept].concat()),
            "rows that were there are left as they are"
        );
        assert_eq!(steady(folder.path()), expected, "after {kept} rows");
    }
    let before = std::fs::read(&path).unwrap();
    assert_eq!(start(folder.path(), &["--resume"]).code, WHOLE);
    assert_eq!(std::fs::read(&path).unwrap(), before, "a complete run has nothing to resume");
}

/// A seed to repeat a failure with: `CONTACTBENCH_SEED=7 cargo test --test program resume`.
/// Without, another one every time.
fn seed() -> u64 {
    let given = std::env::var("CONTACTBENCH_SEED").ok().and_then(|text| text.parse().ok());
    given.unwrap_or_else(|| {
        std::time::UNIX_EPOCH.elapsed().map_or(1, |since| since.subsec_nanos().into())
    })
}

/// Kills the program after a while, with nothing tidied up.
fn kill_after(mut program: Command, while_: Duration) {
    let mut child = program.stderr(Stdio::null()).stdout(Stdio::null()).spawn().unwrap();
    std::thread::sleep(while_);
    child.kill().unwrap();
    child.wait().unwrap();
}

#[test]
fn a_run_killed_at_random_moments_is_completed() {
    let (_folder, expected, took) = undisturbed();
    let whole = took.as_secs_f64();
    let seed = seed();
    eprintln!("CONTACTBENCH_SEED={seed}, an undisturbed run takes {whole:.2} s");
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut cut_short = 0;
    // More only while none fell into the run.
    for kill in 1..=20 {
        if kill > 4 && cut_short > 0 {
            break;
        }
        let folder = tempfile::tempdir().unwrap();
        file(folder.path(), "t.toml", experiment());
        let (first, second) = (random.random::<f64>(), random.random::<f64>());
        kill_after(
            crate::common::program(folder.path(), &["run", "t.toml", "--out", "result"]),
            Duration::from_secs_f64(whole * first),
        );
        let path = folder.path().join("result/samples.jsonl");
        let readable = || row::read(&path).map_or(0, |record| record.rows.len());
        if path.exists() {
            row::read(&path).unwrap_or_else(|error| panic!("kill {kill} of seed {seed}: {error}"));
        }
        let rows = readable();
        cut_short += usize::from(rows > 0 && rows < ROWS);
        // Every other one is killed when it is resumed, too.
        if kill % 2 == 0 {
            let resumed = crate::common::program(
                folder.path(),
                &["run", "t.toml", "--out", "result", "--resume"],
            );
            kill_after(resumed, Duration::from_secs_f64(whole * second));
            assert!(readable() >= rows, "kill {kill} of seed {seed}: rows were lost");
        }
        let ended = start(folder.path(), &["--resume"]);
        assert_eq!(ended.code, WHOLE, "kill {kill} of seed {seed}: {}", ended.stderr);
        assert_eq!(
            steady(folder.path()),
            expected,
            "kill {kill} of seed {seed}: after {first} of the time, {rows} rows"
        );
        eprintln!("kill {kill}: {rows} of {ROWS} rows were there");
    }
    assert!(cut_short > 0, "no kill fell into the run: the test shows nothing");
}

#[test]
fn a_full_disk_costs_no_row() {
    let (_folder, expected, _) = undisturbed();
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    file(folder, "t.toml", experiment());
    // No file may have more than 8 KiB (16 blocks of 512 bytes); the signal that says so is
    // ignored, so that writing fails as on a full disk.
    let script = format!(
        "trap '' XFSZ; ulimit -f 16; exec {} run t.toml --out result",
        crate::common::PROGRAM
    );
    let mut full = Command::new("sh");
    full.args(["-c", &script]).current_dir(folder).env("TMPDIR", folder).stdin(Stdio::null());
    let ended = crate::common::ended(full.output().unwrap());
    assert_eq!(ended.code, Some(2), "{}", ended.stderr);
    let rows = row::read(&folder.join("result/samples.jsonl")).unwrap();
    assert!(
        rows.warnings.is_empty() && (3..ROWS).contains(&rows.rows.len()),
        "{:?}, {}",
        rows.warnings,
        rows.rows.len()
    );
    let last = ended.stderr.lines().last().unwrap();
    for words in [
        "the run stopped; when this is mended, continue with: contactbench run t.toml --resume \
         --out result",
        "cannot write to result/samples.jsonl: File too large",
        &format!("the {} rows before stand there and are whole", rows.rows.len()),
    ] {
        assert!(last.contains(words), "no '{words}' in: {last}");
    }
    assert_eq!(start(folder, &["--resume"]).code, WHOLE);
    assert_eq!(steady(folder), expected);
}
