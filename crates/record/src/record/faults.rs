//! Checks of rows against each other, and against what stands beside them: impossible numbers,
//! several answers for one scene, overlapping samples, deleted rows, wrong dates and revisions. A
//! record with a fault is refused.

use std::collections::{BTreeSet, HashMap};
use std::hash::{BuildHasher, RandomState};
use std::path::Path;

use serde::Serialize;
use serde_json::Value;

use crate::record::folder::ledger::{self, Ledger, Span};
use crate::record::folder::{done, file};
use crate::record::origin::machines::described;
use crate::record::origin::provenance;
use crate::record::outcome::{Outcome, Pass};
use crate::record::row::Row;
use contactbench_terms::{must, text};

pub const MOST_THREADS: usize = 1024;

/// The first fault of a record: its file, with the line if the file has lines, and a sentence.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "{}; the record is damaged or was edited, and is not used: use an undamaged copy{}",
    text::line(.0),
    if .0.contains(file::FILE) {
        ", or remove this line, and measure it again with contactbench run ... --resume"
    } else {
        ""
    }
)]
pub struct Damaged(String);

impl Damaged {
    pub fn new(path: &Path, what: impl std::fmt::Display) -> Damaged {
        Damaged(format!("{}: {what}", path.display()))
    }

    pub fn at_line(path: &Path, line: usize, what: &str) -> Damaged {
        Damaged(format!("{}:{line}: {what}", path.display()))
    }
}

/// Whether the name has only letters, digits, `-`, `_` and `.`, and no `.` first. Experiments and
/// their files need such names.
pub fn is_word(name: &str) -> bool {
    !name.is_empty()
        && name.chars().all(|c| c.is_ascii_alphanumeric() || "-_.".contains(c))
        && !name.starts_with('.')
}

