//! The machines of a record: which descriptions mean the same machine, their names, and the
//! provenance of a merged record.

use std::collections::BTreeSet;
use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::record::folder::{copies, file};
use crate::record::merge::Part;
use crate::record::origin::hardware::Hardware;
use crate::record::origin::provenance;

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Machine {
    pub name: String,
    #[serde(flatten)]
    pub hardware: Hardware,
}

impl Machine {
    pub fn may_be(&self, other: &Machine) -> bool {
        self.name == other.name && self.hardware.may_be(&other.hardware)
    }
}

pub fn described(provenance: &Value) -> Vec<(String, Machine)> {
    let text = |fields: &Value, name: &str| Some(fields.get(name)?.as_str()?.to_string());
    let machine = |fields: &Value, label: &str| {
        // A merged record has `name` in a list, a single run has `host`; older records only have
        // the label.
        let name = text(fields, "host").or_else(|| text(fields, "name"));
        let hardware = serde_json::from_value(fields.clone()).unwrap_or_default();
        (label.to_string(), Machine { name: name.unwrap_or(label.into()), hardware })
    };
    let listed = provenance.get("machines").and_then(Value::as_object).into_iter().flatten();
    let own = text(provenance, "machine").map(|label| machine(provenance, &label));
    own.into_iter().chain(listed.map(|(label, fields)| machine(fields, label))).collect()
}

pub fn label_here(folder: &Path) -> String {
    let mut labels = Labels::default();
    for provenance in provenance::all(folder) {
        labels.0.extend(described(&provenance).into_iter().map(|(label, it)| (it, label)));
    }
    let name = provenance::machine();
    labels.label(Machine { name: name.clone(), hardware: Hardware::here() }, &name)
}

/// The label of every machine: its own name, with a number if the name is taken.
#[derive(Default)]
pub(crate) struct Labels(Vec<(Machine, String)>);

impl Labels {
    pub fn label(&mut self, machine: Machine, name: &str) -> String {
        // Processors of one name may differ in their caches, but rows of one label share a median.
        let is_same = |known: &Machine| {
            known.may_be(&machine) && known.hardware.caches == machine.hardware.caches
        };
        if let Some((_, label)) = self.0.iter().find(|(known, _)| is_same(known)) {
            return label.clone();
        }
        let taken = |label: &str| self.0.iter().any(|(_, known)| known == label);
        let numbered = |k| if k == 1 { name.to_string() } else { format!("{name}-{k}") };
        let label = (1..).map(numbered).find(|label| !taken(label)).unwrap_or_default();
        self.0.push((machine, label.clone()));
        label
    }

    /// Returns the provenance of the first folder if there is one machine; otherwise a list of the
    /// machines.
    pub fn provenance(&self, parts: &[Part]) -> Value {
        let mut all = match &self.0[..] {
            [] | [_] => parts
                .iter()
                .find_map(|part| part.provenance.clone())
                .filter(Value::is_object)
                .unwrap_or_else(|| json!({})),
            several => {
                let machines =
                    several.iter().map(|(machine, label)| (label.clone(), json!(machine)));
                json!({"machines": machines.collect::<serde_json::Map<_, _>>()})
            }
        };
        for name in ["revision", "profile", "contactbench", "rustc"] {
            let value = |part: &Part| Some(part.provenance.as_ref()?.get(name)?.as_str()?.into());
            let values: BTreeSet<String> = parts.iter().filter_map(value).collect();
            if !values.is_empty() {
                all[name] = json!(Vec::from_iter(values).join(", "));
            }
        }
        let copies = parts.iter().flat_map(|part| &part.experiments);
        all[copies::FIELD] = copies::field(copies.map(|(name, text)| (&**name, &**text)));
        all["record_schema"] = json!(file::SCHEMA);
        all["merged_from"] =
            json!(parts.iter().map(|part| part.folder.display().to_string()).collect::<Vec<_>>());
        if let Some(fields) = all.as_object_mut() {
            fields.remove("shard");
        }
        all
    }
}
