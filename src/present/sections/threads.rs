//! What threads gain: a sentence per detector, and a line per scene and N.

use crate::findings::threads::{Gain, Threads, Typical};
use crate::number::{percent, plural};
use crate::present::document::{Block, Text};
use crate::present::table::{Cell, Column, Table};
use crate::stats::interval::Interval;

/// The section of a report.
pub fn blocks(found: &Threads) -> Vec<Block> {
    let how = Text::from(
        "Speed-up: the time with one thread over that with several. Ceiling: the throughput of as \
         many copies with one thread each, at work at the same time, over that of one alone. \
         Fraction: the throughput with several threads over \
         that of the copies; over 100% is possible, since copies share no cache lines and threads \
         do. All are paired within blocks; the numbers are in ",
    );
    let how = how.link("threads.csv", "threads.csv").plain(".");
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
        format!(", {gain} of what the machine lets as many copies gain.")
    }))
}

fn table(found: &Threads) -> Table {
    let columns = vec![
        Column::left("scene"),
        Column::right("N", ""),
        Column::left("detector"),
        Column::right("threads", ""),
        Column::right("speed-up", ""),
        Column::right("ceiling", ""),
        Column::right("fraction of the ceiling", ""),
    ];
    let row = |gain: &Gain| {
        vec![
            gain.scene.as_str().into(),
            Cell::count(gain.n),
            gain.name.as_str().into(),
            Cell::count(gain.line.threads.into()),
            Cell::ratio(&gain.speedup),
            match (&gain.ceiling, &gain.failure) {
                (None, Some((outcome, _))) => outcome.name().into(),
                (ceiling, _) => (*ceiling).into(),
            },
            gain.fraction.map_or_else(Cell::absent, |fraction| percents(&fraction)),
        ]
    };
    Table::new("", columns).with(found.gains.iter().map(row))
}

/// `93% (91% to 96%)`.
pub(super) fn percents(fraction: &Interval) -> Cell {
    let [median, low, high] = [fraction.median, fraction.low, fraction.high].map(percent);
    format!("{median} ({low} to {high})").into()
}

/// `threads.csv`: a line per detector, number of threads, scene and N.
pub fn rows(found: &Threads) -> Table {
    let left = ["experiment", "scene", "n", "detector", "arithmetic", "threads"].map(Column::left);
    let ratios = ["speedup", "ceiling", "fraction"].map(Column::ratio);
    let right = ["blocks", "reason"].map(Column::left);
    let columns = left.into_iter().chain(ratios).chain(right).collect();
    let row = |gain: &Gain| {
        vec![
            gain.experiment.as_str().into(),
            gain.scene.as_str().into(),
            Cell::count(gain.n),
            gain.line.detector.as_str().into(),
            gain.line.arithmetic.as_str().into(),
            Cell::count(gain.line.threads.into()),
            Cell::ratio(&gain.speedup),
            gain.ceiling.into(),
            gain.fraction.into(),
            Cell::count(gain.speedup.count as u64),
            gain.failure.as_ref().map_or("", |(_, reason)| reason).into(),
        ]
    };
    Table::new("", columns).with(found.gains.iter().map(row))
}
