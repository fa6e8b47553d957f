//! How operations grow with N, in a line per scene and detector.

use crate::findings::operations::Operations;
use crate::present::document::Block;
use crate::present::table::{Cell, Column, Table};

/// A heading and a table; nothing where no detector has counts at enough N for an exponent.
pub fn blocks(found: &[Operations]) -> Vec<Block> {
    if found.iter().all(|found| found.choice.slope.is_none()) {
        return Vec::new();
    }
    let columns = vec![
        Column::left("scene"),
        Column::left("detector"),
        Column::right("exponent", ""),
        Column::left("law"),
        Column::right("ΔAICc to the next", ""),
    ];
    let row = |found: &Operations| {
        let choice = &found.choice;
        let exponent = choice.slope.map_or_else(Cell::absent, |slope| {
            format!("{:.3} ({:.3} to {:.3})", slope.exponent, slope.low, slope.high).into()
        });
        let law = match &choice.law {
            Ok(law) => law.name().into(),
            Err(doubt) => format!("undecided: {doubt}").into(),
        };
        let delta = choice.delta().map_or_else(Cell::absent, |delta| format!("{delta:.0}").into());
        vec![found.scene.as_str().into(), found.detector.as_str().into(), exponent, law, delta]
    };
    let title = "How all operations together grow with N (from exact counts)";
    vec![
        Block::heading(3, title),
        Block::Table(Table::new("", columns).with(found.iter().map(row))),
    ]
}
