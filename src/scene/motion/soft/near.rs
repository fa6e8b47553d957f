//! A list of the couples that may soon touch.

use anyhow::Context;
use nalgebra::Point;

use super::body::Body;
use crate::contact::Test;
use crate::detect::Refusal;
use crate::detect::any::AnyDetector;
use crate::scene::{AnyScene, Radii, Scene};
use crate::sink::normalise;

/// Couples up to so far apart are listed, in sizes of the smallest body.
const SKIN: f64 = 0.3;
/// The list is built again when a body has gone this part of the skin: under a half, so that no
/// rounding of a way matters.
const PART: f64 = 0.49;

/// Two bodies.
#[derive(Clone, Copy)]
pub(super) struct Couple {
    pub pair: [u32; 2],
    /// They push each other where they are nearer.
    pub reach: f64,
}

/// The couples within the skin where the list was built, in ascending order: the same whoever finds
/// them.
pub(super) struct Near<const D: usize> {
    detector: Box<dyn AnyDetector>,
    skin: f64,
    pairs: Vec<[u32; 2]>,
    couples: Vec<Couple>,
    /// Those that overlap in frame 0, and reach as far as they are apart there.
    pub first: Vec<Couple>,
    /// Where bodies were when the list was built.
    then: Vec<[f64; D]>,
}

impl<const D: usize> Near<D>
where
    for<'a> AnyScene<'a>: From<Scene<'a, f64, D>>,
{
    pub fn new(detector: Box<dyn AnyDetector>, smallest: f64) -> Near<D> {
        Near {
            detector,
            skin: SKIN * smallest,
            pairs: Vec::new(),
            couples: Vec::new(),
            first: Vec::new(),
            then: Vec::new(),
        }
    }

    /// These are the bodies of frame 0.
    ///
    /// # Errors
    /// What the detector refuses.
    pub fn begin(&mut self, bodies: &[Body<D>]) -> anyhow::Result<()> {
        self.first.clear();
        self.build(bodies)?;
        for couple in &mut self.couples {
            let [a, b] = couple.pair.map(|k| &bodies[k as usize].at);
            let distance = square(a, b).sqrt();
            if distance < couple.reach {
                couple.reach = distance;
                self.first.push(*couple);
            }
        }
        Ok(())
    }

    /// All couples that push each other, and others.
    ///
    /// # Errors
    /// What the detector refuses.
    pub fn couples(&mut self, bodies: &[Body<D>]) -> anyhow::Result<&[Couple]> {
        let ways = bodies.iter().zip(&self.then).map(|(body, then)| square(&body.at, then));
        let most = PART * self.skin;
        if ways.fold(0.0, f64::max) > most * most {
            self.build(bodies)?;
        }
        Ok(&self.couples)
    }

    fn build(&mut self, bodies: &[Body<D>]) -> anyhow::Result<()> {
        let mut centres = room(bodies.len())?;
        centres.extend(bodies.iter().map(|body| Point::from(body.at)));
        let wider = |body: &Body<D>| body.radius + 0.5 * self.skin;
        let radii = match bodies.iter().all(|body| body.radius == bodies[0].radius) {
            true => Radii::Uniform(wider(&bodies[0])),
            false => {
                let mut radii = room(bodies.len())?;
                radii.extend(bodies.iter().map(wider));
                Radii::Each(radii.into())
            }
        };
        self.pairs.clear();
        let scene = Scene::new(centres, radii)?.into();
        self.detector.list(&scene, Test::Exact, &mut self.pairs).context(
            "the motion is simulated within the memory that the machine has free, whatever \
             --memory-limit says",
        )?;
        normalise(&mut self.pairs);
        let mut first = self.first.iter().peekable();
        self.couples.clear();
        if self.couples.capacity() < self.pairs.len() {
            self.couples = room(self.pairs.len())?;
        }
        self.couples.extend(self.pairs.iter().map(|&pair| {
            while first.next_if(|couple| couple.pair < pair).is_some() {}
            let [a, b] = pair.map(|k| bodies[k as usize].radius);
            first
                .next_if(|couple| couple.pair == pair)
                .copied()
                .unwrap_or(Couple { pair, reach: a + b })
        }));
        self.then.clear();
        self.then.extend(bodies.iter().map(|body| body.at));
        Ok(())
    }
}

/// An empty list with room for so many.
pub(super) fn room<T>(count: usize) -> Result<Vec<T>, Refusal> {
    let (mut list, bytes) = (Vec::new(), (count as u64).saturating_mul(size_of::<T>() as u64));
    list.try_reserve_exact(count).map_err(|_| Refusal::Exhausted { bytes })?;
    Ok(list)
}

fn square<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    let mut sum = 0.0;
    for k in 0..D {
        sum += (a[k] - b[k]) * (a[k] - b[k]);
    }
    sum
}
