//! Times relative to one detector: the fastest library of each scene, and all ratios.

use super::winners::{NOT_JUDGED, undecided};
use super::{About, Section};
use crate::document::{Block, Text};
use crate::table::{Cell, Table};
use contactbench_record::cells::series::Line;
use contactbench_record::findings::ratios::{
    Entry, Library, LineRatios, Missing, Ratios, SceneRatios,
};
use contactbench_record::record::row::Outcome;
use contactbench_terms::number::{number, plural, times, with_interval};

/// Counts the scenes in which the reference is faster than the fastest library.
pub fn headline(found: &Ratios, disturbed: bool) -> Text {
    if disturbed {
        return NOT_JUDGED.into();
    }
    let count = |wanted: &dyn Fn(&Library) -> bool| -> usize {
        found.libraries.iter().filter(|it| wanted(it)).map(|it| it.scenes).sum()
    };
    let ahead = |it: &&Library| it.decided() && it.ratio.median > 1.0;
    let (faster, open) = (count(&|it| ahead(&it)), count(&|it| !it.decided()));
    let all = count(&|_| true);
    let reference = &found.reference;
    let words =
        format!("{reference} is faster than the fastest library in {faster} of {all} scenes");
    let mut rest = format!(" (on one thread; undecided {open}, slower {})", all - faster - open);
    let ratios = found.libraries.iter().filter(ahead).map(|it| it.ratio.median);
    if let (Some(least), Some(most)) = (ratios.clone().reduce(f64::min), ratios.reduce(f64::max)) {
        rest += &format!(": that library takes {} to {} times as long", times(least), times(most));
    }
    Text::default().strong(words).plain(rest + ".")
}

pub fn section(about: &About<'_>) -> Option<Section> {
    let reference = about.experiment.ratios_to.as_deref()?;
    let found = Ratios::new(about.cells, reference);
    let none = || vec![Block::paragraph("The reference has no time in this record.")];
    Some(Section {
        heading: format!("Times relative to {reference}"),
        blocks: found.as_ref().map_or_else(none, |it| blocks(it, about.winners.disturbed)),
        csv: found.map(|found| ("ratios.csv", rows(&found))),
    })
}

fn blocks(found: &Ratios, disturbed: bool) -> Vec<Block> {
    let how = Text::marked(
        "Each number is the time over that of the reference: the median of the ratios within a \
         block, and its interval. Below 1 is faster than the reference, which runs with one \
         thread, in the same arithmetic if it has it, else exactly. *wrong (0.45)* is a wrong \
         answer, whose time means nothing; other words give the reason why there is no time. All \
         ratios are in `ratios.csv`.",
    );
    let mut out = Vec::new();
    if !found.libraries.is_empty() {
        out.push(Block::Paragraph(headline(found, disturbed)));
        out.push(Block::Table(libraries(&found.libraries, &found.reference, disturbed)));
        out.push(Block::paragraph(
            "Times are of warm detections: our detectors reuse their buffers, most libraries \
             allocate memory in each call. Both cold: the ratio of the first detections in new \
             processes.",
        ));
    }
    out.push(Block::Paragraph(how));
    let scenes = found.scenes.iter().filter(|scene| !scene.lines.is_empty());
    out.extend(scenes.map(|scene| {
        let table = Table::of(scene.title.clone(), &scene.lines).left("detector", |it| &*it.name);
        Block::table(table.each(scene.sizes.iter().enumerate(), |table, (k, &n)| {
            let shown = |it: &LineRatios| it.entries[k].as_ref().map(|entry| cell(n, entry));
            table.right(format!("N = {n}"), shown)
        }))
    }));
    if !found.missing.is_empty() {
        let line = |Missing { name, outcome, cells, reason }: &Missing| {
            let cells = plural(*cells, "cell");
            Text::from(format!("{name}: {} in {cells}: {reason}", outcome.name()))
        };
        out.push(Block::paragraph("Subjects with no answer, or a wrong one:"));
        out.push(Block::List(found.missing.iter().map(line).collect()));
    }
    out
}

fn libraries(found: &[Library], reference: &str, disturbed: bool) -> Table {
    let decided = |it: &Library| match it.decided() {
        _ if disturbed => "not judged".into(),
        true => "decided".into(),
        false => undecided(&it.open),
    };
    Table::of("", found)
        .left("scene", |it| &*it.title)
        .right("N", |it| it.n)
        .left("fastest library", |it| &*it.name)
        .right(format!("its time / {reference}"), |it| it.ratio)
        .right("both cold", |it| it.cold)
        .left("verdict", decided)
        .into()
}

fn cell(n: u64, entry: &Entry) -> Cell {
    let per = |time: f64| format!("{} ns / N", number(time / n.max(1) as f64));
    match (entry.outcome, entry.ratio, entry.time_ns) {
        (Outcome::Wrong, Some(ratio), _) => format!("wrong ({})", times(ratio.median)).into(),
        (outcome, ..) if !outcome.is_good() => outcome.name().into(),
        (_, Some(_), Some(time)) if entry.is_base => format!("1 = {}", per(time)).into(),
        (Outcome::Lossy, Some(ratio), _) => format!("{} lossy", with_interval(&ratio)).into(),
        (_, Some(ratio), _) => ratio.into(),
        // This subject has a time, but no ratio.
        (_, None, Some(time)) => per(time).into(),
        (_, None, None) => Cell::Absent,
    }
}

fn rows(found: &Ratios) -> Table {
    let mut all = Vec::new();
    for scene in &found.scenes {
        let mut lines: Vec<_> = scene.lines.iter().collect();
        lines.sort_by(|a, b| a.line.cmp(&b.line));
        for LineRatios { line, entries, .. } in lines {
            let entries = scene.sizes.iter().zip(entries);
            all.extend(entries.filter_map(|(n, it)| Some((scene, line, *n, it.as_ref()?))));
        }
    }
    type Row<'a> = (&'a SceneRatios, &'a Line, u64, &'a Entry);
    let outcome = |(.., it): Row<'_>| match it.control && it.outcome.is_good() {
        true => "control",
        false => it.outcome.name(),
    };
    let end = |k: usize| move |(.., it): Row<'_>| Some(it.ratio.as_ref()?.ends()?[k]);
    Table::of("", all)
        .left("experiment", |(scene, ..)| &*scene.experiment)
        .left("scene", |(scene, ..)| &*scene.title)
        .left("n", |(_, _, n, _)| n)
        .left("detector", |(_, line, ..)| &*line.detector)
        .left("arithmetic", |(_, line, ..)| &*line.arithmetic)
        .left("threads", |(_, line, ..)| u64::from(line.threads))
        .left("outcome", outcome)
        .left("time_ns_median", |(.., it)| it.time_ns)
        .left("ratio", |(.., it)| it.ratio.map(|ratio| ratio.median))
        .left("low", end(0))
        .left("high", end(1))
        .left("blocks", |(.., it)| it.ratio.map(|ratio| ratio.count as u64))
        .left("reference", |_| &*found.reference)
        .left("reference_arithmetic", |(.., it)| it.base.as_deref())
        .left("reason", |(.., it)| &*it.reason)
        .into()
}
