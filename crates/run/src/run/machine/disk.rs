//! Checks before a long run that files can be written, and that there is space for them.

use std::io::Write;
use std::path::Path;

use anyhow::Context;
use tempfile::TempDir;

pub fn temporary() -> anyhow::Result<TempDir> {
    tempfile::tempdir()
        .context("cannot make a temporary folder for scenes; set TMPDIR to a writable place")
}

/// Fails, and states `remedy`, unless a file can be written to `folder` and `needed` bytes are free
/// there for `what`.
pub fn ensure(folder: &Path, needed: u64, what: &str, remedy: &str) -> anyhow::Result<()> {
    let probe = || -> std::io::Result<()> {
        let mut file =
            tempfile::Builder::new().prefix(".contactbench-probe-").tempfile_in(folder)?;
        file.write_all(&[0; 4096])?;
        file.as_file().sync_data()
    };
    probe()
        .with_context(|| format!("cannot write into the folder {}; {remedy}", folder.display()))?;
    if let Some(free) = free(folder).filter(|&free| free < needed) {
        let [free, needed] = [free, needed].map(|bytes| format!("{:.1} MB", bytes as f64 / 1e6));
        anyhow::bail!(
            "{} has {free} free, and {what} may need {needed}; {remedy}",
            folder.display()
        );
    }
    Ok(())
}

/// Returns the free bytes for this user; `None` if the system does not report them.
fn free(folder: &Path) -> Option<u64> {
    #[cfg(unix)]
    {
        let known = rustix::fs::statvfs(folder).ok().filter(|known| known.f_blocks > 0)?;
        Some(known.f_bavail.saturating_mul(known.f_frsize))
    }
    #[cfg(not(unix))]
    {
        let _ = folder;
        None
    }
}
