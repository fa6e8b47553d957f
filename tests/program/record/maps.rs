//! Maps of records: what `map` draws, and what it refuses.

use crate::common::Place;

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

#[test]
fn maps_are_drawn_by_a_run_and_of_any_two_variables_of_records() {
    let at = Place::new();
    at.file("small.toml", EXPERIMENT);
    at.good("run small.toml --out out");
    // Two panels of four places, and two blocks decide nothing.
    let maps = at.read("out/maps.csv");
    assert_eq!(maps.lines().count(), 9, "{maps}");
    assert!(maps.lines().skip(1).all(|line| line.contains(",no,")), "{maps}");
    let page = at.read("out/report.html");
    assert_eq!(page.matches("data-row=").count(), 8);
    assert!(page.contains("<a href=\"#maps\">") && page.contains("<section id=\"maps\">"));
    assert!(at.read("out/report.md").contains("Who is the fastest in each place"));
    assert!(at.path("out/figures/small-winners.svg").exists());
    let words = ["loose, 2D", "loose, 3D", "n = 50", "undecided: "];
    at.ends(0, "map out --x n --y fraction", &words);
    let only = at.ends(0, "map out --x n --y density --where dim=3", &["loose, 3D"]);
    assert!(!only.stdout.contains("loose, 2D"), "{}", only.stdout);
    for (place, begins) in [("m.svg", "<svg"), ("m.csv", "map,")] {
        at.good(&format!("map out out --x dim --y fraction --out {place}"));
        assert!(at.read(place).starts_with(begins), "{place}");
    }
    // N varies within the places of the last, and makes panels.
    assert_eq!(at.read("m.csv").lines().count(), 9);
    for (line, words) in [
        ("out --x n --y fractoin", "'fractoin'"),
        ("out --x n --y n", "both axes are n"),
        ("out --x n --y time_ns", "no 'time_ns'"),
        ("out --x n --y fraction --where dim", "--where dim: it must be"),
        ("out --x n --y fraction --where dim=7", "no cell is left"),
        ("out --x n --y fraction --where dims=2", "where names 'dims'"),
        ("out --x n --y fraction --out m.pdf", "must be .svg or .csv"),
        ("none --x n --y fraction", "none has no samples.jsonl"),
    ] {
        at.ends(2, &format!("map {line}"), &[words]);
    }
}
