//! The search: each level against itself, and larger particles against finer levels.

use super::levels::Level;
use super::{FREE, HGrid, STRIP, Strip};
use contactbench_ground::detect::copies::{Judge, Nearness, PairBuffer, Record};
use contactbench_ground::detect::rows::rows_after;
use contactbench_ground::pairs::sink::Sink;
use contactbench_ground::probe::{Op, Probe};

/// Begins and ends of the records in a strip's cells and in the cells before and after the strip.
type Edges = [u32; STRIP as usize + 3];

impl<const D: usize> HGrid<D> {
    pub(super) fn search<P: Probe>(
        &self,
        judge: Judge<'_, P, impl Nearness>,
        probe: &mut P,
        sink: &mut impl Sink,
    ) {
        let mut found = PairBuffer::none();
        for (k, level) in self.levels.all().iter().enumerate() {
            for strip in level.strips.clone() {
                self.beside(level, strip, &judge, &mut found, probe, sink);
            }
            for finer in &self.levels.all()[k + 1..] {
                for a in &self.records[level.records.clone()] {
                    self.below(a, finer, &judge, &mut found, probe, sink);
                }
            }
        }
        found.flush(sink);
    }

    #[inline(always)]
    fn beside<P: Probe>(
        &self,
        level: &Level<D>,
        strip: usize,
        judge: &Judge<'_, P, impl Nearness>,
        found: &mut PairBuffer,
        probe: &mut P,
        sink: &mut impl Sink,
    ) {
        probe.count(Op::CellProbe);
        let mut rows: [Edges; 4] = [[0; STRIP as usize + 3]; 4];
        let Strip { first, starts } = &self.strips[strip];
        for (edges, step) in rows.iter_mut().zip(rows_after::<D>()) {
            let mut row = *first;
            for k in 1..D {
                row[k] = row[k].wrapping_add_signed(step[k - 1]);
            }
            *edges = self.edges(level, row, None, probe);
        }
        let own = self.edges(level, *first, Some(strip), probe);
        for cell in 0..STRIP as usize {
            let (start, end) = (starts[cell] as usize, starts[cell + 1] as usize);
            if start == end {
                continue;
            }
            let next = own[cell + 3] as usize;
            for i in start..end {
                judge.against(&self.records[i], &self.records[i + 1..next], found, probe, sink);
            }
            for edges in &rows[..rows_after::<D>().len()] {
                let others = &self.records[edges[cell] as usize..edges[cell + 3] as usize];
                if others.is_empty() {
                    continue;
                }
                for a in &self.records[start..end] {
                    judge.against(a, others, found, probe, sink);
                }
            }
        }
    }

    /// Returns where records begin and end: of the cell before a strip, of its own cells, and of
    /// the cell after it. Records of a row are in order, so a missing strip leaves no gap.
    #[inline(always)]
    fn edges(
        &self,
        level: &Level<D>,
        first: [u32; D],
        known: Option<usize>,
        probe: &mut impl Probe,
    ) -> Edges {
        const LAST: usize = STRIP as usize;
        let beside = |x: u32| {
            let mut there = first;
            there[0] = x;
            there
        };
        let is = |number: usize, first: [u32; D]| {
            level.strips.contains(&number) && self.strips[number].first == first
        };
        let mut find = |first| {
            probe.count(Op::CellProbe);
            self.find(level, first)
        };
        let middle = known.or_else(|| find(first));
        // If the middle strip exists, its neighbours are adjacent in memory or do not exist.
        let (before, after) = match middle {
            Some(middle) => {
                let before = first[0].checked_sub(STRIP).and_then(|x| {
                    Some(middle.checked_sub(1)?).filter(|&number| is(number, beside(x)))
                });
                let after = Some(middle + 1).filter(|&number| is(number, beside(first[0] + STRIP)));
                (before, after)
            }
            None => (
                first[0].checked_sub(STRIP).and_then(|x| find(beside(x))),
                find(beside(first[0] + STRIP)),
            ),
        };
        let starts = |strip: Option<usize>| strip.map(|strip| &self.strips[strip].starts);
        let (before, middle, after) = (starts(before), starts(middle), starts(after));
        let mut edges = [0; LAST + 3];
        let begin = before
            .map(|starts| starts[LAST - 1])
            .or(middle.map(|starts| starts[0]))
            .or(after.map(|starts| starts[0]));
        let Some(begin) = begin else { return edges };
        edges[0] = begin;
        edges[1] = before.map_or(begin, |starts| starts[LAST]);
        match middle {
            Some(starts) => edges[1..LAST + 2].copy_from_slice(starts),
            None => {
                let end = edges[1];
                edges[1..LAST + 2].fill(end);
            }
        }
        edges[LAST + 2] = after.map_or(edges[LAST + 1], |starts| starts[1]);
        edges
    }

    #[inline(always)]
    fn find(&self, level: &Level<D>, first: [u32; D]) -> Option<usize> {
        let slots = &self.slots[level.slots.clone()];
        let mut slot = level.slot(first);
        while slots[slot] != FREE {
            let number = slots[slot] as usize;
            if self.strips[number].first == first {
                return Some(number);
            }
            slot = (slot + 1) & (slots.len() - 1);
        }
        None
    }

    #[inline(always)]
    fn below<P: Probe>(
        &self,
        a: &Record<D>,
        level: &Level<D>,
        judge: &Judge<'_, P, impl Nearness>,
        found: &mut PairBuffer,
        probe: &mut P,
        sink: &mut impl Sink,
    ) {
        let Some(cells) = &level.cells else { return };
        let reach = judge.nearness.reach(a.radius, level.class.largest);
        let (mut first, mut last) = ([0; D], [0; D]);
        for k in 0..D {
            // Comparisons and cell numbers are monotone, so no margin is needed: a particle within
            // reach is not below the rounded x - reach, and its cell is not below the cell of this
            // number.
            let low = (a.position[k] - reach).max(level.class.low[k]);
            let high = (a.position[k] + reach).min(level.class.high[k]);
            if low > high {
                return;
            }
            first[k] = cells.index(low, k, probe);
            last[k] = cells.index(high, k, probe);
        }
        let strips = first[0] / STRIP..=last[0] / STRIP;
        let rows =
            (1..D).fold(1u64, |rows, k| rows.saturating_mul(u64::from(last[k] - first[k]) + 1));
        let looks = rows.saturating_mul(u64::from(strips.end() - strips.start()) + 1);
        if looks > level.class.particles as u64 / 2 {
            let all = &self.records[level.records.clone()];
            return judge.against(a, all, found, probe, sink);
        }
        let mut row = first;
        loop {
            for strip in strips.clone() {
                row[0] = strip * STRIP;
                probe.count(Op::LevelProbe);
                let Some(number) = self.find(level, row) else { continue };
                let starts = &self.strips[number].starts;
                let from = if strip == *strips.start() { first[0] % STRIP } else { 0 };
                let to = if strip == *strips.end() { last[0] % STRIP } else { STRIP - 1 };
                let others = starts[from as usize] as usize..starts[to as usize + 1] as usize;
                judge.against(a, &self.records[others], found, probe, sink);
            }
            // Advance to the next row: y and z count like the digits of a number.
            let Some(k) = (1..D).find(|&k| row[k] < last[k]) else { return };
            row[k] += 1;
            row[1..k].copy_from_slice(&first[1..k]);
        }
    }
}
