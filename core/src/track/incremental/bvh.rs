//! `incremental(bvh)`: the tree of an earlier frame, its boxes wider than the bodies by a margin
//! and made again where bodies have left them.
//!
//! Boxes are around leaves of at most 16 bodies; that of a leaf is made again when a body of it is
//! no longer inside, and with it those above. The order of the bodies stays, so the tree becomes
//! worse while they mix. It is built anew, in the order of new keys,
//!
//! * before a search, if the edges of the leaves' boxes, added up, are more than twice those after
//!   building: bodies have jumped;
//! * after searches that took, all together, N log2 N more tests of bodies, nodes and bounds than
//!   they would have, had each been as cheap as the first. Where each search takes dq more than the
//!   one before, k searches take dq k²/2 more: this is the optimal number of refits k = -1 + √(1 +
//!   2(t_rebuild - t_refit)/dq) of arXiv 2601.15633, without the assumption, and in counts.
//!
//! Memory: that of the detector, nothing more.

use std::time::{Duration, Instant};

use super::{Carried, Meter, sorting};
use crate::contact::Bodies;
use crate::detect::modern::bvh::Bvh;
use crate::detect::modern::copies::{Each, Judge, Nearness, One, renew};
use crate::detect::{Declare, Detector, Options, Refusal};
use crate::filter::Near;
use crate::probe::Probe;
use crate::scene::Real;
use crate::sink::Sink;

/// A hierarchy of boxes that is there already.
pub(super) struct Refitted<const D: usize> {
    bvh: Bvh<D>,
    /// Bodies are this many times as large for the boxes around them.
    factor: f64,
    /// None if the tree is to be built anew.
    quality: Option<Quality>,
    built: Option<Duration>,
}

/// How good a tree is.
#[derive(Clone, Copy)]
struct Quality {
    /// Of the leaves' boxes after building.
    edges: f64,
    /// What the search took then.
    first: u64,
    /// What all searches since have taken beyond that.
    more: u64,
}

impl<const D: usize> Refitted<D> {
    /// Boxes reach `margin` diameters beyond a body.
    pub fn new(options: Options, margin: f64) -> Refitted<D> {
        // Never infinite: points have boxes without extent.
        let factor = (1.0 + 2.0 * margin).min(f64::MAX);
        Refitted { bvh: Bvh::with(options), factor, quality: None, built: None }
    }

    /// Builds the tree if it must be, and searches.
    fn run<T: Real, P: Probe>(
        &mut self,
        bodies: &impl Bodies<T, D>,
        nearness: impl Nearness,
        probe: &mut P,
        sink: &mut impl Sink,
    ) -> Result<(), Refusal> {
        let roomy = Roomy { of: nearness, factor: self.factor };
        let n = bodies.len();
        let same = self.bvh.tree.records.len() == n;
        let mut quality = self.quality.take().filter(|it| same && it.more <= sorting(n));
        if let Some(Quality { edges, .. }) = quality {
            renew(&mut self.bvh.tree.records, bodies);
            self.bvh.tree.refit(nearness, roomy, probe);
            quality = quality.filter(|_| self.bvh.tree.edges() <= 2.0 * edges);
        }
        self.built = None;
        if quality.is_none() {
            let started = Instant::now();
            self.bvh.order(bodies, "incremental(bvh)", probe)?;
            self.bvh.tree.enclose(roomy);
            self.built = Some(started.elapsed());
        }
        let mut meter = Meter::new(probe);
        let touch = |i, j, probe: &mut Meter<'_, P>| bodies.touch(i, j, probe);
        self.bvh.tree.walk(Judge::new(&touch, nearness), &mut meter, sink);
        let took = meter.tests + meter.visits;
        self.quality = Some(match quality {
            Some(it) => Quality { more: it.more + took.saturating_sub(it.first), ..it },
            None => Quality { edges: self.bvh.tree.edges(), first: took, more: 0 },
        });
        Ok(())
    }
}

impl<const D: usize> Declare for Refitted<D> {
    const DECIDES_FROM_COPIES: bool = true;

    fn with(options: Options) -> Refitted<D> {
        Refitted::new(options, 0.0)
    }

    fn formula_bytes(&self) -> u64 {
        self.bvh.formula_bytes()
    }
}

impl<const D: usize> Carried for Refitted<D> {
    fn built(&self) -> Option<Duration> {
        self.built
    }

    fn forget(&mut self) {
        self.quality = None;
    }
}

impl<T: Real, const D: usize> Detector<T, D> for Refitted<D> {
    fn detect<B: Bodies<T, D>, P: Probe, S: Sink>(
        &mut self,
        bodies: B,
        probe: &mut P,
        sink: &mut S,
    ) -> Result<(), Refusal> {
        let slack = bodies.slack();
        match bodies.uniform() {
            Some(r) => self.run(&bodies, One::new(r, slack), probe, sink),
            None => self.run(&bodies, Each::new(slack), probe, sink),
        }
    }
}

/// Boxes of bodies that are larger than they are.
#[derive(Clone, Copy)]
struct Roomy<N> {
    of: N,
    factor: f64,
}

impl<N: Nearness> Nearness for Roomy<N> {
    fn near(&self, a: f32, b: f32) -> Near {
        self.of.near(a, b)
    }

    /// At least the body's own, since the factor is at least 1 and rounding is monotone.
    fn half(&self, radius: f32) -> f64 {
        self.of.half(radius) * self.factor
    }

    fn reach(&self, radius: f32, largest: f64) -> f64 {
        self.of.reach(radius, largest)
    }
}
