//! Tests notices about files by kind; `cases/files.txt` tests that every verb prints them.

use crate::common::Place;

const KINDS: [(&str, &str); 10] = [
    ("diameters", "hold diameters"),
    ("unit", "another unit than"),
    ("apart", "nothing touches"),
    ("points", "radii are 0"),
    ("nested", "nearly concentric"),
    ("twice", "of another, such"),
    ("flat", "z is 0"),
    ("scaled", "scaled by"),
    ("digits", "6 significant digits"),
    ("deep", "radii in the mean"),
];

/// Returns the kinds of notices in a text, with repetitions.
fn notices(text: &str) -> Vec<&'static str> {
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    let of = |(kind, words): (&'static str, &str)| vec![kind; text.matches(words).count()];
    KINDS.into_iter().flat_map(of).collect()
}

fn table(rows: impl IntoIterator<Item = [f64; 4]>) -> String {
    let line = |[x, y, z, r]: [f64; 4]| format!("{x},{y},{z},{r}\n");
    format!("x,y,z,r\n{}", rows.into_iter().map(line).collect::<String>())
}

#[test]
fn each_kind_is_recognised_and_nothing_else() {
    let at = Place::new();
    at.file("none.csv", "i,j\n");
    let good = at.good("scene packed:dim=3,n=300,spacing=0.99").stdout;
    let numbers = |line: &str| {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        <[f64; 4]>::try_from(cells).unwrap()
    };
    let rows: Vec<[f64; 4]> = good.lines().skip(1).map(numbers).collect();
    let radius = |factor: f64| table(rows.iter().map(|&[x, y, z, r]| [x, y, z, factor * r]));
    let with = |row: [f64; 4]| table(rows.iter().copied().chain([row]));
    let [x, y, z, r] = rows[7];
    let most = |k: usize| rows.iter().map(|row| row[k]).fold(0.0, f64::max);
    let least = |k: usize| rows.iter().map(|row| row[k]).fold(f64::INFINITY, f64::min);
    let share = |row: &[f64; 4], k: usize| (row[k] - least(k)) / (most(k) - least(k));
    let scaled = table(rows.iter().map(|row| [share(row, 0), share(row, 1), share(row, 2), 1e-4]));
    let apart = |k: u32| f64::from(k * 7919 % 1000) / 100.0;
    let gas = table((0..300).map(|k| [apart(k), apart(3 * k + 1), apart(k * k), 0.45]));
    let six = rows.iter().map(|[x, y, z, r]| format!("{x:.5},{y:.5},{z:.5},{r}\n"));
    let lattice = (0..40).map(|k| [f64::from(k / 4), f64::from(k % 4), f64::from(k) * 0.5, 0.1]);
    for (text, expected) in [
        (good.clone(), &[][..]),
        (radius(2.0), &["diameters"]),
        (radius(1000.0), &["unit"]),
        (radius(0.001), &["apart"]),
        (radius(0.0), &["points"]),
        (with([x + 1e-3, y, z, r]), &["nested"]),
        (with([x, y, z, r]), &["twice"]),
        (scaled, &["apart", "scaled"]),
        (gas, &["deep"]),
        (format!("x,y,z,r\n{}", six.collect::<String>()), &["digits"]),
        // Coordinates on a lattice have few digits, but need no notice.
        (table(lattice), &["apart"]),
        ("x,y,z,r\n0,0,0,0.6\n1,0,0,0.6\n".into(), &["flat"]),
    ] {
        at.file("p.csv", text);
        assert_eq!(notices(&at.good("inspect p.csv").stdout), expected);
        assert_eq!(notices(&at.run("verify p.csv --pairs none.csv").stderr), expected);
    }
}
