//! A valid scene with arbitrary `--set` arguments. The first byte of an input chooses the scene,
//! each line of the rest is an argument.

#![no_main]

use libfuzzer_sys::fuzz_target;

const SCENES: [&str; 5] = [
    include_str!("../../scenes/tiny.toml"),
    include_str!("../../scenes/kuri/u2.42.toml"),
    include_str!("../../scenes/xie-2007/fukai-a-3d.toml"),
    include_str!("../../scenes/verification/dam-break.toml"),
    include_str!("../../pipeline.toml"),
];

fuzz_target!(|bytes: &[u8]| {
    let Some((scene, bytes)) = bytes.split_first() else {
        return;
    };
    // Arguments that are not UTF-8 are refused before the scene sees them.
    let Ok(text) = std::str::from_utf8(bytes) else {
        return;
    };
    let sets: Vec<String> = text.lines().map(str::to_string).collect();
    coronet_fuzz::scene(SCENES[usize::from(*scene) % SCENES.len()], &sets);
});
