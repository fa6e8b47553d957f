//! The machine during a run: processors, load, speed and signals.

pub mod interrupt;
pub mod load;
pub mod processors;
pub(super) mod pulse;

use anyhow::Context;

/// Makes the temporary folder of scenes.
pub fn temporary() -> anyhow::Result<tempfile::TempDir> {
    tempfile::tempdir()
        .context("cannot make a temporary folder for scenes; set TMPDIR to a writable place")
}
