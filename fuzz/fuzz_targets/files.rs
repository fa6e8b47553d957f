//! Any bytes as a particle file: a scene or an error, never a panic.

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| contactbench::check::bytes::fuzz_reader(data));
