use std::path::PathBuf;

use clap::builder::{PossibleValuesParser, TypedValueParser};

use crate::cli::shared::scene::Source;
use crate::cli::shared::terminal;
use contactbench_views::trace::{Algorithm, example, page, trace as run};

#[derive(clap::Args)]
#[command(mut_arg("box", |arg| arg.hide(true)), mut_arg("periodic", |arg| arg.hide(true)))]
pub struct Trace {
    /// nbs, screening, sorting or binary-tree
    #[arg(value_parser = algorithm(), hide_possible_values = true)]
    detector: Algorithm,
    #[command(flatten)]
    source: Source,
    /// Page with all steps
    #[arg(short, long, value_name = "FILE", default_value = "trace.html")]
    out: PathBuf,
}

fn algorithm() -> impl TypedValueParser<Value = Algorithm> {
    let named = |name: String| Algorithm::ALL.into_iter().find(|it| it.name() == name);
    PossibleValuesParser::new(Algorithm::ALL.map(Algorithm::name))
        .try_map(move |name| named(name).ok_or("there is no such detector"))
}

/// Writes the page, and prints a summary on standard error.
pub fn trace(options: &Trace) -> anyhow::Result<()> {
    let Trace { detector, source, out } = options;
    let (name, scene) = match source.scene.is_some() || source.input.is_said() {
        true => {
            source.given().and_then(|(name, given)| Ok((name.clone(), Some(given.open(&name)?))))?
        }
        false => (example::example(*detector).name.to_string(), None),
    };
    let trace = run(*detector, scene.as_ref())?;
    terminal::save(out, page::html(&trace, &name).as_bytes(), "-o")?;
    let [n, contacts, steps] = [trace.discs.len(), trace.contacts.len(), trace.steps.len() - 1];
    let (detector, out) = (detector.name(), out.display());
    say!("{name}: N = {n}, {contacts} contacts, {steps} steps of {detector}; {out}");
    Ok(())
}
