//! Standard output and standard error. The work continues after their errors: a closed pipe ends
//! the printing, and the exit code reports any other error.
//!
//! Texts from files are shown without control characters, which could control a terminal.

use std::fmt::Arguments;
use std::io::{self, ErrorKind, Write as _};
use std::path::Path;
use std::sync::Mutex;

/// State of standard output.
static OUTPUT: Mutex<Option<io::Error>> = Mutex::new(None);

/// A line on standard output.
macro_rules! out {
    ($($argument:tt)*) => { $crate::print::line(format_args!($($argument)*)) };
}

/// A line on standard error.
macro_rules! note {
    ($($argument:tt)*) => { $crate::print::error_line(format_args!($($argument)*)) };
}

pub(crate) use {note, out};

/// Prints one line, or more if the text has line breaks.
pub fn line(text: Arguments) {
    let mut failed = OUTPUT
        .lock()
        .unwrap_or_else(|poisoned| poisoned.into_inner());
    if failed.is_some() {
        return;
    }
    let text = plain(&text.to_string());
    let mut out = io::stdout().lock();
    *failed = writeln!(out, "{text}").and_then(|()| out.flush()).err();
}

/// Prints to standard error; errors are ignored.
pub fn error_line(text: Arguments) {
    let _ = writeln!(io::stderr().lock(), "{}", plain(&text.to_string()));
}

/// Whether nothing more can be printed on standard output.
pub fn is_closed() -> bool {
    let failed = OUTPUT
        .lock()
        .unwrap_or_else(|poisoned| poisoned.into_inner());
    failed.is_some()
}

/// The first error of standard output, except a closed pipe.
pub fn failure() -> Option<io::Error> {
    let mut failed = OUTPUT
        .lock()
        .unwrap_or_else(|poisoned| poisoned.into_inner());
    failed
        .take()
        .filter(|error| error.kind() != ErrorKind::BrokenPipe)
}

/// The text with escapes in place of control characters other than line breaks and tabs, and of
/// characters that change the direction of writing.
pub fn plain(text: &str) -> String {
    let is_control = |c: char| {
        (c.is_control() && c != '\n' && c != '\t')
            || matches!(c, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}')
            || matches!(c, '\u{2066}'..='\u{2069}')
    };
    let mut plain = String::with_capacity(text.len());
    for c in text.chars() {
        if is_control(c) {
            plain.extend(c.escape_unicode());
        } else {
            plain.push(c);
        }
    }
    plain
}

/// A number of bytes with a unit.
pub fn size(bytes: u64) -> String {
    match bytes as f64 {
        b if b < 1e3 => format!("{b} B"),
        b if b < 1e6 => format!("{:.1} kB", b / 1e3),
        b if b < 1e9 => format!("{:.1} MB", b / 1e6),
        b if b < 1e12 => format!("{:.2} GB", b / 1e9),
        b => format!("{:.2} TB", b / 1e12),
    }
}

/// A number of things, `what` in the singular.
pub fn counted(number: usize, what: &str) -> String {
    let plural = if number == 1 { "" } else { "s" };
    format!("{number} {what}{plural}")
}

/// A word as a shell reads it.
pub fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "-_./=,:+%@".contains(c);
    match !word.is_empty() && word.chars().all(is_plain) {
        true => word.to_string(),
        false => format!("'{}'", word.replace('\'', "'\\''")),
    }
}

/// A path for messages and for JSON, as Unicode.
pub fn shown(path: &Path) -> String {
    path.to_string_lossy().into_owned()
}

#[cfg(test)]
mod tests {
    #[test]
    fn control_characters_become_escapes() {
        assert_eq!(super::plain("a\tb\nµ 5°"), "a\tb\nµ 5°");
        assert_eq!(
            super::plain("\x1b[2J\r\u{9b}\u{202e}"),
            "\\u{1b}[2J\\u{d}\\u{9b}\\u{202e}"
        );
    }
}
