use std::collections::BTreeMap;
use std::io::Write;

use clap::ValueEnum;
use serde_json::{Map, Value, json};

use crate::cli::shared::terminal;
use contactbench_detectors::table::{self, TABLE};
use contactbench_detectors::tracker;
use contactbench_ground::contact::Arithmetic;
use contactbench_record::experiment::Experiment;
use contactbench_report::table::Table;
use contactbench_run::plan::builtin;
use contactbench_scenes::hard::{self, Case, Expect};
use contactbench_scenes::motion::MotionKind;
use contactbench_scenes::spec::{GENERATORS, Generator, Parameter};

#[derive(clap::Args)]
pub struct List {
    /// detectors, scenes, motions, trackers, experiments, hard-cases, ...
    #[arg(value_enum, hide_possible_values = true)]
    what: Option<What>,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

contactbench_terms::named! {
    /// The kinds of things that are listed, with the titles of their tables.
    #[derive(Clone, Copy, PartialEq, ValueEnum)]
    pub enum What {
        Detectors = "DETECTORS (N particles; nx, ny, nz cells per axis; memory in bytes; \
                     parameters with their values, the default first)",
        Arithmetics = "ARITHMETICS",
        Scenes = "SCENES (parameters with their defaults in 2D, 3D; lengths in diameters)",
        Motions = "MOTIONS (with speed=NUMBER, in diameters per frame, and seed=NUMBER)",
        Trackers = "TRACKERS (skins in diameters of the largest particle)",
        Experiments = "EXPERIMENTS (standard: those that run without a verb)",
        HardCases = "HARD CASES (in experiments: name = \"hard\", case = \"NAME\")",
    }
}

impl What {
    /// Returns the key in JSON.
    fn key(self) -> String {
        let value = self.to_possible_value();
        value.map_or(String::new(), |value| value.get_name().replace('-', "_"))
    }

    /// Returns the items of this kind as JSON, each with its name and fields.
    fn items(self) -> anyhow::Result<Vec<Value>> {
        Ok(match self {
            What::Detectors => TABLE.iter().map(detector).collect(),
            What::Arithmetics => Arithmetic::ALL.map(|it| summed(it.name(), it.summary())).into(),
            What::Scenes => GENERATORS.iter().map(scene).collect(),
            What::Motions => MotionKind::ALL.map(|it| summed(it.name(), it.summary())).into(),
            What::Trackers => tracker::FORMS.map(|(form, summary)| summed(form, summary)).into(),
            What::Experiments => builtin::all()?.iter().map(experiment).collect(),
            What::HardCases => hard::cases().map(hard_case).collect(),
        })
    }

