//! How this program was built.
//!
//! The program sets it once, at its start. The libraries are compiled without it: a changed source
//! compiles none of them again for the sake of the revision.

use std::sync::OnceLock;

/// How a program was built.
#[derive(Clone, Copy, Debug, Default)]
pub struct Build {
    /// The last commit that changed a source; `unknown` outside of a checkout.
    pub revision: &'static str,
    /// Whether the sources differ from that commit: `true`, `false` or `unknown`.
    pub dirty: &'static str,
    pub features: &'static str,
    pub rustc: &'static str,
    pub rustflags: &'static str,
    /// The profile: `release` or `debug`.
    pub profile: &'static str,
}

static BUILD: OnceLock<Build> = OnceLock::new();

/// Sets the build; a second call changes nothing.
pub fn set(build: Build) {
    _ = BUILD.set(build);
}

/// The build as set by the program; `unknown` in every field where no program did.
pub fn build() -> Build {
    let unknown = Build {
        revision: "unknown",
        dirty: "unknown",
        rustc: "unknown",
        profile: "unknown",
        ..Build::default()
    };
    BUILD.get().copied().unwrap_or(unknown)
}
