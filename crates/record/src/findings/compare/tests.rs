use super::comparison::by_build;
use super::*;
use crate::cells::testing::Lab;
use crate::record::role::Role;

fn options() -> Options {
    Options { band: 0.05, ..Options::default() }
}

fn against(detector: &str, drift: f64) -> Options {
    let drift = Some(drift);
    Options { against: Some(Against { detector: detector.into(), drift }), ..options() }
}

fn in_turns(rows: &[Row]) -> Options {
    Options { side_by_side: Some(floors(&cells(rows))), ..options() }
}

fn times(base: u64) -> Vec<u64> {
    (0..15).map(|k| base + base * (k * 7 % 15) / 1000).collect()
}

fn one(times: &[u64]) -> Vec<Row> {
    Lab::new("e", "packed").time(times).rows()
}

fn lab(nbs: u64, sweep: u64) -> Lab {
    let mut lab = Lab::new("e", "packed");
    lab.detector("nbs").count(&[("list_push", 40)]).memory(1000, 900).time(&times(nbs));
    lab.detector("sweep").count(&[("list_push", 0)]).memory(500, 500).time(&times(sweep));
    lab
}

fn timings(a: &[Row], b: &[Row], options: &Options) -> Vec<Timing> {
    let (cells, _) = compare(a, b, options);
    assert!(cells.iter().all(|cell| cell.changes.is_empty() && cell.absent.is_none()), "{cells:?}");
    cells.into_iter().map(|cell| cell.timing.unwrap()).collect()
}

#[test]
fn times_are_judged_by_the_whole_interval() {
    use Judgement::{Faster, NotJudged, Slower, Undecided, WithinBand};
    let a = lab(100_000, 200_000).rows();
    let judged = |sweep, options: &Options| {
        let found = timings(&a, &lab(200_000, sweep).rows(), options);
        assert_eq!(found[0].judgement, NotJudged, "nbs is the control");
        found[1].judgement
    };
    // The machine became half as fast; relative to nbs, nothing changed.
    let nbs = against("nbs", 1.1);
    let machines = ["one", "two"].map(|name| Machine { name: name.into(), ..Machine::default() });
    let machines = Some(machines);
    let two = Options { machines: machines.clone(), ..nbs.clone() };
    let builds = Some(["debug", "release"].map(String::from));
    for (sweep, options, judgement) in [
        (400_000, nbs.clone(), WithinBand),
        (200_000, nbs.clone(), Faster),
        (600_000, nbs.clone(), Slower),
        // A change smaller than the drift of the control is undecided.
        (432_000, nbs.clone(), Undecided),
        (600_000, against("nbs", 1.6), Undecided),
        (400_000, two.clone(), NotJudged),
        (400_000, Options { across: true, ..two }, WithinBand),
        // Not judged: no control, another machine or kind of build, or a control without times.
        (400_000, options(), NotJudged),
        (400_000, Options { machines, ..options() }, NotJudged),
        (400_000, Options { builds, ..nbs }, NotJudged),
        (400_000, against("bvh", 1.0), NotJudged),
    ] {
        assert_eq!(judged(sweep, &options), judgement, "{sweep} {options:?}");
    }
}

#[test]
fn the_control_is_a_detector_with_a_twin_and_its_drift_is_known() {
    let rows = |unit: u64, detector: &str| {
        let mut lab = lab(100, 200);
        let twin = detector.replacen("nbs", "nbs-twin", 1);
        lab.detector(detector).time(&times(1000 * unit)).detector(&twin).time(&times(1000 * unit));
        lab.rows()
    };
    for detector in ["nbs", "streamed-nbs:level=portable"] {
        let (a, b) = (rows(100, detector), rows(120, detector));
        let found = control(&a, &b, None).unwrap();
        assert_eq!(found.detector, detector);
        assert!((found.drift.unwrap() - 1.2).abs() < 1e-3, "{found:?}");
        assert_eq!(control(&a, &b, Some("sweep")).unwrap().detector, "sweep");
        assert_eq!(control(&a, &one(&[1]), None), None);
        // The drift of a control without times is unknown, not 0%.
        assert_eq!(control(&a, &b, Some("streamed-nbs")).unwrap().drift, None);
        let judged = timings(&a, &b, &Options { against: Some(found), ..options() });
        assert!(judged.iter().any(|it| it.judgement != Judgement::NotJudged));
    }
}

