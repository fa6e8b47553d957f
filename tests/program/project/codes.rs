//! Runs the commands of docs/YOUR-CODE.md in simulation codes with their own lists. A test passes
//! with a remark if its code is not installed.

use std::path::Path;
use std::process::{Command, Stdio};

use crate::common::{Place, ended, foreign, not_started, untested};

const PAGE: &str = include_str!("../../../docs/YOUR-CODE.md");
const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/codes");

/// Returns the fenced block of a language in the section about a code.
fn block(section: &str, language: &str) -> &'static str {
    let section = PAGE.split_once(&format!("\n## {section}\n")).unwrap().1;
    let block = section.split_once(&format!("```{language}\n")).unwrap().1;
    block.split_once("```").unwrap().0
}

/// Returns whether a program starts, even if it prints its help and exits with an error.
fn starts(program: &str) -> bool {
    let mut command = Command::new(program);
    command.arg("-h").current_dir(std::env::temp_dir());
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok()
}

/// Runs a program and fails unless it succeeds; returns the reason if MPI could not start.
fn ends(at: &Place, command: &[&str]) -> Result<(), String> {
    let mut started = Command::new(command[0]);
    started.args(&command[1..]).current_dir(at.root()).stdin(Stdio::null());
    let ended = ended(started.output().unwrap());
    let said = format!("{}{}", ended.stdout, ended.stderr);
    match not_started(&said) {
        Some(reason) if ended.code != Some(0) => Err(reason),
        _ => {
            let _: () = assert_eq!(ended.code, Some(0), "{command:?}: {said}");
            Ok(())
        }
    }
}

/// Inserts the lines of the page above the line `before` of the example, runs it in the code, then
/// runs the commands of the page. A careful setting must miss no contact.
fn the_page_holds(section: &str, language: &str, script: &str, before: &str, command: &[&str]) {
    let what = format!("docs/YOUR-CODE.md, {section}");
    if !starts(command[0]) {
        return untested(&what, "installation of it");
    }
    if !starts("python3") {
        return untested(&what, "python3");
    }
    foreign(&what, || {
        let at = Place::new();
        let text = std::fs::read_to_string(Path::new(FOLDER).join(script)).unwrap();
        let (above, below) = text.split_once(before).unwrap();
        at.file(script, format!("{above}{}{before}{below}", block(section, language)));
        let start = format!(
            "import sys; sys.path.insert(0, '{FOLDER}'); sys.dont_write_bytecode = True; import \
             cases; cases.write_start('start.data', cases.CHUTE, quick=True)"
        );
        ends(&at, &["python3", "-c", &start])?;
        ends(&at, command)?;
        let lines = block(section, "text").lines();
        assert!(lines.clone().count() > 0);
        for line in lines.map(|line| line.strip_prefix("contactbench ").unwrap()) {
            let verify = line.starts_with("verify");
            let words = if verify { "the same in " } else { "\nevery step " };
            let said = at.ends(0, line, &[words]);
            assert!(!said.stdout.contains(" 0 touching pairs"), "{line}: {}", said.stdout);
        }
        Ok(())
    });
}

#[test]
fn the_page_holds_for_lammps() {
    let command = ["lmp", "-in", "chute.lammps", "-var", "steps", "1500"];
    the_page_holds("LAMMPS", "lammps", "chute.lammps", "thermo ${steps}", &command);
}

#[test]
fn the_page_holds_for_liggghts() {
    let command = ["liggghts", "-in", "chute.liggghts", "-var", "steps", "2100"];
    the_page_holds("LIGGGHTS", "liggghts", "chute.liggghts", "thermo ${steps}", &command);
}

#[test]
fn the_page_holds_for_yade() {
    let command = ["yade", "-x", "-n", "-j1", "chute_yade.py", "{\"steps\": 2100}"];
    the_page_holds("YADE", "python", "chute_yade.py", "O.dt = ", &command);
}
