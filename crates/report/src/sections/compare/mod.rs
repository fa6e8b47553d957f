pub mod page;

use crate::table::Table;
use contactbench_record::findings::compare::{
    Against, Change, Compared, Judgement, Note, Options, PLACEMENT, Summary, Timing,
};
use contactbench_record::findings::trust::noise::{Noise, Twin};
use contactbench_record::record::origin::hardware::size_of;
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
    let cores = hardware.cores.map(|cores| plural(cores as usize, "core"));
    let caches = hardware.caches.iter().filter(|(level, _)| level.as_str() > "L1z");
    let caches = caches.map(|(level, size)| format!("{level} {}", cache(size)));
    let known: Vec<String> = hardware.cpu.clone().into_iter().chain(cores).chain(caches).collect();
    if known.is_empty() { name.into() } else { format!("{name} ({})", known.join(", ")) }
}

pub fn machines(machines: &[Machine; 2]) -> String {
    let [a, b] = machines.each_ref().map(machine);
    let same = if a == b { ", which differ in family, stepping, features or memory" } else { "" };
    format!("two machines: {a} and {b}{same}")
}

/// Formats a cache size as `480 MiB`; other text stays as it is.
fn cache(size: &str) -> String {
    match size_of(size) {
        Some(bytes) if bytes >= 1 << 20 => format!("{} MiB", number(bytes as f64 / 1048576.0)),
        Some(bytes) => format!("{} KiB", bytes >> 10),
        None => size.into(),
    }
}

fn builds([a, b]: &[String; 2]) -> String {
    format!("A is a {a} build, B a {b} build")
}

pub fn pairing(how: &Options) -> String {
    if how.side_by_side.is_some() {
        return "side by side: in each block both took turns on one processor, in fresh processes"
            .into();
    }
    match (&how.against, &how.builds, &how.machines) {
        (_, Some(found), _) => format!("{}: shown, not judged", builds(found)),
        (Some(_), _, Some(found)) if !how.across => format!(
            "{}: shown, not judged; --across-machines judges multiples of a control's time",
            machines(found)
        ),
        (Some(Against { detector, drift: None }), ..) => {
            format!("shown, not judged: {detector} has no times on a scene of both")
        }
        (Some(Against { detector, drift: Some(drift) }), ..) => format!(
            "multiples of the time of {detector} in the same block, which hide a change of \
             {detector} itself. In nine cells of ten, its own times differ by less than {} between \
             the two records: smaller changes are not reported",
            match *drift < 2.0 {
                true => percent(drift - 1.0),
                false => format!("a factor of {drift:.1}"),
            }
        ),
        (None, _, Some(found)) => format!(
            "{}: shown, not judged; --against DETECTOR --across-machines judges multiples of its \
             time",
            machines(found)
        ),
        (None, None, None) => "shown, not judged: the folders were measured at different times, \
                               and have no control in common; --against DETECTOR compares \
                               multiples of its time; builds are compared side by side with \
                               contactbench run --against PROGRAM"
            .into(),
    }
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
            "no time could be judged ({}; an interval needs six blocks); leave it out, or measure \
             what can be compared",
            pairing(how)
        )),
        (.., Some((typical, _))) if !found.sees() => {
            let but = match how.side_by_side {
                Some(_) => "give it more blocks, or a quieter machine",
                None => "use contactbench run --against PROGRAM",
            };
            let seen = seen(typical);
            Some(format!("this comparison can only find slowdowns above {seen}: {but}"))
        }
        _ => (!found.decides()).then(|| "every cell is undecided; give it more blocks".into()),
    }
}

pub fn pooled((name, ratio): &(String, Interval)) -> String {
    let Interval { median, low, high, coverage, count } = ratio;
    let interval = if *coverage < COVERAGE {
        "; too few cells for an interval".into()
    } else {
        format!(", 95% interval {low:.3} to {high:.3}")
    };
    format!("{name}: B / A {median:.3}, the median of {}{interval}", plural(*count, "cell"))
}

pub fn placement() -> String {
    format!(
        "two builds of equal sources differ by up to {}, since the linker places the code \
         differently (docs/COMPARE.md): smaller differences are called neither slower nor faster",
        percent(PLACEMENT - 1.0)
    )
}

/// Returns two lines: one about values that must be the same, and one about times and their gate.
pub fn summary(found: &Summary, band_percent: f64, gated: bool) -> [String; 2] {
    let verdict = match found.changed {
        0 => "the same everywhere".into(),
        changed => format!("CHANGED in {}", plural(changed, "cell")),
    };
    let lacking = match found.lacking {
        0 => String::new(),
        lacking => format!(", {lacking} measured in part in one: see --all"),
    };
    let compared = plural(found.cells - found.absent, "cell");
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
            "; only slowdowns above {} would show in a typical cell, above {} in the worst; {:.1} \
             cells of equal code are expected to be slower by chance",
            seen(typical),
            seen(most),
            found.by_chance
        );
    }
    let (gate, only) = (if gated { "gated" } else { "not gated" }, found.absent);
    [
        format!(
            "pairs, counts, bytes, outcomes: {verdict} ({compared} compared, {only} in one \
             only{lacking})"
        ),
        format!("times ({gate}, band {band_percent} %): {judged}"),
    ]
}
