//! Tests of experiment files, most of which must be refused with the place of the error.

use std::path::Path;

use crate::plan::parse;
use contactbench_record::record::role::Role;

fn error(text: &str) -> String {
    let error = parse(text, Path::new(".")).err().unwrap_or_else(|| panic!("accepted: {text}"));
    format!("{error:#}")
}

const HEAD: &str =
    "name = \"t\"\ntitle = \"t\"\nquestion = \"?\"\nreading = \"-\"\ndetectors = [\"nbs\"]\n";

fn refused(tail: &str, place: &str, words: &str) {
    let error = error(&format!("{HEAD}{tail}"));
    assert!(
        !error.contains('\n') && error.starts_with(place) && error.contains(words),
        "{tail:?}: {error}"
    );
}

/// Checks rows of `tail => place => words`. `head` goes before each tail, and `;` in a tail stands
/// for a line break. An indented line continues the row above.
fn all_refused(head: &str, rows: &str) {
    for row in rows.trim().replace("\n    ", " ").lines() {
        let [tail, place, words] = row.split("=>").map(str::trim).collect::<Vec<_>>()[..] else {
            panic!("not three columns: {row}")
        };
        refused(&format!("{head}{}\n", tail.replace("; ", "\n")), place, words);
    }
}

#[test]
fn errors_are_one_line_with_a_place() {
    let rows = r#"
[[scene]; name = 1 => line 6, =>
blocks = "three"; scene = [] => line 6, column 10
    => the text "three" stands where a whole number of at least 0 is expected
title = "u"; scene = [] => line 6, column 1 => duplicate key
arithmetics = ["exacd"]; scene = [] => line 6, column 16
    => no value 'exacd' here (did you mean exact?)
scene = 3 => line 6, column 9 => 3 stands where a table
scene = [3] => line 6, column 10 => 3 stands where a table
[[scene]]; n = 5 => line 6: there is no scene '' =>
"#;
    all_refused("", rows);
    refused("", "", "scene is missing: give a [[scene]]");
}

#[test]
fn scenes_are_refused_with_their_line() {
    let rows = r#"
n = [1, "a"] => line 8, column 9 => the text "a" stands where a whole number
n = -1 => line 8, column 5 => -1 stands where a whole number of at least 0
n = 1979-05-27 => line 8, column 5 => a whole number of at least 0 is expected
n = 5; order = "up" => line 6: scene packed: order is 'up' => must be shuffled, generated
n = 5; quick.n = "x" => line 9, column 11 => a whole number
n = 5; quick = 3 => line 9, column 9 => 3 stands where a table
n = 5; spcing = 1 => line 6: packed: there is no parameter 'spcing' (did you mean spacing?)
    => size-ratio
n = 5; quick.jitter = -1 => line 6: packed: jitter is -1 => at least 0
n = 5; params = 5 => line 6: packed: there is no parameter 'params' =>
=> line 6: scene packed: n is missing =>
n = [5, 5] => line 6: scene packed stands there twice =>
"#;
    all_refused("[[scene]]\nname = \"packed\"\n", rows);
}

#[test]
fn claims_and_figures_take_the_keys_of_their_kind() {
    let claims = r#"
kind = "at-most"; value = "n"; to = "1"; within = 0.1 => line 12, column 1
    => there is no key 'within' here; there are: value, to, than
kind = "faster"; value = "n" => line 10, column 1 => no key 'value' here; there are: than, by
value = "n" => line 7, column 1 => the key 'kind' is missing
kind = "equal"; value = "n" => line 9, column 8 => the key 'to' is missing
kind = "equal"; value = "n"; to = "n / / 2" => line 11, column 6
    => cannot read the expression 'n / / 2': at column 5,
kind = "constant"; value = "n"; within = -0.5 => line 11, column 10
    => within is -0.5; it must be a finite number of at least 0
kind = "constant"; value = "n"; within = nan => line 11, column 10 => finite
kind = "model"; value = "n"; model = "N^3" => line 11, column 9
    => unknown model 'N^3'; the models are: N, N log N, N^2
kind = "model"; value = "time_ns"; model = "N" => line 10, column 9 => fitted to counts or bytes
"#;
    all_refused("scene = []\n[[claim]]\nname = \"c\"\n", claims);
    let figures = r#"
kind = "speed-error"; x = "n" => line 11, column 1 => there is no key 'x' here; there are: against, columns
LINES; against = "given" => line 14, column 1 => there is no key 'against' here
kind = "speed-error"; against = "all" => line 11, column 11
    => no value 'all' here; there are: given, stored
kind = "pie" => line 10, column 8 => there are: lines, bars, speed-error
LINES; slopes = true => line 7, column 1 => the figure f has slopes = true
x = "s"; x-label = "s"; y = "n +"; y-label = "n +" => line 12, column 5 => at column 4
"#;
    let lines = r#"x = "s"; x-label = "s"; y = "n"; y-label = "n""#;
    let figures = figures.replace("LINES", lines);
    all_refused("scene = []\n[[figure]]\nname = \"f\"\ntitle = \"F\"\n", &figures);
}

#[test]
fn whole_numbers_may_have_an_exponent_and_lists_may_lack_brackets() {
    let text = |blocks: &str, n: &str, detectors: &str, per_cluster: &str| {
        format!(
            "name = \"t\"\ntitle = \"t\"\nquestion = \"?\"\nreading = \"-\"\ndetectors = \
             {detectors}\nblocks = {blocks}\nmemory-limit-mib = {n}\n[[scene]]\nname = \
             \"clustered\"\nn = [{n}, 5]\nquick.n = {n}\nseed = {n}\nper-cluster = \
             {per_cluster}\n[[claim]]\nname = \"c\"\nkind = \"at-most\"\nvalue = \"n\"\nto = {n}\n"
        )
    };
    let read = |text: String| {
        let experiment = parse(&text, Path::new("."));
        let mut experiment = experiment.unwrap_or_else(|error| panic!("{error:#}\n{text}"));
        experiment.claims.clear();
        experiment
    };
    let short = read(text("1e1", "1e3", "\"nbs\"", "1e1"));
    let long = read(text("10", "1000", "[\"nbs\"]", "10"));
    assert_eq!(format!("{short:?}"), format!("{long:?}"));
    let error = error(&text("1.5", "1e3", "\"nbs\"", "1e1"));
    assert!(error.contains("1.5 stands where a whole number of at least 0 is expected"), "{error}");
}

/// The number of scenes is checked before any is made; otherwise this test would not end.
#[test]
fn plans_are_bounded_before_they_are_made() {
    let list = |unit: &str| (1..=2000).map(|k| format!("{k}{unit}")).collect::<Vec<_>>().join(", ");
    let [whole, broken] = ["", ".5"].map(list);
    let lists = format!("n = [{whole}]\nseed = [{whole}]\nspacing = [{broken}]\n");
    let plan = |detectors: &str, rest: &str| {
        let text = HEAD.replace("\"nbs\"", detectors) + rest;
        parse(&text, Path::new(".")).map(|_| ()).map_err(|error| format!("{error:#}"))
    };
    let packed = "[[scene]]\nname = \"loose\"\n";
    let refused = plan("\"nbs\"", &format!("{packed}{lists}")).unwrap_err();
    for words in ["line 6", "8000000000 scenes", "at most 10000;"] {
        assert!(refused.contains(words), "{refused}");
    }
    let quick = format!("{packed}n = 5\nquick = {{ n = [{whole}], seed = [{whole}] }}\n");
    assert!(plan("\"nbs\"", &quick).unwrap_err().contains("4000000 scenes"));
    let half = format!("{packed}n = [{whole}]\nseed = [{}]\n", "1");
    let many = (1..=8).map(|dim| half.replace("\nn =", &format!("\nspacing = {dim}.5\nn =")));
    let refused = plan("\"nbs\"", &many.collect::<String>()).unwrap_err();
    assert!(refused.contains("12000 scenes with those above"), "{refused}");
    let some =
        format!("{packed}n = [{whole}]\nseed = [{}]\n", &whole[..whole.find(", 5,").unwrap()]);
    let all = format!("threads = [1, 2, 3, 4, 5, 6, 7, 8]\n{some}");
    let refused = plan("\"@all\"", &all).unwrap_err();
    assert!(refused.contains("cells, and an experiment has at most 100000;"), "{refused}");
    let tables = format!("{packed}n = 10\n").repeat(200_000);
    assert!(plan("\"nbs\"", &tables).unwrap_err().contains("at most 1024 KiB"));
    assert_eq!(plan("\"nbs\"", &format!("{packed}n = [{whole}]\n")), Ok(()));
}

#[test]
fn a_runner_is_no_control_whatever_its_name() {
    let runner = "[[runner]]\nname = \"x-twin\"\ncommand = [\"x\"]\n";
    let text = format!("{HEAD}[[scene]]\nname = \"packed\"\nn = 10\n{runner}");
    let subjects = parse(&text, Path::new(".")).unwrap().planned.subjects;
    let roles: Vec<(&str, &Role)> = subjects.iter().map(|it| (&*it.name, &it.role)).collect();
    assert_eq!(roles, [("nbs", &Role::Detector), ("x-twin", &Role::Runner)]);
}

/// The value of `grading` is a file name, unless it lists the points of the curve.
#[test]
fn files_are_taken_from_the_folder_of_the_experiment() {
    let text = format!(
        "{HEAD}[[scene]]\nname = 'loose'\nn = 10\nsizes = 'grading'\ngrading = ['sand.csv', '1 \
         0, 2 100']\n"
    );
    let planned = parse(&text, Path::new("/home/a")).unwrap().planned;
    let curves: Vec<String> =
        planned.scenes.iter().map(|id| id.params["grading"].to_string()).collect();
    assert_eq!(curves, ["/home/a/sand.csv", "1 0, 2 100"]);
}
