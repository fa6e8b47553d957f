//! Interprets any bytes as a particle file or a list of contacts. A reader must return a scene, a
//! list or a one-line error; it must not panic.
//!
//! One program fuzzes all readers. The environment variable `READER` selects one of them;
//! `READER=list` prints their names.

#![no_main]

use std::sync::LazyLock;

#[path = "../../../tests/detectors/fuzz/readers.rs"]
mod readers;

static READER: LazyLock<Option<u8>> = LazyLock::new(|| {
    let name = std::env::var("READER").ok()?;
    if name == "list" {
        readers::readers().for_each(|name| println!("{name}"));
        std::process::exit(0);
    }
    Some(readers::reader(&name).unwrap_or_else(|| panic!("there is no reader '{name}'")))
});

libfuzzer_sys::fuzz_target!(init: { LazyLock::force(&READER); }, |data: &[u8]| match *READER {
    Some(reader) => readers::fuzz_reader_of(reader, data),
    None => readers::fuzz_reader(data),
});