/// Rows of this build, its twin and the base, timed in turns; nanoseconds by block.
fn turns(experiment: &str, twin: u64, base: u64, block: impl Fn(u64, u64) -> u64) -> Vec<Row> {
    let mut lab = Lab::new(experiment, "packed");
    for (name, unit) in [("nbs", 1000), ("nbs-twin", twin), ("nbs@base", base)] {
        lab.detector(name).time(&(1..=15).map(|k| block(unit, k)).collect::<Vec<_>>());
    }
    let mut rows = lab.rows();
    for row in rows.iter_mut().filter(|row| row.id.detector == "nbs@base") {
        row.role = Role::Base("nbs".into());
    }
    rows
}

fn side_by_side(rows: &[Row]) -> Vec<Timing> {
    let [base, this] = by_build(rows);
    timings(&base, &this, &in_turns(rows))
}

#[test]
fn builds_side_by_side_are_paired_by_round() {
    use Judgement::{Slower, Undecided, WithinBand};
    // The machine's speed changes by a factor of 16 over the rounds of every block.
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
        (980, 1010, WithinBand, true),
        (1000, 1010, WithinBand, false),
        (900, 1200, Undecided, false),
    ] {
        let found = judged(base, twin);
        assert_eq!((found.judgement, found.is_small()), (judgement, small), "{base} {found:?}");
        assert!((found.ratio.median - 1000.0 / base as f64).abs() < 1e-9, "{found:?}");
    }
    // Code placement by the linker may matter more than the twin shows.
    assert!((judged(900, 1010).least - PLACEMENT).abs() < 1e-9);
    assert!(by_build(&one(&[1]))[0].is_empty());
    let of = |experiment, twin| turns(experiment, twin, 900, |unit, _| unit);
    let both = side_by_side(&[of("calm", 1010), of("noisy", 1500)].concat());
    assert_eq!([both[0].judgement, both[1].judgement], [Slower, Undecided]);
    let (a, b) = (one(&(0..15).map(|k| 10 * (93 + k)).collect::<Vec<_>>()), one(&[1000; 15]));
    let timing = timings(&a, &b, &in_turns(&a)).remove(0);
    assert!((timing.least - 100.0 / 96.0 * PLACEMENT).abs() < 1e-9, "{timing:?}");
    // Few blocks do not decide; the ratio is still shown.
    let (a, b) = (one(&[100, 101, 102]), one(&[900, 901, 902]));
    let timing = timings(&a, &b, &in_turns(&a)).remove(0);
    assert_eq!((timing.judgement, &*timing.note), (Undecided, "too few blocks: 3"));
    assert!((timing.ratio.median - 901.0 / 101.0).abs() < 0.05, "{:?}", timing.ratio);
}

#[test]
fn as_many_slower_cells_as_chance_makes_are_no_slowdown() {
    // In 15 blocks, each cell is slower by chance with probability 1.8%.
    for (all, slow, is_slower) in [(82, 3, false), (82, 5, true), (2, 1, true), (5, 0, false)] {
        let (mut a, mut b) = (Lab::new("e", "packed"), Lab::new("e", "packed"));
        for n in 1..=all {
            a.n(n).time(&times(1000));
            b.n(n).time(&times(if n <= slow { 2000 } else { 1000 }));
        }
        let (_, found) = compare(&a.rows(), &b.rows(), &in_turns(&a.rows()));
        assert_eq!(found.judged.get(&Judgement::Slower).map_or(0, |it| *it as u64), slow);
        assert!((found.by_chance - 0.0176 * all as f64).abs() < 0.01, "{found:?}");
        assert_eq!(found.is_slower(), is_slower, "{all} {slow}");
    }
}

#[test]
fn whatever_must_be_the_same_is_named() {
    let a = lab(100, 200).rows();
    let sweep = |row: &Row, pass| row.id.detector == "sweep" && row.pass == pass;
    type Case<'a> = (&'a dyn Fn(&mut Row), &'a [&'a str]);
    let cases: [Case; 7] = [
        (&|_| (), &[]),
        (
            &|row| row.counts.values_mut().for_each(|count| *count += 1),
            &["nbs: list_push 40 -> 41", "sweep: list_push 0 -> 1"],
        ),
        // Operations with count 0 may be missing.
        (&|row| row.counts.retain(|_, count| *count > 0), &[]),
        (
            &|row| row.peak_bytes = row.peak_bytes.map(|b| b.min(900)),
            &["nbs: peak_bytes 1000 -> 900"],
        ),
        (
            &|row| row.digest = sweep(row, Pass::Time).then(|| "0x01".into()).or(row.digest.take()),
            &["sweep: answer 250 pairs, 0x00 -> 250 pairs, 0x00 and 250 pairs, 0x01"],
        ),
        (
            &|row| row.outcome = if sweep(row, Pass::Count) { Outcome::Wrong } else { row.outcome },
            &["sweep: outcome (count) ok -> wrong"],
        ),
        (
            &|row| row.stats.scene_hash = "0x2".into(),
            &["nbs: scene  -> 0x2", "sweep: scene  -> 0x2"],
        ),
    ];
    for (change, expected) in cases {
        let mut b = a.clone();
        b.iter_mut().for_each(change);
        let (cells, _) = compare(&a, &b, &options());
        let found = cells.iter().flat_map(|cell| {
            let said = |c: &Change| format!("{}: {} {} -> {}", cell.id.detector, c.what, c.a, c.b);
            cell.changes.iter().map(said)
        });
        assert_eq!(found.collect::<Vec<_>>(), expected);
    }
}

