use super::{About, Section};
use crate::document::Block;
use crate::table::{Cell, Table};
use contactbench_record::findings::scenes::{SceneResults, SubjectResult, Versus, scenes};
use contactbench_record::record::row::Outcome;

pub fn sections(about: &About<'_>) -> Vec<Section> {
    let section = |scene: SceneResults| Section::new(&scene.title, vec![table(&scene)]);
    scenes(about.cells).into_iter().map(section).collect()
}

fn table(scene: &SceneResults) -> Block {
    let quiet = scene.results.iter().any(|found| found.quiet.is_some());
    let time = |found: &SubjectResult| {
        let time = Cell::from(found.time);
        if found.outcome == Outcome::Wrong && found.time.is_some() { time.wrong() } else { time }
    };
    let versus = |found: &SubjectResult| match found.versus {
        Versus::Fastest => Cell::Count(1),
        Versus::Slower(ratio) => ratio.into(),
        Versus::Unknown => Cell::Absent,
    };
    let table = Table::of("", &scene.results)
        .left("detector", |found| &*found.name)
        .unit("time / N", "ns", time)
        .unit("time / pair", "ns", |found| found.time_per_pair)
        .when(quiet, |table| table.unit("quiet / N", "ns", |found| found.quiet))
        .unit("first call / N", "ns", |found| found.first)
        .right("blocks", |found| found.blocks as u64)
        .right("time / fastest", versus)
        .right("contact tests / N", |found| found.contact_tests)
        .right("list operations / N", |found| found.list_operations)
        .unit("peak memory / N", "bytes", |found| found.peak_bytes)
        .unit("peak memory / pair", "bytes", |found| found.bytes_per_pair)
        .unit("by formula / N", "bytes", |found| found.formula_bytes)
        .left("outcome", |found| found.outcome.name());
    Block::table(table)
}
