//! What a motion is like from frame to frame, and the contacts that lie between two frames.

pub use contactbench_terms::moved::{Moved, Way};

use super::through::Through;
use crate::contact::Test;
use crate::contact::exact::label;
use crate::contact::swept::touches_within;
use crate::detect::{Options, table};
use crate::periodic::{ImagePair, Periodic};
use crate::scene::{AnyScene, Radii, Scene, Stored, array};
use crate::track::way;

/// Sums up the steps of a motion.
pub(crate) trait Steps {
    /// One more frame, and the one before it, if there is one, with their contacts.
    fn take(
        &mut self,
        last: Option<(&AnyScene<'_>, &[[u32; 2]])>,
        frame: &AnyScene<'_>,
        contacts: &[[u32; 2]],
        memory_limit: u64,
    );

    /// The same in a box. Contacts are those that last from frame to frame, by the names that they
    /// have in all.
    fn take_in_box(
        &mut self,
        last: Option<(Through<'_>, &[ImagePair])>,
        frame: &Periodic<'_>,
        contacts: &[ImagePair],
        memory_limit: u64,
    );

    /// Counts contacts, in ascending order.
    fn count<P: Ord>(&mut self, frame: &AnyScene<'_>, before: Option<&[P]>, contacts: &[P]);

    fn between<const D: usize>(
        &mut self,
        last: &Scene<'_, f64, D>,
        frame: &Scene<'_, f64, D>,
        memory_limit: u64,
    ) where
        for<'a> AnyScene<'a>: From<Scene<'a, f64, D>>;

    /// Ways from one frame to the next.
    fn go(&mut self, ways: &[f64], at_rest: usize, largest_radius: f64);

    /// Contacts between two frames, or why they were not counted.
    fn note(&mut self, tunnelled: Result<u64, String>);
}

impl Steps for Moved {
    fn take(
        &mut self,
        last: Option<(&AnyScene<'_>, &[[u32; 2]])>,
        frame: &AnyScene<'_>,
        contacts: &[[u32; 2]],
        memory_limit: u64,
    ) {
        let before = last.map(|(_, before)| before);
        self.count(frame, before, contacts);
        match (last.map(|(last, _)| last), frame) {
            (Some(AnyScene::Plane(Stored::F64(last))), AnyScene::Plane(Stored::F64(frame))) => {
                self.between(last, frame, memory_limit);
            }
            (Some(AnyScene::Space(Stored::F64(last))), AnyScene::Space(Stored::F64(frame))) => {
                self.between(last, frame, memory_limit);
            }
            // The first. Others are made in f64, all of one dimension.
            _ => {}
        }
    }

    fn take_in_box(
        &mut self,
        last: Option<(Through<'_>, &[ImagePair])>,
        frame: &Periodic<'_>,
        contacts: &[ImagePair],
        memory_limit: u64,
    ) {
        self.count(frame.scene(), last.as_ref().map(|(_, before)| *before), contacts);
        let Some((through, _)) = last else { return };
        let (ways, at_rest) = through.ways();
        self.go(&ways, at_rest, frame.scene().largest_radius());
        if at_rest < ways.len() || through.changes() {
            self.note(through.tunnelled(&ways, memory_limit));
        }
    }

    fn count<P: Ord>(&mut self, frame: &AnyScene<'_>, before: Option<&[P]>, contacts: &[P]) {
        self.frames += 1;
        self.particles = frame.len() as u64;
        self.contacts += contacts.len() as u64;
        let Some(before) = before else { return };
        let stay = common(before, contacts);
        self.born += contacts.len() as u64 - stay;
        self.ended += before.len() as u64 - stay;
    }

    fn between<const D: usize>(
        &mut self,
        last: &Scene<'_, f64, D>,
        frame: &Scene<'_, f64, D>,
        memory_limit: u64,
    ) where
        for<'a> AnyScene<'a>: From<Scene<'a, f64, D>>,
    {
        let ends = || last.centres().iter().zip(frame.centres());
        // A way is rounded up, and nowhere is no way.
        let gone = |a, b| if a == b { 0.0 } else { way(array(a), array(b)) };
        let ways: Vec<f64> = ends().map(|(a, b)| gone(a, b)).collect();
        let at_rest = ends().filter(|(a, b)| a == b).count();
        self.go(&ways, at_rest, frame.largest_radius());
        if at_rest < ways.len() {
            self.note(tunnelled(last, frame, &ways, memory_limit));
        }
    }

    fn go(&mut self, ways: &[f64], at_rest: usize, largest_radius: f64) {
        let diameter = 2.0 * largest_radius;
        let longest = ways.iter().fold(0.0f64, |most, &way| most.max(way));
        self.way.at_rest += at_rest as u64;
        if diameter > 0.0 {
            self.way.sum += ways.iter().sum::<f64>() / diameter;
            self.way.longest = self.way.longest.max(longest / diameter);
        }
    }

    fn note(&mut self, tunnelled: Result<u64, String>) {
        match tunnelled {
            Ok(tunnelled) => self.tunnelled += tunnelled,
            Err(why) => {
                self.uncounted.get_or_insert(why);
            }
        }
    }
}

/// Contacts between two frames, or why they were not counted.
fn tunnelled<const D: usize>(
    last: &Scene<'_, f64, D>,
    frame: &Scene<'_, f64, D>,
    ways: &[f64],
    memory_limit: u64,
) -> Result<u64, String>
where
    for<'a> AnyScene<'a>: From<Scene<'a, f64, D>>,
{
    // Bodies that touch between the frames were, before, no farther apart than their ways together.
    let wider = ways.iter().enumerate().map(|(k, way)| (last.radius(k) + way).next_up());
    let wider = Radii::Each(wider.collect::<Vec<_>>().into());
    let wider = Scene::new(last.centres(), wider).map_err(|error| error.to_string())?;
    let options = Options { memory_limit, threads: 1 };
    let mut detector = table::fast(options);
    let mut near = Vec::new();
    detector
        .list(&wider.into(), Test::Exact, &mut near)
        .map_err(|refusal| format!("bodies as wide as their ways: {refusal}"))?;
    let is_tunnelled = |&[i, j]: &[u32; 2]| {
        let pair = [i as usize, j as usize];
        let [ri, rj] = pair.map(|k| last.radius(k));
        let [from, to] = [last, frame].map(|scene| pair.map(|k| array(&scene.centres()[k])));
        let apart = |[a, b]: [&[f64; D]; 2]| !label(a, b, ri, rj).touches();
        apart(from) && apart(to) && touches_within([from[0], to[0]], [from[1], to[1]], ri, rj)
    };
    Ok(near.iter().filter(|pair| is_tunnelled(pair)).count() as u64)
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
    use super::*;

    /// Unit discs on a line, at these places.
    fn row(places: [f64; 4]) -> AnyScene<'static> {
        let centres = places.map(|x| nalgebra::Point::from([x, 0.0])).to_vec();
        Scene::new(centres, Radii::Uniform(1.0)).unwrap().into()
    }

    #[test]
    fn contacts_begin_end_and_lie_between_frames() {
        let frames = [row([0.0, 2.0, 5.0, 20.0]), row([0.0, 2.5, 4.5, 20.0])];
        let mut moved = Moved::default();
        moved.take(None, &frames[0], &[[0, 1]], 1 << 20);
        assert_eq!((moved.frames, moved.contacts, moved.born, moved.steps()), (1, 1, 0, 0));
        moved.take(Some((&frames[0], &[[0, 1]])), &frames[1], &[[1, 2]], 1 << 20);
        let [born, ended, tunnelled] = [moved.born, moved.ended, moved.tunnelled];
        assert_eq!([born, ended, tunnelled], [1, 1, 0]);
        assert_eq!((moved.way.at_rest, moved.steps()), (2, 1));
        assert!((moved.way.longest - 0.25).abs() < 1e-12, "of a diameter of 2");
        assert!((moved.mean_way() - 0.125).abs() < 1e-12);
        // The last flies through all others but the first, and beyond the third.
        let through = row([0.0, 2.5, 4.5, -1.5]);
        moved.take(Some((&frames[1], &[[1, 2]])), &through, &[[0, 3], [1, 2]], 1 << 20);
        assert_eq!([moved.born, moved.ended, moved.tunnelled], [2, 1, 2]);
        assert_eq!(moved.uncounted, None);
        // What cannot be counted costs nothing else.
        let far = row([0.0, 2.5, 4.5, 1.7e308]);
        moved.take(Some((&through, &[])), &far, &[], 1 << 20);
        moved.take(Some((&far, &[])), &row([0.0, 2.5, 4.5, -1.7e308]), &[], 1 << 20);
        assert!(moved.uncounted.is_some() && moved.frames == 5, "{moved:?}");
    }
}
