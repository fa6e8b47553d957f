//! Two records compared: tables for a terminal, and the words for what was found.

use crate::findings::compare::{
    Absent, Change, Compared, Judgement, Lack, Note, Options, Summary, Timing,
};
use crate::number::{number, plural};
use crate::present::table::{Cell, Column, Table};
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
        Some(Note::FewBlocks(a, b)) => format!("too few blocks: {a} and {b}"),
    }
}

fn machines(machines: &[Machine; 2]) -> String {
    let [a, b] = machines.each_ref().map(|Machine { name, cpu, cores }| {
        let name = if name.is_empty() { "an unnamed machine" } else { name };
        match (cpu, cores) {
            (Some(cpu), Some(cores)) => {
                format!("{name} ({cpu}, {})", plural(*cores as usize, "core"))
            }
            (Some(cpu), None) => format!("{name} ({cpu})"),
            _ => name.to_string(),
        }
    });
    format!("two machines: {a} and {b}")
}

fn builds([a, b]: &[String; 2]) -> String {
    format!("A is a {a} build, B a {b} build")
}

/// How times are compared, in a sentence.
pub fn pairing(how: &Options) -> String {
    match (&how.against, &how.builds, &how.machines) {
        (_, Some(found), _) => format!("{}: shown, not judged", builds(found)),
        (Some(name), ..) => format!(
            "each a multiple of {name}'s in the same block; the multiples of the two folders are \
             not paired. What changed {name} itself is hidden"
        ),
        (None, _, Some(found)) => format!(
            "{}: shown, not judged; --against DETECTOR compares multiples of its time",
            machines(found)
        ),
        (None, None, None) => "not paired, because the folders were measured at different times: \
                               what else ran then is in the difference; --against DETECTOR takes \
                               most of it out"
            .into(),
    }
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
    let judged = if judged.is_empty() { "none".into() } else { judged.join(", ") };
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
