//! Tests the program `contactbench ranks`: one scene over several ranks.

use std::path::Path;
use std::process::Command;

use contactbench::io::write;
use contactbench::scene::spec::Spec;
use serde_json::Value;

const PROGRAM: &str = env!("CARGO_BIN_EXE_contactbench-ranks");

struct Ended {
    code: Option<i32>,
    stdout: String,
    stderr: String,
}

fn program(folder: &Path, words: &[&str]) -> Command {
    let mut command = Command::new(PROGRAM);
    command.args(words).current_dir(folder);
    command
}

fn finished(mut command: Command) -> Ended {
    let output = command.output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    Ended { code: output.status.code(), stdout: text(output.stdout), stderr: text(output.stderr) }
}

fn good(folder: &Path, words: &[&str]) -> Ended {
    let ended = finished(program(folder, words));
    assert_eq!(ended.code, Some(0), "{words:?}: {}{}", ended.stdout, ended.stderr);
    ended
}

fn scene(folder: &Path, text: &str, file: &str) {
    write::scene(&folder.join(file), &Spec::parse(text).unwrap().given().unwrap()).unwrap();
}

fn rows(folder: &Path, words: &[&str]) -> Vec<Value> {
    let json = folder.join("rows");
    let _ = std::fs::remove_file(&json);
    let words = [words, &["--steps", "1", "--json", "rows"]].concat();
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
fn ranks_agree_with_one_process_and_report_the_data_sent() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let packed = "packed:dim=3,n=2000";
    let made = rows(folder, &[packed, "--ranks", "1,3"]);
    assert_eq!(made.iter().map(|row| number(row, "ranks")).collect::<Vec<_>>(), [1, 3]);
    assert_eq!((number(&made[0], "sent"), number(&made[1], "partners_most")), (0, 1));
    let real = |name: &str| made[0][name].as_f64().unwrap();
    assert!(real("alone_ms") > 0.0 && made[0]["machine"].is_string());
    // A particle takes 4 bytes for its number, and 8 for each coordinate.
    assert!(number(&made[1], "sent") > 100);
    assert_eq!(number(&made[1], "sent_bytes"), 28 * number(&made[1], "sent"));
    // The scene may also come from a file, and have a periodic box and different sizes.
    scene(folder, packed, "scene.csv");
    let read = rows(folder, &["scene.csv", "--ranks", "3"]);
    assert_eq!(read[0]["digest"], made[0]["digest"]);
    let boxed = "loose:dim=3,n=2000,fraction=0.3,size-ratio=3,periodic=true";
    let around = rows(folder, &[boxed, "--ranks", "4", "--detector", "nbs"]);
    assert!(around[0]["around"] == true && number(&around[0], "partners_most") == 2);
    assert_eq!(number(&around[0], "sent_bytes"), 36 * number(&around[0], "sent"));
    // If each rank makes a scene, two ranks have twice the particles of one.
    let each = rows(folder, &[packed, "--each", "--ranks", "1,2"]);
    assert_eq!(each.iter().map(|row| number(row, "n")).collect::<Vec<_>>(), [2000, 4000]);
    assert!(2 * number(&each[1], "pairs") > 3 * number(&each[0], "pairs"));
}

