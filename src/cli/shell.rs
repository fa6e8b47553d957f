//! `contactbench completions` with man pages, and remedies for words that are not verbs.

use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::CommandFactory;
use clap::error::{ContextKind, ContextValue};
use clap_complete::Shell;

use crate::cli::Cli;
use contactbench_run::plan::builtin;
use contactbench_scenes::spec::GENERATORS;
use contactbench_terms::nearest::nearest;

/// Returns a remedy for a wrong argument: a second file, or, in place of a verb, an experiment, a
/// file or a scene.
pub fn advice(error: &clap::Error) -> Option<String> {
    if let Some(ContextValue::String(word)) = error.get(ContextKind::InvalidArg) {
        return Path::new(word).is_file().then(|| {
            "to read several files as one trajectory, give a pattern in quotes, as in 'run_*.csv'"
                .into()
        });
    }
    let Some(ContextValue::String(word)) = error.get(ContextKind::InvalidSubcommand) else {
        return None;
    };
    let is_scene = |name: &str| GENERATORS.iter().any(|generator| generator.name == name);
    let near = || nearest(word, builtin::names());
    if builtin::names().any(|name| name == word) || word.ends_with(".toml") {
        Some(format!("it is an experiment: contactbench run {word}"))
    } else if Path::new(word).is_file() {
        Some(format!("it is a file: contactbench inspect {word}"))
    } else if word.split(':').next().is_some_and(is_scene) {
        Some(format!("it is a scene: contactbench draw {word}"))
    } else {
        near().map(|name| format!("did you mean the experiment {name}? contactbench run {name}"))
    }
}

#[derive(clap::Args)]
pub struct Completions {
    /// bash, elvish, fish, powershell or zsh
    #[arg(value_enum, hide_possible_values = true, required_unless_present = "man")]
    shell: Option<Shell>,
    /// Write man pages to a folder instead
    #[arg(long, value_name = "FOLDER", conflicts_with = "shell")]
    man: Option<PathBuf>,
}

pub fn completions(options: &Completions) -> anyhow::Result<()> {
    if let Some(folder) = &options.man {
        std::fs::create_dir_all(folder)
            .and_then(|()| clap_mangen::generate_to(Cli::command(), folder))
            .with_context(|| format!("cannot write man pages to {}", folder.display()))?;
    }
    if let Some(shell) = options.shell {
        let mut out = std::io::stdout().lock();
        clap_complete::generate(shell, &mut Cli::command(), "contactbench", &mut out);
    }
    Ok(())
}
