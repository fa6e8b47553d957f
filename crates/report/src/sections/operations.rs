use super::{About, Section};
use crate::document::Block;
use crate::table::Table;
use contactbench_record::findings::operations::operations;

pub fn section(about: &About<'_>) -> Option<Section> {
    let found = operations(about.cells);
    found.iter().find(|found| found.choice.slope.is_some())?;
    let table = Table::of("", &found)
        .left("scene", |found| &*found.scene)
        .left("detector", |found| &*found.detector)
        .right("exponent", |found| {
            let slope = found.choice.slope;
            slope.map(|it| format!("{:.3} ({:.3} to {:.3})", it.exponent, it.low, it.high))
        })
        .left("law", |found| match &found.choice.law {
            Ok(law) => law.name().to_string(),
            Err(doubt) => format!("undecided: {doubt}"),
        })
        .right("ΔAICc to the next", |found| found.choice.delta().map(|it| format!("{it:.0}")));
    let heading = "How the sum of all operations grows with N (exact counts)";
    Some(Section::new(heading, vec![Block::table(table)]))
}
