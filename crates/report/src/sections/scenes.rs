use super::{About, Section};
use crate::document::Block;
use crate::table::{Cell, Table};
use contactbench_record::cells::Cell as Measured;
use contactbench_record::findings::scenes::{SceneResults, scenes};

const LISTS: [&str; 3] = ["list_push", "list_step", "list_reset"];

pub fn sections(about: &About<'_>) -> Vec<Section> {
    let section = |scene: SceneResults<'_>| Section::new(&scene.title, vec![table(&scene)]);
    scenes(about.cells).into_iter().map(section).collect()
}

fn table(&SceneResults { n, fastest, ref cells, .. }: &SceneResults<'_>) -> Block {
    let quiet = cells.iter().any(|(_, cell)| cell.quiet_time().is_some());
    let per = |cell: &Measured, name| cell.variable(name, None).map(|value| value / n);
    let per_step = |cell: &Measured, name| per(cell, name).map(|value| value / cell.frames());
    let per_pair = |cell: &Measured, name| cell.per_pair(cell.variable(name, None)?);
    let time = |cell: &Measured| match cell.wrong_time() {
        Some(time) => Cell::Number(time / n).wrong(),
        None => cell.time().map(|time| time.median / n).into(),
    };
    let versus = |cell: &Measured| match fastest.filter(|_| cell.time().is_some()) {
        Some(fastest) if fastest.id == cell.id => Cell::Count(1),
        fastest => fastest.and_then(|fastest| cell.ratio(fastest)).into(),
    };
    let table = Table::of("", cells)
        .left("detector", |(name, _)| &**name)
        .unit("time / N", "ns", |(_, cell)| time(cell))
        .unit("time / pair", "ns", |(_, cell)| per_pair(cell, "time_ns"))
        .when(quiet, |table| {
            table.unit("quiet / N", "ns", |(_, cell)| cell.quiet_time().map(|time| time / n))
        })
        .unit("first call / N", "ns", |(_, cell)| per(cell, "first_ns"))
        .right("blocks", |(_, cell)| cell.times.len() as u64)
        .right("time / fastest", |(_, cell)| versus(cell))
        .right("contact tests / N", |(_, cell)| per_step(cell, "contact_test"))
        .right("list operations / N", |(_, cell)| {
            LISTS.into_iter().map(|name| per_step(cell, name)).sum::<Option<f64>>()
        })
        .unit("peak memory / N", "bytes", |(_, cell)| per(cell, "peak_bytes"))
        .unit("peak memory / pair", "bytes", |(_, cell)| per_pair(cell, "peak_bytes"))
        .unit("by formula / N", "bytes", |(_, cell)| per(cell, "formula_bytes"))
        .left("outcome", |(_, cell)| cell.overall().0.name());
    Block::table(table)
}
