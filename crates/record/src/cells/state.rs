//! Detects samples that were taken while the machine was slow.
//!
//! A fixed loop is timed beside each sample ([`Row::pulse_ns`]). Its quiet time on a processor is
//! the first decile of these times. If the loop takes [`SLOW`] times as long, the machine was slow.
//! Such samples stay in the medians; medians of the quiet samples are reported beside them.
//!
//! The loop may be slow when samples are not. If slow samples typically take less than [`SLOWER`]
//! times as long as the quiet samples of the same cell, the speed of the machine counts as not
//! measured.

use std::collections::BTreeMap;

use crate::record::row::{Pass, Row};
use crate::stats::interval::median;

/// Multiple of the quiet time at which the machine counts as slow. On an idle machine, a loop of
/// one millisecond varies by a tenth.
pub const SLOW: f64 = 1.25;

/// Smallest ratio of slow to quiet times, in the median over the cells that have both.
pub const SLOWER: f64 = 1.05;

type Where<'a> = (Option<&'a str>, Option<u32>);

#[derive(Clone, Debug, Default)]
pub struct States<'a> {
    limits: BTreeMap<Where<'a>, f64>,
}

impl<'a> States<'a> {
    pub fn new(rows: &'a [Row]) -> States<'a> {
        let mut pulses: BTreeMap<Where<'_>, Vec<u64>> = BTreeMap::new();
        for (place, pulse) in rows.iter().filter_map(|row| Some((place(row), pulse(row)?))) {
            pulses.entry(place).or_default().push(pulse);
        }
        let limit = |mut pulses: Vec<u64>| {
            pulses.sort_unstable();
            pulses.get(pulses.len() / 10).map_or(0.0, |&quiet| SLOW * quiet as f64)
        };
        let limits = pulses.into_iter().map(|(name, all)| (name, limit(all))).collect();
        let states = States { limits };
        let ratio = states.slow_to_quiet(rows);
        if ratio.is_some_and(|ratio| ratio >= SLOWER) { states } else { States::default() }
    }

    /// Returns the ratio of slow to quiet times, in the median over the cells that have both.
    fn slow_to_quiet(&self, rows: &[Row]) -> Option<f64> {
        let mut cells: BTreeMap<_, [Vec<f64>; 2]> = BTreeMap::new();
        for row in rows {
            if let (Some(slow), Some(time)) = (self.is_slow(row), row.time_ns) {
                cells.entry(&row.id).or_default()[usize::from(slow)].push(time as f64);
            }
        }
        let ratio = |[quiet, slow]: &[Vec<f64>; 2]| Some(median(slow)? / median(quiet)?);
        median(&cells.values().filter_map(ratio).collect::<Vec<_>>())
    }

    /// Whether the machine was slow during this row; `None` if its speed was not measured.
    pub fn is_slow(&self, row: &Row) -> Option<bool> {
        Some(pulse(row)? as f64 > *self.limits.get(&place(row))?)
    }
}

fn place(row: &Row) -> Where<'_> {
    (row.id.machine.as_deref(), row.processor)
}

fn pulse(row: &Row) -> Option<u64> {
    row.pulse_ns.filter(|_| row.pass == Pass::Time)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_machine_has_its_own_quiet() {
        let row = |name: &str, pulse_ns: Option<u64>| {
            let time_ns = pulse_ns.map(|pulse| if pulse % 1000 > 250 { 105 } else { 100 });
            let mut row = Row { pass: Pass::Time, time_ns, pulse_ns, ..Row::default() };
            row.id.machine = Some(name.into());
            row.processor = Some(1);
            row
        };
        let mut rows: Vec<Row> = (0..20).map(|k| row("a", Some(1000 + k))).collect();
        rows.extend((0..20).map(|k| row("b", Some(3000 + k))));
        rows.extend([row("a", Some(1252)), row("a", Some(1253)), row("b", Some(3700))]);
        rows.push(row("a", None));
        let states = States::new(&rows);
        let slow: Vec<_> = rows[40..].iter().map(|row| states.is_slow(row)).collect();
        assert_eq!(slow, [Some(false), Some(true), Some(false), None]);
        assert!(rows[..40].iter().all(|row| states.is_slow(row) == Some(false)));
        assert_eq!(States::new(&[]).is_slow(&rows[0]), None);
        let elsewhere = Row { processor: Some(2), ..rows[0].clone() };
        assert_eq!(states.is_slow(&elsewhere), None, "another processor");
        // Slow samples of the same cell take no longer.
        rows[41].time_ns = Some(104);
        assert_eq!(States::new(&rows).is_slow(&rows[41]), None);
    }
}