#[test]
fn bad_requests_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let refuse = |words: &[&str], why: &str| {
        let ended = finished(program(folder, words));
        assert_eq!(ended.code, Some(2), "{words:?}: {}", ended.stdout);
        assert!(ended.stderr.contains(why), "{words:?}: no '{why}' in: {}", ended.stderr);
    };
    refuse(&[], "name a particle file, or a scene");
    refuse(&["loose", "--ranks", "0"], "--ranks is 0; it must be from 1 to 64; use mpirun");
    refuse(&["loose", "--ranks", "65"], "--ranks is 65; it must be from 1 to 64");
    refuse(&["loose", "--steps", "0"], "--steps is 0; it must be at least 1");
    refuse(&["loose", "--radius", "1"], "dim=3");
    refuse(&["loose:periodic=true", "--each"], "this one has a periodic box; leave out the box");
    std::fs::write(folder.join("p.csv"), "x,y,r\n0,0,1\n").unwrap();
    refuse(&["p.csv", "--each"], "a file is split between ranks; leave out --each");
    // Only the last ranks fail, by overflow; the others do not wait for them.
    let far = "packed:n=4,diameter=1e307";
    good(folder, &[far, "--each", "--ranks", "2"]);
    let ended = finished(program(folder, &[far, "--each", "--ranks", "16"]));
    assert!(ended.code == Some(2), "{}", ended.stdout);
    assert!(ended.stderr.contains("--each goes too far along x"), "{}", ended.stderr);
    if cfg!(not(feature = "mpi")) {
        let mut command = program(folder, &["loose"]);
        command.env("OMPI_COMM_WORLD_RANK", "0").env("OMPI_COMM_WORLD_SIZE", "2");
        let ended = finished(command);
        assert_eq!(ended.code, Some(2));
        assert!(ended.stderr.contains("the program was built without MPI"), "{}", ended.stderr);
    }
}

/// Starts processes if the program was built with `mpi` and there is an `mpirun`.
#[cfg(feature = "mpi")]
#[test]
fn mpi_processes_find_the_contacts_of_threads() {
    match Command::new("mpirun").arg("--version").output() {
        Ok(_) => {
            of_mpi().or_else(|_| of_mpi()).unwrap_or_else(|why| eprintln!("not tested: {why}"))
        }
        Err(_) => eprintln!("not tested: no mpirun"),
    }
}

#[cfg(feature = "mpi")]
fn of_mpi() -> Result<(), String> {
    let not_started = |stderr: &str| {
        let signs = ["mpi_init", "unable to start a daemon", "orte_init"];
        let of_start = |line: &&str| signs.iter().any(|sign| line.to_lowercase().contains(sign));
        stderr.lines().find(of_start).map(str::to_string)
    };
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let mpirun = |ranks: &str, words: &[&str]| {
        let mut command = Command::new("mpirun");
        command.current_dir(folder).args(["--allow-run-as-root", "--oversubscribe", "-n", ranks]);
        command.arg(PROGRAM).args(words);
        finished(command)
    };
    if let Some(reason) = not_started(&mpirun("2", &["loose:n=10", "--steps", "1"]).stderr) {
        return Err(reason);
    }
    scene(folder, "packed:dim=3,n=3000,size-ratio=2", "p.npy");
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
    // If one rank finds no file or a different file, the other rank also ends.
    let alone = |words: &'static str| ["-n", "1", PROGRAM].into_iter().chain(words.split(' '));
    scene(folder, "packed:dim=2,n=3000,size-ratio=2", "flat.csv");
    scene(folder, "packed:dim=3,n=2000,size-ratio=2", "few.npy");
    for (other, why) in [
        ("missing.npy --steps 1", "missing.npy"),
        ("flat.csv --steps 1", "its dimension differs between ranks"),
        ("few.npy --steps 1", "its number of particles differs between ranks"),
        ("p.npy --steps 2", "--steps or --each differs between ranks"),
        ("p.npy --steps 1 --each", "--steps or --each differs between ranks"),
    ] {
        let mut command = Command::new("timeout");
        command.current_dir(folder).args([
            "60",
            "mpirun",
            "--allow-run-as-root",
            "--oversubscribe",
        ]);
        command.args(alone("p.npy --steps 1")).arg(":").args(alone(other));
        let ended = finished(command);
        assert!(ended.code != Some(124) && ended.code != Some(0), "{other}: {:?}", ended.code);
        let said = ended.stderr.lines().filter(|line| line.contains(why)).count();
        assert_eq!(said, 1, "{}", ended.stderr);
    }
    let ended = mpirun("2", &["loose:n=500", "--each"]);
    assert!(ended.stdout.contains("those of one process"), "{}{}", ended.stdout, ended.stderr);
    Ok(())
}
