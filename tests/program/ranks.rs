//! `contactbench ranks`: one scene over several ranks.

use std::path::Path;

use serde_json::Value;

use crate::common::{good, program, refused};

/// The rows of a call, of one step.
fn rows(folder: &Path, words: &[&str]) -> Vec<Value> {
    let json = folder.join("rows");
    let _ = std::fs::remove_file(&json);
    let words = [&["ranks"], words, &["--steps", "1", "--json", "rows"]].concat();
    let said = good(folder, &words).stdout;
    let text = std::fs::read_to_string(json).unwrap();
    let rows: Vec<Value> = text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(said.matches("those of one process").count(), rows.len(), "{said}");
    rows
}

fn number(row: &Value, name: &str) -> u64 {
    row[name].as_u64().unwrap()
}

#[test]
fn ranks_are_compared_with_one_process_and_what_they_send_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let scene = "packed:dim=3,n=2000";
    let made = rows(folder, &[scene, "--ranks", "1,3"]);
    assert_eq!(made.iter().map(|row| number(row, "ranks")).collect::<Vec<_>>(), [1, 3]);
    assert_eq!((number(&made[0], "sent"), number(&made[1], "partners_most")), (0, 1));
    // Of one rank and one step, the ratios are those of the times.
    let real = |name: &str| made[0][name].as_f64().unwrap();
    for (ratio, time) in [("alone_over_step", "step_ms"), ("alone_over_search", "search_ms")] {
        let median = made[0][ratio]["median"].as_f64().unwrap();
        assert!((median - real("alone_ms") / real(time)).abs() < 1e-9 * median, "{ratio}");
    }
    assert!(real("alone_ms") > 0.0 && made[0]["machine"].is_string());
    // 4 bytes of a number, 8 of each coordinate.
    assert!(number(&made[1], "sent") > 100);
    assert_eq!(number(&made[1], "sent_bytes"), 28 * number(&made[1], "sent"));
    // From a file, the whole of which is read; around a box, and with sizes.
    good(folder, &["scene", scene, "-o", "scene.csv"]);
    let read = rows(folder, &["scene.csv", "--ranks", "3"]);
    assert_eq!(read[0]["digest"], made[0]["digest"]);
    let boxed = "loose:dim=3,n=2000,fraction=0.3,size-ratio=3,periodic=true";
    let around = rows(folder, &[boxed, "--ranks", "4", "--detector", "nbs"]);
    assert!(around[0]["around"] == true && number(&around[0], "partners_most") == 2);
    assert_eq!(number(&around[0], "sent_bytes"), 36 * number(&around[0], "sent"));
    // A scene for each: twice as many particles on two.
    let each = rows(folder, &[scene, "--each", "--ranks", "1,2"]);
    assert_eq!(each.iter().map(|row| number(row, "n")).collect::<Vec<_>>(), [2000, 4000]);
    assert!(2 * number(&each[1], "pairs") > 3 * number(&each[0], "pairs"));
}

#[test]
fn the_model_goes_to_a_thousand_ranks_and_bad_requests_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let said = good(folder, &["ranks", "loose:n=1000", "--ranks", "2", "--model"]).stdout;
    let last = said.lines().last().unwrap();
    let words: Vec<&str> = last.split_whitespace().collect();
    // No further than 64 times the two ranks that were measured.
    assert_eq!(words[..2], ["128", "64000"], "{said}");
    let alone = good(folder, &["ranks", "loose:n=1000", "--ranks", "1", "--model"]).stdout;
    assert!(alone.ends_with("The model needs what two ranks or more send.\n"), "{alone}");
    let refuse = |words: &[&str], why: &str| {
        refused(folder, &[&["ranks"], words].concat(), &[why]);
    };
    refuse(&[], "name a particle file, or a scene");
    refuse(&["loose", "--ranks", "0"], "threads are ranks from 1 to 64; start more by mpirun");
    refuse(&["loose", "--ranks", "65"], "threads are ranks from 1 to 64");
    refuse(&["loose", "--steps", "0"], "--steps 0: at least one is needed");
    let command = program(folder, &["ranks", "loose", "--network", "fast"]).output().unwrap();
    assert!(crate::common::ended(command).stderr.contains("seconds and bytes per second"));
    refuse(&["loose", "--radius", "1"], "belong to files");
    refuse(&["loose:periodic=true", "--each"], "this one repeats in a box; leave out the box");
    std::fs::write(folder.join("p.csv"), "x,y,r\n0,0,1\n").unwrap();
    refuse(&["p.csv", "--each"], "a file is dealt out: leave it out");
    // Only the last ranks fail, beyond the largest number, and the others do not wait for them.
    let far = "packed:n=4,diameter=1e307";
    good(folder, &["ranks", far, "--each", "--ranks", "2"]);
    let command = program(folder, &["ranks", far, "--each", "--ranks", "16"]).output().unwrap();
    let ended = crate::common::ended(command);
    assert!(ended.code == Some(2), "{}", ended.stdout);
    assert!(ended.stderr.contains("--each goes too far along x"), "{}", ended.stderr);
    if cfg!(not(feature = "mpi")) {
        let mut command = program(folder, &["ranks", "loose"]);
        command.env("OMPI_COMM_WORLD_RANK", "0").env("OMPI_COMM_WORLD_SIZE", "2");
        let ended = crate::common::ended(command.output().unwrap());
        assert_eq!(ended.code, Some(2));
        assert!(ended.stderr.contains("the program was built without MPI"), "{}", ended.stderr);
    }
}

