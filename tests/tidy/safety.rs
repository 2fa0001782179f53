//! Where code may be unsafe.

use super::{files, none, shown, text};

/// Where code may be unsafe: in the room of space, and where the system is called.
const UNSAFE: &[&str] = &["src/space/", "src/pipeline/machine", "stages/signals.rs"];

#[test]
fn unsafe_code_has_its_rooms() {
    let mut faults = Vec::new();
    for file in files("src", "rs").into_iter().chain(files("stages", "rs")) {
        let path = shown(&file);
        if UNSAFE.iter().any(|room| path.starts_with(room)) {
            continue;
        }
        for (number, line) in text(&file).lines().enumerate() {
            let code = line.split("//").next().unwrap_or("");
            if code
                .split(|c: char| !c.is_alphanumeric() && c != '_')
                .any(|word| word == "unsafe")
            {
                faults.push(format!("{path}:{}: unsafe", number + 1));
            }
        }
    }
    none(&faults);
}
