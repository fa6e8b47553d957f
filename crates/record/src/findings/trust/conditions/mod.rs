//! The conditions of a record: its sources, its build, and other load on the machine. Reports show
//! doubts about them next to the times.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::Value;

use crate::cells::state::States;
use crate::record::folder::ledger::{Ledger, Span};
use crate::record::role::Role;
use crate::record::row::{Pass, Row};
use contactbench_terms::number::{percent, plural};

/// Share of a core that other processes may use on average during a run. If they use more, times
/// are doubtful, unless [`OTHERS_OF_ALL`] allows it.
pub const OTHERS: f64 = 0.10;
/// Share of all cores that other processes may use, because an idle system uses some.
pub const OTHERS_OF_ALL: f64 = 0.01;
/// Share of a core that the host of a virtual machine may take away.
pub const STOLEN: f64 = 0.02;
/// In a single scene, this multiple of [`OTHERS`] and [`STOLEN`] is allowed.
pub const IN_A_SCENE: f64 = 2.5;
/// Shortest scene that is judged, in seconds. The system's clocks are too coarse for less.
pub const SHORTEST_S: f64 = 1.0;
/// Limit for the load average of the minute before the run. It is used if processor times are
/// missing or too short.
pub const LOAD: f64 = 1.0;

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Conditions {
    pub doubts: Vec<String>,
    /// Whether other load may have changed the times. Nothing is decided by such times.
    pub disturbed: bool,
    pub load: Load,
    /// Number of timed rows during which the machine was slow, and number of rows for which that is
    /// known.
    pub slow: (usize, usize),
}

#[derive(Clone, Debug, Default, PartialEq)]
pub enum Load {
    #[default]
    Unknown,
    /// The highest load average of the minute before a run, which excludes the run itself.
    Before(f64),
    /// Load during timing, on the machine with the most load by other processes.
    Watched { seconds: f64, others: f64, stolen: f64 },
}

