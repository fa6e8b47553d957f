//! Scenes in motion: a table of motions, one of builds, and one of what was missed.

use crate::findings::courses::{Course, Courses, Done};
use crate::present::document::Block;
use crate::present::table::{Cell, Column, Table};

/// Below a heading of their own.
pub fn blocks(found: &Courses) -> Vec<Block> {
    let mut out = vec![Block::heading(3, "How the scenes move"), Block::Table(motions(found))];
    out.push(Block::heading(3, "When lists were built"));
    let arithmetic = found.arithmetic.iter().map(|name| format!(", in {name} arithmetic"));
    out.push(Block::paragraph(format!(
        "Frames in which the detector was asked, or what is mended was made anew, the first among \
         them{}.",
        arithmetic.collect::<String>()
    )));
    out.push(Block::Table(builds(found)));
    out.push(Block::heading(3, "What was missed"));
    let missed = missed(found);
    if missed.is_empty() {
        out.push(Block::paragraph("No tracker missed a contact, and no build was dangerous."));
        return out;
    }
    out.push(Block::paragraph(
        "Missed: contacts of a frame that the tracker did not report in it, summed over the \
         frames. Share: missed contacts among all. Since: the first frame with a missed contact. \
         Never: contacts that were not reported later either. Late: the longest delay of the \
         others. Deepest: the largest overlap of a missed contact. Dangerous: builds whose rule \
         was broken when it was first looked at, as LAMMPS counts them. Rightly: dangerous builds \
         after a missed contact. Of: all builds after a missed contact. Trackers that are not \
         listed missed nothing and had no dangerous build.",
    ));
    let columns = vec![
        Column::left("scene"),
        Column::left("tracker"),
        Column::right("missed", ""),
        Column::right("share", ""),
        Column::right("since", ""),
        Column::right("never", ""),
        Column::right("late", "frames"),
        Column::right("deepest", "mean radii"),
        Column::right("dangerous", ""),
        Column::right("rightly", ""),
        Column::right("of", ""),
    ];
    let row = |(course, tracker, done): &(&Course, &String, &Done)| {
        let count = |value: f64| Cell::count(value as u64);
        let reported = done.latest > 0.0;
        vec![
            course.title.as_str().into(),
            tracker.as_str().into(),
            count(done.missed),
            Cell::share(done.share),
            done.first.map_or_else(Cell::absent, count),
            count(done.never),
            if reported { count(done.latest) } else { Cell::absent() },
            if done.missed > 0.0 { Cell::number(done.deepest) } else { Cell::absent() },
            count(done.dangerous),
            count(done.rightly),
            count(done.missing),
        ]
    };
    out.push(Block::Table(Table::new("", columns).with(missed.iter().map(row))));
    out
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

fn motions(found: &Courses) -> Table {
    let columns = vec![
        Column::left("scene"),
        Column::right("mean step", "diameters"),
        Column::right("longest", "diameters"),
        Column::right("contacts in a frame", ""),
        Column::right("new", ""),
        Column::right("between frames alone", ""),
    ];
    let row = |course: &Course| {
        let motion = &course.motion;
        vec![
            course.title.as_str().into(),
            motion.mean_way.into(),
            motion.longest_way.into(),
            motion.contacts.into(),
            motion.born.into(),
            motion.tunnelled.into(),
        ]
    };
    Table::new("", columns).with(found.courses.iter().map(row))
}

fn builds(found: &Courses) -> Table {
    let named = found.trackers.iter().map(|name| Column::right(name.as_str(), ""));
    let columns = [Column::left("scene")].into_iter().chain(named).collect();
    let built = |done: &Option<Done>| {
        done.map_or_else(Cell::absent, |done| Cell::count(done.builds as u64))
    };
    let row = |course: &Course| {
        let title = Cell::from(course.title.as_str());
        [title].into_iter().chain(course.done.iter().map(built)).collect()
    };
    Table::new("", columns).with(found.courses.iter().map(row))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cells;
    use crate::cells::testing::Lab;
    use crate::present::document::markdown;
    use crate::record::row;
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
        let text = markdown(&blocks(&found));
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
