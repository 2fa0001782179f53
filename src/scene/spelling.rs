//! Words as users type them: the probable meaning, and printable texts.

/// Likeness (1 is equal) from which a word may be meant: one wrong letter in three.
pub(super) const ALIKE: f64 = 0.6;
/// Likeness from which a key of another table may be meant.
const VERY_ALIKE: f64 = 0.8;

/// The word most like `given`, with its likeness from 0 to 1.
pub(super) fn nearest<'a>(
    given: &str,
    words: impl Iterator<Item = &'a str>,
) -> Option<(&'a str, f64)> {
    let rated = words.map(|word| (word, strsim::normalized_damerau_levenshtein(given, word)));
    rated.fold(
        None,
        |best: Option<(&str, f64)>, (word, likeness)| match best {
            Some((_, top)) if top >= likeness => best,
            _ => Some((word, likeness)),
        },
    )
}

/// The key, one of `keys`, spelled most like `given` in the tables beside, above and below that at
/// `path`.
pub(super) fn beside(given: &str, path: &str, keys: &[String]) -> Option<(String, f64)> {
    // One schema describes all bodies.
    let general = match path.strip_prefix("body.") {
        Some(rest) => rest.find('.').map_or("body.NAME".to_string(), |end| {
            format!("body.NAME{}", &rest[end..])
        }),
        None => path.to_string(),
    };
    let table = |key: &str| {
        key.rsplit_once('.')
            .map_or(String::new(), |(table, _)| table.into())
    };
    let above = table(&general);
    let is_near = |key: &&String| {
        let own = table(key);
        own == above || table(&own) == above || table(&own) == general
    };
    let near = keys.iter().filter(is_near).map(|key| {
        let leaf = key.rsplit('.').next().unwrap_or(key);
        (
            key.clone(),
            strsim::normalized_damerau_levenshtein(given, leaf),
        )
    });
    let best = near.max_by(|a, b| a.1.total_cmp(&b.1));
    best.filter(|(_, likeness)| *likeness >= VERY_ALIKE)
}

/// Neither a control character nor one that changes the direction of the text around it.
pub(super) fn is_printable(letter: char) -> bool {
    !letter.is_control() && !matches!(letter, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// A text with escapes in place of what cannot be printed.
pub(super) fn printable(text: &str) -> String {
    let escaped = |letter: char| match is_printable(letter) {
        true => letter.to_string(),
        false => letter.escape_default().to_string(),
    };
    text.chars().map(escaped).collect()
}
