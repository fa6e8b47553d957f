//! What a motion is like from frame to frame, and the contacts that lie between two frames.

pub use contactbench_terms::moved::{Moved, Way};

use super::through::Through;
use contactbench_core::periodic::{ImagePair, Periodic};

/// Adds one more frame to what is known of a motion, and the one before it, if there is one.
/// Contacts are in ascending order, by names that are the same in all frames.
pub(super) fn add(
    moved: &mut Moved,
    last: Option<(Through<'_>, &[ImagePair])>,
    frame: &Periodic<'_>,
    contacts: &[ImagePair],
    memory_limit: u64,
) {
    moved.frames += 1;
    moved.particles = frame.scene().len() as u64;
    moved.contacts += contacts.len() as u64;
    let Some((through, before)) = last else { return };
    let stay = common(before, contacts);
    moved.born += contacts.len() as u64 - stay;
    moved.ended += before.len() as u64 - stay;
    let (ways, at_rest) = through.ways();
    let diameter = 2.0 * frame.scene().largest_radius();
    let longest = ways.iter().fold(0.0f64, |most, &way| most.max(way));
    moved.way.at_rest += at_rest as u64;
    if diameter > 0.0 {
        moved.way.sum += ways.iter().sum::<f64>() / diameter;
        moved.way.longest = moved.way.longest.max(longest / diameter);
    }
    if at_rest < ways.len() || through.changes() {
        match through.tunnelled(&ways, memory_limit) {
            Ok(tunnelled) => moved.tunnelled += tunnelled,
            Err(why) => {
                moved.uncounted.get_or_insert(why);
            }
        }
    }
}

/// How many pairs are in both lists, which are in ascending order.
fn common<P: Ord>(a: &[P], b: &[P]) -> u64 {
    let mut b = b.iter().peekable();
    let is_there = |pair: &&P| {
        while b.next_if(|other| other < pair).is_some() {}
        b.next_if_eq(pair).is_some()
    };
    a.iter().filter(is_there).count() as u64
}

#[cfg(test)]
mod tests {
    use crate::moving::Course;
    use contactbench_core::scene::{AnyScene, Radii, Scene};

    /// Unit discs on a line, at these places.
    fn row(places: [f64; 4]) -> AnyScene<'static> {
        let centres = places.map(|x| nalgebra::Point::from([x, 0.0])).to_vec();
        Scene::new(centres, Radii::Uniform(1.0)).unwrap().into()
    }

    #[test]
    fn contacts_begin_end_and_lie_between_frames() {
        let mut course = Course::default();
        let mut take = |places, pairs: &[[u32; 2]]| {
            course.open(row(places), pairs, 1 << 20);
            course.moved.clone()
        };
        let moved = take([0.0, 2.0, 5.0, 20.0], &[[0, 1]]);
        assert_eq!((moved.frames, moved.contacts, moved.born, moved.steps()), (1, 1, 0, 0));
        let moved = take([0.0, 2.5, 4.5, 20.0], &[[1, 2]]);
        let [born, ended, tunnelled] = [moved.born, moved.ended, moved.tunnelled];
        assert_eq!([born, ended, tunnelled], [1, 1, 0]);
        assert_eq!((moved.way.at_rest, moved.steps()), (2, 1));
        assert!((moved.way.longest - 0.25).abs() < 1e-12, "of a diameter of 2");
        assert!((moved.mean_way() - 0.125).abs() < 1e-12);
        // The last flies through all others but the first, and beyond the third.
        let moved = take([0.0, 2.5, 4.5, -1.5], &[[0, 3], [1, 2]]);
        assert_eq!([moved.born, moved.ended, moved.tunnelled], [2, 1, 2]);
        assert_eq!(moved.uncounted, None);
        // What cannot be counted costs nothing else.
        take([0.0, 2.5, 4.5, 1.7e308], &[]);
        let moved = take([0.0, 2.5, 4.5, -1.7e308], &[]);
        assert!(moved.uncounted.is_some() && moved.frames == 5, "{moved:?}");
    }
}
