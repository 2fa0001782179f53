//! Makes the modules of the program (`../stages`), which is a binary crate, part of this library:
//! `main.rs` without its documentation and with full paths to its modules.

use std::fmt::Write as _;
use std::path::Path;
use std::{env, fs};

fn main() {
    let root = env::var("CARGO_MANIFEST_DIR").expect("set by cargo");
    let stages = Path::new(&root).join("../stages");
    println!("cargo:rerun-if-changed={}", stages.display());
    println!("cargo:rustc-env=CORONET_BUILD=fuzz");
    let main = fs::read_to_string(stages.join("main.rs")).expect("the program is next door");
    let mut text = String::new();
    for line in main.lines().filter(|line| !line.starts_with("//!")) {
        if let Some(module) = line.strip_prefix("mod ").and_then(|l| l.strip_suffix(';')) {
            let file = stages.join(format!("{module}.rs"));
            let folder = stages.join(module).join("mod.rs");
            let path = if file.exists() { file } else { folder };
            writeln!(text, "#[path = {:?}]", path.display().to_string()).expect("to a string");
        }
        writeln!(text, "{line}").expect("to a string");
    }
    let out = env::var("OUT_DIR").expect("set by cargo");
    fs::write(Path::new(&out).join("program.rs"), text).expect("cargo made the folder");
}
