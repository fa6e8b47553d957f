//! Machines and builds of two records, and the rows that can be compared.

use std::collections::BTreeSet;

use anyhow::ensure;
use serde_json::Value;

use crate::record::merge::Part;
use crate::record::origin::machines::Machine;
use crate::record::row::Row;

pub fn machines(part: &Part) -> BTreeSet<String> {
    part.rows.iter().map(|row| row.id.machine.clone().unwrap_or_default()).collect()
}

pub fn detectors(part: &Part) -> BTreeSet<String> {
    part.rows.iter().map(|row| row.id.subject()).collect()
}

/// Returns the rows to compare. If a record has several machines, these are the rows of machines in
/// both records. Fails if there are none.
pub fn common(parts: [&Part; 2]) -> anyhow::Result<[Vec<Row>; 2]> {
    let names = parts.map(machines);
    if names.iter().all(|names| names.len() == 1) {
        return Ok(parts.map(|part| part.rows.clone()));
    }
    let both: BTreeSet<&String> = names[0].intersection(&names[1]).collect();
    let list = |names: &BTreeSet<String>| names.iter().cloned().collect::<Vec<_>>().join(", ");
    ensure!(
        !both.is_empty(),
        "{} is of the machines {}, {} of {}: compare folders of one machine each, or of the same",
        parts[0].folder.display(),
        list(&names[0]),
        parts[1].folder.display(),
        list(&names[1])
    );
    let in_both = |row: &&Row| row.id.machine.as_ref().is_some_and(|name| both.contains(name));
    let kept = |part: &Part| part.rows.iter().filter(in_both).cloned().collect();
    Ok(parts.map(kept))
}

/// Returns the first two machines that differ, of the only machine of each record or of machines of
/// equal name. Names are those of the machines, to which a merged record may add a label.
pub fn two_machines(parts: [&Part; 2]) -> Option<[Machine; 2]> {
    let names = parts.map(machines);
    let pairs: Vec<[&String; 2]> = match names.each_ref().map(|it| (it.len(), it.first())) {
        [(1, Some(a)), (1, Some(b))] => vec![[a, b]],
        _ => names[0].intersection(&names[1]).map(|name| [name, name]).collect(),
    };
    let both = pairs.into_iter().map(|[a, b]| [parts[0].machine(a), parts[1].machine(b)]);
    both.into_iter().find(|[a, b]| !a.may_be(b))
}

pub fn two_builds(parts: [&Part; 2]) -> Option<[String; 2]> {
    let profile = |part: &Part| field(part, "profile").as_str().map(String::from);
    let [a, b] = parts.map(profile);
    Some([a?, b?]).filter(|[a, b]| a != b)
}

pub fn field(part: &Part, name: &str) -> Value {
    let fields = part.provenance.as_ref();
    fields.and_then(|fields| fields.get(name)).cloned().unwrap_or(Value::Null)
}
