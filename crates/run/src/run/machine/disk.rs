//! The temporary folder of scenes.

use anyhow::Context;
use tempfile::TempDir;

pub fn temporary() -> anyhow::Result<TempDir> {
    tempfile::tempdir()
        .context("cannot make a temporary folder for scenes; set TMPDIR to a writable place")
}
