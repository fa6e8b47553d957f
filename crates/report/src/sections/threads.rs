use super::{About, Section};
use crate::document::{Block, Text};
use crate::table::{Cell, Table};
use contactbench_record::cells::Cell as Measured;
use contactbench_record::findings::threads::{Gain, Threads, Typical};
use contactbench_record::stats::interval::Interval;
use contactbench_terms::number::{percent, plural, with_ends};

pub fn section(about: &About<'_>) -> Option<Section> {
    let found = Threads::new(about.cells)?;
    Some(Section {
        heading: "What threads gain".into(),
        blocks: blocks(&found),
        csv: Some(("threads.csv", rows(&found))),
    })
}

/// Returns one sentence per detector, without twins.
pub fn answer(cells: &[&Measured]) -> Vec<Block> {
    let own: Vec<&Measured> =
        cells.iter().filter(|cell| !cell.role.is_control()).copied().collect();
    let found = Threads::new(&own).map_or_else(Vec::new, |found| found.typical);
    found.iter().map(|typical| Block::Paragraph(sentence(typical))).collect()
}

fn blocks(found: &Threads) -> Vec<Block> {
    let how = Text::marked(
        "Speed-up: the time with one thread over the time with several. Ceiling: the throughput of \
         as many independent copies of the one-thread program, run at the same time, over that of \
         one copy alone. Fraction: speed-up over ceiling; it may exceed 100%, because threads \
         share cache lines and copies do not. All are paired within blocks; the numbers are in \
         `threads.csv`.",
    );
    let sentences = found.typical.iter().map(|typical| Block::Paragraph(sentence(typical)));
    let table = Block::Table(table(found));
    sentences.chain([Block::Paragraph(how), table]).collect()
}

fn sentence(typical: &Typical) -> Text {
    let Typical { name, scenes, speedup, least, most, fraction } = typical;
    let out = Text::new().strong(format!("{name}: {speedup:.2} times as fast as one thread"));
    let scenes = plural(*scenes, "scene");
    let out = out.plain(format!(" (median of {scenes}; {least:.2} to {most:.2})"));
    let gain = fraction.map(percent);
    out.plain(gain.map_or(".".into(), |gain| {
        format!(", {gain} of the throughput of as many independent copies.")
    }))
}

fn table(found: &Threads) -> Table {
    let ceiling = |gain: &Gain| match (gain.ceiling, &gain.failure) {
        (None, Some((outcome, _))) => outcome.name().into(),
        (ceiling, _) => Cell::from(ceiling),
    };
    Table::of("", &found.gains)
        .left("scene", |gain| &*gain.scene)
        .right("N", |gain| gain.n)
        .left("detector", |gain| &*gain.name)
        .right("threads", |gain| u64::from(gain.line.threads))
        .right("speed-up", |gain| gain.speedup)
        .right("ceiling", ceiling)
        .right("fraction of the ceiling", |gain| gain.fraction.as_ref().map(percents))
        .into()
}

/// Formats a fraction as `93% (91% to 96%)`.
fn percents(fraction: &Interval) -> Cell {
    with_ends(fraction, percent).into()
}

fn rows(found: &Threads) -> Table {
    Table::of("", &found.gains)
        .left("experiment", |gain| &*gain.experiment)
        .left("scene", |gain| &*gain.scene)
        .left("n", |gain| gain.n)
        .left("detector", |gain| &*gain.line.detector)
        .left("arithmetic", |gain| &*gain.line.arithmetic)
        .left("threads", |gain| u64::from(gain.line.threads))
        .ratio("speedup", |gain| gain.speedup)
        .ratio("ceiling", |gain| gain.ceiling)
        .ratio("fraction", |gain| gain.fraction)
        .left("blocks", |gain| gain.speedup.count as u64)
        .left("reason", |gain| gain.failure.as_ref().map_or("", |(_, reason)| reason))
        .into()
}
