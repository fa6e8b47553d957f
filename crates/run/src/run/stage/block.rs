//! A block: one timed sample of each subject, each in a new process.
//!
//! Builds of one detector are timed in turns: this build, the other one, and this one again as a
//! twin. In each block, all three are started on the same processor and alternate, round after
//! round. So changes of the machine's speed affect them alike. The ratio of a block is the median
//! over its rounds. Several blocks average over the positions of processes in memory.

use std::sync::OnceLock;
use std::time::{Duration, Instant, SystemTime};

use crate::run::machine::pulse::pulse;
use crate::run::runner::client::{Client, Failure};
use crate::run::runner::protocol::Sample;
use crate::run::stage::Stage;
use crate::run::stage::bench::{Bench, sample};
use crate::run::stage::passes::{Running, SHORTEST_SAMPLE_NS};
use contactbench_record::record::row::{Outcome, Pass, Row};

const TURN_NS: u64 = 500_000;
/// Maximum number of rounds in a block; `LONGEST` ends it earlier, after each subject had each
/// place.
const MOST_ROUNDS: usize = 30;
const LONGEST: Duration = Duration::from_millis(200);

/// Groups subjects that are timed in turns; each other subject is a group of its own.
pub(super) fn entries(running: Vec<Running>) -> Vec<Vec<Running>> {
    let mut entries: Vec<Vec<Running>> = Vec::new();
    for one in running {
        let number = one.subject.duet;
        match entries.iter_mut().find(|entry| number.is_some() && entry[0].subject.duet == number) {
            Some(entry) => entry.push(one),
            None => entries.push(vec![one]),
        }
    }
    entries
}

struct TimedSubject {
    running: Running,
    client: Client,
    row: Row,
    turns: Vec<Sample>,
}

impl Stage<'_, '_> {
    /// Times one block of a group of subjects; returns the subjects that did not fail. `warm` is
    /// the last block for which the processor was warmed up.
    pub fn block(
        &mut self,
        entry: Vec<Running>,
        block: u32,
        warm: &mut u32,
        bench: &mut Bench<'_>,
    ) -> anyhow::Result<Vec<Running>> {
        let blank = |one: &Running| Row { pass: Pass::Time, block, ..one.blank.clone() };
        // If a killed run left the block incomplete, it is measured again.
        if entry.iter().all(|one| self.index.has(&blank(one))) {
            return Ok(entry);
        }
        if let Some(first) = entry.first().filter(|_| *warm != block) {
            *warm = block;
            warm_up(first, block, bench);
        }
        let mut subjects = Vec::new();
        for running in entry {
            let (mut row, processor) = (blank(&running), running.processor(block));
            if running.is_alone() {
                // The pulse would disturb the caches, so it is measured before the process starts.
                row.pulse_ns = pulse(processor);
            }
            match running.fresh(bench, processor) {
                Ok(client) => {
                    subjects.push(TimedSubject { running, client, row, turns: Vec::new() })
                }
                Err(failure) => self.fail(&blank(&running), failure, Pass::Time.rest())?,
            }
        }
        let started = Instant::now();
        let rounds = if subjects.iter().any(|it| it.running.is_alone()) { 1 } else { MOST_ROUNDS };
        for round in 0..rounds {
            let all = subjects.len().max(1);
            if round > 0 && round % all == 0 && started.elapsed() > LONGEST {
                break;
            }
            let order = order(round + all * block as usize, subjects.len());
            for (subject, failure) in take_turns(&mut subjects, &order, block) {
                self.fail(&blank(&subject.running), failure, Pass::Time.rest())?;
            }
        }
        subjects
            .into_iter()
            .filter_map(|timed| self.written(timed, block, bench).transpose())
            .collect()
    }

    /// Writes the row of a timed subject; returns the subject if it has times.
    fn written(
        &mut self,
        timed: TimedSubject,
        block: u32,
        bench: &mut Bench<'_>,
    ) -> anyhow::Result<Option<Running>> {
        let TimedSubject { running, mut client, mut row, turns } = timed;
        let Some(sum) = total(&turns) else { return Ok(None) };
        running.fill(&mut row, &sum, running.processor(block));
        // If the scene has a history, this is not the process's first detection.
        row.first_ns = row.first_ns.filter(|_| bench.loads.len() == 1);
        row.process = self.log.origins.process(&running.subject, &client)?;
        if !running.is_alone() {
            row.rounds_ns = turns.iter().map(|turn| turn.time_ns).collect();
        }
        self.judge(&mut row, &running, &mut client, bench, &sum.found)?;
        let others = others(&turns);
        if others > 0 && row.outcome != Outcome::Wrong {
            row.outcome = Outcome::Wrong;
            row.reason =
                format!("{others} of {} turns gave another answer than the last", turns.len());
            // The row's errors are removed, because they describe only the last turn.
            (row.errors, row.causes, row.course) = (None, None, None);
            self.note_first("WRONG", &row, &row.reason);
        }
        self.write(&row)?;
        Ok(Some(running))
    }
}

