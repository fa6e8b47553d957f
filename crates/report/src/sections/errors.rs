use std::collections::BTreeMap;

use super::{About, Section};
use crate::document::{Block, Text};
use crate::table::{Cell, Table};
use contactbench_record::cells::{Cell as Measured, CellId};
use contactbench_record::findings::errors::{ErrorLine, lines};
use contactbench_record::record::row::Outcome;
use contactbench_terms::errors::{Causes, Errors};
use contactbench_terms::number::{percent, radii, times};

pub fn section(about: &About<'_>) -> Option<Section> {
    let found = lines(about.cells);
    found.first()?;
    let how = Text::marked(
        "Pairs missed / pairs added, by cause: the *representation* of the scene (its coordinates \
         rounded, then decided exactly), the *predicate* (the arithmetic's contact test on all \
         pairs of the stored scene), the *search* (which pairs the detector tested). *Together* \
         compares the answer with exact decisions on the scene as given; errors of two causes can \
         cancel. The error rate is the number of wrong pairs over that of true contacts. Depths \
         and gaps are in mean radii of the pair: a miss of 0 r is a pair that just touches.",
    );
    let blocks = vec![Block::Paragraph(how), Block::Table(table(&found))];
    Some(Section::new("Against the exact truth", blocks))
}

/// Returns one sentence on the contacts that rounding costs, and one on the time that it saves.
pub fn answer(cells: &[&Measured]) -> Option<Text> {
    let mut worst: BTreeMap<String, f64> = BTreeMap::new();
    for line in lines(cells) {
        let worst = worst.entry(line.arithmetic.clone()).or_default();
        *worst = worst.max(share(&line));
    }
    let mut worst = Vec::from_iter(worst);
    worst.first()?;
    worst.sort_by(|a, b| b.1.total_cmp(&a.1));
    let part = |(name, share): (String, f64)| format!("{name} up to {}", percent(share));
    let parts: Vec<String> = worst.into_iter().map(part).collect();
    let out = Text::default().strong("Wrong pairs per true contact:");
    let out = out.plain(format!(" {}.", parts.join(", ")));
    let by_id: BTreeMap<&CellId, &Measured> = cells.iter().map(|cell| (&cell.id, *cell)).collect();
    let exact =
        cells.iter().filter(|cell| cell.id.arithmetic == "exact" && !cell.role.is_control());
    let ratio = |cell: &&Measured| {
        let id = CellId { arithmetic: "f64".into(), ..cell.id.clone() };
        Some(cell.ratio(by_id.get(&id)?)?.median)
    };
    let mut ratios: Vec<f64> = exact.filter_map(ratio).collect();
    ratios.sort_by(f64::total_cmp);
    let (Some(low), Some(high)) = (ratios.first(), ratios.last()) else { return Some(out) };
    Some(out.plain(" ").strong("Exact decisions").plain(format!(
        " take {} to {} times as long as those in f64.",
        times(*low),
        times(*high)
    )))
}

fn share(line: &ErrorLine) -> f64 {
    line.sum.errors.wrong() as f64 / line.sum.contacts.max(1.0)
}

fn table(lines: &[ErrorLine]) -> Table {
    let cause = |cause: fn(&Causes) -> &Errors| {
        move |line: &ErrorLine| line.sum.causes.as_ref().map(|causes| counts(cause(causes)))
    };
    let depth = |there: u64, depth: f64| (there > 0).then(|| radii(depth));
    let outcome = |line: &ErrorLine| {
        let bad = line.sum.outcomes.iter().filter(|outcome| **outcome != Outcome::Ok);
        bad.map(|outcome| outcome.name()).collect::<Vec<_>>().join(", ")
    };
    Table::of("", lines)
        .left("detectors", |line| &*line.detectors)
        .left("arithmetic", |line| &*line.arithmetic)
        .left("scene", |line| &*line.scene)
        .right("true contacts", |line| line.sum.contacts)
        .right("representation", cause(|causes| &causes.representation))
        .right("predicate", cause(|causes| &causes.predicate))
        .right("search", cause(|causes| &causes.search))
        .right("together", |line| counts(&line.sum.errors))
        .right("error rate", |line| Cell::Share(share(line)))
        .right("deepest miss", |line| depth(line.sum.errors.missed, line.sum.errors.deepest_miss))
        .right("widest false", |line| depth(line.sum.errors.spurious, line.sum.errors.widest_false))
        .left("outcome", outcome)
        .into()
}

/// Formats three missed and two spurious pairs as `3 / 2`, followed by repeated pairs and
/// self-pairs if there are any; no errors are `0`.
fn counts(errors: &Errors) -> String {
    if errors.wrong() == 0 {
        return "0".into();
    }
    let mut out = format!("{} / {}", errors.missed, errors.spurious);
    for (count, noun) in [(errors.duplicate, "twice"), (errors.self_pairs, "self")] {
        if count > 0 {
            out += &format!(" / {count} {noun}");
        }
    }
    out
}
