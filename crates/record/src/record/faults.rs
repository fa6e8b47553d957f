//! Rows held to what a run writes, and to each other. A record in which something cannot be is
//! refused as a whole, and every row that cannot be is named.

use std::collections::{BTreeMap, HashMap};
use std::fmt;

use crate::record::column::{COLUMNS, Column};
use crate::record::id::Projection;
use crate::record::ledger::{self, Ledger};
use crate::record::outcome::{Outcome, Pass};
use crate::record::role::Role;
use crate::record::row::{Course, Row};
use crate::record::{done, file};
use contactbench_terms::errors::Errors;
use contactbench_terms::number::plural;

/// More threads than any machine has cores are a slip of the pen.
pub const MOST_THREADS: usize = 1024;
/// Faults listed one by one, at most.
const SHOWN: usize = 20;

#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// The file, with the line if it has lines: `result/samples.jsonl:7`.
    pub place: String,
    /// What is wrong, in a sentence without an end.
    pub what: String,
}

/// A result folder that contradicts itself: nothing is made of it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub struct Damaged(pub Vec<Fault>);

impl fmt::Display for Damaged {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Damaged(faults) = self;
        let count = plural(faults.len(), "fault");
        write!(f, "{count}: the record is damaged or was edited, and nothing is made of it")?;
        for Fault { place, what } in faults.iter().take(SHOWN) {
            write!(f, "\n{place}: {what}")?;
        }
        if faults.len() > SHOWN {
            write!(f, "\nand {} more", faults.len() - SHOWN)?;
        }
        write!(f, "\ntake a copy that is whole")?;
        if faults.iter().all(|fault| fault.place.contains(file::FILE)) {
            let again = "contactbench run ... --resume";
            write!(f, "; or take these lines out, and measure them again with {again}")?;
        }
        Ok(())
    }
}

pub fn sound(faults: Vec<Fault>) -> Result<(), Damaged> {
    if faults.is_empty() { Ok(()) } else { Err(Damaged(faults)) }
}

/// What cannot be in these rows: the numbers of the rows, and what is wrong with each.
pub fn faults(rows: &[Row], ledger: &Ledger) -> Vec<(usize, String)> {
    let mut found: Vec<(usize, String)> = Vec::new();
    for (k, row) in rows.iter().enumerate() {
        found.extend(alone(row).or_else(|| dangling(row, ledger)).map(|what| (k, what)));
    }
    found.extend(together(rows));
    found.sort();
    found
}

/// What is wrong with a row whatever the others say.
fn alone(row: &Row) -> Option<String> {
    ranges(row).or_else(|| numbers(row)).or_else(|| times(row)).or_else(|| answer(row))
}

/// A process is written before the rows that point to it.
fn dangling(row: &Row, ledger: &Ledger) -> Option<String> {
    let process = row.process.as_ref()?;
    let absent = !ledger.processes.contains_key(process);
    absent.then(|| format!("its process is {process}, which is not in {}", ledger::FILE))
}

fn ranges(row: &Row) -> Option<String> {
    let id = &row.id;
    let threads = id.threads() as usize;
    Some(if !is_word(&id.experiment) {
        format!("the experiment '{}' is no name", id.experiment.escape_default())
    } else if !(2..=3).contains(&id.dim) {
        format!("dim is {}; it must be 2 or 3", id.dim)
    } else if id.n > u64::from(u32::MAX) {
        format!("n is {}; at most 2^32 - 1 particles can be numbered", id.n)
    } else if !(1..=MOST_THREADS).contains(&threads) {
        format!("threads is {threads}; it must be 1 to {MOST_THREADS}")
    } else if row.block > 0 && matches!(row.pass, Pass::Count | Pass::Memory) {
        format!("block is {} in the pass {}, which has no blocks", row.block, row.pass.name())
    } else if row.block == 0 && row.time_ns.is_some() {
        "it has a time, and block 0: blocks are numbered from 1".into()
    } else {
        return None;
    })
}

