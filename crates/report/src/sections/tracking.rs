use super::{About, Section};
use crate::document::Block;
use crate::table::{Cell, Table};
use contactbench_record::cells::Cell as Measured;
use contactbench_record::findings::tracking::{Scene, Tracking};

pub fn sections(about: &About<'_>) -> Vec<Section> {
    let Some(found) = Tracking::new(about.cells) else { return Vec::new() };
    let arithmetic = found.arithmetic.iter().map(|name| format!(", in {name} arithmetic"));
    let asked = format!(
        "Number of frames in which the detector ran, the first included{}.",
        arithmetic.collect::<String>()
    );
    vec![
        Section::new("How the scenes move", vec![motions(&found)]),
        Section::new("When lists were built", vec![Block::paragraph(asked), builds(&found)]),
        Section::new("What was missed", misses(&found)),
    ]
}

fn misses(found: &Tracking) -> Vec<Block> {
    let missed = missed(found);
    if missed.is_empty() {
        let none = "No tracker missed a contact, and no build was dangerous.";
        return vec![Block::paragraph(none)];
    }
    let how = Block::paragraph(
        "Missed: contacts of a frame that the tracker did not report in it, summed over the \
         frames. Share: missed contacts among all. Since: the first frame with a missed contact. \
         Never: contacts that were not reported later either. Late: the longest delay of the \
         others. Deepest: the largest overlap of a missed contact. Dangerous: builds whose rule \
         was already broken when it was first checked, as LAMMPS counts them. Of these \
         after a miss: dangerous builds after a missed contact. Builds after a miss: all of them. \
         Trackers that are not listed missed nothing and had no dangerous build.",
    );
    let whole = |name| move |(.., cell): Missed<'_>| value(cell, name) as u64;
    let table = Table::of("", missed)
        .left("scene", |(scene, ..)| &*scene.title)
        .left("tracker", |(_, tracker, _)| tracker.as_str())
        .right("missed", whole("search_missed"))
        .right("share", |(.., cell)| {
            Cell::Share(value(cell, "search_missed") / value(cell, "true_contacts").max(1.0))
        })
        .right("since", |(.., cell)| cell.variable("first_wrong", None).map(|frame| frame as u64))
        .right("never", whole("never"))
        .unit("late", "frames", |(.., cell)| {
            Some(value(cell, "latest") as u64).filter(|frames| *frames > 0)
        })
        .unit("deepest", "mean radii", |(.., cell)| {
            (value(cell, "search_missed") > 0.0).then(|| value(cell, "search_deepest_miss"))
        })
        .right("dangerous", whole("dangerous"))
        .right("of these after a miss", whole("dangerous_rightly"))
        .right("builds after a miss", whole("missing_builds"));
    vec![how, Block::table(table)]
}

/// Returns the rows of trackers that missed contacts or had a dangerous build. Dangerous builds
/// without a missed contact show how reliable this flag is.
fn missed<'a>(found: &'a Tracking<'_>) -> Vec<Missed<'a>> {
    let mut all = Vec::new();
    for scene in &found.scenes {
        for (name, done) in found.trackers.iter().zip(&scene.done) {
            all.extend(done.iter().map(|cell| (scene, name, *cell)));
        }
    }
    all.retain(|(.., cell)| value(cell, "search_missed") > 0.0 || value(cell, "dangerous") > 0.0);
    all
}

type Missed<'a> = (&'a Scene<'a>, &'a String, &'a Measured);

fn value(cell: &Measured, name: &str) -> f64 {
    cell.variable(name, None).unwrap_or(0.0)
}

fn motions(found: &Tracking) -> Block {
    let table = Table::of("", &found.scenes)
        .left("scene", |scene| &*scene.title)
        .unit("mean step", "diameters", |scene| scene.mean_way)
        .unit("longest", "diameters", |scene| scene.longest_way)
        .right("contacts in a frame", |scene| scene.contacts)
        .right("new", |scene| scene.born);
    Block::table(table)
}

fn builds(found: &Tracking) -> Block {
    let table = Table::of("", &found.scenes).left("scene", |scene| &*scene.title);
    Block::table(table.each(found.trackers.iter().enumerate(), |table, (k, name)| {
        table.right(name, |scene| scene.done[k].map(|cell| value(cell, "builds") as u64))
    }))
}
