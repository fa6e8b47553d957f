//! Detects impossible numbers in replies, which break the protocol, for `run`, `recommend` and
//! `check`.

use crate::run::runner::protocol::{Counted, Found, Memory, Reply, Sample};
use contactbench_record::record::possible::{self, Sampled};
use contactbench_terms::must;

/// Minimum number of detections of a sample that may be shorter than requested, because a detection
/// may be shorter than the clock's resolution.
pub const MOST_CALLS: u64 = 1 << 20;

#[derive(Clone, Copy, Debug)]
pub struct Asked {
    /// Requested length of the sample, in nanoseconds; 0 if the number of detections is already
    /// fixed.
    pub min_ns: u64,
    pub frames: usize,
    pub particles: u64,
    /// Nanoseconds from the request to the reply.
    pub waited_ns: u64,
    /// The runner's address space in bytes, if the system enforces it.
    pub memory_limit: Option<u64>,
}

/// Checks a reply; the error states what is impossible, as a sentence without a full stop.
pub fn check(reply: &Reply, asked: &Asked) -> Result<(), String> {
    match reply {
        Reply::Sample(of) => answers(&of.found, asked).and_then(|()| sample(of, asked)),
        Reply::Memory(of) => answers(&of.found, asked).and_then(|()| memory(of, asked)),
        Reply::Count(of) => answers(&of.found, asked).and_then(|()| count(of, asked)),
        _ => Ok(()),
    }
}

fn answers(found: &Found, asked: &Asked) -> Result<(), String> {
    let (Found { contacts, digest, steps }, frames) = (found, asked.frames);
    if steps.is_empty() && frames == 1 {
        return Ok(());
    }
    if let Some((name, len)) = steps.unlike(frames) {
        return Err(format!("{name} has {len} values, and the trajectory {frames} frames"));
    }
    let last = steps.last() == (*contacts, digest.clone());
    must!(last, "contacts and digest are not those of the last frame");
    Ok(())
}

fn count(Counted { counts, found }: &Counted, asked: &Asked) -> Result<(), String> {
    let each = found.steps.contacts.iter();
    let all = each.fold(0u64, |all, &one| all.saturating_add(one)).max(found.contacts);
    possible::counts(counts, all, asked.particles, asked.frames as u64)
}

fn sample(sample: &Sample, asked: &Asked) -> Result<(), String> {
    let &Sample { time_ns, calls, elapsed_ns, first_ns, building_ns, ref step_ns, .. } = sample;
    let (frames, &Asked { min_ns, waited_ns, .. }) = (asked.frames as u64, asked);
    let all = step_ns.iter().fold(0u64, |all, &ns| all.saturating_add(ns));
    let by_frame = match frames {
        ..=1 => step_ns.len() <= 1 && (step_ns.is_empty() || all == time_ns),
        _ => {
            step_ns.len() as u64 == frames
                && all.abs_diff(time_ns.saturating_mul(frames)) <= frames
                && calls.is_multiple_of(frames)
        }
    };
    must!(
        by_frame,
        "it reports time_ns {time_ns}, calls {calls} and {} numbers in step_ns, together {all}: \
         step_ns has one number for each of {frames} frames, and time_ns is their mean",
        step_ns.len()
    );
    let within_ns = waited_ns;
    Sampled { time_ns, calls, elapsed_ns, first_ns, building_ns, within_ns }.check()?;
    // A sample of several frames may be shorter, because each pass reads all files.
    let long = elapsed_ns >= min_ns / 10 || calls >= MOST_CALLS || frames != 1;
    must!(
        long,
        "asked for {min_ns} ns, it measured only {elapsed_ns} ns: repeat the detection until \
         min_ns are over"
    );
    Ok(())
}

