//! Two records compared: tables for a terminal, and the words for what was found.

use crate::findings::compare::{
    Absent, Against, Change, Compared, Judgement, Lack, Note, Options, Summary, Timing,
};
use crate::findings::noise::Noise;
use crate::number::{number, percent, plural};
use crate::present::table::{Cell, Column, Table};
use crate::record::hardware::size_of;
use crate::record::machines::Machine;

/// `digest 0x01 -> 0x02`.
pub fn change(Change { what, a, b }: &Change) -> String {
    format!("{what} {a} -> {b}")
}

/// Why a cell cannot be compared.
pub fn absent(absent: &Absent) -> String {
    match absent {
        Absent::OnlyIn(side) => format!("only in {}", side.name()),
        Absent::UnavailableIn(side, reason) => {
            format!("unavailable in {}: {reason}", side.name())
        }
    }
}

/// What cannot be compared of a cell.
pub fn lack(lack: &Lack) -> String {
    match lack {
        Lack::Pass(pass, side) => {
            format!("the {} pass only in {}", pass.name(), side.name())
        }
        Lack::Value(what, side) => format!("{what} only in {}", side.name()),
        Lack::Blocks => "no times in blocks of both".into(),
    }
}

/// Why times are not judged; empty where nothing need be said.
pub fn note(timing: &Timing, options: &Options) -> String {
    match &timing.note {
        None => String::new(),
        Some(Note::Builds) => options.builds.as_ref().map_or(String::new(), builds),
        Some(Note::Machines) => options.machines.as_ref().map_or(String::new(), machines),
        Some(Note::Reference) => "it is the reference".into(),
        Some(Note::NoReference(name)) => format!("{name} has no times on this scene in both"),
        Some(Note::NoControl) => "no control in both".into(),
        Some(Note::FewBlocks(a, b)) => format!("too few blocks: {a} and {b}"),
    }
}

fn machines(machines: &[Machine; 2]) -> String {
    let [a, b] = machines.each_ref().map(|Machine { name, hardware }| {
        let name = if name.is_empty() { "an unnamed machine" } else { name };
        let cores = hardware.cores.map(|cores| plural(cores as usize, "core"));
        let caches = hardware.caches.iter().filter(|(level, _)| level.as_str() > "L1z");
        let caches = caches.map(|(level, size)| format!("{level} {}", cache(size)));
        let known: Vec<String> =
            hardware.cpu.clone().into_iter().chain(cores).chain(caches).collect();
        if known.is_empty() { name.into() } else { format!("{name} ({})", known.join(", ")) }
    });
    let same = if a == b { ", which differ in family, stepping, flags or memory" } else { "" };
    format!("two machines: {a} and {b}{same}")
}

/// `480 MiB`; a size that cannot be read as it stands there.
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

/// How times are compared, in a sentence.
pub fn pairing(how: &Options) -> String {
    if how.side_by_side.is_some() {
        return "side by side: in each block both took turns on one processor, in fresh processes"
            .into();
    }
    match (&how.against, &how.builds, &how.machines) {
        (_, Some(found), _) => format!("{}: shown, not judged", builds(found)),
        (Some(Against { detector, drift: None }), ..) => {
            format!("shown, not judged: {detector} has no times on a scene of both")
        }
        (Some(Against { detector, drift: Some(drift) }), ..) => format!(
            "each a multiple of that of {detector} in the same block. What changed {detector} \
             itself is hidden; its own times are up to {} apart between the two (nine in ten \
             cells): nothing less is told",
            percent(drift - 1.0)
        ),
        (None, _, Some(found)) => format!(
            "{}: shown, not judged; --against DETECTOR compares multiples of its time",
            machines(found)
        ),
        (None, None, None) => "shown, not judged: the folders were measured at different times, \
                               and have no control in common; --against DETECTOR compares \
                               multiples of its time; builds are compared side by side with \
                               contactbench run --against PROGRAM"
            .into(),
    }
}

/// What equal code differed by where builds took turns, in a sentence.
pub fn floor(experiment: &str, noise: &Noise) -> String {
    let (outside, cells) = noise
        .twins
        .iter()
        .fold((0, 0), |(outside, cells), twin| (outside + twin.outside, cells + twin.cells));
    format!(
        "this build against itself, the same way: {outside} of {} exclude 1; nine in ten are \
         within {} ({experiment})",
        plural(cells, "interval"),
        percent(noise.floor - 1.0)
    )
}

/// `1.012 (1.003 to 1.021)`: the differences of interest are small.
pub fn ratio(timing: &Timing) -> String {
    let ratio = &timing.ratio;
    format!("{:.3} ({:.3} to {:.3})", ratio.median, ratio.low, ratio.high)
}

/// The times of those cells that became slower or faster, or of all; the largest change first.
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
    let columns = vec![
        Column::left(""),
        Column::left("B / A"),
        Column::right("A ns", ""),
        Column::right("B ns", ""),
        Column::left("cell"),
    ];
    let row = |(timing, place): (&Timing, &str)| {
        // Of two builds the head of the table has spoken.
        let place = match note(timing, how) {
            note if note.is_empty() || how.builds.is_some() => place.to_string(),
            note => format!("{place}: {note}"),
        };
        vec![
            timing.judgement.name().into(),
            ratio(timing).into(),
            number(timing.a_ns).into(),
            number(timing.b_ns).into(),
            Cell::from(place),
        ]
    };
    Table::new("", columns).with(timed.into_iter().map(row))
}

/// What must be the same, and the times, in a line each; the times with how they are gated.
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
    let judged: Vec<String> =
        found.judged.iter().map(|(verdict, count)| format!("{count} {}", verdict.name())).collect();
    let mut judged = if judged.is_empty() { "none".into() } else { judged.join(", ") };
    if let Some((typical, most)) = found.least {
        let [typical, most] = [typical, most].map(|least| percent(least - 1.0));
        judged +=
            &format!("; a slowdown by {typical} would show (median of cells; at most {most})");
    }
    if found.least.is_some() {
        judged += &format!("; of equal code {:.1} would be slower by chance", found.by_chance);
    }
    let gate = if gated { "gated" } else { "not gated" };
    [
        format!(
            "pairs, counts, bytes, outcomes: {verdict} ({compared} compared, {} in one \
             only{lacking})",
            found.absent
        ),
        format!("times ({gate}, equal within {band_percent} %): {judged}"),
    ]
}
