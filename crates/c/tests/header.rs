//! Checks that `include/contactbench.h` matches the sources.

use std::path::Path;

use cbindgen::{Builder, Config, Language};

const HEAD: &str = "\
/* Contacts among discs and spheres, decided exactly: see docs/PYTHON.md of contactbench.

   Calls return CONTACTBENCH_OK or another code; contactbench_last_error then returns the reason.
   Numbers are read in place and never changed; all lengths are in one unit.

   Generated from crates/c/src by HEADER=write cargo test, in the folder c. */";

#[test]
fn the_header_matches_the_sources() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let path = folder.join("include/contactbench.h");
    let config = Config {
        language: Language::C,
        cpp_compat: true,
        header: Some(HEAD.into()),
        include_guard: Some("CONTACTBENCH_H".into()),
        documentation: true,
        style: cbindgen::Style::Both,
        usize_is_size_t: true,
        no_includes: true,
        sys_includes: vec!["stddef.h".into(), "stdint.h".into()],
        line_length: 100,
        ..Config::default()
    };
    let made = Builder::new()
        .with_config(config)
        .with_src(folder.join("src/lib.rs"))
        .generate()
        .expect("the sources describe a header");
    let mut bytes = Vec::new();
    made.write(&mut bytes);
    let made = String::from_utf8(bytes).expect("a header is text");
    // Sections about safety only concern callers in Rust.
    let made = without_safety(&made);
    if std::env::var("HEADER").is_ok_and(|word| word == "write") {
        std::fs::write(&path, &made).expect("the header can be written");
    }
    let there = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(there == made, "{} is outdated: run HEADER=write cargo test", path.display());
}

/// Removes the `# Safety` sections of comments.
fn without_safety(text: &str) -> String {
    let (mut kept, mut inside) = (Vec::new(), false);
    for line in text.lines() {
        if line.trim() == "* # Safety" {
            inside = true;
            // The empty line before the section is also removed.
            kept.pop();
        }
        inside &= line.trim() != "*/";
        if !inside {
            kept.push(line);
        }
    }
    kept.join("\n") + "\n"
}
