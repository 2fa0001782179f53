//! `stamp::read_file`. The first byte of an input chooses: even, the rest is the file; odd, it gets
//! the seal that makes the reader go on.

#![no_main]

use coronet::pipeline::stamp;
use coronet_fuzz::{file, hexadecimal, sha256};
use libfuzzer_sys::fuzz_target;

const SEAL: &str = "  \"seal\": \"sha256:";

fuzz_target!(|bytes: &[u8]| {
    let Some((mode, bytes)) = bytes.split_first() else {
        return;
    };
    let bytes = match (mode % 2, std::str::from_utf8(bytes)) {
        (1, Ok(text)) => sealed(text).into_bytes(),
        _ => bytes.to_vec(),
    };
    match stamp::read_file(&file("stamp.json", &bytes)) {
        Ok(stamp) => assert_eq!(stamp.stamp, coronet::pipeline::Stamp::layout()),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});

/// `text` up to its seal, if it has one, sealed.
fn sealed(text: &str) -> String {
    let body = text.rfind(SEAL).map_or(text, |start| &text[..start]);
    let zeros = format!("{body}{SEAL}{}\"\n}}\n", "0".repeat(64));
    let seal = hexadecimal(&sha256(zeros.as_bytes()));
    format!("{body}{SEAL}{seal}\"\n}}\n")
}
