//! Crossovers of made-up detectors, whose laws are known.

use super::super::{fake::Lab, value};
use super::*;

/// `direct` with 0.01 N^2 ns, `nbs` with 100 N + 1000 ns, `screening` with twice that: the first two are equal at about 10^4.
fn cells() -> Vec<Cell> {
    let mut lab = Lab::new("e", "packed");
    for (scene, factor) in [("packed", 1), ("loose", 1), ("clustered", 1)] {
        for n in [1000_u64, 3000, 30_000, 100_000] {
            lab.scene(scene, 2).n(n);
            lab.detector("direct").time(&[n * n * factor / 100; 5]).count(&[("contact_test", n * n)]);
            lab.detector("nbs").time(&[100 * n + 1000; 5]).count(&[("list_push", 2 * n)]);
            lab.detector("screening").time(&[200 * n + 2000; 5]).count(&[("list_push", 2 * n)]);
        }
    }
    value::cells(&lab.rows())
}

#[test]
fn known_crossovers_are_found() {
    let cells = cells();
    let all: Vec<&Cell> = cells.iter().collect();
    let series = series(&all);
    let fits = fits(&series);
    assert_eq!(fits.len(), 3);
    let curve_of = |name: &str| {
        let one = series.iter().find(|one| one.line.detector == name).unwrap();
        curve(fits.iter().find(|fit| fit.line == one.line).unwrap(), one).unwrap()
    };
    let (direct, nbs, screening) = (curve_of("direct"), curve_of("nbs"), curve_of("screening"));
    let found = crossings(&direct, &nbs);
    assert_eq!(found.len(), 1, "{found:?}");
    assert!((found[0].n / 1e4 - 1.0).abs() < 0.02, "{found:?}");
    assert_eq!((&*found[0].below.detector, &*found[0].above.detector), ("direct", "nbs"));
    assert!(found[0].range.0 <= found[0].n && found[0].n <= found[0].range.1);
    assert!(crossings(&nbs, &screening).is_empty());
    let reign = [direct, nbs, screening];
    let names: Vec<&str> = super::reign(&reign).iter().map(|(_, line)| &*line.detector).collect();
    assert_eq!(names, ["direct", "nbs"]);
    assert_eq!(score(&series, &fits), (36, 36));
}

#[test]
fn the_section_says_where_and_where_not() {
    let cells = cells();
    let page = section(&cells.iter().collect::<Vec<_>>());
    assert!(page.contains("| packed, 2D | direct; from 10^4 nbs |"), "{page}");
    assert!(page.contains("| packed, 2D | direct | nbs | 10^4 ("), "{page}");
    // direct crosses nbs and screening in each scene; nbs and screening never meet
    assert!(page.ends_with("No crossover in 10^2..10^7: 3 of 9 couples."), "{page}");
    assert!(page.contains("it names the faster one in 100%"), "{page}");
    assert!(section(&[]).contains("nothing can be fitted"));
    assert_eq!(
        (about(1e4), about(99_990.0), about(3.14e5), about(250.0)),
        ("10^4".into(), "10^5".into(), "3.1·10^5".into(), "2.5·10^2".into())
    );
}
