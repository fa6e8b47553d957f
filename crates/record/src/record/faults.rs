//! Checks that rows could have been written by a run, and do not contradict each other. A record
//! with such a fault is refused, and all faulty rows are listed.

use std::collections::{BTreeMap, HashMap};
use std::fmt;

use crate::record::column::{COLUMNS, Column};
use crate::record::folder::ledger::{self, Ledger};
use crate::record::folder::{done, file};
use crate::record::id::Projection;
use crate::record::outcome::{Outcome, Pass};
use crate::record::role::Role;
use crate::record::row::{Course, Row};
use contactbench_terms::arithmetic::Arithmetic;
use contactbench_terms::errors::Errors;
use contactbench_terms::number::plural;
use contactbench_terms::text;

pub const MOST_THREADS: usize = 1024;
const SHOWN: usize = 20;

#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// The file and, if it has lines, the line: `result/samples.jsonl:7`.
    pub place: String,
    /// The fault, as a sentence without a full stop.
    pub what: String,
}

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub struct Damaged(pub Vec<Fault>);

impl fmt::Display for Damaged {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Damaged(faults) = self;
        let count = plural(faults.len(), "fault");
        write!(f, "{count}: the record is damaged or was edited, and is not used")?;
        for Fault { place, what } in faults.iter().take(SHOWN) {
            write!(f, "\n{}", text::line(&format!("{place}: {what}")))?;
        }
        if faults.len() > SHOWN {
            write!(f, "\nand {} more", faults.len() - SHOWN)?;
        }
        write!(f, "\nuse an undamaged copy")?;
        if faults.iter().all(|fault| fault.place.contains(file::FILE)) {
            let again = "contactbench run ... --resume";
            write!(f, "; or remove these lines, and measure them again with {again}")?;
        }
        Ok(())
    }
}

pub fn sound(faults: Vec<Fault>) -> Result<(), Damaged> {
    if faults.is_empty() { Ok(()) } else { Err(Damaged(faults)) }
}

pub fn faults(rows: &[Row], ledger: &Ledger) -> Vec<(usize, String)> {
    let mut found: Vec<(usize, String)> = Vec::new();
    for (k, row) in rows.iter().enumerate() {
        found.extend(alone(row).or_else(|| dangling(row, ledger)).map(|what| (k, what)));
    }
    found.extend(together(rows));
    found.sort();
    found
}

fn alone(row: &Row) -> Option<String> {
    ranges(row).or_else(|| numbers(row)).or_else(|| times(row)).or_else(|| answer(row))
}

/// A process must be written before the rows that point to it.
fn dangling(row: &Row, ledger: &Ledger) -> Option<String> {
    let process = row.process.as_ref()?;
    let absent = !ledger.processes.contains_key(process);
    absent.then(|| format!("its process is {process}, which is not in {}", ledger::FILE))
}

macro_rules! must {
    ($holds:expr, $($words:tt)*) => {
        if !$holds {
            return Some(format!($($words)*));
        }
    };
}

fn ranges(row: &Row) -> Option<String> {
    let id = &row.id;
    let (threads, pass) = (id.threads() as usize, row.pass.name());
    must!(
        is_word(&id.experiment),
        "the experiment '{}' is not a valid name",
        id.experiment.escape_default()
    );
    must!((2..=3).contains(&id.dim), "dim is {}; it must be 2 or 3", id.dim);
    let fits = id.n <= u64::from(u32::MAX);
    must!(fits, "n is {}; at most 2^32 - 1 particles can be numbered", id.n);
    let some = (1..=MOST_THREADS).contains(&threads);
    must!(some, "threads is {threads}; it must be 1 to {MOST_THREADS}");
    let blocks = !matches!(row.pass, Pass::Count | Pass::Memory);
    must!(
        row.block == 0 || blocks,
        "block is {} in the pass {pass}, which has no blocks",
        row.block
    );
    let numbered = row.block > 0 || row.time_ns.is_none();
    must!(numbered, "it has a time, and block 0: blocks are numbered from 1");
    None
}

/// Whether the name has only letters, digits, `-`, `_` and `.`, and no `.` first. Experiments and
/// their files need such names.
pub fn is_word(name: &str) -> bool {
    !name.is_empty()
        && name.chars().all(|c| c.is_ascii_alphanumeric() || "-_.".contains(c))
        && !name.starts_with('.')
}

