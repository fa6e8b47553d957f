//! Bounds of measured numbers, for rows of a record and for replies of runners alike. An error is a
//! sentence without a full stop.

use std::collections::BTreeMap;

use contactbench_terms::must;

/// Bounds of fields that stand alone: the name, the smallest and the largest possible value.
const BOUNDS: [(&str, u64, u64); 7] = [
    ("block", 0, 10_000_000),
    ("calls", 1, 1 << 40),
    // A clock takes 10 ns itself, and no sample lasts 11 days.
    ("first_ns", 10, LONGEST_NS),
    ("time_ns", 1, LONGEST_NS),
    ("elapsed_ns", 1, LONGEST_NS),
    // The fixed loop takes 0.2 ms.
    ("pulse_ns", 10_000, LONGEST_NS),
    ("peak_bytes", 0, 1 << 50),
];
/// Longest name of a row, in bytes.
pub const LONGEST_NAME: usize = 10_000;
const LONGEST_NS: u64 = 1_000_000_000_000_000;

/// A count of operations is at most this number, and [`PER_PAIR`] for each pair of particles and
/// frame.
const OPERATIONS: u64 = 1 << 32;
const PER_PAIR: u64 = 1 << 12;

/// Checks that a field with fixed bounds is within them.
pub fn bounded(name: &str, value: Option<u64>) -> Result<(), String> {
    let bounds = BOUNDS.iter().find(|(known, ..)| *known == name);
    let Some((value, (_, least, most))) = value.zip(bounds) else { return Ok(()) };
    must!(
        (least..=most).contains(&&value),
        "it reports {name} {value}: from {least} to {most} is possible"
    );
    Ok(())
}

/// The time of a sample, in nanoseconds.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sampled {
    pub time_ns: u64,
    pub calls: u64,
    pub elapsed_ns: u64,
    pub first_ns: Option<u64>,
    pub building_ns: Option<u64>,
    /// Length of the period that contains the sample and the first detection.
    pub within_ns: u64,
}

impl Sampled {
    pub fn check(&self) -> Result<(), String> {
        let &Sampled { time_ns, calls, elapsed_ns, first_ns, building_ns, within_ns } = self;
        for (name, value) in [("calls", calls), ("time_ns", time_ns), ("elapsed_ns", elapsed_ns)] {
            bounded(name, Some(value))?;
        }
        bounded("first_ns", first_ns)?;
        let mean = u128::from(time_ns).saturating_mul(calls.into()).abs_diff(elapsed_ns.into());
        must!(
            mean <= calls.into(),
            "it reports time_ns {time_ns}, calls {calls}, elapsed_ns {elapsed_ns}: time_ns is \
             elapsed_ns / calls, rounded"
        );
        let (building, first) = (building_ns.unwrap_or(0), first_ns.unwrap_or(0));
        must!(
            building <= time_ns.saturating_add(1),
            "it reports building_ns {building} and time_ns {time_ns}, of which that is a part"
        );
        must!(
            elapsed_ns.saturating_add(first) <= within_ns,
            "it reports elapsed_ns {elapsed_ns} and first_ns {first}, but its answer was there \
             after {within_ns} ns: are these nanoseconds?"
        );
        Ok(())
    }
}

/// Checks the operation counts of a detector that found `contacts` among `n` particles, over all
/// frames. A detector that counts contact tests needs one for each contact.
pub fn counts(
    counts: &BTreeMap<String, u64>,
    contacts: u64,
    n: u64,
    frames: u64,
) -> Result<(), String> {
    let count = |name: &str| counts.get(name).copied().unwrap_or(0);
    let (tests, exact) = (count("contact_test"), count("exact_test"));
    must!(
        tests == 0 || tests >= contacts,
        "it reports contact_test {tests}, and found {contacts} contacts: each takes a test"
    );
    must!(
        exact <= tests,
        "it reports exact_test {exact} and contact_test {tests}: each exact test is one of those"
    );
    let pairs = n.saturating_mul(n).saturating_mul(frames);
    let most = pairs.saturating_mul(PER_PAIR).saturating_add(OPERATIONS);
    counts.iter().try_for_each(|(name, &count)| {
        let words = format!("at most {most} are possible for {n} particles");
        if count > most { Err(format!("it reports {name} {count}: {words}")) } else { Ok(()) }
    })
}

pub fn memory(peak_bytes: u64, live_bytes: u64) -> Result<(), String> {
    bounded("peak_bytes", Some(peak_bytes))?;
    must!(
        peak_bytes >= live_bytes,
        "it reports peak_bytes {peak_bytes} and live_bytes {live_bytes}: the most bytes held are \
         not fewer than those held at the end"
    );
    Ok(())
}
