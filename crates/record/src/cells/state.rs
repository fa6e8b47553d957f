//! Detects samples that were taken while the machine was slow.
//!
//! A fixed loop is timed beside each sample ([`Row::pulse_ns`]). Its quiet time on a processor is
//! the first decile of these times. If the loop takes [`SLOW`] times as long, the machine was slow.
//! Such samples stay in the medians; medians of the quiet samples are reported beside them.

use std::collections::BTreeMap;

use crate::record::row::{Pass, Row};

/// Multiple of the quiet time at which the machine counts as slow. On an idle machine, a loop of
/// one millisecond varies by a tenth.
pub const SLOW: f64 = 1.25;

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
        States { limits: pulses.into_iter().map(|(name, all)| (name, limit(all))).collect() }
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
        let row = |name: &str, pulse_ns| {
            let mut row = Row { pass: Pass::Time, pulse_ns, ..Row::default() };
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
    }
}
