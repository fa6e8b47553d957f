//! One row of the record: one measurement. docs/RECORD.md describes the fields and columns, and
//! tests compare it with the tables below.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use serde_json::json;

pub use crate::record::folder::file::{FILE, Record, SCHEMA, Writer, exists, read, unpacked};
use crate::record::id::CellId;
pub use crate::record::outcome::{Outcome, Pass};
use crate::record::possible::{self, Sampled};
use crate::record::role::Role;
use crate::stats::interval::Block;
use contactbench_terms::errors::{Causes, Errors};
use contactbench_terms::moved::Moved;
use contactbench_terms::must;
use contactbench_terms::scene::Stats;

/// A field that is a column: name, pass (`None` if every pass records it), unit, value.
pub(super) type Field<T> = (&'static str, Option<Pass>, &'static str, fn(&T) -> Option<f64>);

/// Defines a struct that is a part of a row. A field declared with `= pass, unit` is also a column.
/// Fields after `@known` are written only if they have a value.
macro_rules! table {
    (
        $(#[$meta:meta])* $name:ident {
            $($(#[$attribute:meta])* $field:ident: $type:ty $(= $pass:expr, $unit:literal)?;)*
            $(@known $($(#[$doc:meta])* $some:ident: $kind:ty $(= $by:expr, $in:literal)?;)*)?
        }
    ) => {
        $(#[$meta])*
        #[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
        pub struct $name {
            $($(#[$attribute])* pub $field: $type,)*
            $($(
                $(#[$doc])*
                #[serde(skip_serializing_if = "Option::is_none")]
                pub $some: Option<$kind>,
            )*)?
        }

        impl $name {
            pub(super) const COLUMNS: &[Field<$name>] = &[
                $($((stringify!($field), $pass, $unit, |it| json!(it.$field).as_f64()),)?)*
                $($($((stringify!($some), $by, $in, |it| json!(it.$some).as_f64()),)?)*)?
            ];

            #[cfg(test)]
            const FIELDS: &[&str] = &[$(stringify!($field),)* $($(stringify!($some),)*)?];
        }
    };
}

const TIME: Option<Pass> = Some(Pass::Time);
const MEMORY: Option<Pass> = Some(Pass::Memory);

table! {
    Row {
        #[serde(flatten)]
        id: CellId;
        role: Role;
        pass: Pass;
        block: u32;
        time_ns: Option<u64> = TIME, "ns";
        first_ns: Option<u64> = TIME, "ns";
        calls: Option<u64>;
        elapsed_ns: Option<u64>;
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        rounds_ns: Vec<u64>;
        outcome: Outcome;
        reason: String;
        contacts: Option<u64> = None, "pairs";
        digest: Option<String>;
        counts: BTreeMap<String, u64>;
        peak_bytes: Option<u64> = MEMORY, "bytes";
        live_bytes: Option<u64> = MEMORY, "bytes";
        allocations: Option<u64> = MEMORY, "";
        warm_allocations: Option<u64> = MEMORY, "";
        formula_bytes: Option<u64> = MEMORY, "bytes";
        errors: Option<Errors>;
        causes: Option<Causes>;
        stats: Stats;
        @known
        building_ns: u64 = TIME, "ns";
        median_step_ns: u64 = TIME, "ns";
        worst_step_ns: u64 = TIME, "ns";
        pulse_ns: u64 = TIME, "ns";
        alone_ns: u64;
        processor: u32;
        began_ms: u64;
        course: Course;
        moved: Moved;
        process: String;
        span: String;
    }
}

table! {
    /// Numbers of a tracker over all frames: rebuilds and missed contacts; see `Builds` and `Late`
    /// of the run crate.
    #[derive(Copy)]
    Course {
        builds: u64 = None, "frames";
        dangerous: u64 = None, "frames";
        dangerous_rightly: u64 = None, "frames";
        missing_builds: u64 = None, "frames";
        listed: u64 = None, "pairs";
        wrong_frames: u64 = None, "frames";
        worst_missed: u64 = None, "pairs";
        never: u64 = None, "pairs";
        latest: u64 = None, "frames";
        deepest_late: f64 = None, "mean radii";
        first_wrong: Option<u64> = None, "frame";
    }
}

#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Measurement {
    pub id: CellId,
    pub pass: Pass,
    pub block: u32,
}

impl Row {
    pub fn true_contacts(&self) -> f64 {
        let moving = self.moved.as_ref().map(|moved| moved.contacts as f64);
        moving.unwrap_or_else(|| self.stats.true_contacts(self.id.n))
    }

    pub fn measurement(&self) -> Measurement {
        Measurement { id: self.id.clone(), pass: self.pass, block: self.block }
    }

    /// The measurement, on any machine.
    pub fn anywhere(&self) -> Measurement {
        Measurement { id: self.id.clone().anywhere(), ..self.measurement() }
    }

    /// Fails if a number of the row is impossible. The row was measured within this many
    /// nanoseconds.
    pub fn possible(&self, within_ns: u64) -> Result<(), String> {
        let CellId { experiment, scene, machine, order, arithmetic, detector, .. } = &self.id;
        let names = [experiment, scene, order, arithmetic, detector].into_iter().chain(machine);
        let (length, most) = (names.map(String::len).max().unwrap_or(0), possible::LONGEST_NAME);
        must!(length <= most, "a name has {length} bytes: at most {most} are possible");
        possible::bounded("block", Some(self.block.into()))?;
        possible::bounded("pulse_ns", self.pulse_ns)?;
        let frames = self.moved.as_ref().map_or(1, |moved| moved.frames);
        possible::counts(&self.counts, self.contacts.unwrap_or(0), self.id.n, frames)?;
        possible::memory(self.peak_bytes.unwrap_or(0), self.live_bytes.unwrap_or(0))?;
        self.consistent()?;
        let (first_ns, building_ns) = (self.first_ns, self.building_ns);
        match (self.time_ns, self.calls, self.elapsed_ns) {
            // The time of copies is their harmonic mean.
            (Some(time_ns), Some(calls), Some(elapsed_ns)) if self.pass == Pass::Time => {
                Sampled { time_ns, calls, elapsed_ns, first_ns, building_ns, within_ns }.check()
            }
            _ => possible::bounded("time_ns", self.time_ns),
        }
    }

    /// Fails if the outcome contradicts the other fields.
    fn consistent(&self) -> Result<(), String> {
        let (outcome, timed) = (self.outcome.name(), self.time_ns.is_some());
        must!(
            !timed || self.pass != Pass::Time || self.calls.is_some() && self.elapsed_ns.is_some(),
            "it has time_ns, but not calls and elapsed_ns"
        );
        must!(!timed || !self.outcome.is_final(), "it has time_ns, but its outcome is {outcome}");
        if self.outcome != Outcome::Ok {
            return Ok(());
        }
        must!(self.role != Role::Nothing, "its outcome is ok, but its role is 'nothing'");
        let wrong = self.causes.as_ref().is_some_and(|causes| causes.search != Errors::default());
        must!(!wrong, "its outcome is ok, but its search is wrong");
        // Runners need not count or measure memory; their rows then have no answer.
        let is_empty = !timed && self.peak_bytes.is_none() && self.counts.is_empty();
        must!(is_empty || self.digest.is_some(), "its outcome is ok, but it has no digest");
        let is_idle = self.pass == Pass::Count && self.counts.is_empty();
        must!(
            !is_idle || self.role != Role::Detector || self.contacts == Some(0),
            "its outcome is ok, but it has no counts"
        );
        let (contacts, exact) = (self.contacts.map(|it| it as f64), self.true_contacts());
        must!(
            self.id.arithmetic != "exact" || contacts.is_none_or(|contacts| contacts == exact),
            "its outcome is ok, but its contacts are not the {exact} of its coordination and n"
        );
        Ok(())
    }

    /// The block and span of the row. Rows of one block are paired only within one span; a resumed
    /// run has new spans.
    pub fn timed_in(&self) -> Block {
        let span = self.span.as_deref().and_then(|id| u32::from_str_radix(id, 16).ok());
        Block { number: self.block, span: span.unwrap_or(0) }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use contactbench_terms::moved::Displacements;

    fn fields(value: impl Serialize) -> Vec<String> {
        let value = serde_json::to_value(value).unwrap();
        value.as_object().unwrap().keys().cloned().collect()
    }

    #[test]
    fn the_page_on_the_record_names_every_field() {
        let page = include_str!("../../../../docs/RECORD.md");
        let lines = page.split("\n## Columns\n").next().into_iter().flat_map(str::lines);
        let cells = lines.filter_map(|line| line.strip_prefix("| ")?.split(" | ").next());
        let names = cells.flat_map(|cell| cell.split('`').skip(1).step_by(2));
        let documented: BTreeSet<String> = names.map(String::from).collect();
        let mut known: BTreeSet<String> =
            ["schema", crate::record::folder::seal::NAME].map(String::from).into();
        let of = |names: &[&str]| names.iter().map(|name| name.to_string()).collect();
        let params = [(String::new(), 0u64.into())];
        let id = CellId {
            machine: Some(String::new()),
            detector_params: params.into(),
            ..CellId::default()
        };
        for (part, names) in [
            ("", fields(id)),
            ("", of(Row::FIELDS)),
            ("stats.", fields(Stats::default())),
            ("errors.", fields(Errors::default())),
            ("causes.", fields(Causes::default())),
            ("course.", of(Course::FIELDS)),
            ("moved.", fields(Moved::default())),
            ("moved.way.", fields(Displacements::default())),
        ] {
            known.extend(names.iter().map(|name| format!("{part}{name}")));
        }
        assert!(known.remove("id") && known.remove("moved.way"));
        assert_eq!(documented, known);
        assert!(page.contains(&format!("**schema {SCHEMA}**")));
    }
}
