//! The machines of a record: which are one, what each is called where there are several, and the
//! provenance of the whole.

use serde_json::{Value, json};

use crate::record::file;
use crate::record::merge::Part;

/// A machine, as far as a provenance describes it: the name alone may be that of many.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Machine {
    /// Its name.
    pub name: String,
    /// The processor's model.
    pub cpu: Option<String>,
    /// Its cores.
    pub cores: Option<u64>,
}

impl Machine {
    /// May the two be one? What is not known of one of them does not tell them apart.
    pub fn may_be(&self, other: &Machine) -> bool {
        let alike = |a: Option<&str>, b: Option<&str>| a.is_none() || b.is_none() || a == b;
        let cores = self.cores.is_none() || other.cores.is_none() || self.cores == other.cores;
        self.name == other.name && alike(self.cpu.as_deref(), other.cpu.as_deref()) && cores
    }
}

/// A name for every machine: its own; where another has it already, a number is added.
#[derive(Default)]
pub(super) struct Labels(Vec<(Machine, String)>);

impl Labels {
    /// The name of a part's machine in the whole.
    pub fn label(&mut self, part: &Part, name: &str) -> String {
        let machine = part.machine(name);
        if let Some((known, label)) = self.0.iter_mut().find(|(known, _)| known.may_be(&machine)) {
            // What is learnt of it tells later ones from it.
            known.cpu = known.cpu.take().or(machine.cpu);
            known.cores = known.cores.or(machine.cores);
            return label.clone();
        }
        let taken = |label: &str| self.0.iter().any(|(_, known)| known == label);
        let numbered = (2..).map(|k| format!("{name}-{k}"));
        let label = std::iter::once(name.to_string())
            .chain(numbered)
            .find(|label| !taken(label))
            .unwrap_or_default();
        self.0.push((machine, label.clone()));
        label
    }

    /// Of one machine it is that of the first folder; of several it has a list of them.
    pub fn provenance(&self, parts: &[Part]) -> Value {
        let mut all = match &self.0[..] {
            [] | [_] => parts
                .iter()
                .find_map(|part| part.provenance.clone())
                .filter(Value::is_object)
                .unwrap_or_else(|| json!({})),
            several => {
                let machines = several.iter().map(|(machine, label)| {
                    (
                        label.clone(),
                        json!({"name": machine.name, "cpu": machine.cpu, "cores": machine.cores}),
                    )
                });
                json!({"machines": machines.collect::<serde_json::Map<_, _>>()})
            }
        };
        let of = |name: &str| {
            let values = parts.iter().filter_map(|part| {
                Some(part.provenance.as_ref()?.get(name)?.as_str()?.to_string())
            });
            let mut values: Vec<String> = values.collect();
            values.sort();
            values.dedup();
            values
        };
        for name in ["revision", "profile", "contactbench", "rustc"] {
            match &of(name)[..] {
                [] => {}
                [one] => all[name] = json!(one),
                several => all[name] = json!(several.join(", ")),
            }
        }
        all["record_schema"] = json!(file::SCHEMA);
        all["merged_from"] =
            json!(parts.iter().map(|part| part.folder.display().to_string()).collect::<Vec<_>>());
        if let Some(fields) = all.as_object_mut() {
            fields.remove("shard");
        }
        all
    }
}
