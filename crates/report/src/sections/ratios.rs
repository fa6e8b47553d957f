//! Who is how fast, against one detector: a sentence, the fastest of each scene, and everybody's
//! ratios.

use super::winners::undecided;
use super::{About, Section};
use crate::document::{Block, Text};
use crate::table::{Cell, Table};
use contactbench_record::cells::series::{Line, LineValues};
use contactbench_record::findings::ratios::{
    Entry, Fastest, Library, Missing, NEAR, Near, Ratios, SceneRatios,
};
use contactbench_record::record::row::Outcome;
use contactbench_record::stats::interval::Interval;
use contactbench_terms::number::{number, plural, times, with_interval};

/// The answer in a sentence: how far the fastest library is behind; without libraries, where the
/// reference is near the fastest.
pub fn headline(found: &Ratios) -> Text {
    if found.libraries.is_empty() { near_fastest(found) } else { over_libraries(found) }
}

/// By scene, against the fastest library there.
fn over_libraries(found: &Ratios) -> Text {
    let all = &found.libraries;
    let decided = |ahead: bool| -> Vec<&Library> {
        all.iter().filter(|it| it.decided() && (it.ratio.median > 1.0) == ahead).collect()
    };
    let count = |found: &[&Library]| found.iter().map(|it| it.scenes).sum::<usize>();
    let (mut ahead, behind) = (decided(true), count(&decided(false)));
    let (scenes, faster) = (all.iter().map(|it| it.scenes).sum(), count(&ahead));
    let (reference, of) = (&found.reference, plural(scenes, "scene"));
    let claim = format!("{reference} is faster than the fastest library in {faster} of {of}");
    let mut rest = " (one thread)".to_string();
    ahead.sort_by(|a, b| a.ratio.median.total_cmp(&b.ratio.median));
    if let (Some(least), Some(most)) = (ahead.first(), ahead.last()) {
        let said = |it: &Library| {
            let Library { name, title, n, .. } = it;
            (times(it.ratio.median), format!("({name}; {title}, N = {n})"))
        };
        let ((low, first), (high, last)) = (said(least), said(most));
        rest += &format!("; that library takes {low} times as long {first}");
        if ahead.len() > 1 {
            rest += &format!(" to {high} times {last}");
        }
    }
    for (count, words) in [(behind, "slower in"), (scenes - faster - behind, "undecided in")] {
        if count > 0 {
            rest += &format!("; {words} {count}");
        }
    }
    Text::new().strong(claim).plain(rest + ".")
}

/// Where the reference is near the fastest.
fn near_fastest(found: &Ratios) -> Text {
    let count = |wanted: fn(&Near) -> bool| -> usize {
        let all = found.fastest().filter(|(_, fastest)| wanted(&fastest.near));
        all.map(|(_, fastest)| fastest.scenes).sum()
    };
    let fastest = count(|near| matches!(near, Near::Fastest));
    let near = fastest + count(|near| matches!(near, Near::Within(_)));
    let (reference, scenes) = (&found.reference, plural(count(|_| true), "scene"));
    let claim = match near == fastest {
        true => format!("{reference} is the fastest in {fastest} of {scenes}"),
        false => format!(
            "{reference} is within {NEAR} times the time of the fastest detector in {near} of \
             {scenes}"
        ),
    };
    let own = if near == fastest { "" } else { &*format!("; itself the fastest in {fastest}") };
    let mut rest = format!(" (one thread{own})");
    for (count, words) in [
        (count(|near| matches!(near, Near::Beyond(_))), "slower than that in"),
        (count(|near| matches!(near, Near::Undecided(_))), "undecided in"),
        (count(|near| matches!(near, Near::Absent(_))), "without an answer in"),
    ] {
        if count > 0 {
            rest += &format!(", {words} {count}");
        }
    }
    if let Some((scene, n, worst)) = found.worst() {
        let (place, worst) = (&scene.entries.title, with_interval(&worst));
        rest += &format!("; at worst {worst} times the time of the fastest, on {place}, N = {n}");
    }
    Text::new().strong(claim).plain(rest + ".")
}

/// The section of a report, if the experiment asks for it.
pub fn section(about: &About<'_>) -> Option<Section> {
    let reference = about.experiment.ratios_to.as_deref()?;
    let found = Ratios::new(about.cells, reference);
    let none = || vec![Block::paragraph("The reference has no time in this record.")];
    Some(Section {
        heading: format!("Who is how fast, against {reference}"),
        blocks: found.as_ref().map_or_else(none, blocks),
        csv: found.map(|found| ("ratios.csv", rows(&found))),
    })
}

