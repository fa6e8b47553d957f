//! Any bytes as a scene: every detector is right on it, in every safe arithmetic.

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| contactbench_run::check::bytes::fuzz_one(data));