fn numbers(row: &Row) -> Option<String> {
    let timed = matches!(row.pass, Pass::Time | Pass::Ceiling);
    let beside = [row.first_ns, row.alone_ns, row.pulse_ns].into_iter().flatten();
    let rounds = !row.rounds_ns.is_empty() || beside.clone().next().is_some();
    // Copies are timed, too.
    let clock = |pass: Pass| pass == Pass::Time && timed;
    let elsewhere = |column: &&Column| {
        let other = column.pass.is_some_and(|pass| pass != row.pass && !clock(pass));
        other && column.read(row).is_some()
    };
    let measured = row.outcome.is_good() || row.outcome == Outcome::Wrong;
    let (pass, outcome) = (row.pass.name(), row.outcome.name());
    if let Some(column) = COLUMNS.iter().find(elsewhere) {
        return Some(format!("it has {} in the pass {pass}", column.name));
    }
    let has_time = row.time_ns.is_some();
    must!(!has_time || measured, "it has a time with the outcome {outcome}");
    must!(has_time || !(timed && row.outcome.is_good()), "it is {outcome} and has no time");
    must!(has_time || !rounds, "it has rounds_ns, first_ns, alone_ns or pulse_ns, and no time");
    let lasted = row.rounds_ns.iter().copied().chain(beside).all(|ns| ns > 0);
    must!(
        lasted,
        "one of its rounds_ns, first_ns, alone_ns or pulse_ns is 0: nothing was measured"
    );
    let counted = row.counts.is_empty() || row.pass == Pass::Count;
    must!(counted, "it has counts in the pass {pass}");
    let more = row.peak_bytes.zip(row.live_bytes).is_none_or(|(peak, live)| peak >= live);
    must!(more, "its peak_bytes are fewer than its live_bytes");
    None
}

fn times(row: &Row) -> Option<String> {
    let time = u128::from(row.time_ns?);
    let (Some(calls), Some(elapsed)) = (row.calls, row.elapsed_ns) else {
        return Some("it has a time without calls and elapsed_ns".into());
    };
    let (calls, elapsed) = (u128::from(calls), u128::from(elapsed));
    let product = time.saturating_mul(calls);
    let agrees = match row.pass {
        // `elapsed_ns` is the time of the longest copy, but calls are summed over all copies.
        Pass::Ceiling => product <= (elapsed * u128::from(row.id.threads())).saturating_add(calls),
        _ => product.abs_diff(elapsed) <= calls,
    };
    let part = row.building_ns.is_none_or(|building| u128::from(building) <= time + 1);
    must!(part, "its building_ns are more than its time_ns");
    let steps = row.median_step_ns.zip(row.worst_step_ns);
    let less = steps.is_none_or(|(median, worst)| median <= worst);
    must!(less, "its median_step_ns are more than its worst_step_ns");
    let some = calls > 0 && time > 0;
    must!(some, "its time_ns is {time}, with {calls} calls: nothing was measured");
    must!(agrees, "its time_ns {time} is not its elapsed_ns {elapsed} over its calls {calls}");
    None
}

fn answer(row: &Row) -> Option<String> {
    if row.role == Role::Nothing {
        return None;
    }
    let search = row.causes.map(|causes| causes.search);
    let exact = row.id.arithmetic.parse().is_ok_and(Arithmetic::is_exact);
    if let Some(digest) = row.digest.as_deref().filter(|_| row.outcome.is_good()) {
        must!(is_hex(digest), "its digest is '{}'", digest.escape_default());
    }
    let hash = &row.stats.scene_hash;
    must!(hash.is_empty() || is_hex(hash), "its scene_hash is '{}'", hash.escape_default());
    let wrong = |errors: Option<Errors>| errors.map_or(0, |errors| errors.wrong());
    if row.outcome == Outcome::Ok {
        let (found, all) = (wrong(search), wrong(row.errors));
        must!(found == 0, "it is ok, and its search has {found} wrong pairs");
        must!(!exact || all == 0, "it is ok, and has {all} wrong pairs");
        let both = row.contacts.is_some() == row.digest.is_some();
        must!(both, "it has one of contacts and digest without the other");
    }
    if let Some(fault) = course(row) {
        return Some(fault);
    }
    let (contacts, errors) = (row.contacts?, row.errors?);
    let extra = errors.spurious as f64 + errors.duplicate as f64 + errors.self_pairs as f64;
    let right = row.true_contacts().round() - errors.missed as f64 + extra;
    let agree = right == contacts as f64;
    must!(
        agree,
        "its contacts are {contacts}, and by its coordination and its errors they are {right}"
    );
    None
}

