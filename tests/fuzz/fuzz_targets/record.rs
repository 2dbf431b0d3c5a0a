#![no_main]
#![doc = "Runs `planish_fuzz::record` under libFuzzer."]

libfuzzer_sys::fuzz_target!(|data: &[u8]| planish_fuzz::record(data));
