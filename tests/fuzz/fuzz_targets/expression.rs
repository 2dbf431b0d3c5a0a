#![no_main]
#![doc = "Runs `planish_fuzz::expression` under libFuzzer."]

libfuzzer_sys::fuzz_target!(|data: &[u8]| planish_fuzz::expression(data));
