//! Who is how fast, against one detector: a sentence, the fastest of each scene, and everybody's
//! ratios.

use super::by_size::{self, per_particle};
use super::winners::undecided;
use crate::findings::ratios::{Entry, Fastest, Library, Missing, NEAR, Near, Ratios, SceneRatios};
use crate::number::{number, plural, times, with_interval};
use crate::present::document::{Block, Text};
use crate::present::table::{Cell, Column, Table};
use crate::record::row::Outcome;

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
    let (ahead, behind) = (decided(true), decided(false));
    let scenes = all.iter().map(|it| it.scenes).sum();
    let reference = &found.reference;
    let claim = format!(
        "{reference} is faster than the fastest library in {} of {}",
        count(&ahead),
        plural(scenes, "scene")
    );
    let mut rest = " (one thread)".to_string();
    let by_median = |a: &&&Library, b: &&&Library| a.ratio.median.total_cmp(&b.ratio.median);
    let least = ahead.iter().min_by(by_median);
    if let (Some(least), Some(most)) = (least, ahead.iter().max_by(by_median)) {
        let at = |it: &Library| format!("({}; {}, N = {})", it.name, it.title, it.n);
        let [low, high] = [least, most].map(|it| times(it.ratio.median));
        rest += &format!("; that library takes {low} times as long {}", at(least));
        if ahead.len() > 1 {
            rest += &format!(" to {high} times {}", at(most));
        }
    }
    let open = scenes - count(&ahead) - count(&behind);
    for (count, words) in [(count(&behind), "slower in"), (open, "undecided in")] {
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
    let scenes = plural(count(|_| true), "scene");
    let reference = &found.reference;
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
        let place = &scene.entries.title;
        let worst = with_interval(&worst);
        rest += &format!("; at worst {worst} times the time of the fastest, on {place}, N = {n}");
    }
    Text::new().strong(claim).plain(rest + ".")
}

/// The section of a report.
pub fn blocks(found: &Ratios) -> Vec<Block> {
    let how = Text::from(
        "Times as multiples of that of the reference (with one thread, in the same arithmetic if \
         it has one, else exact): median of the ratios within a block, and its interval. Below 1 \
         is faster than the reference. ",
    );
    let libraries = Block::Table(libraries(&found.libraries, &found.reference));
    let libraries = (!found.libraries.is_empty()).then_some(libraries);
    let how = how
        .emphasis("wrong (0.45)")
        .plain(
            " is a wrong answer, whose time means nothing; other words say why there is no time. \
             All ratios are in ",
        )
        .link("ratios.csv", "ratios.csv")
        .plain(".");
    let mut out = vec![Block::Paragraph(headline(found))];
    out.extend(libraries);
    if !found.libraries.is_empty() {
        out.push(Block::paragraph(
            "Times are of warm detections: ours reuse their buffers, and most libraries ask for \
             new memory at each call. Both cold: the ratio of first detections in a new process.",
        ));
        out.push(Block::Paragraph(near_fastest(found)));
    }
    out.extend([Block::Table(fastest(found)), Block::Paragraph(how)]);
    let scenes = found.scenes.iter().filter(|scene| !scene.entries.lines.is_empty());
    out.extend(scenes.map(|scene| Block::Table(by_size::table(&scene.entries, Vec::new(), cell))));
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
    let columns = vec![
        Column::left("scene"),
        Column::right("N", ""),
        Column::left("fastest library"),
        Column::right(format!("its time / {reference}"), ""),
        Column::right("both cold", ""),
        Column::left("decided"),
    ];
    let row = |it: &Library| {
        vec![
            it.title.as_str().into(),
            Cell::count(it.n),
            it.name.as_str().into(),
            Cell::ratio(&it.ratio),
            it.cold.into(),
            if it.decided() { "yes".into() } else { undecided(&it.open) },
        ]
    };
    Table::new("", columns).with(found.iter().map(row))
}

fn fastest(found: &Ratios) -> Table {
    let columns = vec![
        Column::left("scene"),
        Column::right("N", ""),
        Column::left("fastest"),
        Column::right("ns / N", ""),
        Column::right(format!("{} / fastest", found.reference), ""),
        Column::left(format!("within {NEAR}?")),
    ];
    let row = |(scene, fastest): (&SceneRatios, &Fastest)| {
        vec![
            scene.entries.title.as_str().into(),
            Cell::count(fastest.n),
            fastest.name.as_str().into(),
            Cell::number(per_particle(fastest.time_ns, fastest.n)),
            fastest.near.ratio().into(),
            verdict(fastest),
        ]
    };
    Table::new("", columns).with(found.fastest().map(row))
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
        (_, Some(ratio), _) => Cell::ratio(&ratio),
        // It has a time, but nothing to compare it with.
        (_, None, Some(time)) => per(time).into(),
        (_, None, None) => Cell::absent(),
    }
}

/// `ratios.csv`: a line per contender, scene and N.
pub fn rows(found: &Ratios) -> Table {
    let columns = [
        "experiment",
        "scene",
        "n",
        "detector",
        "arithmetic",
        "threads",
        "outcome",
        "time_ns_median",
        "ratio",
        "low",
        "high",
        "blocks",
        "reference",
        "reference_arithmetic",
        "reason",
    ];
    let mut table = Table::new("", columns.map(Column::left).into());
    for SceneRatios { experiment, entries, .. } in &found.scenes {
        let mut lines: Vec<_> = entries.lines.iter().collect();
        lines.sort_by(|a, b| a.line.cmp(&b.line));
        for (line, (n, entry)) in lines.into_iter().flat_map(|contender| {
            let values = entries.sizes.iter().zip(&contender.values);
            values.filter_map(|(n, value)| Some((&contender.line, (*n, value.as_ref()?))))
        }) {
            let good = entry.control && entry.outcome.is_good();
            let ratio = |end: fn(&crate::stats::interval::Interval) -> f64| {
                Cell::from(entry.ratio.as_ref().map(end))
            };
            table.rows.push(vec![
                experiment.as_str().into(),
                entries.title.as_str().into(),
                Cell::count(n),
                line.detector.as_str().into(),
                line.arithmetic.as_str().into(),
                Cell::count(line.threads.into()),
                if good { "control".into() } else { entry.outcome.name().into() },
                entry.time_ns.into(),
                ratio(|ratio| ratio.median),
                ratio(|ratio| ratio.low),
                ratio(|ratio| ratio.high),
                entry.ratio.map_or_else(Cell::absent, |ratio| Cell::count(ratio.count as u64)),
                found.reference.as_str().into(),
                entry.base.as_deref().map_or_else(Cell::absent, Cell::from),
                entry.reason.as_str().into(),
            ]);
        }
    }
    table
}
