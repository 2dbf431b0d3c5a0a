#![no_main]
#![doc = "Runs `planish_fuzz::word` under libFuzzer."]

libfuzzer_sys::fuzz_target!(|data: &[u8]| planish_fuzz::word(data));
