//! What exact decisions cost, and what each arithmetic gets wrong.

use crate::findings::price::{BASE, Exactness, Price, Rates, ScenePrice};
use crate::number::{percent, plural, with_interval};
use crate::present::document::{Block, Text};
use crate::present::table::{Cell, Column, Table};

/// The price of exactness in a sentence, how to read the table, and the table.
pub fn blocks(found: &Price) -> Vec<Block> {
    let price = found.exactness.as_ref().map(|found| Block::Paragraph(sentence(found)));
    let how = Block::paragraph(
        "Errors are wrong pairs per true contact, against the scene as given (and, behind the \
         bar, against the scene as stored, where that differs); a range is one over detectors. \
         Times are ratios within a block, of each block the median over the detectors.",
    );
    price.into_iter().chain([how, Block::Table(table(found))]).collect()
}

fn sentence(found: &Exactness) -> Text {
    let Exactness { typical, scenes, least, most } = found;
    let out =
        Text::new().strong(format!("Price of exactness: {typical:.2} times the time of {BASE}"));
    let mut rest = format!(" (median of {}", plural(*scenes, "scene"));
    if *scenes > 1 {
        for (word, (place, ratio)) in [("least", least), ("most", most)] {
            rest += &format!("; {word} {} on {place}", with_interval(ratio));
        }
    }
    out.plain(rest + ").")
}

fn table(found: &Price) -> Table {
    let others = || (0..found.arithmetics.len()).filter(|&k| found.arithmetics[k] != BASE);
    let errors = found.arithmetics.iter().map(|name| format!("errors, {name}"));
    let times = others().map(|k| format!("time, {} / {BASE}", found.arithmetics[k]));
    let right = errors.chain(times).map(|head| Column::right(head, ""));
    let columns = std::iter::once(Column::left("scene")).chain(right).collect();
    let row = |scene: &ScenePrice| {
        let errors = scene.errors.iter().map(rates);
        let times = others().map(|k| scene.times[k].into());
        std::iter::once(scene.title.as_str().into()).chain(errors).chain(times).collect()
    };
    Table::new("", columns).with(found.scenes.iter().map(row))
}

/// `12% | 0.3%`: against the scene as given and, where they differ, as stored.
fn rates(found: &Rates) -> Cell {
    let words = |range: Option<(f64, f64)>| {
        range.map(|(low, high)| match (percent(low), percent(high)) {
            (low, high) if low == high => low,
            (low, high) => format!("{low} to {high}"),
        })
    };
    match (words(found.given), words(found.stored)) {
        (Some(given), Some(stored)) if given != stored => format!("{given} | {stored}").into(),
        (Some(given), _) => given.into(),
        (None, Some(stored)) => format!("– | {stored}").into(),
        (None, None) => Cell::absent(),
    }
}