/// The spans by id, and the nanoseconds that no sample has used.
type Left<'a> = HashMap<&'a str, (&'a Span, u64)>;

/// Returns the index of a faulty row, and a sentence about it.
pub fn fault(rows: &[Row], ledger: &Ledger) -> Option<(usize, String)> {
    // The length of a span is rounded to milliseconds.
    let length_ns = |span: &Span| ((span.seconds + 1e-3) * 1e9) as u64;
    let spans = ledger.spans.iter().map(|(id, span)| (&**id, (span, length_ns(span))));
    let mut left: Left<'_> = spans.collect();
    let impossible = |(k, row)| Some((k, possible(row, ledger, &mut left).err()?));
    let found = rows.iter().enumerate().find_map(impossible);
    found.or_else(|| between(rows))
}

/// Returns the first row that contradicts another one.
pub fn between(rows: &[Row]) -> Option<(usize, String)> {
    contradiction(rows).or_else(|| overlap(rows)).or_else(|| disorder(rows))
}

/// Fails if a row contradicts its process or its span. `spans` has the nanoseconds left of each span.
fn possible(row: &Row, ledger: &Ledger, spans: &mut Left<'_>) -> Result<(), String> {
    let is_known = row.process.as_ref().is_none_or(|id| ledger.processes.contains_key(id));
    must!(is_known, "{} has no process {}", ledger::FILE, row.process.as_deref().unwrap_or(""));
    let Some((span, left)) = row.span.as_deref().and_then(|id| spans.get_mut(id)) else {
        return row.possible(u64::MAX);
    };
    let (scene, of) = (format!("{}: {}", row.id.experiment, row.id.scene), &span.scene);
    let rest = of.strip_prefix(&scene);
    let same = rest.is_some_and(|rest| !rest.starts_with(|c: char| c.is_ascii_alphanumeric()));
    must!(same, "its experiment and scene are {scene}, and those of its span are {of}");
    row.possible(*left)?;
    // Copies run at once.
    let alone_ns = row.elapsed_ns.filter(|_| row.pass == Pass::Time);
    *left = left.saturating_sub(alone_ns.unwrap_or(0));
    Ok(())
}

/// Returns the first row that contradicts an earlier one: rows that share a scene, subject,
/// measurement or span share a value.
fn contradiction(rows: &[Row]) -> Option<(usize, String)> {
    let (mut known, keys) = (HashMap::new(), RandomState::new());
    for (k, row) in rows.iter().enumerate() {
        let (id, hash) = (&row.id, &*row.stats.scene_hash);
        let scene = done::scene(&id.clone().anywhere());
        let is_ok = row.outcome == Outcome::Ok;
        let digest = row.digest.clone().filter(|_| is_ok);
        let in_arithmetic = keys.hash_one((&scene, &id.arithmetic));
        let made = |value: String| Some(value).filter(|_| !hash.is_empty());
        let counts = (!row.counts.is_empty()).then(|| told(&row.counts));
        let there = row.span.as_ref().map(|_| told(&done::scene(id)));
        for (name, of, key, value) in [
            ("digest", "scene", in_arithmetic, digest),
            ("scene_hash", "scene", keys.hash_one(&scene), made(hash.into())),
            ("stats", "scene", in_arithmetic, made(told(&row.stats)).filter(|_| is_ok)),
            (
                "role",
                "subject",
                keys.hash_one((&id.experiment, id.subject())),
                Some(told(&row.role)),
            ),
            ("counts", "measurement", keys.hash_one(row.measurement()), counts),
            ("scene", "span", keys.hash_one((&row.span, &id.machine)), there),
        ] {
            let Some(value) = value else { continue };
            let first = known.entry((name, key)).or_insert_with(|| value.clone());
            if *first != value {
                let words = format!("earlier rows of the same {of} have");
                return Some((k, format!("its {name} is {value}, but {words} {first}")));
            }
        }
    }
    None
}

fn told(value: &impl Serialize) -> String {
    serde_json::to_string(value).unwrap_or_default()
}

/// Returns a sample that began before another one of the same span and processor had ended, such as
/// a copy of a sample under another block number.
fn overlap(rows: &[Row]) -> Option<(usize, String)> {
    let mut samples = Vec::new();
    for (k, row) in rows.iter().enumerate() {
        let began = row.processor.zip(row.began_ms).zip(row.elapsed_ns);
        let Some(((processor, began), elapsed_ns)) = began else { continue };
        let lasted_ns = elapsed_ns.saturating_add(row.first_ns.unwrap_or(0));
        // Two runs at once may share a processor.
        let place = (row.span.as_deref(), row.id.machine.as_deref(), processor);
        samples.push((place, began, lasted_ns / 1_000_000, k));
    }
    samples.sort_unstable();
    let found = samples.windows(2).find(|pair| {
        let ((place, began, lasted, _), (next, then, ..)) = (pair[0], pair[1]);
        // A process starts between two samples, which takes over a millisecond.
        place == next && then < began.saturating_add(lasted.max(1))
    })?;
    let ((_, began, _, k), (.., other)) = (found[0], found[1]);
    let (first, second) = (&rows[k.min(other)], k.max(other));
    let words = format!(
        "its sample overlaps in time with that of {} in block {}, begun at {began} ms on the same \
         processor: one is a copy",
        first.id.subject(),
        first.block
    );
    Some((second, words))
}

/// Returns a sample that began before one of an earlier block of its span.
fn disorder(rows: &[Row]) -> Option<(usize, String)> {
    let began = |(k, row): (usize, &Row)| Some((row.span.clone()?, row.block, row.began_ms?, k));
    let mut samples: Vec<_> = rows.iter().enumerate().filter_map(began).collect();
    samples.sort_unstable();
    let found = samples.windows(2).find(|pair| pair[0].0 == pair[1].0 && pair[1].2 < pair[0].2)?;
    let (earlier, k) = (found[0].1, found[1].3);
    Some((k, format!("its sample began before one of block {earlier}: they are out of order")))
}

/// Returns the spans that have fewer rows than were written during them, with the rows left.
pub fn shortened(rows: &[Row], ledger: &Ledger) -> Vec<Span> {
    let mut left: HashMap<&str, u64> = HashMap::new();
    rows.iter().filter_map(|row| row.span.as_deref()).for_each(|id| {
        *left.entry(id).or_default() += 1;
    });
    let left = |span: &Span| left.get(&*span.id).copied().unwrap_or(0);
    let shortened = |span: &Span| {
        let (was, left) = (span.rows?, left(span));
        let deleted = Some(span.deleted.unwrap_or(0) + was.checked_sub(left)?);
        (left < was).then(|| Span { rows: Some(left), deleted, ..span.clone() })
    };
    ledger.spans.values().filter_map(shortened).collect()
}

/// Returns a sentence if rows of a span are missing.
pub fn deleted(rows: &[Row], ledger: &Ledger) -> Option<String> {
    let Span { id, scene, rows: left, .. } = shortened(rows, ledger).into_iter().next()?;
    let was = ledger.spans.get(&id)?.rows?;
    Some(format!(
        "the span {id} ({scene}) had {was} rows, and {} are left; contactbench run --resume \
         measures what the plan lacks",
        left.unwrap_or(0)
    ))
}

/// The day of the first program that wrote records; an earlier `date_utc` is refused.
const FIRST_DAY: &str = "2026-11-21";

/// Returns a sentence if the clock of this machine would make such a record.
pub fn clock() -> Option<String> {
    let date = provenance::date();
    (*date < *FIRST_DAY)
        .then(|| format!("the clock of this machine says {date}; set it before the run"))
}

/// Returns a sentence if dates or revisions of the provenances contradict the rows or the clock.
pub fn origin(rows: &[Row], ledger: &Ledger, provenances: &[&Value]) -> Option<String> {
    let texts = |name: &str| -> Vec<&str> {
        provenances.iter().filter_map(|fields| fields.get(name)?.as_str()).collect()
    };
    let (dates, tomorrow) = (texts("date_utc"), provenance::date_after(86_400));
    let is_date = |date: &str| {
        let like = |(a, b): (u8, u8)| a == b || a.is_ascii_digit() && b.is_ascii_digit();
        date.len() == tomorrow.len() && date.bytes().zip(tomorrow.bytes()).all(like)
    };
    let possible = |date: &str| is_date(date) && date >= FIRST_DAY && *date <= *tomorrow;
    if let Some(date) = dates.iter().find(|date| !possible(date)) {
        return Some(format!("its date_utc is {date}: from {FIRST_DAY} to today is possible"));
    }
    let began =
        || rows.iter().filter_map(|row| row.began_ms).map(|ms| provenance::dated(ms / 1000));
    if let Some(late) = began().find(|began| *began > tomorrow) {
        return Some(format!("a sample began at {late}, which is in the future"));
    }
    if let (Some(date), Some(first)) = (dates.iter().min(), began().min())
        && **date > *first
    {
        return Some(format!(
            "its date_utc {date} is later than the start of its first sample, {first}"
        ));
    }
    let machines: BTreeSet<String> =
        provenances.iter().flat_map(|it| described(it)).map(|(name, _)| name).collect();
    let mut of = rows.iter().filter_map(|row| row.id.machine.as_ref());
    // A merge sets a missing machine to the empty name.
    let is_known = |name: &str| name.is_empty() || machines.is_empty() || machines.contains(name);
    if let Some(name) = of.find(|name| !is_known(name)) {
        return Some(format!("it does not describe the machine {name}, which rows name"));
    }
    let said: BTreeSet<&str> =
        texts("revision").into_iter().flat_map(|it| it.split(", ")).collect();
    let ours = rows.iter().filter(|row| row.role.is_ours() && row.role.base_of().is_none());
    let built = |row: &Row| ledger.processes.get(row.process.as_deref()?)?.build.get("revision");
    let other =
        ours.filter_map(built).find(|built| !said.is_empty() && !said.contains(&***built))?;
    let said = Vec::from_iter(said).join(", ");
    Some(format!("its revision is {said}, but the program of a row has {other}"))
}