/// Letters, digits, `-`, `_` and `.`, not a `.` first: what names an experiment and its file.
pub fn is_word(name: &str) -> bool {
    !name.is_empty()
        && name.chars().all(|c| c.is_ascii_alphanumeric() || "-_.".contains(c))
        && !name.starts_with('.')
}

/// Numbers belong to a pass and an outcome.
fn numbers(row: &Row) -> Option<String> {
    let timed = matches!(row.pass, Pass::Time | Pass::Ceiling);
    let beside = [row.first_ns, row.alone_ns, row.pulse_ns].into_iter().flatten();
    let rounds = !row.rounds_ns.is_empty() || beside.clone().next().is_some();
    // The clock runs for copies as well.
    let clock = |pass: Pass| pass == Pass::Time && timed;
    let elsewhere = |column: &&Column| {
        let other = column.pass.is_some_and(|pass| pass != row.pass && !clock(pass));
        other && column.read(row).is_some()
    };
    let measured = row.outcome.is_good() || row.outcome == Outcome::Wrong;
    let name = row.pass.name();
    Some(if let Some(column) = COLUMNS.iter().find(elsewhere) {
        format!("it has {} in the pass {name}", column.name)
    } else if row.time_ns.is_some() && !measured {
        format!("it has a time with the outcome {}", row.outcome.name())
    } else if timed && row.outcome.is_good() && row.time_ns.is_none() {
        format!("it is {} and has no time", row.outcome.name())
    } else if rounds && row.time_ns.is_none() {
        "it has rounds_ns, first_ns, alone_ns or pulse_ns, and no time".into()
    } else if row.rounds_ns.iter().copied().chain(beside).any(|ns| ns == 0) {
        "one of its rounds_ns, first_ns, alone_ns or pulse_ns is 0: nothing was measured".into()
    } else if !row.counts.is_empty() && row.pass != Pass::Count {
        format!("it has counts in the pass {name}")
    } else if row.peak_bytes.zip(row.live_bytes).is_some_and(|(peak, live)| peak < live) {
        "its peak_bytes are fewer than its live_bytes".into()
    } else {
        return None;
    })
}

/// A time is that of the whole sample over its detections.
fn times(row: &Row) -> Option<String> {
    let time = u128::from(row.time_ns?);
    let (Some(calls), Some(elapsed)) = (row.calls, row.elapsed_ns) else {
        return Some("it has a time without calls and elapsed_ns".into());
    };
    let (calls, elapsed) = (u128::from(calls), u128::from(elapsed));
    let product = time.saturating_mul(calls);
    let agrees = match row.pass {
        // The longest of as many samples as there are threads, and all detections.
        Pass::Ceiling => product <= (elapsed * u128::from(row.id.threads())).saturating_add(calls),
        _ => product.abs_diff(elapsed) <= calls,
    };
    let words =
        format!("its time_ns {time} is not its elapsed_ns {elapsed} over its calls {calls}");
    let steps = row.median_step_ns.zip(row.worst_step_ns);
    if row.building_ns.is_some_and(|building| u128::from(building) > time + 1) {
        Some("its building_ns are more than its time_ns".into())
    } else if steps.is_some_and(|(median, worst)| median > worst) {
        Some("its median_step_ns are more than its worst_step_ns".into())
    } else if calls == 0 || time == 0 {
        Some(format!("its time_ns is {time}, with {calls} calls: nothing was measured"))
    } else {
        (!agrees).then_some(words)
    }
}