fn course(row: &Row) -> Option<String> {
    let course = row.course?;
    must!(row.moved.is_some(), "it has a course, and its scene does not move");
    let frames = row.moved.as_ref()?.frames;
    let missed = row.causes.map_or(0, |causes| causes.search.missed);
    let Course { builds, dangerous, dangerous_rightly, missing_builds, .. } = course;
    let Course { first_wrong, wrong_frames, worst_missed, never, latest, .. } = course;
    let at_most = [
        ("builds", builds, frames),
        ("dangerous", dangerous, builds),
        ("missing_builds", missing_builds, builds),
        ("dangerous_rightly", dangerous_rightly, dangerous.min(missing_builds)),
        ("wrong_frames", wrong_frames, frames),
        ("first_wrong", first_wrong.unwrap_or(0), frames),
        ("latest", latest, frames),
        ("never", never, missed),
        ("worst_missed", worst_missed, missed),
    ];
    if let Some((name, value, most)) = at_most.into_iter().find(|(_, value, most)| value > most) {
        return Some(format!("its course has {name} {value}, and there can be {most} at most"));
    }
    let all = worst_missed.saturating_mul(wrong_frames);
    let none = [wrong_frames == 0, worst_missed == 0, first_wrong.is_none(), missed == 0];
    must!(
        missed <= all && none == [none[0]; 4],
        "its search missed {missed}, at most {worst_missed} in each of {wrong_frames} frames"
    );
    let late = course.deepest_late;
    must!(late >= 0.0 && late.is_finite(), "its deepest_late is {late}");
    None
}

fn is_hex(text: &str) -> bool {
    let digits = text.strip_prefix("0x");
    digits
        .is_some_and(|d| d.len() == 16 && d.bytes().all(|b| matches!(b, b'0'..=b'9' | b'a'..=b'f')))
}

type Votes<T> = BTreeMap<T, Vec<usize>>;

fn together(rows: &[Row]) -> Vec<(usize, String)> {
    let mut scenes: HashMap<Projection, Votes<&str>> = HashMap::new();
    let mut answers: HashMap<(Projection, &str), Votes<&str>> = HashMap::new();
    let mut contacts: HashMap<(Projection, &str), Votes<u64>> = HashMap::new();
    for (k, row) in rows.iter().enumerate() {
        let scene = done::scene(&row.id.clone().anywhere());
        if !row.stats.scene_hash.is_empty() {
            let said = scenes.entry(scene.clone()).or_default();
            said.entry(&row.stats.scene_hash).or_default().push(k);
        }
        if row.outcome != Outcome::Ok {
            continue;
        }
        let place = (scene, &*row.id.arithmetic);
        if let (Some(digest), Some(count)) = (&row.digest, row.contacts) {
            contacts.entry(place.clone()).or_default().entry(count).or_default().push(k);
            answers.entry(place).or_default().entry(digest).or_default().push(k);
        }
    }
    let mut found = Vec::new();
    found.extend(twice(rows));
    scenes.values().for_each(|votes| differ(votes, "scene_hash", &mut found));
    answers.values().for_each(|votes| differ(votes, "digest", &mut found));
    contacts.values().for_each(|votes| differ(votes, "number of contacts", &mut found));
    found.dedup_by_key(|fault: &mut (usize, String)| fault.0);
    found
}

fn twice(rows: &[Row]) -> Vec<(usize, String)> {
    let (mut begun, mut found) = (HashMap::new(), Vec::new());
    for (k, row) in rows.iter().enumerate() {
        let Some(began) = done::began(row) else { continue };
        let first: &Row = begun.entry(began).or_insert(row);
        if done::times(first) != done::times(row) {
            let began = row.began_ms.unwrap_or(0);
            found.push((
                k,
                format!(
                    "it is of the sample that began at {began} ms, as another row is, which has \
                 another time"
                ),
            ));
        }
    }
    found
}

fn differ<T: fmt::Display + Ord>(votes: &Votes<T>, what: &str, found: &mut Vec<(usize, String)>) {
    let Some(most) = votes.values().map(Vec::len).max().filter(|_| votes.len() > 1) else { return };
    // If two values are equally frequent, the first one counts as right.
    let common =
        votes.iter().filter(|(_, rows)| rows.len() == most).min_by_key(|(_, rows)| rows[0]);
    let Some((common, _)) = common else { return };
    for (said, rows) in votes {
        if said != common {
            let words = format!(
                "its {what} is {said}, but {most} other rows of the same scene have {common}"
            );
            found.extend(rows.iter().map(|&row| (row, words.clone())));
        }
    }
}
