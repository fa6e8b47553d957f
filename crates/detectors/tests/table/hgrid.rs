use contactbench_detectors::table;
use contactbench_ground::contact::Test;
use contactbench_ground::detect::Options;
use contactbench_ground::pairs::sink::Digest;
use contactbench_ground::probe::{Op, Tally};
use contactbench_ground::scene::AnyScene;

use crate::sizes::scene;

fn count(detector: &str, scene: &AnyScene<'_>) -> Tally {
    let mut tally = Tally::default();
    let mut detector = table::parse(detector).unwrap().make(Options::default());
    detector.count(scene, Test::Exact, &mut tally, &mut Digest::default()).unwrap();
    tally
}

/// A giant is tested against the dust around it, or against all dust if that is cheaper than
/// visiting cells. Dust is never tested against the giant's cells.
#[test]
fn a_giant_costs_only_its_neighbourhood() {
    let (dust, edge) = (4000, 10.0);
    // streamed-nbs gets the form with cells, because it would make columns of dust alone. A giant
    // changes the grid of its dust, and so the tests among dust.
    for (detector, slack) in [("hgrid", 0.0), ("streamed-nbs:form=dense", 0.1)] {
        let with = |giant: Option<f64>| {
            let radii = (0..dust).map(|_| 0.25).chain(giant).collect();
            let tally = count(detector, &scene::<3>(radii, edge, 5));
            [Op::ContactTest, Op::LevelProbe].map(|op| tally.get(op) as f64)
        };
        let [without, probes] = with(None);
        assert_eq!(probes, 0.0, "{detector}");
        for giant in [1.5, 2.5, 10.0, 250.0] {
            let [more, probes] = with(Some(giant));
            // Particles in the box around the giant, a cell wider on each side.
            let around = (2.0 * (giant + 4.0 * 0.25) / edge).min(1.0).powi(3) * f64::from(dust);
            let most = 1.3 * around + 30.0 + slack * without;
            assert!((more - without).abs() <= most, "{detector}, {giant}: {more} of {around}");
            let all = detector == "hgrid" && giant >= edge;
            assert!(probes > 0.0 || all, "{detector}, {giant}");
        }
    }
}

/// Occupied strips take memory, the size of the domain does not.
#[test]
fn memory_depends_on_particles_not_on_cells() {
    let mut radii = vec![0.25; 1000];
    radii.push(250.0);
    let near = scene::<3>(radii.clone(), 60.0, 3);
    let far = scene::<3>(radii, 60_000.0, 3);
    let bytes = |scene: &AnyScene<'_>| {
        let mut detector = table::parse("hgrid").unwrap().make(Options::default());
        detector.visit(scene, Test::Exact, &mut Digest::default()).unwrap();
        detector.formula_bytes()
    };
    // 2048 slots for dust, 2 for the giant; one place and record each; at most one strip each.
    let least = 4 * (2050 + 1001) + 32 * 1001;
    for scene in [near, far] {
        let found = bytes(&scene);
        assert!((least + 48..=least + 48 * 1001).contains(&found), "{found}");
    }
}
