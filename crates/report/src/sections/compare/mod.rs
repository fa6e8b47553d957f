pub mod page;

use crate::table::Table;
use contactbench_record::findings::compare::{
    Against, Change, Compared, Judgement, Note, Options, PLACEMENT, Summary, Timing,
};
use contactbench_record::findings::trust::noise::{Noise, Twin};
use contactbench_record::record::origin::machines::Machine;
use contactbench_record::stats::interval::{COVERAGE, Interval};
use contactbench_terms::number::{number, percent, plural, with_ends};

/// Formats a change such as `digest 0x01 -> 0x02`.
pub fn change(Change { what, a, b }: &Change) -> String {
    format!("{what} {a} -> {b}")
}

/// Explains why times are not judged; empty if there is nothing to explain.
pub fn note(timing: &Timing, options: &Options) -> String {
    match &timing.note {
        None => String::new(),
        Some(Note::Builds) => options.builds.as_ref().map_or(String::new(), builds),
        Some(Note::Machines) => options.machines.as_ref().map_or(String::new(), machines),
        Some(Note::Reference) => "it is the reference".into(),
        Some(Note::NoReference(name)) => format!("{name} has no times on this scene in both"),
        Some(Note::NoControl) => "no control in both".into(),
        Some(Note::Twin(name, factor)) => moved(name, *factor),
        Some(Note::FewBlocks(a, b)) => format!("too few blocks: {a} and {b}"),
    }
}

pub fn moved(name: &str, factor: f64) -> String {
    format!(
        "{name} is equal code and moved by {factor:.2}: nothing is decided; compare builds side by \
         side with contactbench run --against PROGRAM"
    )
}

/// Describes a machine by name and processor, since virtual machines may share a name.
pub fn machine(Machine { name, hardware }: &Machine) -> String {
    let name = if name.is_empty() { "an unnamed machine" } else { name };
    hardware.cpu.as_ref().map_or(name.into(), |cpu| format!("{name} ({cpu})"))
}

pub fn machines(machines: &[Machine; 2]) -> String {
    let [a, b] = machines.each_ref().map(machine);
    let same = if a == b { ", which differ in cores, caches, features or memory" } else { "" };
    format!("two machines: {a} and {b}{same}")
}

fn builds([a, b]: &[String; 2]) -> String {
    format!("A is a {a} build, B a {b} build")
}

/// Describes how times are compared, or why they are not judged.
pub fn pairing(how: &Options) -> String {
    let against = how.against.as_ref();
    let why = match (&how.builds, &how.machines, against) {
        _ if how.side_by_side.is_some() => {
            return "side by side: both took turns in each block, in fresh processes".into();
        }
        (Some(found), ..) => builds(found),
        (_, Some(found), _) if against.is_none() || !how.across => {
            format!("{}; --against DETECTOR --across-machines judges multiples", machines(found))
        }
        (.., Some(Against { detector, drift: Some(drift) })) => {
            return format!(
                "multiples of the time of {detector} in the same block. In nine cells of ten, its \
                 own times differ by less than {}: smaller changes are not reported",
                seen(*drift)
            );
        }
        (.., Some(Against { detector, .. })) => {
            format!("{detector} has no times on a scene of both")
        }
        (.., None) => "the folders were measured at different times; --against DETECTOR compares \
                       multiples of its time; contactbench run --against PROGRAM compares builds \
                       side by side"
            .into(),
    };
    format!("shown, not judged: {why}")
}

/// Describes how far the times of equal code differed while two builds took turns.
pub fn floor(experiment: &str, noise: &Noise) -> String {
    let sum = |count: fn(&Twin) -> usize| -> usize { noise.twins.iter().map(count).sum() };
    format!(
        "this build against itself in the same way: {} of {} exclude 1; nine in ten are within \
         {} ({experiment})",
        sum(|twin| twin.outside),
        plural(sum(|twin| twin.cells), "interval"),
        percent(noise.floor - 1.0)
    )
}

/// Formats `1.012 (1.003 to 1.021)`. Three decimals show the small differences of interest.
pub fn ratio(timing: &Timing) -> String {
    with_ends(&timing.ratio, |ratio| format!("{ratio:.3}"))
}

/// Returns the verdict of a cell, marked if it has a certain difference within the band.
fn verdict(timing: &Timing) -> String {
    let but = if timing.is_small() { ", not 1" } else { "" };
    format!("{}{but}", timing.judgement.name())
}