/// By real processes, where the program is built for it and there is an `mpirun`.
#[cfg(feature = "mpi")]
#[test]
fn processes_of_mpi_find_what_threads_find() {
    use crate::common::{foreign, has};

    if has("mpirun") {
        foreign("ranks of MPI", of_mpi);
    }
}

#[cfg(feature = "mpi")]
fn of_mpi() -> Result<(), String> {
    use crate::common::{PROGRAM, not_started};

    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let mpirun = |ranks: &str, words: &[&str]| {
        let mut command = std::process::Command::new("mpirun");
        command.current_dir(folder).args(["--allow-run-as-root", "--oversubscribe", "-n", ranks]);
        crate::common::ended(command.arg(PROGRAM).arg("ranks").args(words).output().unwrap())
    };
    if let Some(reason) = not_started(&mpirun("2", &["loose:n=10", "--steps", "1"]).stderr) {
        return Err(reason);
    }
    good(folder, &["scene", "packed:dim=3,n=3000,size-ratio=2", "-o", "p.npy"]);
    let boxed = "clustered:dim=3,n=3000,periodic=xy";
    for ranks in ["1", "2", "3", "4", "8"] {
        for scene in ["p.npy", "loose:n=2000", boxed, "hard:case=giant-first-in-dust,dim=3"] {
            let ended = mpirun(ranks, &[scene, "--steps", "1"]);
            assert_eq!(ended.code, Some(0), "{ranks} {scene}: {}{}", ended.stdout, ended.stderr);
            assert!(ended.stdout.contains("those of one process"), "{}", ended.stdout);
        }
    }
    let ended = mpirun("3", &["missing.npy"]);
    assert!(ended.code != Some(0) && ended.stderr.contains("missing.npy"), "{}", ended.stderr);
    // One rank does not find its file, or another one; the other ends, too.
    let alone =
        |words: &'static str| ["-n", "1", PROGRAM, "ranks"].into_iter().chain(words.split(' '));
    good(folder, &["scene", "packed:dim=2,n=3000,size-ratio=2", "-o", "flat.csv"]);
    good(folder, &["scene", "packed:dim=3,n=2000,size-ratio=2", "-o", "few.npy"]);
    for (other, why) in [
        ("missing.npy --steps 1", "missing.npy"),
        ("flat.csv --steps 1", "its dimension differs from rank to rank"),
        ("few.npy --steps 1", "its number of particles differs from rank to rank"),
        ("p.npy --steps 2", "--steps or --each differs from rank to rank"),
        ("p.npy --steps 1 --each", "--steps or --each differs from rank to rank"),
    ] {
        let mut command = std::process::Command::new("timeout");
        command.current_dir(folder).args([
            "60",
            "mpirun",
            "--allow-run-as-root",
            "--oversubscribe",
        ]);
        command.args(alone("p.npy --steps 1")).arg(":").args(alone(other));
        let ended = crate::common::ended(command.output().unwrap());
        assert!(ended.code != Some(124) && ended.code != Some(0), "{other}: {:?}", ended.code);
        let said = ended.stderr.lines().filter(|line| line.contains(why)).count();
        assert_eq!(said, 1, "{}", ended.stderr);
    }
    let ended = mpirun("2", &["loose:n=500", "--each"]);
    assert!(ended.stdout.contains("those of one process"), "{}{}", ended.stdout, ended.stderr);
    Ok(())
}
