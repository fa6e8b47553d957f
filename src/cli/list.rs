use std::collections::BTreeMap;
use std::io::Write;
use std::process::ExitCode;

use clap::ValueEnum;
use serde_json::{Map, Value, json};

use crate::cli::shared::terminal;
use contactbench_detectors::table;
use contactbench_detectors::table::TABLE;
use contactbench_detectors::tracker;
use contactbench_ground::contact::Arithmetic;
use contactbench_record::experiment::Experiment;
use contactbench_report::table::Table;
use contactbench_run::plan::builtin;
use contactbench_scenes::hard::{self, Case, Expect};
use contactbench_scenes::motion::Kind;
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
        Experiments = "EXPERIMENTS (* part of the standard reproduction)",
        HardCases = "HARD CASES (in experiments: name = \"hard\", case = \"NAME\")",
    }
}

/// A listed thing, as lines for people and as JSON.
struct Item {
    name: String,
    lines: Vec<String>,
    json: Value,
}

impl What {
    /// Returns the key in JSON.
    fn key(self) -> String {
        let value = self.to_possible_value();
        value.map_or(String::new(), |value| value.get_name().replace('-', "_"))
    }

    fn items(self) -> anyhow::Result<Vec<Item>> {
        Ok(match self {
            What::Detectors => TABLE.iter().map(detector).collect(),
            What::Arithmetics => Arithmetic::ALL.map(|it| summed(it.name(), it.summary())).into(),
            What::Scenes => GENERATORS.iter().map(scene).collect(),
            What::Motions => Kind::ALL.map(|it| summed(it.name(), it.summary())).into(),
            What::Trackers => tracker::FORMS.map(|(form, summary)| summed(form, summary)).into(),
            What::Experiments => builtin::all()?.iter().map(experiment).collect(),
            What::HardCases => hard::cases().map(hard_case).collect(),
        })
    }

    /// Returns a table with two columns: each name, and its lines with an empty line below.
    fn table(self) -> anyhow::Result<Table> {
        let rows: Vec<(String, Vec<String>)> = std::iter::once((String::new(), Vec::new()))
            .chain(self.items()?.into_iter().map(|Item { name, lines, .. }| (name, lines)))
            .collect();
        let lines = |lines: &[String]| [lines, &[String::new()]].concat();
        let table = Table::of(self.name(), &rows).left("", |row| row.0.as_str());
        Ok(table.left("", |row| lines(&row.1)).into())
    }
}

pub fn list(options: &List) -> anyhow::Result<ExitCode> {
    let mut out = terminal::out();
    // The hundred hard cases would hide the rest.
    let usual = || What::ALL.into_iter().filter(|what| *what != What::HardCases).collect();
    let wanted: Vec<What> = options.what.map_or_else(usual, |what| vec![what]);
    if options.json {
        let mut all = Map::new();
        for what in wanted {
            let items = what.items()?.into_iter().map(|item| item.json);
            all.insert(what.key(), items.collect());
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
    Ok(ExitCode::SUCCESS)
}

fn summed(name: &str, summary: &str) -> Item {
    let json = json!({ "name": name, "summary": summary });
    Item { name: name.into(), lines: vec![summary.into()], json }
}

fn dims(dims: &[u32]) -> String {
    dims.iter().map(|dim| format!("{dim}D")).collect::<Vec<_>>().join(", ")
}

fn detector(it: &table::Entry) -> Item {
    let table::Entry { name, summary, cost, memory, limits, threads, .. } = *it;
    let about =
        [summary.into(), format!("cost: {cost}; memory: {memory}"), format!("limits: {limits}")];
    let (lines, parameters): (Vec<String>, Vec<Value>) = it
        .parameters
        .iter()
        .map(|it| {
            let table::Parameter { name, meaning, values, .. } = *it;
            let default = it.default();
            let json = json!({
                "name": name, "meaning": meaning, "values": values, "default": default,
            });
            (format!("{name} [{}]: {meaning}", values.join(", ")), json)
        })
        .unzip();
    let json = json!({
        "name": name,
        "summary": summary,
        "cost": cost,
        "memory": memory,
        "limits": limits,
        "threads": threads,
        "parameters": parameters,
    });
    Item { name: name.into(), lines: about.into_iter().chain(lines).collect(), json }
}

fn scene(it: &Generator) -> Item {
    let Generator { name, summary, dims, .. } = *it;
    let parameter = |parameter: &Parameter| {
        let Parameter { name, meaning, .. } = *parameter;
        let default = |&dim: &u32| parameter.default[dim as usize - 2].to_string();
        let mut values: Vec<String> = dims.iter().map(default).collect();
        let named = dims.iter().map(|dim| (format!("{dim}D"), default(dim)));
        let defaults: BTreeMap<String, String> = named.collect();
        values.dedup();
        let json = json!({ "name": name, "meaning": meaning, "defaults": defaults });
        (format!("{name} [{}]: {meaning}", values.join(", ")), json)
    };
    let (lines, parameters): (Vec<String>, Vec<Value>) = it.params().map(parameter).unzip();
    let json = json!({ "name": name, "summary": summary, "dims": dims, "parameters": parameters });
    let summary = format!("{summary} ({})", self::dims(dims));
    Item { name: name.into(), lines: std::iter::once(summary).chain(lines).collect(), json }
}

fn experiment(it: &Experiment) -> Item {
    let Experiment { name, title, question, standard, detectors, .. } = it;
    let mark = if *standard { "*" } else { "" };
    let json = json!({
        "name": name,
        "title": title,
        "question": question,
        "standard": standard,
        "detectors": detectors,
    });
    Item { name: format!("{mark}{name}"), lines: vec![title.clone(), question.clone()], json }
}

fn hard_case(it: &Case) -> Item {
    let Case { name, group, dims, reason, source, .. } = *it;
    let (contacts, known) = match it.expect {
        Expect::Contacts(contacts) => {
            let of_dim = |&dim: &u32| contacts[usize::from(dim == 3)];
            let words: Vec<String> = dims.iter().map(|dim| of_dim(dim).to_string()).collect();
            let known = dims.iter().map(|dim| (format!("{dim}D"), of_dim(dim)));
            (format!("contacts: {}", words.join(", ")), json!(known.collect::<BTreeMap<_, _>>()))
        }
        Expect::Oracle => {
            let words = "by the exact test of all pairs";
            (format!("contacts: {words}"), json!(words))
        }
        Expect::Invalid => ("must be refused".into(), json!("must be refused")),
    };
    let json = json!({
        "name": name,
        "group": group,
        "dims": dims,
        "contacts": known,
        "reason": reason,
        "source": source,
    });
    let about = format!("{group}, {}; {contacts}", self::dims(dims));
    Item { name: name.into(), lines: vec![about, reason.into(), format!("source: {source}")], json }
}
