//! A study file, up to the points that it names, beside a scene and a table.

#![no_main]

use std::sync::Once;

use coronet_fuzz::file;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    static BESIDE: Once = Once::new();
    BESIDE.call_once(|| {
        file("tiny.toml", include_bytes!("../../scenes/tiny.toml"));
        file(
            "table.csv",
            include_bytes!("../../scenes/study/pool-reference.csv"),
        );
    });
    coronet_fuzz::study_file(&file("study.toml", bytes));
});
