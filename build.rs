//! Notes the compiler and its flags, for the provenance of results.

use std::process::Command;

fn main() {
    let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".into());
    let version = Command::new(rustc)
        .arg("--version")
        .output()
        .map(|out| String::from_utf8_lossy(&out.stdout).trim().to_string());
    println!("cargo:rustc-env=CONTACTBENCH_RUSTC={}", version.unwrap_or_else(|_| "unknown".into()));
    let flags = std::env::var("CARGO_ENCODED_RUSTFLAGS").unwrap_or_default().replace('\u{1f}', " ");
    println!("cargo:rustc-env=CONTACTBENCH_RUSTFLAGS={flags}");
    println!(
        "cargo:rustc-env=CONTACTBENCH_PROFILE={}",
        std::env::var("PROFILE").unwrap_or_default()
    );
    println!("cargo:rerun-if-changed=build.rs");
}
