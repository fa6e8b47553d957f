use super::*;
use crate::cells::testing::Lab;

fn ratios(lab: &Lab, reference: &str) -> Option<Ratios> {
    lab.find(|cells| Ratios::new(cells, reference))
}

fn near(ratio: Option<Interval>, expected: f64) -> bool {
    ratio.is_some_and(|ratio| {
        [ratio.low, ratio.median, ratio.high].iter().all(|v| (v - expected).abs() < 1e-9)
    })
}

#[test]
fn ratios_are_paired_sorted_and_without_wrong_winners() {
    let mut lab = Lab::new("e", "packed");
    for (n, screening, sorting) in [(100, 125, 300), (1000, 110, 250)] {
        lab.n(n).arithmetic("exact");
        lab.detector("nbs").time(&[100 * n; 15]).edit(|row| row.first_ns = Some(200));
        lab.detector("nbs-twin").time(&[101 * n; 15]);
        lab.detector("screening").time(&[screening * n; 15]);
        lab.detector("sorting").time(&[sorting * n; 15]);
        lab.detector("nothing").time(&[1; 15]).edit(|row| row.outcome = Outcome::Control);
        // The fastest subject is wrong. The library `peer`, in f64 only, is not installed.
        lab.detector("direct").time(&[50 * n; 15]).edit(|row| row.outcome = Outcome::Wrong);
        let why = format!("get it, {n}");
        lab.arithmetic("f64").detector("peer").fail(Pass::Time, Outcome::Unavailable, &why);
        lab.detector("other").time(&[80 * n; 15]).edit(|row| row.first_ns = Some(800));
    }
    let found = ratios(&lab, "nbs").unwrap();
    let [scene] = &*found.scenes else { panic!("{found:?}") };
    assert_eq!(scene.sizes, [100, 1000]);
    let names: Vec<&str> = scene.lines.iter().map(|line| &*line.name).collect();
    let first =
        ["other (f64)", "nbs (exact)", "nbs-twin (exact)", "screening (exact)", "sorting (exact)"];
    assert_eq!((&names[..5], names.len()), (&first[..], 7), "nothing is no subject");
    let entry = |name: &str, k: usize| {
        let line = scene.lines.iter().find(|line| line.name == name).unwrap();
        line.entries[k].clone().unwrap()
    };
    for (name, k, ratio) in [
        ("other (f64)", 1, 0.8),
        ("screening (exact)", 0, 1.25),
        ("screening (exact)", 1, 1.1),
        ("direct (exact)", 0, 0.5),
    ] {
        assert!(near(entry(name, k).ratio, ratio), "{name}");
    }
    let nbs = entry("nbs (exact)", 0);
    assert_eq!((nbs.time_ns, nbs.is_base, nbs.control), (Some(1e4), true, false));
    assert!(entry("nbs-twin (exact)", 0).control);
    let wrong = entry("direct (exact)", 0);
    assert_eq!((wrong.outcome, wrong.time_ns, wrong.right_ratio()), (Outcome::Wrong, None, None));
    let peer = entry("peer (f64)", 1);
    assert_eq!((peer.outcome, peer.ratio), (Outcome::Unavailable, None));
    assert_eq!(peer.base.as_deref(), Some("exact"));
    let Missing { name, outcome, cells, reason } = &found.missing[1];
    assert_eq!((&**name, *outcome, *cells), ("peer (f64)", Outcome::Unavailable, 2));
    assert_eq!(reason, "get it, 100");
    let library = &found.libraries[0];
    assert!(near(Some(library.ratio), 0.8) && near(library.cold, 4.0), "{library:?}");
}

#[test]
fn a_noisy_library_leaves_it_open() {
    let noisy: Vec<u64> = (0..15).map(|k| if k % 2 == 0 { 900 } else { 50 }).collect();
    let mut lab = Lab::new("e", "packed");
    lab.detector("nbs").time(&[100; 15]).detector("noisy").time(&noisy);
    lab.detector("other").time(&[700; 15]).detector("contactbench-half").time(&[200; 15]);
    let found = ratios(&lab, "nbs").unwrap();
    let [library] = &*found.libraries else { panic!("{found:?}") };
    assert_eq!((&*library.name, &library.open[..]), ("other", &["noisy".to_string()][..]));
    assert!(ratios(&lab, "sorting").is_none());
}

#[test]
fn seeds_are_compared_with_their_own_and_threads_with_one() {
    let mut lab = Lab::new("e", "packed");
    for (seed, scale) in [(1, 1), (2, 10), (3, 100)] {
        lab.seed(seed).threads(1).detector("nbs").time(&[100 * scale; 15]);
        lab.detector("direct").time(&[200 * scale; 15]);
        lab.threads(2).detector("nbs").time(&[60 * scale; 15]);
    }
    let found = ratios(&lab, "nbs").unwrap();
    let entries = &found.scenes[0].lines;
    let names: Vec<&str> = entries.iter().map(|line| &*line.name).collect();
    assert_eq!(names, ["nbs (2 threads)", "nbs", "direct"]);
    for (line, ratio) in entries.iter().zip([0.6, 1.0, 2.0]) {
        let entry = line.entries[0].as_ref().unwrap();
        assert!(near(entry.ratio, ratio) && entry.is_base == (line.name == "nbs"), "{entry:?}");
    }
    assert_eq!(entries[1].entries[0].as_ref().unwrap().time_ns, Some(1000.0));
}