/// Takes a sample and throws it away. A block may begin on another processor than the last one
/// ended on; in committed records its first sample is slower, by 0 to 11% in the median
/// (docs/BIAS.md). If it fails here, it fails again in the block and is recorded there.
fn warm_up(first: &Running, block: u32, bench: &mut Bench<'_>) {
    if let Ok(mut client) = first.fresh(bench, first.processor(block)) {
        let _ = sample(&mut client, SHORTEST_SAMPLE_NS);
    }
}

/// Returns the order of a round: the rotations of the subjects, then those of the reversed order.
/// In six rounds, each of three subjects has each place twice; if the rounds repeat, each follows
/// each other one three times in six.
fn order(round: usize, all: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..all).collect();
    let turn = round % (2 * all.max(1));
    if turn >= all {
        order.reverse();
    }
    order.rotate_left(turn % all.max(1));
    order
}

/// Takes one turn of each subject, in this order; subjects that fail are removed.
fn take_turns(
    subjects: &mut Vec<TimedSubject>,
    order: &[usize],
    block: u32,
) -> Vec<(TimedSubject, Failure)> {
    let mut failures = Vec::new();
    for &k in order {
        let TimedSubject { running, client, row, turns } = &mut subjects[k];
        let alone = running.is_alone();
        if alone {
            row.began_ms = since_1970();
        }
        match sample(client, if alone { SHORTEST_SAMPLE_NS } else { TURN_NS }) {
            Ok(turn) => {
                if alone {
                    row.pulse_ns = row.pulse_ns.max(pulse(running.processor(block)));
                }
                turns.push(turn);
            }
            Err(failure) => failures.push((k, failure)),
        }
    }
    failures.sort_unstable_by_key(|(k, _)| std::cmp::Reverse(*k));
    failures.into_iter().map(|(k, failure)| (subjects.remove(k), failure)).collect()
}

fn since_1970() -> Option<u64> {
    // The system's clock may be set back during a run.
    static START: OnceLock<Option<(Instant, Duration)>> = OnceLock::new();
    let now = || SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).ok();
    let (start, since) = (*START.get_or_init(|| Some((Instant::now(), now()?))))?;
    u64::try_from((since + start.elapsed()).as_millis()).ok()
}

fn others(turns: &[Sample]) -> usize {
    let answer = |turn: &Sample| turn.found.whole();
    let last = turns.last().map(answer);
    turns.iter().filter(|turn| Some(answer(turn)) != last).count()
}

fn total(turns: &[Sample]) -> Option<Sample> {
    let (first, last) = (turns.first()?, turns.last()?);
    if turns.len() == 1 {
        return Some(first.clone());
    }
    let calls: u64 = turns.iter().map(|turn| turn.calls).sum();
    let elapsed_ns: u64 = turns.iter().map(|turn| turn.elapsed_ns).sum();
    let mean = |of: &dyn Fn(&Sample) -> Option<u64>| {
        let all = turns.iter().map(|turn| Some(u128::from(of(turn)?) * u128::from(turn.calls)));
        let all: u128 = all.sum::<Option<u128>>()?;
        Some(((all + u128::from(calls / 2)) / u128::from(calls.max(1))) as u64)
    };
    let step_ns = (0..last.step_ns.len()).map_while(|k| mean(&|turn| turn.step_ns.get(k).copied()));
    Some(Sample {
        time_ns: (elapsed_ns + calls / 2) / calls.max(1),
        step_ns: step_ns.collect(),
        building_ns: mean(&|turn| turn.building_ns),
        first_ns: first.first_ns,
        calls,
        elapsed_ns,
        found: last.found.clone(),
    })
}

#[cfg(test)]
mod tests {
    use super::{MOST_ROUNDS, order};

    /// Counts how often each of three subjects has each place, and how often each follows another.
    fn counts(rounds: usize) -> ([[usize; 3]; 3], [[usize; 3]; 3]) {
        let (mut places, mut after, mut last) = ([[0; 3]; 3], [[0; 3]; 3], None);
        for round in 0..rounds {
            for (place, k) in order(round, 3).into_iter().enumerate() {
                places[k][place] += 1;
                last.inspect(|&before: &usize| after[k][before] += 1);
                last = Some(k);
            }
        }
        (places, after)
    }

    #[test]
    fn each_build_has_each_place_and_each_predecessor_equally_often() {
        assert_eq!(MOST_ROUNDS % 6, 0);
        for cycles in [1, 2, 5] {
            let (places, after) = counts(6 * cycles);
            assert_eq!(places, [[2 * cycles; 3]; 3]);
            for (k, others) in after.iter().enumerate() {
                for (before, &times) in others.iter().enumerate() {
                    let most = if before == k { 0 } else { 3 * cycles };
                    assert!(times <= most && times + 1 >= most, "{k} after {before}: {times}");
                }
            }
        }
        assert_eq!(order(0, 0), [0; 0]);
        assert_eq!([0, 1, 2, 3].map(|round| order(round, 2)[0]), [0, 1, 1, 0]);
    }
}
