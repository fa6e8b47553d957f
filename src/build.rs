//! Records compiler, flags and commit of the build, for the provenance of results.

use std::path::Path;
use std::process::Command;

/// Sources of the program, relative to the root of the workspace.
const SOURCES: [&str; 7] = [
    "src",
    "crates",
    "Cargo.toml",
    "Cargo.lock",
    "experiments",
    "tests/regressions",
    "rust-toolchain.toml",
];

fn main() {
    // Cargo starts this script in the folder of a crate, so it looks for the workspace above.
    let here = std::env::current_dir().unwrap_or_default();
    let root = here.ancestors().find(|folder| folder.join("Cargo.lock").is_file());
    let root = root.unwrap_or(&here);
    let _ = std::env::set_current_dir(root);
    let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".into());
    let version = said(&rustc, &["--version"]);
    note("RUSTC", &version.unwrap_or_else(|| "unknown".into()));
    let flags = std::env::var("CARGO_ENCODED_RUSTFLAGS").unwrap_or_default().replace('\u{1f}', " ");
    note("RUSTFLAGS", &flags);
    note("PROFILE", &std::env::var("PROFILE").unwrap_or_default());

    let sources: Vec<&str> = SOURCES.into_iter().filter(|path| Path::new(path).exists()).collect();
    let commit = commit(&sources);
    note("REVISION", commit.as_ref().map_or("unknown", |commit| &commit.revision));
    let dirty = match commit {
        Some(Commit { dirty: true, .. }) => "true",
        Some(_) => "false",
        None => "unknown",
    };
    note("DIRTY", dirty);
    for path in &sources {
        println!("cargo:rerun-if-changed={}", root.join(path).display());
    }
    // A commit changes no source, so Cargo also watches git's HEAD while sources are uncommitted.
    if dirty == "true" {
        for name in ["HEAD", "logs/HEAD"] {
            let path = said("git", &["rev-parse", "--git-path", name]);
            if let Some(path) = path.filter(|path| Path::new(path).exists()) {
                println!("cargo:rerun-if-changed={}", root.join(path).display());
            }
        }
    }
}

fn note(name: &str, value: &str) {
    println!("cargo:rustc-env=CONTACTBENCH_{name}={value}");
}

struct Commit {
    /// Last commit that changed one of the sources.
    revision: String,
    /// Whether a source has uncommitted changes or is not tracked.
    dirty: bool,
}

/// Returns the last commit of the sources; `None` if git is missing or does not track them.
fn commit(sources: &[&str]) -> Option<Commit> {
    said("git", &["ls-files", "--error-unmatch", "src/build.rs"])?;
    let with = |arguments: &[&str]| said("git", &[arguments, &["--"], sources].concat());
    let revision = with(&["log", "-1", "--format=%H"])?;
    let dirty = !with(&["status", "--porcelain", "--untracked-files=all"])?.is_empty();
    Some(Commit { revision, dirty }).filter(|commit| !commit.revision.is_empty())
}

fn said(program: &str, arguments: &[&str]) -> Option<String> {
    let mut command = Command::new(program);
    let output = command.args(arguments).env("GIT_OPTIONAL_LOCKS", "0").output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_string())
}
