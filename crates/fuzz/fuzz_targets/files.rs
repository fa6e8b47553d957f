//! Any bytes as a particle file or a contact list: a scene, a list, or an error of one clear line;
//! never a panic.
//!
//! One program for all readers. The environment variable `READER` narrows it to one of them: npy,
//! npz, dump, vtk, vtp, ply, lammps-data, mercury, xyz, csv, gsd, gzip or pairs.

#![no_main]

use std::sync::LazyLock;

use contactbench::check::bytes;

static READER: LazyLock<Option<u8>> = LazyLock::new(|| {
    std::env::var("READER")
        .ok()
        .map(|name| bytes::reader(&name).unwrap_or_else(|| panic!("there is no reader '{name}'")))
});

libfuzzer_sys::fuzz_target!(|data: &[u8]| match *READER {
    Some(reader) => bytes::fuzz_reader_of(reader, data),
    None => bytes::fuzz_reader(data),
});
