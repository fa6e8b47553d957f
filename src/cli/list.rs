//! `contactbench list`.

use std::io::Write;
use std::process::ExitCode;

use serde_json::{Map, Value, json};

use crate::cli::shared::terminal;
use crate::contact::Arithmetic;
use crate::detect::peers::PEERS;
use crate::detect::table::{self, TABLE};
use crate::experiment::builtin;
use crate::present::table::{Cell, Column, Table};
use crate::scene::hard::{self, Case, Expect};
use crate::scene::motion::Kind;
use crate::scene::spec::{GENERATORS, Parameter};
use crate::track;

/// Options of `list`.
#[derive(clap::Args)]
pub struct List {
    /// What to list (default: everything)
    #[arg(value_enum)]
    what: Option<What>,
    /// Print JSON instead of tables
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, PartialEq, clap::ValueEnum)]
enum What {
    /// With cost, memory and limits
    Detectors,
    /// How scenes are stored and contacts decided
    Arithmetics,
    /// Generators with their parameters
    Scenes,
    /// Ways in which a scene moves (contactbench track)
    Motions,
    /// Lists of near pairs, and the rules by which they are built again
    Trackers,
    /// With their questions
    Experiments,
    /// Scenes on which detectors go wrong, with the reason and its source (only when asked for)
    HardCases,
}

impl What {
    /// A hundred hard cases would bury the rest: they are not among these.
    const USUAL: [What; 6] = [
        What::Detectors,
        What::Arithmetics,
        What::Scenes,
        What::Motions,
        What::Trackers,
        What::Experiments,
    ];

    /// Its name in JSON.
    fn name(self) -> &'static str {
        match self {
            What::Detectors => "detectors",
            What::Arithmetics => "arithmetics",
            What::Scenes => "scenes",
            What::Motions => "motions",
            What::Trackers => "trackers",
            What::Experiments => "experiments",
            What::HardCases => "hard_cases",
        }
    }

    fn table(self) -> anyhow::Result<Table> {
        Ok(match self {
            What::Detectors => detectors(),
            What::Arithmetics => arithmetics(),
            What::Scenes => scenes(),
            What::Motions => motions(),
            What::Trackers => trackers(),
            What::Experiments => experiments()?,
            What::HardCases => hard_cases(),
        })
    }

    fn json(self) -> anyhow::Result<Value> {
        Ok(match self {
            What::Detectors => TABLE.iter().map(detector_json).collect(),
            What::Arithmetics => Arithmetic::ALL
                .iter()
                .map(|it| json!({ "name": it.name(), "summary": it.summary() }))
                .collect(),
            What::Scenes => scenes_json(),
            What::Motions => Kind::ALL
                .iter()
                .map(|it| json!({ "name": it.name(), "summary": it.summary() }))
                .collect(),
            What::Trackers => track::FORMS
                .iter()
                .map(|(form, summary)| json!({ "name": form, "summary": summary }))
                .collect(),
            What::Experiments => builtin::all()?
                .iter()
                .map(|it| {
                    json!({
                        "name": it.name,
                        "title": it.title,
                        "question": it.question,
                        "standard": it.standard,
                        "detectors": it.detectors,
                    })
                })
                .collect(),
            What::HardCases => hard::cases().map(hard_case_json).collect(),
        })
    }
}

/// Prints the tables.
pub fn list(options: &List) -> anyhow::Result<ExitCode> {
    let mut out = terminal::out();
    let wanted = options.what.map_or(What::USUAL.to_vec(), |what| vec![what]);
    if options.json {
        let mut all = Map::new();
        for what in wanted {
            all.insert(what.name().into(), what.json()?);
        }
        terminal::json(&Value::Object(all))?;
    } else {
        for what in wanted {
            // Reasons are long: wrapped for the eye wherever they go.
            let most = if what == What::HardCases { 100 } else { usize::MAX };
            writeln!(out, "{}", what.table()?.plain(terminal::width().min(most)))?;
        }
    }
    Ok(ExitCode::SUCCESS)
}

/// A name and the lines on it, with an empty line after them.
fn entry(name: impl Into<String>, lines: impl IntoIterator<Item = String>) -> Vec<Cell> {
    let lines = lines.into_iter().chain([String::new()]).collect();
    vec![Cell::from(name.into()), Cell::lines(lines)]
}

fn titled(title: &str, rows: impl IntoIterator<Item = Vec<Cell>>) -> Table {
    let rows = std::iter::once(entry("", [])).chain(rows);
    Table::new(title, ["", ""].map(Column::left).into()).with(rows)
}

fn dims(dims: &[u32]) -> String {
    dims.iter().map(|dim| format!("{dim}D")).collect::<Vec<_>>().join(", ")
}

