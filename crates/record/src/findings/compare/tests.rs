//! Made-up records compared.

use super::*;
use crate::cells::testing::Lab;

fn options() -> Options {
    Options { band: 0.05, ..Options::default() }
}

/// Against a control whose own times are so far apart.
fn against(detector: &str, drift: f64) -> Options {
    let drift = Some(drift);
    Options { against: Some(Against { detector: detector.into(), drift }), ..options() }
}

fn two() -> [Machine; 2] {
    ["one", "two"].map(|name| Machine { name: name.into(), ..Machine::default() })
}

/// 15 times about `base`, with some scatter.
fn times(base: u64) -> Vec<u64> {
    (0..15).map(|k| base + base * (k * 7 % 15) / 1000).collect()
}

fn lab(nbs: u64, sweep: u64) -> Lab {
    let mut lab = Lab::new("e", "packed");
    lab.detector("nbs").count(&[("list_push", 40)]).memory(1000, 900).time(&times(nbs));
    lab.detector("sweep").count(&[("list_push", 0)]).memory(500, 500).time(&times(sweep));
    lab
}

fn judgements(a: &Lab, b: &Lab, options: &Options) -> Vec<(String, Judgement)> {
    let cells = compare(&a.rows(), &b.rows(), options);
    assert!(cells.iter().all(|cell| cell.changes.is_empty() && cell.absent.is_none()), "{cells:?}");
    cells.into_iter().map(|cell| (cell.id.detector, cell.timing.unwrap().judgement)).collect()
}

#[test]
fn times_are_judged_by_the_whole_interval() {
    use Judgement::{Faster, NotJudged, Slower, Undecided, WithinBand};
    let judged = |nbs, sweep, options: &Options| {
        let found = judgements(&lab(100_000, 200_000), &lab(nbs, sweep), options);
        assert_eq!([&*found[0].0, &*found[1].0], ["nbs", "sweep"]);
        [found[0].1, found[1].1]
    };
    // The machine has become half as fast: against nbs nothing has changed.
    let nbs = against("nbs", 1.1);
    assert_eq!(judged(200_000, 400_000, &nbs), [NotJudged, WithinBand]);
    assert_eq!(judged(200_000, 200_000, &nbs), [NotJudged, Faster]);
    assert_eq!(judged(200_000, 600_000, &nbs), [NotJudged, Slower]);
    // Less than what the control itself drifted by tells nothing.
    assert_eq!(judged(200_000, 432_000, &nbs), [NotJudged, Undecided]);
    assert_eq!(judged(200_000, 600_000, &against("nbs", 1.6)), [NotJudged, Undecided]);
    let machines = Options { machines: Some(two()), ..nbs.clone() };
    assert_eq!(judged(200_000, 400_000, &machines), [NotJudged; 2]);
    let across = Options { across: true, ..machines };
    assert_eq!(judged(200_000, 400_000, &across), [NotJudged, WithinBand]);
    // Without a control, on one machine or two, on two kinds of builds, or without its times.
    let builds = Some(["debug", "release"].map(String::from));
    for none in [
        options(),
        Options { machines: Some(two()), ..options() },
        Options { builds, ..nbs },
        against("bvh", 1.0),
    ] {
        assert_eq!(judged(200_000, 400_000, &none), [NotJudged; 2], "{none:?}");
    }
}

#[test]
fn the_control_is_a_detector_with_a_twin_and_its_drift_is_known() {
    let with_twin = |nbs| {
        let mut lab = lab(nbs, 200_000);
        lab.detector("nbs-twin").time(&times(nbs));
        lab.rows()
    };
    let (a, b) = (with_twin(100_000), with_twin(120_000));
    let found = control(&a, &b, None).unwrap();
    assert!(found.detector == "nbs" && (found.drift.unwrap() - 1.2).abs() < 1e-3, "{found:?}");
    assert_eq!(control(&a, &b, Some("sweep")).unwrap().detector, "sweep");
    assert_eq!(control(&a, &lab(1, 1).rows(), None), None);
}