impl Conditions {
    pub fn new<'a>(
        provenances: impl IntoIterator<Item = &'a Value>,
        ledger: &Ledger,
        rows: &[Row],
    ) -> Conditions {
        let provenances: Vec<&Value> = provenances.into_iter().collect();
        let timed = |row: &&Row| row.pass == Pass::Time && row.time_ns.is_some();
        let timed: Vec<&Row> = rows.iter().filter(timed).collect();
        let mut conditions = Conditions::default();
        let states = States::new(rows);
        let looked: Vec<bool> = timed.iter().filter_map(|row| states.is_slow(row)).collect();
        conditions.slow = (looked.iter().filter(|&&slow| slow).count(), looked.len());
        let unwatched = conditions.watched(&timed, ledger);
        // Load does not affect a record of counts alone.
        let counts_alone = timed.is_empty() && !rows.is_empty();
        if conditions.load == Load::Unknown && !counts_alone {
            conditions.before(&provenances);
        }
        conditions.disturbed = !conditions.doubts.is_empty();
        conditions.doubts.extend(unwatched);
        let deleted: u64 = ledger.spans.values().filter_map(|span| span.deleted).sum();
        if deleted > 0 {
            let rows = plural(deleted as usize, "row");
            conditions.doubts.push(format!("{rows} had been deleted when the run was resumed"));
        }
        // The provenance of a merged record does not state `dirty`, but those of its parts do.
        let dirty = provenances.iter().any(|fields| fields.get("dirty") == Some(&true.into()));
        if dirty || said_by(&timed, ledger, "sources").contains("changed") {
            let words = "the program was built from sources that were not committed";
            conditions.doubts.push(words.into());
        }
        let profiles = provenances.iter().filter_map(|fields| fields.get("profile")?.as_str());
        // A merged record lists the values of its parts in one text.
        let mut profiles: BTreeSet<&str> = profiles.flat_map(|text| text.split(", ")).collect();
        profiles.extend(said_by(&timed, ledger, "profile"));
        let slow = profiles.iter().filter(|profile| !["", "release"].contains(profile));
        let slow = slow.map(|profile| format!("the program is a {profile} build"));
        conditions.doubts.extend(slow);
        conditions
    }

    /// Adds doubts about spans, and returns one about rows without a span.
    fn watched(&mut self, timed: &[&Row], ledger: &Ledger) -> Option<String> {
        let mut machines: BTreeMap<Option<&str>, BTreeMap<&str, &Span>> = BTreeMap::new();
        let mut unwatched = 0;
        for row in timed {
            match row.span.as_ref().and_then(|id| ledger.spans.get(id)) {
                Some(span) => {
                    machines.entry(row.id.machine.as_deref()).or_default().insert(&span.id, span);
                }
                None => unwatched += 1,
            }
        }
        let mut busiest = f64::NEG_INFINITY;
        for spans in machines.values() {
            let sum = |part: fn(&Span) -> f64| spans.values().map(|it| part(it)).sum::<f64>();
            let seconds = sum(|span| span.seconds);
            let cores = spans.values().map(|span| span.cores).max().unwrap_or(0) as f64;
            let mut share = |part: fn(&Span) -> f64, limit: f64, words: &str| {
                let mean = if seconds > 0.0 { sum(part) / seconds } else { 0.0 };
                let worst = worst(spans.values().copied(), part, limit);
                if worst.is_some() || seconds >= SHORTEST_S && mean > limit {
                    let worst =
                        worst.map(|(scene, it)| format!(" ({} during {scene})", percent(it)));
                    let (mean, worst) = (percent(mean), worst.unwrap_or_default());
                    self.doubts.push(format!("{words} {mean} of a core{worst}"));
                }
                mean
            };
            let limit = OTHERS.max(OTHERS_OF_ALL * cores);
            let others = share(|span| span.others_s, limit, "other processes used");
            let stolen = share(|span| span.stolen_s, STOLEN, "the host took away");
            // A run too short for the system's clocks is judged by the load average.
            if seconds >= SHORTEST_S && others >= busiest {
                busiest = others;
                self.load = Load::Watched { seconds, others, stolen };
            }
        }
        // Older records have no spans. If a row's span is missing, the run was killed.
        let killed = !machines.is_empty() || timed.iter().any(|row| row.span.is_some());
        (unwatched > 0 && killed).then(|| {
            let rows = plural(unwatched, "row");
            format!("what else the machine did is not known of {rows} of {} timed", timed.len())
        })
    }

    fn before(&mut self, provenances: &[&Value]) {
        let load = |fields: &&Value| {
            fields.get("load_average")?.as_str()?.split(' ').next()?.parse::<f64>().ok()
        };
        let Some(load) = provenances.iter().filter_map(load).max_by(f64::total_cmp) else { return };
        self.load = Load::Before(load);
        if load >= LOAD {
            self.doubts.push(format!("the machine was busy before the run (load {load})"));
        }
    }
}

/// Returns the share of a core that other processes and the host took during a span, if it may have
/// changed times.
pub fn disturbance(span: &Span) -> Option<f64> {
    let share = (span.others_s + span.stolen_s) / span.seconds;
    let limit = OTHERS.max(OTHERS_OF_ALL * span.cores as f64);
    (span.seconds >= SHORTEST_S && share > limit).then_some(share)
}

fn worst<'a>(
    spans: impl Iterator<Item = &'a Span>,
    part: fn(&Span) -> f64,
    limit: f64,
) -> Option<(&'a str, f64)> {
    let long = spans.filter(|span| span.seconds >= SHORTEST_S);
    let shares = long.map(|span| (&*span.scene, part(span) / span.seconds));
    let much = shares.filter(|(_, share)| *share > IN_A_SCENE * limit);
    much.max_by(|a, b| a.1.total_cmp(&b.1))
}

/// Returns the values of a build property in the programs that ran our detectors; several values
/// mean that two builds took part.
fn said_by<'a>(timed: &[&Row], ledger: &'a Ledger, name: &str) -> BTreeSet<&'a str> {
    let ours = timed.iter().filter(|row| row.role != Role::Runner);
    let ids: BTreeSet<&String> = ours.filter_map(|row| row.process.as_ref()).collect();
    let processes = ids.into_iter().filter_map(|id| ledger.processes.get(id));
    processes.filter_map(|process| Some(process.build.get(name)?.as_str())).collect()
}

#[cfg(test)]
mod tests;
