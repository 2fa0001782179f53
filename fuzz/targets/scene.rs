//! A scene file, and all that a scene goes through before anything runs.

#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| coronet_fuzz::scene(text, &[]));
