//! `contactbench completions` and `contactbench man`: what shells and `man` want to know of the program.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Context;
use clap::CommandFactory;

use super::Cli;

/// Options of `completions`.
#[derive(clap::Args)]
pub struct Completions {
    /// The shell
    #[arg(value_enum)]
    shell: clap_complete::Shell,
}

/// Writes the script to standard output.
pub fn completions(options: &Completions) -> anyhow::Result<ExitCode> {
    let mut script = Vec::new();
    clap_complete::generate(options.shell, &mut Cli::command(), "contactbench", &mut script);
    std::io::stdout().lock().write_all(&script)?;
    Ok(ExitCode::SUCCESS)
}

/// Options of `man`.
#[derive(clap::Args)]
pub struct Man {
    /// Writes the pages of the program and of every verb into this folder, made if it is not there
    #[arg(short, long)]
    output: Option<PathBuf>,
}

/// Writes the page of the program to standard output, or all pages into a folder.
pub fn man(options: &Man) -> anyhow::Result<ExitCode> {
    match &options.output {
        None => {
            let mut page = Vec::new();
            clap_mangen::Man::new(Cli::command()).render(&mut page)?;
            std::io::stdout().lock().write_all(&page)?;
        }
        Some(folder) => {
            let failed = || format!("cannot write to {}; choose another folder with -o", folder.display());
            std::fs::create_dir_all(folder).with_context(failed)?;
            clap_mangen::generate_to(Cli::command(), folder).with_context(failed)?;
        }
    }
    Ok(ExitCode::SUCCESS)
}
