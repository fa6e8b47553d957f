//! `incremental(sweep)`: the order of the last frame, repaired by insertion sort (Baraff 1992,
//! section 3.4; Ericson 2005, section 7.5).
//!
//! * **Bound:** a repair that takes more than N log2 N swaps is given up, and all is sorted anew.
//!   So no frame costs more than about twice a new sort.
//! * **Axis:** that of the longest extent when bodies were sorted anew, kept until another is more
//!   than twice as long. The second axis is the longest of the others, in each frame.
//! * Memory: that of the detector, nothing more.

use std::time::{Duration, Instant};

use super::{Carried, sorting};
use crate::contact::Bodies;
use crate::detect::modern::copies::{Bounds, Each, Judge, Nearness, One, Record, renew};
use crate::detect::modern::sweep::{Sweep, interval};
use crate::detect::{Declare, Detector, Options, Refusal};
use crate::probe::{Op, Probe};
use crate::scene::Real;
use crate::sink::Sink;

/// A sweep that is sorted already, nearly.
pub(super) struct Sweeping<const D: usize> {
    sweep: Sweep<D>,
    /// Along which it is sorted; none if it is not.
    axis: Option<usize>,
    built: Option<Duration>,
}

impl<const D: usize> Declare for Sweeping<D> {
    const DECIDES_FROM_COPIES: bool = true;

    fn with(options: Options) -> Sweeping<D> {
        Sweeping { sweep: Sweep::with(options), axis: None, built: None }
    }

    fn formula_bytes(&self) -> u64 {
        self.sweep.formula_bytes()
    }
}

impl<const D: usize> Carried for Sweeping<D> {
    fn built(&self) -> Option<Duration> {
        self.built
    }

    fn forget(&mut self) {
        self.axis = None;
    }
}

impl<T: Real, const D: usize> Detector<T, D> for Sweeping<D> {
    fn detect<B: Bodies<T, D>, P: Probe, S: Sink>(
        &mut self,
        bodies: B,
        probe: &mut P,
        sink: &mut S,
    ) -> Result<(), Refusal> {
        let axis = self.axis.take().filter(|_| self.sweep.records.len() == bodies.len());
        match axis {
            Some(_) => renew(&mut self.sweep.records, &bodies),
            None => self.sweep.take(&bodies, "incremental(sweep)")?,
        }
        let (slack, touch) = (bodies.slack(), |i, j, probe: &mut P| bodies.touch(i, j, probe));
        match bodies.uniform() {
            Some(r) => self.run(axis, Judge::new(&touch, One::new(r, slack)), probe, sink),
            None => self.run(axis, Judge::new(&touch, Each::new(slack)), probe, sink),
        }
        Ok(())
    }
}

impl<const D: usize> Sweeping<D> {
    fn run<P: Probe>(
        &mut self,
        axis: Option<usize>,
        judge: Judge<'_, P, impl Nearness>,
        probe: &mut P,
        sink: &mut impl Sink,
    ) {
        let started = Instant::now();
        let bounds = Bounds::around(&self.sweep.records);
        let [longest, next] = bounds.longest();
        let good = axis.filter(|&axis| 2.0 * bounds.half_edge(axis) >= bounds.half_edge(longest));
        let repaired =
            good.filter(|&axis| repair(&mut self.sweep.records, axis, judge.nearness, probe));
        self.built = None;
        let first = repaired.unwrap_or_else(|| {
            self.sweep.sort(longest, judge.nearness, probe);
            self.built = Some(started.elapsed());
            longest
        });
        self.axis = Some(first);
        let second = if first == longest { next } else { longest };
        self.sweep.search(judge, [first, second], bounds, probe, sink);
    }
}

/// Sorts records that are nearly sorted; false if it takes too many swaps.
fn repair<const D: usize>(
    records: &mut [Record<D>],
    axis: usize,
    nearness: impl Nearness,
    probe: &mut impl Probe,
) -> bool {
    let low = |record: &Record<D>| interval(record, axis, nearness)[0];
    let mut left = sorting(records.len());
    for end in 1..records.len() {
        let record = records[end];
        let (key, mut place) = (low(&record), end);
        while place > 0 {
            probe.count(Op::KeyCompare);
            if low(&records[place - 1]).total_cmp(&key).is_le() {
                break;
            }
            records[place] = records[place - 1];
            place -= 1;
        }
        records[place] = record;
        let swaps = (end - place) as u64;
        probe.add(Op::Swap, swaps);
        if swaps > left {
            return false;
        }
        left -= swaps;
    }
    true
}