/// Pairs, fingerprint and errors agree with the outcome.
fn answer(row: &Row) -> Option<String> {
    if row.role == Role::Nothing {
        return None;
    }
    let search = row.causes.map(|causes| causes.search);
    let exact = row.id.arithmetic == "exact";
    let digest = row.digest.as_deref().filter(|_| row.outcome.is_good());
    if let Some(text) = digest.filter(|text| !is_hex(text)) {
        return Some(format!("its digest is '{}'", text.escape_default()));
    }
    if !row.stats.scene_hash.is_empty() && !is_hex(&row.stats.scene_hash) {
        return Some(format!("its scene_hash is '{}'", row.stats.scene_hash.escape_default()));
    }
    let wrong = |errors: Option<Errors>| errors.map_or(0, |errors| errors.wrong());
    match row.outcome {
        Outcome::Ok if wrong(search) > 0 => {
            return Some(format!("it is ok, and its search has {} wrong pairs", wrong(search)));
        }
        Outcome::Ok if exact && wrong(row.errors) > 0 => {
            return Some(format!("it is ok, and has {} wrong pairs", wrong(row.errors)));
        }
        Outcome::Ok if row.contacts.is_some() != row.digest.is_some() => {
            return Some("it has one of contacts and digest without the other".into());
        }
        _ => {}
    }
    if let Some(fault) = course(row) {
        return Some(fault);
    }
    let (contacts, errors) = (row.contacts?, row.errors?);
    let truth = row.true_contacts().round();
    let extra = errors.spurious as f64 + errors.duplicate as f64 + errors.self_pairs as f64;
    let right = truth - errors.missed as f64 + extra;
    (right != contacts as f64).then(|| {
        format!(
            "its contacts are {contacts}, and by its coordination and its errors they are {right}"
        )
    })
}

/// What became of the frames of a scene in motion agrees with itself.
fn course(row: &Row) -> Option<String> {
    let course = match (row.course, &row.moved) {
        (None, _) => return None,
        (Some(_), None) => return Some("it has a course, and its scene does not move".into()),
        (Some(course), Some(_)) => course,
    };
    let frames = row.moved.as_ref().map_or(0, |moved| moved.frames);
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
    if missed > all || none != [none[0]; 4] {
        return Some(format!(
            "its search missed {missed}, at most {worst_missed} in each of {wrong_frames} frames"
        ));
    }
    let late = course.deepest_late;
    (!(late >= 0.0 && late.is_finite())).then(|| format!("its deepest_late is {late}"))
}

fn is_hex(text: &str) -> bool {
    let digits = text.strip_prefix("0x");
    digits
        .is_some_and(|d| d.len() == 16 && d.bytes().all(|b| matches!(b, b'0'..=b'9' | b'a'..=b'f')))
}

/// What rows that must agree hold, and the numbers of the rows that hold it.
type Votes<T> = BTreeMap<T, Vec<usize>>;

/// What rows say of the same scene must be the same.
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

/// Rows of a sample that another row has, with other times.
fn twice(rows: &[Row]) -> Vec<(usize, String)> {
    let (mut begun, mut found) = (HashMap::new(), Vec::new());
    for (k, row) in rows.iter().enumerate() {
        let Some(began) = done::began(row) else { continue };
        let first: &Row = begun.entry(began).or_insert(row);
        if done::times(first) != done::times(row) {
            let began = row.began_ms.unwrap_or(0);
            let words = format!(
                "it is of the sample that began at {began} ms, as another row is, \
                                 which has another time"
            );
            found.push((k, words));
        }
    }
    found
}

fn differ<T: fmt::Display + Ord>(votes: &Votes<T>, what: &str, found: &mut Vec<(usize, String)>) {
    let Some(most) = votes.values().map(Vec::len).max().filter(|_| votes.len() > 1) else { return };
    // Of two as frequent the one that was said first.
    let common =
        votes.iter().filter(|(_, rows)| rows.len() == most).min_by_key(|(_, rows)| rows[0]);
    let Some((common, _)) = common else { return };
    for (said, rows) in votes {
        if said != common {
            let words = format!(
                "its {what} is {said}, and that of {most} other rows of the same scene {common}"
            );
            found.extend(rows.iter().map(|&row| (row, words.clone())));
        }
    }
}