#[test]
fn a_control_with_parameters_is_found() {
    let rows = |unit: u64| {
        let mut lab = lab(100, 200);
        for name in ["streamed-nbs:level=portable", "streamed-nbs-twin:level=portable"] {
            lab.detector(name).time(&times(10_000 * unit));
        }
        lab.rows()
    };
    let (a, b) = (rows(10), rows(11));
    let found = control(&a, &b, None).unwrap();
    assert_eq!(found.detector, "streamed-nbs:level=portable");
    assert!((found.drift.unwrap() - 1.1).abs() < 1e-3, "{found:?}");
    let how = Options { against: Some(found), ..options() };
    let judged = compare(&a, &b, &how).into_iter().map(|cell| cell.timing.unwrap().judgement);
    assert!(judged.filter(|it| *it != Judgement::NotJudged).count() >= 2);
    // The bare name has no times: that is said, and no drift of 0%.
    assert_eq!(control(&a, &b, Some("streamed-nbs")).unwrap().drift, None);
}

/// Rows of this build, its twin and the base, which take turns, in nanoseconds by block.
fn turns(experiment: &str, twin: u64, base: u64, block: impl Fn(u64, u64) -> u64) -> Vec<Row> {
    let mut lab = Lab::new(experiment, "packed");
    for (name, unit) in [("nbs", 1000), ("nbs-twin", twin), ("nbs@base", base)] {
        lab.detector(name).time(&(1..=15).map(|k| block(unit, k)).collect::<Vec<_>>());
    }
    let mut rows = lab.rows();
    for row in rows.iter_mut().filter(|row| row.id.detector == "nbs@base") {
        row.role = crate::record::role::Role::Base("nbs".into());
    }
    rows
}

/// The cells of such rows, this build beside the base.
fn side_by_side(rows: &[Row]) -> Vec<Timing> {
    let Builds { base, this } = Builds::new(rows).unwrap();
    let how = Options { side_by_side: Some(floors(&cells(rows))), ..options() };
    compare(&base, &this, &how).into_iter().map(|cell| cell.timing.unwrap()).collect()
}

#[test]
fn builds_side_by_side_are_paired_by_round() {
    use Judgement::{Slower, Undecided, WithinBand};
    // The machine changes its speed by a factor of 16 over the rounds of every block.
    let judged = |base: u64, twin: u64| {
        let mut rows = turns("e", twin, base, |unit, block| unit * block);
        for row in &mut rows {
            row.rounds_ns = [1, 4, 16].map(|speed| row.time_ns.unwrap() * speed).into();
        }
        side_by_side(&rows).remove(0)
    };
    for (base, twin, judgement, small) in [
        (900, 1010, Slower, false),
        (940, 1010, Undecided, false),
        // A difference that is shown and does not count.
        (980, 1010, WithinBand, true),
        (995, 1010, WithinBand, true),
        (1000, 1010, WithinBand, false),
        // Equal code differs by more.
        (900, 1200, Undecided, false),
    ] {
        let found = judged(base, twin);
        assert_eq!((found.judgement, found.is_small()), (judgement, small), "{base} {found:?}");
        assert!((found.ratio.median - 1000.0 / base as f64).abs() < 1e-9, "{found:?}");
    }
    // Where the linker puts the code is worth more than the twin shows.
    assert!((judged(900, 1010).least - PLACEMENT).abs() < 1e-9);
    assert!(Builds::new(&lab(1, 1).rows()).is_none());
}

/// A slowdown that shows for sure is as wide as the interval, not as half of it.
#[test]
fn what_would_show_is_as_wide_as_the_interval() {
    let (mut a, mut b) = (Lab::new("e", "packed"), Lab::new("e", "packed"));
    a.time(&(0..15).map(|k| 10 * (93 + k)).collect::<Vec<_>>());
    b.time(&[1000; 15]);
    let how = Options { side_by_side: Some(floors(&cells(&lab(1, 1).rows()))), ..options() };
    let timing = compare(&a.rows(), &b.rows(), &how).remove(0).timing.unwrap();
    assert!((timing.least - 100.0 / 96.0 * PLACEMENT).abs() < 1e-9, "{timing:?}");
}

#[test]
fn a_noisy_experiment_does_not_blur_another() {
    let of = |experiment, twin| turns(experiment, twin, 900, |unit, _| unit);
    let rows = [of("calm", 1010), of("noisy", 1500)].concat();
    let judged: Vec<_> = side_by_side(&rows).iter().map(|it| it.judgement).collect();
    assert_eq!(judged, [Judgement::Slower, Judgement::Undecided]);
}

