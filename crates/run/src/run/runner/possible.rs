//! Detects impossible numbers in replies, which break the protocol, for `run`, `recommend` and
//! `check`.

use crate::run::runner::protocol::{Counted, Found, Memory, Reply, Sample, Steps};
use contactbench_ground::probe::Op;
use contactbench_terms::must;

/// Minimum number of detections of a sample that may be shorter than requested, because a detection
/// may be shorter than the clock's resolution.
pub const MOST_CALLS: u64 = 1 << 20;

/// Maximum number of pairs that any machine can test per nanosecond.
const MOST_LISTED_PER_NS: u64 = 1000;

#[derive(Clone, Copy, Debug)]
pub struct Asked {
    /// Requested length of the sample, in nanoseconds; 0 if the number of detections is already
    /// fixed.
    pub min_ns: u64,
    pub frames: usize,
    /// Nanoseconds from the request to the reply.
    pub waited_ns: u64,
    /// The runner's address space in bytes, if the system enforces it.
    pub memory_limit: Option<u64>,
    /// Number of ordered pairs of particles in open space; `None` in a box, where images are pairs,
    /// too.
    pub most_listed: Option<u64>,
}

/// Checks a reply; the error states what is impossible, as a sentence without a full stop.
pub fn check(reply: &Reply, asked: &Asked) -> Result<(), String> {
    match reply {
        Reply::Sample(of) => answers(&of.found, asked).and_then(|()| sample(of, asked)),
        Reply::Memory(of) => answers(&of.found, asked).and_then(|()| memory(of, asked)),
        Reply::Count(of) => answers(&of.found, asked).and_then(|()| count(of)),
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
    for (k, &contacts) in steps.contacts.iter().enumerate() {
        let built = steps.built.get(k) == Some(&true);
        let begun = k > 0 || contacts == 0 || built || steps.built.is_empty();
        must!(begun, "it reports step_built false in frame 0: each pass begins with a reset");
        let dangerous = steps.dangerous.get(k) == Some(&true);
        must!(built || !dangerous, "it reports step_dangerous true in frame {k}, without a build");
        let Some(&listed) = steps.listed.get(k) else { continue };
        let said = format!("it reports step_listed {listed} in frame {k}");
        must!(listed >= contacts, "{said}, and found {contacts} contacts there");
        let most = asked.most_listed.unwrap_or(u64::MAX);
        must!(
            listed <= most,
            "{said}, and its particles have {most} pairs, counted from both sides"
        );
        let (waited, ns) = (asked.waited_ns, listed.div_ceil(MOST_LISTED_PER_NS));
        must!(ns <= waited, "{said}, within {waited} ns");
    }
    Ok(())
}

/// Checks that there are as many contact tests, if counted, as contacts in all frames, or more.
fn count(Counted { counts, found }: &Counted) -> Result<(), String> {
    let tests = counts.get(Op::ContactTest.name()).copied().unwrap_or(0);
    let each = found.steps.contacts.iter();
    let all = each.fold(0u64, |all, &one| all.saturating_add(one)).max(found.contacts);
    let enough = tests == 0 || tests >= all;
    must!(enough, "it reports contact_test {tests}, and found {all} contacts: each takes a test");
    Ok(())
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
    must!(calls > 0, "it reports calls 0: a sample has at least one detection");
    let mean = u128::from(time_ns).saturating_mul(calls.into()).abs_diff(elapsed_ns.into());
    let said = format!("it reports time_ns {time_ns}, calls {calls}, elapsed_ns {elapsed_ns}");
    must!(mean <= calls.into(), "{said}: time_ns is elapsed_ns / calls, rounded");
    must!(time_ns > 0 && elapsed_ns > 0, "{said}: every detection takes time; repeat it");
    let (building, first) = (building_ns.unwrap_or(0), first_ns.unwrap_or(0));
    let part = building <= time_ns.saturating_add(1);
    must!(part, "it reports building_ns {building} and time_ns {time_ns}, of which that is a part");
    must!(first_ns != Some(0), "it reports first_ns 0: leave it out if the clock is too coarse");
    must!(
        elapsed_ns.saturating_add(first) <= waited_ns,
        "it reports elapsed_ns {elapsed_ns} and first_ns {first}, but its answer was there after \
         {waited_ns} ns: are these nanoseconds?"
    );
    // A sample of several frames may be shorter, because each pass reads all files.
    let long = elapsed_ns >= min_ns / 10 || calls >= MOST_CALLS || frames != 1;
    must!(
        long,
        "asked for {min_ns} ns, it measured only {elapsed_ns} ns: repeat the detection until \
         min_ns are over"
    );
    Ok(())
}

/// Returns whether some frame used an earlier list, or a list with pairs that do not touch.
fn keeps_a_list(steps: &Steps) -> bool {
    let longer = steps.listed.iter().zip(&steps.contacts).any(|(listed, found)| listed > found);
    longer || steps.built.contains(&false)
}

fn memory(memory: &Memory, asked: &Asked) -> Result<(), String> {
    let &Memory { peak_bytes, live_bytes, allocations, warm_allocations, formula_bytes, .. } =
        memory;
    let some = [peak_bytes, live_bytes, allocations] != [0; 3];
    must!(
        some || !keeps_a_list(&memory.found.steps),
        "it reports no bytes and no allocations, and keeps a list, and a list takes memory; answer \
         unsupported where it cannot be measured"
    );
    must!(
        peak_bytes >= live_bytes,
        "it reports peak_bytes {peak_bytes} and live_bytes {live_bytes}: the most bytes held are \
         not fewer than those held at the end"
    );
    let limit = asked.memory_limit.unwrap_or(u64::MAX);
    for (name, bytes) in [("peak_bytes", peak_bytes), ("formula_bytes", formula_bytes.unwrap_or(0))]
    {
        let fits = bytes <= limit;
        must!(fits, "it reports {name} {bytes}, and has {limit} bytes of address space");
    }
    // No allocator can make more than one allocation per nanosecond.
    let (pieces, waited) = (allocations.max(warm_allocations.unwrap_or(0)), asked.waited_ns);
    must!(pieces <= waited, "it reports {pieces} allocations within {waited} ns");
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const ASKED: Asked = Asked {
        min_ns: 2_000_000,
        frames: 1,
        waited_ns: 1_000_000_000,
        memory_limit: Some(1 << 30),
        most_listed: Some(100 * 100),
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
            (0, 1, 0, "every detection takes time"),
            (0, MOST_CALLS, 1000, "every detection takes time"),
            (5, 0, 5, "calls 0"),
            (500, 1000, 5_000_000, "elapsed_ns / calls, rounded"),
            (u64::MAX, u64::MAX, 5_000_000, "elapsed_ns / calls, rounded"),
            (E15, 1, E15, "are these nanoseconds?"),
            (999_999_500, 1, 999_999_500, "and first_ns 1000, but its answer was there"),
            (10_000, 10, 100_000, "it measured only 100000 ns: repeat the detection"),
        ] {
            says(&Reply::Sample(sampled(time_ns, calls, elapsed_ns).into()), &ASKED, words);
        }
        says(&Reply::Sample(sampled(5, 1, 5).into()), &Asked { min_ns: 0, ..ASKED }, "");
        let first = Sample { first_ns: Some(0), ..sampled(2_000_000, 1, 2_000_000) };
        says(&Reply::Sample(first.into()), &ASKED, "first_ns 0");
    }

    #[test]
    fn memory_is_what_can_be() {
        let memory = |peak_bytes, live_bytes, allocations| {
            let memory = Memory { peak_bytes, live_bytes, allocations, ..Memory::default() };
            Reply::Memory(memory.into())
        };
        for (peak, live, allocations, words) in [
            (0, 0, 0, ""),
            (1 << 30, 1 << 30, 1, ""),
            (5, 9, 1, "the most bytes held are not fewer"),
            (u64::MAX, 9, 1, "peak_bytes 18446744073709551615, and has 1073741824 bytes"),
            (9, 9, u64::MAX, "18446744073709551615 allocations within"),
        ] {
            says(&memory(peak, live, allocations), &ASKED, words);
        }
        let unlimited = Asked { memory_limit: None, ..ASKED };
        says(&memory(1 << 31, 1 << 31, 1), &unlimited, "");
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

    /// Returns steps of three frames with 5 contacts each.
    fn tracked(listed: &[u64], built: &[bool], dangerous: &[bool]) -> Found {
        let steps = Steps {
            contacts: vec![5; 3],
            digests: vec![String::new(); 3],
            listed: listed.to_vec(),
            built: built.to_vec(),
            dangerous: dangerous.to_vec(),
        };
        Found { contacts: 5, digest: String::new(), steps }
    }

    #[test]
    fn trackers_say_what_can_be() {
        let asked = Asked { frames: 3, ..ASKED };
        let boxed = Asked { most_listed: None, ..asked };
        let once = [true, false, false];
        let fair = || tracked(&[9; 3], &once, &[]);
        let alone = Found { steps: Steps::default(), ..fair() };
        for (tests, found, asked, words) in [
            (0, tracked(&[5, 9, 9], &once, &[false; 3]), asked, ""),
            (0, tracked(&[5; 3], &[true; 3], &[false, true, false]), asked, ""),
            (0, tracked(&[], &[], &[]), asked, ""),
            (0, tracked(&[0; 3], &once, &[]), asked, "step_listed 0 in frame 0, and found 5"),
            (0, tracked(&[9, 4, 9], &[true; 3], &[]), asked, "step_listed 4 in frame 1"),
            (0, tracked(&[9, 9, 1 << 63], &once, &[]), asked, "particles have 10000 pairs"),
            (0, tracked(&[9, 9, 1 << 62], &once, &[]), boxed, "within 1000000000 ns"),
            (0, tracked(&[9; 3], &[false; 3], &[]), asked, "step_built false in frame 0"),
            (0, tracked(&[9; 3], &once, &[false, true, false]), asked, "step_dangerous true"),
            (0, tracked(&[9; 3], &[], &[false, true, false]), asked, "step_dangerous true"),
            (15, fair(), asked, ""),
            (1, fair(), asked, "found 15 contacts"),
            (14, fair(), asked, "found 15 contacts"),
            (4, alone, ASKED, "contact_test 4, and found 5"),
        ] {
            let counts = [("contact_test".to_string(), tests)].into();
            says(&Reply::Count(Counted { counts, found }.into()), &asked, words);
        }
        for (bytes, found, words) in [
            (0, fair(), "a list takes memory"),
            (8, fair(), ""),
            (0, tracked(&[5; 3], &[true; 3], &[]), ""),
        ] {
            let memory =
                Memory { peak_bytes: bytes, live_bytes: bytes, found, ..Memory::default() };
            says(&Reply::Memory(memory.into()), &asked, words);
        }
    }
}