fn memory(memory: &Memory, asked: &Asked) -> Result<(), String> {
    let &Memory { peak_bytes, live_bytes, formula_bytes, .. } = memory;
    possible::memory(peak_bytes, live_bytes)?;
    let most = peak_bytes.max(formula_bytes.unwrap_or(0));
    let limit = asked.memory_limit.unwrap_or(u64::MAX);
    must!(most <= limit, "it reports {most} bytes, and has {limit} bytes of address space");
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::runner::protocol::Steps;

    const ASKED: Asked = Asked {
        min_ns: 2_000_000,
        frames: 1,
        particles: 30,
        waited_ns: 1_000_000_000,
        memory_limit: Some(1 << 30),
    };

    /// Checks that a reply is refused with these words, or accepted if `words` is empty.
    fn says(reply: &Reply, asked: &Asked, words: &str) {
        match check(reply, asked) {
            Ok(()) => assert_eq!(words, "", "{reply:?}"),
            Err(why) => assert!(!words.is_empty() && why.contains(words), "{reply:?}: {why}"),
        }
    }

    fn sampled(time_ns: u64, calls: u64, elapsed_ns: u64) -> Sample {
        let (step_ns, first_ns) = (vec![time_ns], Some(1000));
        Sample { time_ns, calls, elapsed_ns, step_ns, first_ns, ..Sample::default() }
    }

    #[test]
    fn a_sample_says_what_can_be() {
        const E15: u64 = 1_000_000_000_000_000;
        for (time_ns, calls, elapsed_ns, words) in [
            (2_000_000, 1, 2_000_000, ""),
            (2, 1_000_000, 2_300_000, ""),
            // A detection without particles may take 1 ns, and is repeated as often as allowed.
            (1, MOST_CALLS, MOST_CALLS, ""),
            // The number of detections is fixed by the first sample, so later ones may be shorter.
            (400_000, 1, 400_000, ""),
            (0, 1, 0, "time_ns 0: from 1 to"),
            (0, MOST_CALLS, 1000, "time_ns 0: from 1 to"),
            (5, 0, 5, "calls 0"),
            (500, 1000, 5_000_000, "elapsed_ns / calls, rounded"),
            (5, u64::MAX, 5_000_000, "calls 18446744073709551615: from 1 to"),
            (E15, 1, E15, "are these nanoseconds?"),
            (
                E15 + 1,
                1,
                E15 + 1,
                "time_ns 1000000000000001: from 1 to 1000000000000000 is possible",
            ),
            (999_999_500, 1, 999_999_500, "and first_ns 1000, but its answer was there"),
            (10_000, 10, 100_000, "it measured only 100000 ns: repeat the detection"),
        ] {
            says(&Reply::Sample(sampled(time_ns, calls, elapsed_ns).into()), &ASKED, words);
        }
        says(&Reply::Sample(sampled(5, 1, 5).into()), &Asked { min_ns: 0, ..ASKED }, "");
        for first in [0, 1] {
            let first = Sample { first_ns: Some(first), ..sampled(2_000_000, 1, 2_000_000) };
            says(&Reply::Sample(first.into()), &ASKED, "first_ns");
        }
    }

    #[test]
    fn memory_is_what_can_be() {
        let memory = |peak_bytes, live_bytes| {
            Reply::Memory(Memory { peak_bytes, live_bytes, ..Memory::default() }.into())
        };
        for (peak, live, words) in [
            (0, 0, ""),
            (1 << 30, 1 << 30, ""),
            (5, 9, "the most bytes held are not fewer"),
            (1 << 31, 9, "2147483648 bytes, and has 1073741824 bytes"),
            (u64::MAX, 9, "peak_bytes 18446744073709551615: from 0"),
        ] {
            says(&memory(peak, live), &ASKED, words);
        }
        let unlimited = Asked { memory_limit: None, ..ASKED };
        says(&memory(1 << 31, 1 << 31), &unlimited, "");
    }

    #[test]
    fn every_frame_has_a_time_and_an_answer() {
        let asked = Asked { frames: 3, ..ASKED };
        let right = [1_000_000, 4_000_000, 1_000_001];
        // Returns a sample of two passes over three frames.
        let passes = |step_ns: &[u64], answered: usize| {
            let mut sample = sampled(2_000_000, 6, 12_000_000);
            sample.step_ns = step_ns.to_vec();
            sample.found.steps.contacts.resize(answered, 0);
            sample.found.steps.digests.resize(answered, String::new());
            sample
        };
        let mut other = passes(&right, 3);
        other.found.contacts = 7;
        for (sample, words) in [
            (passes(&right, 3), ""),
            (passes(&right, 2), "step_contacts has 2 values, and the trajectory 3 frames"),
            (passes(&right[1..], 3), "2 numbers in step_ns"),
            (passes(&[1_000_000; 3], 3), "together 3000000"),
            (sampled(2_000_000, 1, 2_000_000), "step_contacts has 0 values"),
            (other, "not those of the last frame"),
            (Sample { building_ns: Some(12_000_000), ..passes(&right, 3) }, "building_ns 12000000"),
        ] {
            says(&Reply::Sample(sample.into()), &asked, words);
        }
    }

    #[test]
    fn counts_are_what_can_be() {
        let steps =
            Steps { contacts: vec![5; 3], digests: vec![String::new(); 3], ..Steps::default() };
        let found = Found { contacts: 5, digest: String::new(), steps };
        let asked = Asked { frames: 3, ..ASKED };
        for (name, count, words) in [
            ("contact_test", 0, ""),
            ("contact_test", 15, ""),
            ("contact_test", 14, "found 15 contacts"),
            ("contact_test", u64::MAX, "for 30 particles"),
            ("exact_test", 1, "each exact test is one of those"),
            // This is 4,096 for each of 900 pairs and three frames, and 2^32.
            ("list_step", 4_306_026_496, ""),
            ("list_step", 4_306_026_497, "at most 4306026496 are possible"),
        ] {
            let counts = [(name.to_string(), count)].into();
            let counted = Counted { counts, found: found.clone() };
            says(&Reply::Count(counted.into()), &asked, words);
        }
    }
}
