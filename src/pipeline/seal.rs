//! The seal of a JSON file: its last member is the SHA-256 of the text with the digits of the seal
//! set to zero, so that any damage is detected.

use crate::record::Digest;

/// Start of the line that holds the seal.
const SEAL: &str = "  \"seal\": \"sha256:";
/// End of the text.
const END: &str = "\"\n}\n";

/// A JSON object, pretty-printed, with its seal.
pub fn seal(json: &str) -> String {
    let body = json.strip_suffix("\n}").expect("an object");
    let zeros = "0".repeat(64);
    let seal = Digest::of(format!("{body},\n{SEAL}{zeros}{END}").as_bytes()).hex();
    format!("{body},\n{SEAL}{seal}{END}")
}

/// Fails if the text was changed after sealing.
pub fn check(text: &str) -> Result<(), &'static str> {
    let start = text.rfind(SEAL).ok_or("it has no seal")? + SEAL.len();
    let seal = text.get(start..start + 64).ok_or("its seal is cut off")?;
    let end = &text[start + 64..];
    if end != END {
        return Err("it does not end with its seal");
    }
    let unsealed = format!("{}{}{end}", &text[..start], "0".repeat(64));
    if Digest::of(unsealed.as_bytes()).hex() != seal {
        return Err("its seal does not match: it was damaged or edited");
    }
    Ok(())
}
