//! What a motion is like from frame to frame, and the contacts that lie between two frames.

use crate::contact::Arithmetic;
use crate::contact::exact::label;
use crate::contact::swept::touches_within;
use crate::detect::Options;
use crate::scene::{AnyScene, Radii, Scene, Stored, array};
use crate::track::parse;

/// What happens from one frame to the next, summed up or the most of it.
#[derive(Clone, Debug, Default, PartialEq)]
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
    /// straight from one to the other.
    pub tunnelled: u64,
    /// How far particles go in a frame.
    pub way: Way,
}

/// Ways of particles from one frame to the next, in diameters of the largest body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
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

    /// One more frame, and the one before it, if there is one, with their contacts.
    pub(super) fn take(
        &mut self,
        last: Option<(&AnyScene<'_>, &[[u32; 2]])>,
        frame: &AnyScene<'_>,
        contacts: &[[u32; 2]],
    ) -> anyhow::Result<()> {
        self.frames += 1;
        self.particles = frame.len() as u64;
        self.contacts += contacts.len() as u64;
        let Some((last, before)) = last else { return Ok(()) };
        let stay = common(before, contacts);
        self.born += contacts.len() as u64 - stay;
        self.ended += before.len() as u64 - stay;
        match (last, frame) {
            (AnyScene::Plane(Stored::F64(last)), AnyScene::Plane(Stored::F64(frame))) => {
                self.between(last, frame)
            }
            (AnyScene::Space(Stored::F64(last)), AnyScene::Space(Stored::F64(frame))) => {
                self.between(last, frame)
            }
            _ => Ok(()),
        }
    }

    fn between<const D: usize>(
        &mut self,
        last: &Scene<'_, f64, D>,
        frame: &Scene<'_, f64, D>,
    ) -> anyhow::Result<()>
    where
        for<'a> AnyScene<'a>: From<Scene<'a, f64, D>>,
    {
        let (a, b) = (last.centres(), frame.centres());
        let diameter = 2.0 * frame.largest_radius();
        let mut longest = 0.0f64;
        for (a, b) in a.iter().zip(b) {
            let way = (a - b).norm();
            longest = longest.max(way);
            self.way.at_rest += u64::from(a == b);
            self.way.sum += if diameter > 0.0 { way / diameter } else { 0.0 };
        }
        if diameter > 0.0 {
            self.way.longest = self.way.longest.max(longest / diameter);
        }
        if longest == 0.0 {
            return Ok(());
        }
        // Bodies that touch between the frames are at most two of the longest ways apart before:
        // by half a part in a thousand more than that, which covers all rounding.
        let wider = |r: f64| (r + longest) * 1.0005 + f64::MIN_POSITIVE;
        let radii = match last.radii() {
            Radii::Uniform(r) => Radii::Uniform(wider(*r)),
            Radii::Each(radii) => {
                Radii::Each(radii.iter().map(|&r| wider(r)).collect::<Vec<_>>().into())
            }
        };
        let wide: AnyScene<'_> = Scene::new(a, radii)?.into();
        let mut near = Vec::new();
        parse("streamed-nbs")?.make(Options::default()).step(
            &wide,
            Arithmetic::Exact.test(),
            &mut near,
        )?;
        for [i, j] in near {
            let (i, j) = (i as usize, j as usize);
            let (ri, rj) = (last.radius(i), last.radius(j));
            let [from, to] = [[&a[i], &a[j]], [&b[i], &b[j]]].map(|pair| pair.map(array));
            let apart = |[a, b]: [&[f64; D]; 2]| !label(a, b, ri, rj).touches();
            if apart(from)
                && apart(to)
                && touches_within([from[0], to[0]], [from[1], to[1]], ri, rj)
            {
                self.tunnelled += 1;
            }
        }
        Ok(())
    }
}

/// How many pairs are in both lists, which are in ascending order.
fn common(a: &[[u32; 2]], b: &[[u32; 2]]) -> u64 {
    let mut b = b.iter().peekable();
    let is_there = |pair: &&[u32; 2]| {
        while b.next_if(|other| other < pair).is_some() {}
        b.next_if_eq(pair).is_some()
    };
    a.iter().filter(is_there).count() as u64
}
