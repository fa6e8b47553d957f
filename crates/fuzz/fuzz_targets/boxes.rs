//! Interprets any bytes as a scene in a box; every detector must be right in every safe arithmetic.

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| contactbench_run::check::bytes::fuzz_box(data));