fn blocks(found: &Ratios) -> Vec<Block> {
    let how = Text::from(
        "Times as multiples of that of the reference (with one thread, in the same arithmetic if \
         it has one, else exact): median of the ratios within a block, and its interval. Below 1 \
         is faster than the reference. ",
    );
    let how = how
        .emphasis("wrong (0.45)")
        .plain(
            " is a wrong answer, whose time means nothing; other words say why there is no time. \
             All ratios are in ",
        )
        .code("ratios.csv")
        .plain(".");
    let mut out = vec![Block::Paragraph(headline(found))];
    if !found.libraries.is_empty() {
        out.push(Block::Table(libraries(&found.libraries, &found.reference)));
        out.push(Block::paragraph(
            "Times are of warm detections: ours reuse their buffers, and most libraries ask for \
             new memory at each call. Both cold: the ratio of first detections in a new process.",
        ));
        out.push(Block::Paragraph(near_fastest(found)));
    }
    out.extend([Block::Table(fastest(found)), Block::Paragraph(how)]);
    let scenes = found.scenes.iter().filter(|scene| !scene.entries.lines.is_empty());
    out.extend(scenes.map(|scene| {
        let entries = &scene.entries;
        let table =
            Table::of(entries.title.clone(), &entries.lines).left("detector", |it| &*it.name);
        Block::table(table.each(entries.sizes.iter().enumerate(), |table, (k, &n)| {
            let shown = |it: &LineValues<Entry>| it.values[k].as_ref().map(|entry| cell(n, entry));
            table.right(format!("N = {n}"), shown)
        }))
    }));
    if !found.missing.is_empty() {
        let line = |Missing { name, outcome, cells, reason }: &Missing| {
            let cells = plural(*cells, "cell");
            Text::from(format!("{name}: {} in {cells}: {reason}", outcome.name()))
        };
        out.push(Block::paragraph("Without an answer, or with a wrong one:"));
        out.push(Block::List(found.missing.iter().map(line).collect()));
    }
    out
}

fn libraries(found: &[Library], reference: &str) -> Table {
    let decided = |it: &Library| if it.decided() { "yes".into() } else { undecided(&it.open) };
    Table::of("", found)
        .left("scene", |it| &*it.title)
        .right("N", |it| it.n)
        .left("fastest library", |it| &*it.name)
        .right(format!("its time / {reference}"), |it| it.ratio)
        .right("both cold", |it| it.cold)
        .left("decided", decided)
        .into()
}

fn fastest(found: &Ratios) -> Table {
    let all: Vec<_> = found.fastest().collect();
    Table::of("", all)
        .left("scene", |(scene, _)| &*scene.entries.title)
        .right("N", |(_, fastest)| fastest.n)
        .left("fastest", |(_, fastest)| &*fastest.name)
        .right("ns / N", |(_, fastest)| per_particle(fastest.time_ns, fastest.n))
        .right(format!("{} / fastest", found.reference), |(_, fastest)| fastest.near.ratio())
        .left(format!("within {NEAR}?"), |(_, fastest)| verdict(fastest))
        .into()
}

fn per_particle(value: f64, n: u64) -> f64 {
    value / n.max(1) as f64
}

fn verdict(fastest: &Fastest) -> Cell {
    match &fastest.near {
        Near::Fastest => "it is the fastest".into(),
        Near::Within(_) => "yes".into(),
        Near::Beyond(_) => Cell::from("no").strong(),
        Near::Undecided(_) => undecided(&fastest.open),
        Near::Absent(outcome) => outcome.map_or("not measured", Outcome::name).into(),
    }
}

fn cell(n: u64, entry: &Entry) -> Cell {
    let per = |time: f64| format!("{} ns / N", number(per_particle(time, n)));
    match (entry.outcome, entry.ratio, entry.time_ns) {
        (Outcome::Wrong, Some(ratio), _) => format!("wrong ({})", times(ratio.median)).into(),
        (outcome, ..) if !outcome.is_good() => outcome.name().into(),
        (_, Some(_), Some(time)) if entry.is_base => format!("1 = {}", per(time)).into(),
        (Outcome::Lossy, Some(ratio), _) => format!("{} lossy", with_interval(&ratio)).into(),
        (_, Some(ratio), _) => ratio.into(),
        // It has a time, but nothing to compare it with.
        (_, None, Some(time)) => per(time).into(),
        (_, None, None) => Cell::Absent,
    }
}

/// A line of `ratios.csv`.
#[derive(Clone, Copy)]
struct Row<'a> {
    experiment: &'a str,
    scene: &'a str,
    n: u64,
    line: &'a Line,
    entry: &'a Entry,
}

/// `ratios.csv`: a line per contender, scene and N.
fn rows(found: &Ratios) -> Table {
    let mut all = Vec::new();
    for SceneRatios { experiment, entries, .. } in &found.scenes {
        let mut lines: Vec<_> = entries.lines.iter().collect();
        lines.sort_by(|a, b| a.line.cmp(&b.line));
        for LineValues { line, values, .. } in lines {
            for (&n, entry) in entries.sizes.iter().zip(values) {
                let scene = entries.title.as_str();
                all.extend(entry.iter().map(|entry| Row { experiment, scene, n, line, entry }));
            }
        }
    }
    let outcome = |it: Row<'_>| match it.entry.control && it.entry.outcome.is_good() {
        true => "control",
        false => it.entry.outcome.name(),
    };
    let ratio = |part: fn(&Interval) -> f64| move |it: Row<'_>| it.entry.ratio.as_ref().map(part);
    Table::of("", all)
        .left("experiment", |it| it.experiment)
        .left("scene", |it| it.scene)
        .left("n", |it| it.n)
        .left("detector", |it| &*it.line.detector)
        .left("arithmetic", |it| &*it.line.arithmetic)
        .left("threads", |it| u64::from(it.line.threads))
        .left("outcome", outcome)
        .left("time_ns_median", |it| it.entry.time_ns)
        .left("ratio", ratio(|it| it.median))
        .left("low", ratio(|it| it.low))
        .left("high", ratio(|it| it.high))
        .left("blocks", |it| it.entry.ratio.map(|ratio| ratio.count as u64))
        .left("reference", |_| &*found.reference)
        .left("reference_arithmetic", |it| it.entry.base.as_deref())
        .left("reason", |it| &*it.entry.reason)
        .into()
}
