#![no_main]
#![doc = "Runs `planish_fuzz::link` under libFuzzer."]

libfuzzer_sys::fuzz_target!(|data: &[u8]| planish_fuzz::link(data));