/// Makes the table of cells that became slower or faster, or of all, by verdict and falling ratio.
pub fn times(cells: &[Compared], how: &Options, all: bool) -> Table {
    let shown =
        |timing: &Timing| all || matches!(timing.judgement, Judgement::Slower | Judgement::Faster);
    let mut timed: Vec<(&Timing, &str)> = cells
        .iter()
        .filter_map(|cell| Some((cell.timing.as_ref()?, cell.place.as_str())))
        .filter(|(timing, _)| shown(timing))
        .collect();
    timed.sort_by(|(a, _), (b, _)| {
        a.judgement.cmp(&b.judgement).then(b.ratio.median.total_cmp(&a.ratio.median))
    });
    let control = how.against.as_ref().filter(|_| how.side_by_side.is_none());
    let unit = control.map_or("ns".into(), |control| format!("/ {}", control.detector));
    let shown = |ns: f64, multiple: Option<f64>| match (control, multiple) {
        (None, _) => number(ns),
        (Some(_), Some(multiple)) => format!("{multiple:.3}"),
        (Some(_), None) => format!("{} ns", number(ns)),
    };
    let cell = |timing: &Timing, place: &str| match note(timing, how) {
        // Builds are named above the table; notes on machines and twins are on lines of their own.
        note if note.is_empty()
            || how.builds.is_some()
            || matches!(timing.note, Some(Note::Machines | Note::Twin(..))) =>
        {
            place.to_string()
        }
        note => format!("{place}: {note}"),
    };
    Table::of("", timed)
        .left("", |(timing, _)| verdict(timing))
        .left("B / A", |(timing, _)| ratio(timing))
        .right(format!("A {unit}"), |(it, _)| shown(it.a_ns, it.multiples.map(|both| both[0])))
        .right(format!("B {unit}"), |(it, _)| shown(it.b_ns, it.multiples.map(|both| both[1])))
        .left("cell", |(timing, place)| cell(timing, place))
        .into()
}

/// Formats the smallest slowdown that a comparison can detect: `12%`, `47 times`.
fn seen(least: f64) -> String {
    match least < 2.0 {
        true => percent(least - 1.0),
        false => format!("{least:.0} times"),
    }
}

/// Explains why times cannot be gated; `None` if they can.
pub fn ungated(found: &Summary, how: &Options) -> Option<String> {
    match (&how.machines, &found.moved, found.least) {
        (Some(two), ..) => Some(format!("no time could be judged ({})", machines(two))),
        (_, Some((name, factor)), _) => Some(moved(name, *factor)),
        (.., None) => Some(format!(
            "no time could be judged ({}; an interval needs six blocks); leave --gate-time out",
            pairing(how)
        )),
        (.., Some((typical, _))) if !found.sees() => Some(format!(
            "this comparison can only find slowdowns above {}: give it more blocks, or use \
             contactbench run --against PROGRAM",
            seen(typical)
        )),
        _ => (!found.decides()).then(|| "every cell is undecided; give it more blocks".into()),
    }
}

pub fn pooled((name, ratio): &(String, Interval)) -> String {
    let Interval { median, low, high, coverage, count } = ratio;
    let interval = match *coverage < COVERAGE {
        true => "too few for an interval".into(),
        false => format!("95% interval {low:.3} to {high:.3}"),
    };
    format!("{name}: B / A {median:.3}, the median of {}, {interval}", plural(*count, "cell"))
}

pub fn placement() -> String {
    format!(
        "two builds of equal sources differ by up to {} (docs/COMPARE.md): smaller differences are \
         called neither slower nor faster",
        percent(PLACEMENT - 1.0)
    )
}

/// Returns two lines: one about values that must be the same, and one about times and their gate.
pub fn summary(found: &Summary, band_percent: f64, gated: bool) -> [String; 2] {
    let verdict = match found.changed {
        0 => "the same everywhere".into(),
        changed => format!("CHANGED in {}", plural(changed, "cell")),
    };
    let compared = plural(found.cells - found.absent, "cell");
    let mut counts = format!("{compared} compared, {} in one only", found.absent);
    if found.lacking > 0 {
        counts += &format!(", {} measured in part in one: see --all", found.lacking);
    }
    let count = |(verdict, count): (&Judgement, &usize)| match (verdict, found.small) {
        (Judgement::WithinBand, small @ 1..) => {
            format!("{count} {} ({small} of them not 1)", verdict.name())
        }
        _ => format!("{count} {}", verdict.name()),
    };
    let judged: Vec<String> = found.judged.iter().map(count).collect();
    let mut judged = if judged.is_empty() { "none".into() } else { judged.join(", ") };
    if let Some((typical, most)) = found.least {
        judged += &format!(
            "; only slowdowns above {} would show in a typical cell, above {} in the worst",
            seen(typical),
            seen(most),
        );
    }
    let gate = if gated { "gated" } else { "not gated" };
    [
        format!("pairs, counts, bytes, outcomes: {verdict} ({counts})"),
        format!("times ({gate}, band {band_percent} %): {judged}"),
    ]
}
