//! `contactbench list`.

use std::io::Write;
use std::process::ExitCode;

use serde_json::{Value, json};

use crate::analyse::text::wrap;
use crate::contact::Arithmetic;
use crate::detect::peers::PEERS;
use crate::detect::table::{Entry, TABLE};
use crate::harness::builtin;
use crate::harness::experiment::Experiment;
use crate::scene::hard::{self, Expect};
use crate::scene::spec::{GENERATORS, Generator, Parameter};

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
    /// With their questions
    Experiments,
    /// Scenes on which detectors go wrong, with the reason and its source (only when asked for)
    HardCases,
}

/// Prints the tables.
pub fn list(options: &List) -> anyhow::Result<ExitCode> {
    let mut out = std::io::stdout().lock();
    let wanted = |what| options.what.is_none_or(|chosen| chosen == what);
    if options.json {
        writeln!(out, "{}", serde_json::to_string_pretty(&as_json(options.what, wanted)?)?)?;
        return Ok(ExitCode::SUCCESS);
    }
    if wanted(What::Detectors) {
        writeln!(out, "DETECTORS (N elements; nx, ny, nz cells per axis; memory in bytes)\n")?;
        for entry in TABLE {
            writeln!(out, "  {:<12} {}", entry.name, entry.summary)?;
            writeln!(out, "  {:<12} cost: {}; memory: {}", "", entry.cost, entry.memory)?;
            writeln!(out, "  {:<12} limits: {}\n", "", entry.limits)?;
        }
        if !cfg!(feature = "peers") {
            let names = PEERS.map(|peer| peer.name).join(", ");
            writeln!(out, "  with the cargo feature peers also libraries: {names}\n")?;
        }
    }
    if wanted(What::Arithmetics) {
        writeln!(out, "ARITHMETICS\n")?;
        for arithmetic in Arithmetic::ALL {
            writeln!(out, "  {:<12} {}", arithmetic.name(), arithmetic.summary())?;
        }
        writeln!(out)?;
    }
    if wanted(What::Scenes) {
        writeln!(out, "SCENES (parameters with their defaults in 2D, 3D; lengths in diameters)\n")?;
        for generator in &GENERATORS {
            let dims: Vec<String> = generator.dims.iter().map(|dim| format!("{dim}D")).collect();
            writeln!(out, "  {:<12} {} ({})", generator.name, generator.summary, dims.join(", "))?;
            for parameter in generator.params {
                let mut defaults: Vec<String> = generator.dims.iter().map(|dim| parameter.default[*dim as usize - 2].to_string()).collect();
                defaults.dedup();
                writeln!(out, "  {:<12}   {:<12} {} [{}]", "", parameter.name, parameter.meaning, defaults.join(", "))?;
            }
            writeln!(out)?;
        }
    }
    if wanted(What::Experiments) {
        writeln!(out, "EXPERIMENTS (* part of the standard reproduction)\n")?;
        for experiment in builtin::all()? {
            writeln!(out, "  {}{:<20} {}", if experiment.standard { "*" } else { " " }, experiment.name, experiment.title)?;
            writeln!(out, "   {:<20} {}\n", "", experiment.question)?;
        }
    }
    // A hundred cases would bury the rest.
    if options.what == Some(What::HardCases) {
        hard_cases(&mut out)?;
    }
    Ok(ExitCode::SUCCESS)
}

/// The same as an object with a list for each table.
fn as_json(what: Option<What>, wanted: impl Fn(What) -> bool) -> anyhow::Result<Value> {
    let mut all = serde_json::Map::new();
    if wanted(What::Detectors) {
        let of = |entry: &Entry| {
            json!({"name": entry.name, "summary": entry.summary, "cost": entry.cost, "memory": entry.memory, "limits": entry.limits,
                "threads": entry.threads})
        };
        all.insert("detectors".into(), TABLE.iter().map(of).collect());
    }
    if wanted(What::Arithmetics) {
        let of = |arithmetic: Arithmetic| json!({"name": arithmetic.name(), "summary": arithmetic.summary()});
        all.insert("arithmetics".into(), Arithmetic::ALL.into_iter().map(of).collect());
    }
    if wanted(What::Scenes) {
        let of = |generator: &Generator| {
            let parameter = |parameter: &Parameter| {
                let of = |dim: &u32| (format!("{dim}D"), Value::from(parameter.default[*dim as usize - 2].to_string()));
                let defaults: serde_json::Map<String, Value> = generator.dims.iter().map(of).collect();
                json!({"name": parameter.name, "meaning": parameter.meaning, "defaults": defaults})
            };
            let params: Vec<Value> = generator.params.iter().map(parameter).collect();
            json!({"name": generator.name, "summary": generator.summary, "dims": generator.dims, "parameters": params})
        };
        all.insert("scenes".into(), GENERATORS.iter().map(of).collect());
    }
    if wanted(What::Experiments) {
        let of = |experiment: Experiment| {
            let Experiment { name, title, question, standard, detectors, .. } = experiment;
            json!({"name": name, "title": title, "question": question, "standard": standard, "detectors": detectors})
        };
        all.insert("experiments".into(), builtin::all()?.into_iter().map(of).collect());
    }
    if what == Some(What::HardCases) {
        let cases = hard::cases().map(|case| {
            let expect = match case.expect {
                Expect::Contacts(contacts) => {
                    let of = |dim: &u32| (format!("{dim}D"), json!(contacts[usize::from(*dim == 3)]));
                    Value::Object(case.dims.iter().map(of).collect())
                }
                Expect::Oracle => "all pairs tested tell".into(),
                Expect::Invalid => "must be refused".into(),
            };
            json!({"name": case.name, "group": case.group.name(), "dims": case.dims, "contacts": expect, "reason": case.reason,
                "source": case.source})
        });
        all.insert("hard_cases".into(), cases.collect());
    }
    Ok(Value::Object(all))
}

fn hard_cases(out: &mut impl Write) -> std::io::Result<()> {
    writeln!(out, "HARD CASES (in experiments: name = \"hard\", case = \"NAME\")\n")?;
    for case in hard::cases() {
        let dims: Vec<String> = case.dims.iter().map(|dim| format!("{dim}D")).collect();
        let answer = match case.expect {
            Expect::Contacts(contacts) => {
                let contacts: Vec<String> = case.dims.iter().map(|dim| contacts[usize::from(*dim == 3)].to_string()).collect();
                format!("contacts: {}", contacts.join(", "))
            }
            Expect::Oracle => "contacts: all pairs tested tell".into(),
            Expect::Invalid => "must be refused".into(),
        };
        writeln!(out, "  {:<32} {:<12} {:<7} {answer}", case.name, case.group.name(), dims.join(", "))?;
        for line in wrap(case.reason, 94) {
            writeln!(out, "    {line}")?;
        }
        writeln!(out, "    source: {}\n", case.source)?;
    }
    Ok(())
}
