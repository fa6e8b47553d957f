//! How the program was built. The program sets this when it starts, so that a new revision does not
//! recompile the libraries.

use std::sync::OnceLock;

#[derive(Clone, Copy, Debug, Default)]
pub struct Build {
    /// The last commit that changed a source file; `unknown` outside of a checkout.
    pub revision: &'static str,
    /// Whether source files differ from that commit: `true`, `false` or `unknown`.
    pub dirty: &'static str,
    pub rustc: &'static str,
    pub rustflags: &'static str,
    pub profile: &'static str,
}

static BUILD: OnceLock<Build> = OnceLock::new();

pub fn set(build: Build) {
    _ = BUILD.set(build);
}

/// Every field is `unknown` until [`set`] is called.
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
