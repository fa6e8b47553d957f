//! Scenes in motion: a table of motions, one of builds, and one of what was missed.

use super::{About, Section};
use crate::document::Block;
use crate::table::{Cell, Table};
use contactbench_record::findings::courses::{Course, Courses, Done};

/// The sections of a report, if scenes move: motions, builds, and what was missed.
pub fn sections(about: &About<'_>) -> Vec<Section> {
    let Some(found) = Courses::new(about.cells) else { return Vec::new() };
    let arithmetic = found.arithmetic.iter().map(|name| format!(", in {name} arithmetic"));
    let asked = format!(
        "Frames in which the detector was asked, the first among them{}.",
        arithmetic.collect::<String>()
    );
    vec![
        Section::new("How the scenes move", vec![motions(&found)]),
        Section::new("When lists were built", vec![Block::paragraph(asked), builds(&found)]),
        Section::new("What was missed", misses(&found)),
    ]
}

fn misses(found: &Courses) -> Vec<Block> {
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
         was broken when it was first looked at, as LAMMPS counts them. Rightly: dangerous builds \
         after a missed contact. Of: all builds after a missed contact. Trackers that are not \
         listed missed nothing and had no dangerous build.",
    );
    let table = Table::of("", missed)
        .left("scene", |(course, ..)| &*course.title)
        .left("tracker", |(_, tracker, _)| tracker.as_str())
        .right("missed", |(.., done)| done.missed as u64)
        .right("share", |(.., done)| Cell::share(done.share))
        .right("since", |(.., done)| done.first.map(|frame| frame as u64))
        .right("never", |(.., done)| done.never as u64)
        .unit("late", "frames", |(.., done)| (done.latest > 0.0).then_some(done.latest as u64))
        .unit("deepest", "mean radii", |(.., done)| (done.missed > 0.0).then_some(done.deepest))
        .right("dangerous", |(.., done)| done.dangerous as u64)
        .right("rightly", |(.., done)| done.rightly as u64)
        .right("of", |(.., done)| done.missing as u64);
    vec![how, Block::table(table)]
}

/// The rows of trackers that missed contacts, or whose builds were called dangerous: the flag is
/// judged by the builds that came without a miss as well.
fn missed(found: &Courses) -> Vec<(&Course, &String, &Done)> {
    let mut all = Vec::new();
    for course in &found.courses {
        for (name, done) in found.trackers.iter().zip(&course.done) {
            all.extend(done.iter().map(|done| (course, name, done)));
        }
    }
    all.retain(|(.., done)| done.missed > 0.0 || done.dangerous > 0.0);
    all
}

fn motions(found: &Courses) -> Block {
    let table = Table::of("", &found.courses)
        .left("scene", |course| &*course.title)
        .unit("mean step", "diameters", |course| course.motion.mean_way)
        .unit("longest", "diameters", |course| course.motion.longest_way)
        .right("contacts in a frame", |course| course.motion.contacts)
        .right("new", |course| course.motion.born)
        .right("between frames alone", |course| course.motion.tunnelled);
    Block::table(table)
}

fn builds(found: &Courses) -> Block {
    let table = Table::of("", &found.courses).left("scene", |course| &*course.title);
    Block::table(table.each(found.trackers.iter().enumerate(), |table, (k, name)| {
        table.right(name, |course| course.done[k].map(|done| done.builds as u64))
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::markdown;
    use contactbench_record::cells;
    use contactbench_record::cells::testing::Lab;
    use contactbench_record::record::row;
    use contactbench_terms::moved::Moved;

    #[test]
    fn misses_stand_beside_builds() {
        let mut lab = Lab::new("e", "packed");
        lab.n(1000).param("motion", "drift").param("frames", 11);
        let moved =
            Moved { frames: 11, particles: 1000, contacts: 2200, born: 50, ..Moved::default() };
        for (tracker, builds, missed, dangerous) in [
            ("every-step(nbs)", 11, 0, 0),
            ("verlet(nbs,rule=every-5,skin=0.1)", 3, 22, 0),
            ("verlet(nbs,rule=lammps-10-1-yes,skin=0.1)", 4, 0, 3),
        ] {
            let course = row::Course {
                builds,
                never: 1,
                latest: if missed > 0 { 2 } else { 0 },
                dangerous,
                ..Default::default()
            };
            lab.detector(tracker).count(&[("contact_test", 6000)]).edit(|row| {
                row.moved = Some(moved.clone());
                row.course = Some(course);
                let errors = contactbench_terms::errors::Errors {
                    missed,
                    deepest_miss: 0.25,
                    ..Default::default()
                };
                row.causes = Some(contactbench_terms::errors::Causes {
                    search: errors,
                    ..Default::default()
                });
            });
        }
        let cells = cells::cells(&lab.rows());
        let found = Courses::new(&cells.iter().collect::<Vec<_>>()).unwrap();
        let tables = [vec![motions(&found), builds(&found)], misses(&found)].concat();
        let text = markdown(&tables);
        for line in [
            "| packed, 2D, N = 1000 | 0 | 0 | 200 | 5 | 0 |",
            "| scene | every step | every-5, 0.1 | lammps-10-1-yes, 0.1 |",
            "| packed, 2D, N = 1000 | 11 | 3 | 4 |",
            "| packed, 2D, N = 1000 | every-5, 0.1 | 22 | 1.0% | – | 1 | 2 | 0.2500 | 0 | 0 | 0 |",
            // A dangerous build without a miss is shown, or the flag looks better than it is.
            "| packed, 2D, N = 1000 | lammps-10-1-yes, 0.1 | 0 | 0% | – | 1 | – | – | 3 | 0 | 0 |",
        ] {
            assert!(text.contains(line), "{line} is not in {text}");
        }
        assert_eq!(Courses::new(&[]), None);
    }
}
