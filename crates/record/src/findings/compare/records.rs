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

pub fn two_machines(parts: [&Part; 2]) -> Option<[Machine; 2]> {
    // A merged record may add a label to the machine's own name.
    let named = |(name, machine): (String, Machine)| Machine { name, ..machine };
    together(parts).into_iter().find(|[a, b]| !a.1.may_be(&b.1)).map(|both| both.map(named))
}

/// Whether two machines are taken for one although only one record states their cache sizes.
pub fn caches_of_one(parts: [&Part; 2]) -> bool {
    let unknown = |machine: &Machine| machine.hardware.caches.is_empty();
    together(parts).iter().any(|[a, b]| a.1.may_be(&b.1) && unknown(&a.1) != unknown(&b.1))
}

/// Returns the machines to compare, with their names in the rows: the only machine of each record,
/// or machines of equal name.
fn together(parts: [&Part; 2]) -> Vec<[(String, Machine); 2]> {
    let names = parts.map(machines);
    let both = |a: &String, b: &String| {
        [(a.clone(), parts[0].machine(a)), (b.clone(), parts[1].machine(b))]
    };
    match names.each_ref().map(|names| (names.len(), names.first())) {
        [(1, Some(a)), (1, Some(b))] => vec![both(a, b)],
        _ => names[0].intersection(&names[1]).map(|name| both(name, name)).collect(),
    }
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
