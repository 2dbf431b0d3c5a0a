#![no_main]
#![doc = "Runs `planish_fuzz::codec` under libFuzzer."]

libfuzzer_sys::fuzz_target!(|data: &[u8]| planish_fuzz::codec(data));