#[test]
fn as_many_slower_cells_as_chance_makes_are_no_slowdown() {
    // 15 blocks: each of the cells is slower by chance with 1.8%.
    let slower = |all: u64, slow: u64| {
        let (mut a, mut b) = (Lab::new("e", "packed"), Lab::new("e", "packed"));
        for n in 1..=all {
            a.n(n).time(&times(1000));
            b.n(n).time(&times(if n <= slow { 2000 } else { 1000 }));
        }
        let how = Options { side_by_side: Some(floors(&cells(&a.rows()))), ..options() };
        let found = Summary::new(&compare(&a.rows(), &b.rows(), &how));
        assert_eq!(found.judged.get(&Judgement::Slower).map_or(0, |it| *it as u64), slow);
        assert!((found.by_chance - 0.0176 * all as f64).abs() < 0.01, "{found:?}");
        found.is_slower()
    };
    assert!(!slower(82, 3) && slower(82, 5) && slower(2, 1) && !slower(5, 0));
}

#[test]
fn few_blocks_decide_nothing() {
    let few = |time| {
        let mut lab = Lab::new("e", "packed");
        lab.time(&[time, time + 1, time + 2]);
        lab
    };
    let how = Options { side_by_side: Some(floors(&cells(&few(1).rows()))), ..options() };
    let cells = compare(&few(100).rows(), &few(900).rows(), &how);
    let timing = cells[0].timing.as_ref().unwrap();
    assert_eq!(
        (timing.judgement, &timing.note),
        (Judgement::Undecided, &Some(Note::FewBlocks(3, 3)))
    );
    assert!((timing.ratio.median - 901.0 / 101.0).abs() < 0.05, "shown all the same: {timing:?}");
}

#[test]
fn whatever_must_be_the_same_is_named() {
    let a = lab(100, 200).rows();
    let changed = |change: fn(&mut Row)| {
        let mut b = a.clone();
        b.iter_mut().for_each(change);
        let cells = compare(&a, &b, &options());
        cells
            .iter()
            .flat_map(|cell| {
                cell.changes
                    .iter()
                    .map(|c| format!("{}: {} {} -> {}", cell.id.detector, c.what, c.a, c.b))
            })
            .collect::<Vec<_>>()
    };
    assert!(changed(|_| ()).is_empty());
    let nbs = |row: &Row| row.id.detector == "nbs";
    assert!(nbs(&a[0]));
    let one: fn(&mut Row) = |row| row.counts.values_mut().for_each(|count| *count += 1);
    assert_eq!(changed(one), ["nbs: list_push 40 -> 41", "sweep: list_push 0 -> 1"]);
    let unknown: fn(&mut Row) = |row| {
        row.counts =
            row.counts.iter().filter(|count| *count.1 > 0).map(|(k, v)| (k.clone(), *v)).collect()
    };
    assert!(changed(unknown).is_empty(), "an operation that did not happen need not be named");
    assert_eq!(
        changed(|row| row.peak_bytes = row.peak_bytes.map(|b| b.min(900))),
        ["nbs: peak_bytes 1000 -> 900"]
    );
    assert_eq!(
        changed(|row| if row.id.detector == "sweep" && row.pass == Pass::Time {
            row.digest = Some("0x01".into())
        }),
        ["sweep: answer 250 pairs, 0x00 -> 250 pairs, 0x00 and 250 pairs, 0x01"]
    );
    assert_eq!(
        changed(|row| if row.id.detector == "sweep" && row.pass == Pass::Count {
            row.outcome = Outcome::Wrong
        }),
        ["sweep: outcome (count) ok -> wrong"]
    );
    assert_eq!(
        changed(|row| row.stats.scene_hash = "0x2".into()),
        ["nbs: scene  -> 0x2", "sweep: scene  -> 0x2"]
    );
}

#[test]
fn cells_of_one_side_and_unavailable_ones_are_absent() {
    let (a, mut b) = (lab(100, 200), Lab::new("e", "packed"));
    b.time(&times(100)).detector("sweep").fail(Pass::Count, Outcome::Unavailable, "not installed");
    b.detector("bvh").time(&times(7));
    let absent: Vec<_> = compare(&a.rows(), &b.rows(), &options())
        .into_iter()
        .map(|cell| (cell.id.detector, cell.absent))
        .collect();
    assert_eq!(
        absent,
        [
            ("bvh".into(), Some(Absent::OnlyIn(Side::B))),
            ("nbs".into(), None),
            ("sweep".into(), Some(Absent::UnavailableIn(Side::B, "not installed".into())))
        ]
    );
}

