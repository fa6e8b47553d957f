//! `contactbench list`.

use std::io::Write;
use std::process::ExitCode;

use crate::analyse::text::wrap;
use crate::contact::Arithmetic;
use crate::detect::peers::PEERS;
use crate::detect::table::TABLE;
use crate::harness::builtin;
use crate::scene::hard::{self, Expect};
use crate::scene::spec::GENERATORS;

/// Options of `list`.
#[derive(clap::Args)]
pub struct List {
    /// What to list (default: everything)
    #[arg(value_enum)]
    what: Option<What>,
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
