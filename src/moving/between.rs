//! What a motion is like from frame to frame, and the contacts that lie between two frames.

use serde::{Deserialize, Serialize};

use super::through::Through;
use crate::contact::Test;
use crate::contact::exact::label;
use crate::contact::swept::touches_within;
use crate::detect::{Options, table};
use crate::periodic::{ImagePair, Periodic};
use crate::scene::{AnyScene, Radii, Scene, Stored, array};
use crate::track::way;

/// What happens from one frame to the next, summed up or the most of it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Moved {
    /// Particles.
    pub particles: u64,
    /// Frames.
    pub frames: u64,
    /// Contacts, summed over the frames.
    pub contacts: u64,
    /// Contacts of a frame that were not there in the frame before.
    pub born: u64,
    /// Contacts of a frame that are not there in the next.
    pub ended: u64,
    /// Pairs that touch at some time between two frames and in neither of them, if bodies go
    /// straight from one to the other: exactly, for the numbers as given, in a box with images
    /// rounded to f64.
    pub tunnelled: u64,
    /// Why they were not counted between some frames.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub uncounted: Option<String>,
    /// How far particles go in a frame.
    pub way: Way,
}

/// Ways of particles from one frame to the next, in diameters of the largest body; in a box to the
/// nearest image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Way {
    /// The longest.
    pub longest: f64,
    /// All together.
    pub sum: f64,
    /// Particles that stayed exactly where they were, summed over the frames.
    pub at_rest: u64,
}

impl Moved {
    /// Steps from one frame to the next.
    pub fn steps(&self) -> u64 {
        self.frames.saturating_sub(1)
    }

    /// The mean way of a particle in a frame, in diameters of the largest body.
    pub fn mean_way(&self) -> f64 {
        match self.steps() * self.particles {
            0 => 0.0,
            steps => self.way.sum / steps as f64,
        }
    }

    /// The share of particles that stay exactly where they are from one frame to the next.
    pub fn share_at_rest(&self) -> f64 {
        match self.steps() * self.particles {
            0 => 1.0,
            steps => self.way.at_rest as f64 / steps as f64,
        }
    }

    /// One more frame, and the one before it, if there is one, with their contacts.
    pub(crate) fn take(
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

    /// The same in a box. Contacts are those that last from frame to frame, by the names that they
    /// have in all.
    pub(crate) fn take_in_box(
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

    /// Counts contacts, in ascending order.
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

    /// Ways from one frame to the next.
    fn go(&mut self, ways: &[f64], at_rest: usize, largest_radius: f64) {
        let diameter = 2.0 * largest_radius;
        let longest = ways.iter().fold(0.0f64, |most, &way| most.max(way));
        self.way.at_rest += at_rest as u64;
        if diameter > 0.0 {
            self.way.sum += ways.iter().sum::<f64>() / diameter;
            self.way.longest = self.way.longest.max(longest / diameter);
        }
    }

    /// Contacts between two frames, or why they were not counted.
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
    let detector = table::find("streamed-nbs").ok_or("streamed-nbs is not in the table")?;
    let mut detector = detector.make(options);
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
