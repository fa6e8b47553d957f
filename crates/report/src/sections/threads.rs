use std::collections::BTreeMap;

use super::{About, Section};
use crate::document::{Block, Text};
use crate::table::{Cell, Table};
use contactbench_record::cells::Cell as Measured;
use contactbench_record::cells::series::{Line, labels};
use contactbench_record::findings::threads::{Gain, gains};
use contactbench_record::stats::interval::{median, spread};
use contactbench_terms::number::{percent, plural, with_ends};

pub fn section(about: &About<'_>) -> Option<Section> {
    let gains = gains(about.cells);
    gains.first()?;
    let how = Text::marked(
        "Speed-up: the time with one thread over the time with several. Ceiling: the throughput of \
         as many independent copies of the one-thread program, run at the same time, over that of \
         one copy alone. Fraction: speed-up over ceiling; it may exceed 100%, because threads \
         share cache lines and copies do not. All are paired within blocks; the numbers are in \
         `threads.csv`.",
    );
    let mut blocks = sentences(about.cells, &gains);
    blocks.extend([Block::Paragraph(how), Block::Table(table(&gains))]);
    let csv = Some(("threads.csv", rows(&gains)));
    Some(Section { heading: "What threads gain".into(), blocks, csv })
}

/// Returns one sentence per detector, without twins.
pub fn answer(cells: &[&Measured]) -> Vec<Block> {
    let own: Vec<&Measured> =
        cells.iter().filter(|cell| !cell.role.is_control()).copied().collect();
    sentences(&own, &gains(&own))
}

fn sentences(cells: &[&Measured], gains: &[Gain]) -> Vec<Block> {
    let label = labels(cells);
    let mut lines: BTreeMap<&Line, Vec<&Gain>> = BTreeMap::new();
    gains.iter().for_each(|gain| lines.entry(&gain.line).or_default().push(gain));
    let sentence = |(line, gains): (&Line, Vec<&Gain>)| sentence(&label(line), &gains);
    lines.into_iter().filter_map(sentence).map(Block::Paragraph).collect()
}

fn sentence(name: &str, gains: &[&Gain]) -> Option<Text> {
    let speedups: Vec<f64> = gains.iter().map(|gain| gain.speedup.median).collect();
    let fractions: Vec<f64> = gains.iter().filter_map(|gain| Some(gain.fraction?.median)).collect();
    let ([least, speedup, most], scenes) = (spread(&speedups)?, plural(gains.len(), "scene"));
    let out = Text::default().strong(format!("{name}: {speedup:.2} times as fast as one thread"));
    let out = out.plain(format!(" (median of {scenes}; {least:.2} to {most:.2})"));
    Some(out.plain(median(&fractions).map_or(".".into(), |fraction| {
        let gain = percent(fraction);
        format!(", {gain} of the throughput of as many independent copies.")
    })))
}

fn table(gains: &[Gain]) -> Table {
    let ceiling = |gain: &Gain| match (gain.ceiling, &gain.failure) {
        (None, Some((outcome, _))) => outcome.name().into(),
        (ceiling, _) => Cell::from(ceiling),
    };
    Table::of("", gains)
        .left("scene", |gain| &*gain.scene)
        .right("N", |gain| gain.n)
        .left("detector", |gain| &*gain.name)
        .right("threads", |gain| u64::from(gain.line.threads))
        .right("speed-up", |gain| gain.speedup)
        .right("ceiling", ceiling)
        .right("fraction of the ceiling", |gain| gain.fraction.map(|it| with_ends(&it, percent)))
        .into()
}

fn rows(gains: &[Gain]) -> Table {
    Table::of("", gains)
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