#[test]
fn what_one_has_not_measured_is_lacking() {
    let (a, mut b) = (lab(100, 200), Lab::new("e", "packed"));
    b.count(&[("list_push", 40)]).time(&times(100)).detector("sweep");
    b.count(&[("list_push", 0)]).memory(500, 500);
    let cells = compare(&a.rows(), &b.rows(), &options());
    let lacks = |k: usize| cells[k].lacks.clone();
    let only = |what| Lack::Value(what, Side::A);
    assert_eq!(
        lacks(0),
        [Lack::Pass(Pass::Memory, Side::A), only("peak_bytes"), only("formula_bytes")]
    );
    assert_eq!(lacks(1), [Lack::Pass(Pass::Time, Side::A), only("times")]);
    let found = Summary::new(&cells);
    assert_eq!((found.cells, found.changed, found.absent, found.lacking), (2, 0, 0, 2));
    assert_eq!(found.judged.values().sum::<usize>(), 1);
}

/// Columns and ratio are of one quantity; a twin that moved leaves nothing decided.
#[test]
fn a_twin_that_moves_voids_the_verdicts() {
    use Judgement::{NotJudged, Slower, WithinBand};
    let record = |scenes: u64, moved: u64, twin: u64, sweep: u64| {
        let mut lab = Lab::new("e", "packed");
        for n in 1..=scenes {
            let twin = if n <= moved { twin } else { 100_000 };
            for (name, base) in [("nbs", 100_000), ("nbs-twin", twin), ("sweep", sweep)] {
                lab.detector(name).n(n).time(&times(base));
            }
        }
        lab.rows()
    };
    let judged = |scenes: u64, moved: u64, twin: u64| {
        let found = compare(
            &record(scenes, 0, 100_000, 200_000),
            &record(scenes, moved, twin, 300_000),
            &against("nbs", 1.0),
        );
        let sweep = found.iter().filter(|cell| cell.id.detector == "sweep");
        let sweep: Vec<Judgement> =
            sweep.map(|cell| cell.timing.as_ref().unwrap().judgement).collect();
        (sweep, Summary::new(&found), found)
    };
    let (all, summary, found) = judged(3, 0, 100_000);
    assert_eq!((all, &summary.moved), (vec![Slower; 3], &None));
    for cell in found.iter().filter(|cell| cell.id.detector != "nbs") {
        let timing = cell.timing.as_ref().unwrap();
        let [a, b] = timing.multiples.unwrap();
        assert!((b / a - timing.ratio.median).abs() < 1e-9, "{timing:?}");
        assert_eq!(timing.judgement == WithinBand, cell.id.detector == "nbs-twin");
    }
    // By far in one of many scenes.
    let (all, summary, _) = judged(12, 1, 590_000);
    assert_eq!(all, [NotJudged; 12]);
    let (name, factor) = summary.moved.clone().unwrap();
    assert!(name == "nbs-twin" && (factor - 5.9).abs() < 1e-9, "{factor}");
    assert!(!summary.decides() && !summary.sees() && summary.least.is_none());
    // By little in one of many: that is chance, and its scene is not judged; in several: all.
    let (all, ..) = judged(12, 1, 110_000);
    assert_eq!(all, [&[NotJudged][..], &[Slower; 11]].concat());
    assert_eq!(judged(12, 4, 110_000).0, [NotJudged; 12]);
}

#[test]
fn cells_say_together_what_each_leaves_open() {
    let pooled_over = |cells: u64| {
        let (mut a, mut b) = (Lab::new("e", "packed"), Lab::new("e", "packed"));
        for n in 1..=cells {
            a.n(n).time(&times(100_000));
            b.n(n).time(&times(98_000 + 100 * n));
        }
        let how = Options { side_by_side: Some(floors(&cells_of(&a))), ..options() };
        pooled(&compare(&a.rows(), &b.rows(), &how))
    };
    fn cells_of(lab: &Lab) -> Vec<Cell> {
        cells(&lab.rows())
    }
    let found = pooled_over(18);
    let [(name, ratio)] = &found[..] else { panic!("{found:?}") };
    assert!(name == "nbs" && ratio.count == 18 && ratio.excludes(1.0), "{ratio:?}");
    assert!((ratio.median - 0.9895).abs() < 1e-4, "{ratio:?}");
    assert!(pooled_over(4)[0].1.coverage < 0.95 && pooled_over(1).is_empty());
}