    /// Returns a table with two columns: each name, and its lines with an empty line below.
    fn table(self) -> anyhow::Result<Table> {
        let (items, mut known) = (self.items()?, BTreeMap::new());
        let row = |item: &Value| {
            let name = item["name"].as_str().unwrap_or_default().to_string();
            let lines = lines(item, &name, &mut known);
            (name, lines)
        };
        let rows: Vec<_> = std::iter::once(&Value::Null).chain(&items).map(row).collect();
        let table = Table::of(self.name(), &rows);
        Ok(table.left("", |row| &*row.0).left("", |row| row.1.clone()).into())
    }
}

/// Returns the fields of a thing as lines for people: sentences first, then other fields with their
/// keys, and a line for each parameter. Parameters that an earlier thing has, too, share a line;
/// `known` has the lines of parameters and the first thing with each.
fn lines(item: &Value, thing: &str, known: &mut BTreeMap<String, String>) -> Vec<String> {
    const SENTENCES: [&str; 4] = ["summary", "title", "question", "reason"];
    fn words(value: &Value) -> String {
        let mut all: Vec<String> = match value {
            Value::String(text) => return text.clone(),
            Value::Array(all) => all.iter().map(words).collect(),
            // Values for 2D and 3D, which are often the same.
            Value::Object(all) => all.values().map(words).collect(),
            value => return value.to_string(),
        };
        all.dedup();
        all.join(", ")
    }
    let parameter = |it: &Value| {
        let values = it.get("defaults").unwrap_or(&it["values"]);
        format!("{} [{}]: {}", words(&it["name"]), words(values), words(&it["meaning"]))
    };
    let mut again: BTreeMap<String, Vec<String>> = BTreeMap::new();
    let mut lines: Vec<String> =
        SENTENCES.iter().filter_map(|key| item.get(key).map(words)).collect();
    let fields = item.as_object().into_iter().flatten();
    for (key, value) in fields.filter(|(key, _)| !SENTENCES.contains(&key.as_str())) {
        match (key.as_str(), value) {
            ("name", _) | (_, Value::Bool(false)) => {}
            ("parameters", Value::Array(all)) => {
                for it in all {
                    let line = parameter(it);
                    if let Some(of) = known.get(&line) {
                        again.entry(of.clone()).or_default().push(words(&it["name"]));
                    } else {
                        lines.push(line.clone());
                        known.insert(line, thing.into());
                    }
                }
            }
            (key, value) => lines.push(format!("{key}: {}", words(value))),
        }
    }
    let again = again.into_iter();
    lines.extend(again.map(|(first, names)| format!("as in {first}: {}", names.join(", "))));
    lines.push(String::new());
    lines
}

pub fn list(options: &List) -> anyhow::Result<()> {
    let mut out = terminal::out();
    // The hundred hard cases would hide the rest.
    let usual = || What::ALL.into_iter().filter(|what| *what != What::HardCases).collect();
    let wanted: Vec<What> = options.what.map_or_else(usual, |what| vec![what]);
    if options.json {
        let mut all = Map::new();
        for what in wanted {
            all.insert(what.key(), what.items()?.into());
        }
        terminal::json(&Value::Object(all))?;
    } else {
        for what in wanted {
            // Hard cases have long reasons, so they are wrapped even if the output is not a
            // terminal.
            let most = if what == What::HardCases { 100 } else { usize::MAX };
            writeln!(out, "{}", what.table()?.plain(terminal::width().min(most)))?;
        }
    }
    Ok(())
}

fn summed(name: &str, summary: &str) -> Value {
    json!({ "name": name, "summary": summary })
}

fn detector(it: &table::Entry) -> Value {
    let table::Entry { name, summary, cost, memory, limits, threads, .. } = *it;
    let parameter = |it: &table::Parameter| {
        let table::Parameter { name, meaning, values, .. } = *it;
        json!({ "name": name, "meaning": meaning, "values": values, "default": it.default() })
    };
    let parameters: Vec<Value> = it.parameters.iter().map(parameter).collect();
    json!({
        "name": name,
        "summary": summary,
        "cost": cost,
        "memory": memory,
        "limits": limits,
        "threads": threads,
        "parameters": parameters,
    })
}

fn scene(it: &Generator) -> Value {
    let Generator { name, summary, dims, .. } = *it;
    let parameter = |parameter: &Parameter| {
        let Parameter { name, meaning, .. } = *parameter;
        let default = |&dim: &u32| parameter.default[dim as usize - 2].to_string();
        let named = dims.iter().map(|dim| (format!("{dim}D"), default(dim)));
        let defaults: BTreeMap<String, String> = named.collect();
        json!({ "name": name, "meaning": meaning, "defaults": defaults })
    };
    let parameters: Vec<Value> = it.params().map(parameter).collect();
    json!({ "name": name, "summary": summary, "dims": dims, "parameters": parameters })
}

fn experiment(it: &Experiment) -> Value {
    let Experiment { name, title, question, standard, detectors, .. } = it;
    json!({
        "name": name,
        "title": title,
        "question": question,
        "standard": standard,
        "detectors": detectors,
    })
}

fn hard_case(it: &Case) -> Value {
    let Case { name, group, dims, reason, source, .. } = *it;
    let contacts = match it.expect {
        Expect::Contacts(contacts) => {
            let of_dim = |dim: &u32| (format!("{dim}D"), contacts[usize::from(*dim == 3)]);
            json!(dims.iter().map(of_dim).collect::<BTreeMap<_, _>>())
        }
        Expect::Oracle => json!("by the exact test of all pairs"),
        Expect::Invalid => json!("must be refused"),
    };
    json!({
        "name": name,
        "group": group,
        "dims": dims,
        "contacts": contacts,
        "reason": reason,
        "source": source,
    })
}
