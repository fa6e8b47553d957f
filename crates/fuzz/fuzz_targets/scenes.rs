//! Interprets any bytes as a scene; every detector must be right in every safe arithmetic.

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| contactbench_run::check::bytes::fuzz_one(data));
