//! Words as users type them: guesses only where something is near, texts that can be printed.

use crate::scene_error::{edited, holds};
use crate::scene_file::SMALL;
use coronet::scene::file;
use std::path::Path;

#[test]
fn a_key_that_is_near_nothing_is_not_guessed() {
    for (from, to) in [
        // A key of another method; a word of another meaning.
        ("gap =", "radius ="),
        ("dynamic =", "kinematic ="),
        ("spacing =", "courant ="),
    ] {
        let message = edited(from, to).to_string();
        assert!(!message.contains("did you mean"), "{message}");
        holds(&message, &["unknown key", "known here: "]);
    }
}

#[test]
fn texts_have_no_control_characters() {
    for text in ["a\u{1b}[31m", "a\u{7}", "a\u{202e}b", "two\nlines"] {
        let escaped: String = text
            .chars()
            .map(|c| format!("\\u{:04x}", c as u32))
            .collect();
        let scene = format!("title = \"{escaped}\"\n{SMALL}");
        let read = file::read(&scene, Path::new("small.toml"), &[]);
        let message = read.unwrap_err().to_string();
        holds(
            &message,
            &[
                "small.toml:1:9",
                "`title`",
                "control character",
                "leave it out",
            ],
        );
        assert!(!message.chars().any(char::is_control), "{message:?}");
    }
    for key in ["\"a\\u001bb\" = 1\n", "[body.\"a\\u001bb\"]\n"] {
        let read = file::read(&format!("{key}{SMALL}"), Path::new("small.toml"), &[]);
        let message = read.unwrap_err().to_string();
        assert!(!message.chars().any(char::is_control), "{message:?}");
    }
}
