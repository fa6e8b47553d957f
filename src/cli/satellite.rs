//! Verbs that are separate programs, in the folder of this program or on PATH.

use std::ffi::OsString;
use std::io::ErrorKind;
use std::process::{Command, ExitCode};

use anyhow::{Context, bail};

#[derive(clap::Args)]
#[command(disable_help_flag = true)]
pub struct Passed {
    /// Arguments of the program
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, value_name = "ARGUMENTS")]
    words: Vec<OsString>,
}

/// Runs a program with these arguments; on Unix it replaces this process.
pub fn run(name: &str, passed: &Passed) -> anyhow::Result<ExitCode> {
    let file = format!("{name}{}", std::env::consts::EXE_SUFFIX);
    let beside = std::env::current_exe().ok().and_then(|own| Some(own.parent()?.join(&file)));
    let program = beside.filter(|path| path.is_file()).map_or(file.into(), OsString::from);
    let error = match started(Command::new(&program).args(&passed.words)) {
        Ok(code) => return Ok(code),
        Err(error) => error,
    };
    if error.kind() == ErrorKind::NotFound {
        bail!(
            "the program {name} is neither beside contactbench nor on PATH; build it with cargo \
             build --release -p {name}"
        );
    }
    Err(error).with_context(|| format!("cannot start {}", program.display()))
}

#[cfg(unix)]
fn started(command: &mut Command) -> std::io::Result<ExitCode> {
    use std::os::unix::process::CommandExt;

    Err(command.exec())
}

#[cfg(not(unix))]
fn started(command: &mut Command) -> std::io::Result<ExitCode> {
    let code = command.status()?.code().and_then(|code| u8::try_from(code).ok());
    Ok(code.map_or(ExitCode::FAILURE, ExitCode::from))
}