fn detectors() -> Table {
    let row = |it: &table::Entry| {
        let parameter = |it: &table::Parameter| {
            format!("{} [{}]: {}", it.name, it.values.join(", "), it.meaning)
        };
        let about = [
            it.summary.to_string(),
            format!("cost: {}; memory: {}", it.cost, it.memory),
            format!("limits: {}", it.limits),
        ];
        entry(it.name, about.into_iter().chain(it.parameters.iter().map(parameter)))
    };
    let names = PEERS.map(|peer| peer.name).join(", ");
    let libraries = format!("libraries, with the cargo feature peers: {names}");
    let more = (!cfg!(feature = "peers")).then(|| entry("", [libraries]));
    titled(
        "DETECTORS (N particles; nx, ny, nz cells per axis; memory in bytes; parameters with \
         their values, the default first)",
        TABLE.iter().map(row).chain(more),
    )
}

fn detector_json(it: &table::Entry) -> Value {
    let parameter = |it: &table::Parameter| {
        json!({
            "name": it.name,
            "meaning": it.meaning,
            "values": it.values,
            "default": it.default(),
        })
    };
    json!({
        "name": it.name,
        "summary": it.summary,
        "cost": it.cost,
        "memory": it.memory,
        "limits": it.limits,
        "threads": it.threads,
        "parameters": it.parameters.iter().map(parameter).collect::<Vec<_>>(),
    })
}

fn arithmetics() -> Table {
    let row = |it: Arithmetic| entry(it.name(), [it.summary().to_string()]);
    titled("ARITHMETICS", Arithmetic::ALL.into_iter().map(row))
}

fn motions() -> Table {
    let row = |it: Kind| entry(it.name(), [it.summary().to_string()]);
    titled(
        "MOTIONS (with speed=NUMBER, in diameters per frame, and seed=NUMBER)",
        Kind::ALL.map(row),
    )
}

fn trackers() -> Table {
    let row = |&(form, summary): &(&str, &str)| entry(form, [summary.to_string()]);
    titled("TRACKERS (skins in diameters of the largest body)", track::FORMS.iter().map(row))
}

/// The default of a generator's parameter in 2D or 3D.
fn default(parameter: &Parameter, dim: u32) -> String {
    parameter.default[dim as usize - 2].to_string()
}

fn scenes() -> Table {
    let rows = GENERATORS.iter().map(|it| {
        let parameter = |parameter: &Parameter| {
            let mut defaults: Vec<String> =
                it.dims.iter().map(|&dim| default(parameter, dim)).collect();
            defaults.dedup();
            format!("{} [{}]: {}", parameter.name, defaults.join(", "), parameter.meaning)
        };
        let summary = format!("{} ({})", it.summary, dims(it.dims));
        entry(it.name, [summary].into_iter().chain(it.params.iter().map(parameter)))
    });
    titled("SCENES (parameters with their defaults in 2D, 3D; lengths in diameters)", rows)
}

fn scenes_json() -> Value {
    let scene = GENERATORS.iter().map(|it| {
        let parameter = |parameter: &Parameter| {
            let defaults = it.dims.iter().map(|&dim| (format!("{dim}D"), default(parameter, dim)));
            json!({
                "name": parameter.name,
                "meaning": parameter.meaning,
                "defaults": defaults.collect::<std::collections::BTreeMap<_, _>>(),
            })
        };
        json!({
            "name": it.name,
            "summary": it.summary,
            "dims": it.dims,
            "parameters": it.params.iter().map(parameter).collect::<Vec<_>>(),
        })
    });
    scene.collect()
}

fn experiments() -> anyhow::Result<Table> {
    let all = builtin::all()?;
    let rows = all.iter().map(|it| {
        let mark = if it.standard { "*" } else { "" };
        entry(format!("{mark}{}", it.name), [it.title.clone(), it.question.clone()])
    });
    Ok(titled("EXPERIMENTS (* part of the standard reproduction)", rows))
}

fn hard_cases() -> Table {
    let rows = hard::cases().map(|case| {
        let contacts = match case.expect {
            Expect::Contacts(contacts) => {
                let contacts =
                    case.dims.iter().map(|&dim| contacts[usize::from(dim == 3)].to_string());
                format!("contacts: {}", contacts.collect::<Vec<_>>().join(", "))
            }
            Expect::Oracle => "contacts: by the exact test of all pairs".into(),
            Expect::Invalid => "must be refused".into(),
        };
        let about = format!("{}, {}; {contacts}", case.group.name(), dims(case.dims));
        entry(case.name, [about, case.reason.into(), format!("source: {}", case.source)])
    });
    titled("HARD CASES (in experiments: name = \"hard\", case = \"NAME\")", rows)
}

fn hard_case_json(case: &Case) -> Value {
    let contacts = match case.expect {
        Expect::Contacts(contacts) => {
            let of_dim = |dim: &u32| (format!("{dim}D"), contacts[usize::from(*dim == 3)].into());
            Value::Object(case.dims.iter().map(of_dim).collect())
        }
        Expect::Oracle => "by the exact test of all pairs".into(),
        Expect::Invalid => "must be refused".into(),
    };
    json!({
        "name": case.name,
        "group": case.group.name(),
        "dims": case.dims,
        "contacts": contacts,
        "reason": case.reason,
        "source": case.source,
    })
}
