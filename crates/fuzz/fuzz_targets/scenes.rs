//! Interprets any bytes as a scene; every detector must be right in every safe arithmetic.

#![no_main]

#[allow(dead_code)]
#[path = "../../../tests/detectors/fuzz/held.rs"]
mod held;

libfuzzer_sys::fuzz_target!(|data: &[u8]| held::fuzz_one(data));
