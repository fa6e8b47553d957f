//! Maps of records: what `map` draws, and what it refuses.

use std::path::Path;
use std::sync::LazyLock;

use crate::common::{Template, file, good, refused};

const EXPERIMENT: &str = "
name = 'small'
title = 'A map'
question = 'Who is the fastest?'
reading = 'The name in the tile.'
detectors = ['nbs', 'sorting', 'cell-grid']
blocks = 2
[[scene]]
name = 'loose'
dim = [2, 3]
n = [50, 100]
fraction = [0.1, 0.4]
[[figure]]
name = 'winners'
title = 'Who is the fastest'
kind = 'map'
x = 'n'
y = 'fraction'
";

/// A record with a map, made once.
static RECORD: LazyLock<Template> = LazyLock::new(|| {
    Template::new(|folder| {
        file(folder, "small.toml", EXPERIMENT);
        good(folder, &["run", "small.toml", "--out", "out"]);
    })
});

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

#[test]
fn a_run_draws_its_maps() {
    let folder = RECORD.copy();
    let out = folder.path().join("out");
    let maps = read(&out.join("maps.csv"));
    // Two panels of four places, and two blocks decide nothing.
    assert_eq!(maps.lines().count(), 9, "{maps}");
    assert!(maps.lines().skip(1).all(|line| line.contains(",no,")), "{maps}");
    let page = read(&out.join("report.html"));
    assert_eq!(page.matches("data-row=").count(), 8);
    assert!(page.contains("<a href=\"#maps\">Maps</a>") && page.contains("<section id=\"maps\">"));
    let report = read(&out.join("report.md"));
    assert!(report.contains("Who is the fastest in each place"), "{report}");
    assert!(out.join("figures/small-winners.svg").exists());
}

#[test]
fn map_draws_any_two_variables_of_records() {
    let folder = RECORD.copy();
    let folder = folder.path();
    let printed = good(folder, &["map", "out", "--x", "n", "--y", "fraction"]).stdout;
    for words in ["loose, 2D", "loose, 3D", "n = 50", "undecided: "] {
        assert!(printed.contains(words), "{words} is not in {printed}");
    }
    let only = ["map", "out", "--x", "n", "--y", "density", "--where", "dim=3"];
    let printed = good(folder, &only).stdout;
    assert!(printed.contains("loose, 3D") && !printed.contains("loose, 2D"), "{printed}");
    for (place, begins) in [("m.svg", "<svg"), ("m.csv", "map,")] {
        let twice = ["map", "out", "out", "--x", "dim", "--y", "fraction", "--out", place];
        good(folder, &twice);
        let bytes = std::fs::read(folder.join(place)).unwrap();
        assert!(String::from_utf8_lossy(&bytes).starts_with(begins), "{place}");
    }
    // N varies within the places of the last, and makes panels.
    assert_eq!(read(&folder.join("m.csv")).lines().count(), 9);
}

#[test]
fn what_is_no_map_is_refused_in_one_sentence() {
    let folder = RECORD.copy();
    let folder = folder.path();
    for (rest, words) in [
        (
            &["out", "--x", "n", "--y", "fractoin"][..],
            "no 'fractoin' of a scene or a detector; did",
        ),
        (&["out", "--x", "n", "--y", "n"], "both axes are n"),
        (&["out", "--x", "n", "--y", "time_ns"], "no 'time_ns'"),
        (&["out", "--x", "n", "--y", "fraction", "--where", "dim"], "--where dim: it must be"),
        (&["out", "--x", "n", "--y", "fraction", "--where", "dim=7"], "no cell is left"),
        (&["out", "--x", "n", "--y", "fraction", "--where", "dims=2"], "where names 'dims'"),
        (&["out", "--x", "n", "--y", "fraction", "--out", "m.pdf"], "must be .svg or .csv"),
        (&["none", "--x", "n", "--y", "fraction"], "none has no samples.jsonl"),
    ] {
        refused(folder, &[&["map"], rest].concat(), &[words]);
    }
}