#[test]
fn what_one_has_not_measured_is_absent_or_lacking() {
    let (a, mut b) = (lab(100, 200), Lab::new("e", "packed"));
    b.time(&times(100)).detector("sweep").fail(Pass::Count, Outcome::Unavailable, "not installed");
    b.detector("bvh").time(&times(7));
    let (cells, _) = compare(&a.rows(), &b.rows(), &options());
    let absent: Vec<_> = cells.into_iter().map(|cell| (cell.id.detector, cell.absent)).collect();
    assert_eq!(
        absent,
        [
            ("bvh".into(), Some("only in B".into())),
            ("nbs".into(), None),
            ("sweep".into(), Some("unavailable in B: not installed".into()))
        ]
    );
    let mut b = Lab::new("e", "packed");
    b.count(&[("list_push", 40)]).time(&times(100)).detector("sweep");
    b.count(&[("list_push", 0)]).memory(500, 500);
    let (cells, found) = compare(&a.rows(), &b.rows(), &options());
    assert_eq!(cells[0].lacks, ["the memory pass only in A"]);
    assert_eq!(cells[1].lacks, ["the time pass only in A", "times only in A"]);
    assert_eq!((found.cells, found.changed, found.absent, found.lacking), (2, 0, 0, 2));
    assert_eq!(found.judged.values().sum::<usize>(), 1);
}

/// If a twin moved, no verdict is given; the printed columns and the ratio measure the same
/// quantity.
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
        let (a, b) = (record(scenes, 0, 0, 200_000), record(scenes, moved, twin, 300_000));
        let (found, summary) = compare(&a, &b, &against("nbs", 1.0));
        let sweep = found.iter().filter(|cell| cell.id.detector == "sweep");
        let sweep = sweep.map(|cell| cell.timing.as_ref().unwrap().judgement);
        (sweep.collect::<Vec<_>>(), summary, found)
    };
    let (all, summary, found) = judged(3, 0, 100_000);
    assert_eq!((all, &summary.moved), (vec![Slower; 3], &None));
    for cell in found.iter().filter(|cell| cell.id.detector != "nbs") {
        let timing = cell.timing.as_ref().unwrap();
        let [a, b] = timing.multiples.unwrap();
        assert!((b / a - timing.ratio.median).abs() < 1e-9, "{timing:?}");
        assert_eq!(timing.judgement == WithinBand, cell.id.detector == "nbs-twin");
    }
    // A twin that moves far in one scene voids all verdicts.
    let (all, summary, _) = judged(12, 1, 590_000);
    assert_eq!(all, [NotJudged; 12]);
    let (name, factor) = summary.moved.clone().unwrap();
    assert!(name == "nbs-twin" && (factor - 5.9).abs() < 1e-9, "{factor}");
    assert!(!summary.decides() && !summary.sees() && summary.least.is_none());
    // A twin that moves little in one scene voids only that scene; in several scenes, it voids all.
    assert_eq!(judged(12, 1, 110_000).0, [&[NotJudged][..], &[Slower; 11]].concat());
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
        pooled(&compare(&a.rows(), &b.rows(), &in_turns(&a.rows())).0)
    };
    let found = pooled_over(18);
    let [(name, ratio)] = &found[..] else { panic!("{found:?}") };
    assert!(name == "nbs" && ratio.count == 18 && ratio.excludes(1.0), "{ratio:?}");
    assert!((ratio.median - 0.9895).abs() < 1e-4, "{ratio:?}");
    assert!(pooled_over(4)[0].1.coverage < 0.95 && pooled_over(1).is_empty());
}
