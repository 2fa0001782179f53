//! Finding things in source code, as far as the rules of the house need it.

/// Modules that code names with `crate::`, alone or in braces.
pub fn named(code: &str) -> Vec<String> {
    let lines = code
        .lines()
        .map(|line| line.split("//").next().unwrap_or(""));
    let code = lines.collect::<Vec<_>>().join("\n");
    let mut found = Vec::new();
    for part in code.split("crate::").skip(1) {
        match part.strip_prefix('{') {
            Some(list) => found.extend(heads(list)),
            None => found.push(head(part)),
        }
    }
    found
}

/// The word that code starts with.
fn head(code: &str) -> String {
    let word = |letter: &char| *letter == '_' || letter.is_alphanumeric();
    code.trim_start().chars().take_while(word).collect()
}

/// The words that the items of a list start with, up to the brace that closes it.
fn heads(list: &str) -> Vec<String> {
    let mut depth = 0;
    let mut item = true;
    let mut found = Vec::new();
    for (at, letter) in list.char_indices() {
        match letter {
            '{' => depth += 1,
            '}' if depth == 0 => break,
            '}' => depth -= 1,
            ',' if depth == 0 => item = true,
            _ if item && letter.is_alphanumeric() => {
                found.push(head(&list[at..]));
                item = false;
            }
            _ => {}
        }
    }
    found
}

#[test]
fn uses_are_found() {
    assert_eq!(named("use crate::scene::Scene;"), ["scene"]);
    assert_eq!(
        named("use crate::{scene, method::Solver};"),
        ["scene", "method"]
    );
    let nested = "use crate::{\n    scene::{Body, Shape},\n    record,\n};\nuse std::fs;";
    assert_eq!(named(nested), ["scene", "record"]);
    assert_eq!(
        named("let x = crate::record::read(crate::scene::A);"),
        ["record", "scene"]
    );
    assert!(named("// use crate::scene").is_empty());
}

/// Name, first line and number of lines of each function, in formatted code: it ends at the brace
/// that stands below its `fn`.
pub fn functions(text: &str) -> Vec<(String, usize, usize)> {
    let lines: Vec<&str> = text.lines().collect();
    let mut found = Vec::new();
    for (start, line) in lines.iter().enumerate() {
        let code = line.trim_start();
        let words: Vec<&str> = code.split_whitespace().collect();
        let lead = words.iter().take_while(|word| {
            ["pub", "const", "unsafe", "async", "extern"].contains(word) || word.starts_with("pub(")
        });
        let at = lead.count();
        if words.get(at) != Some(&"fn") {
            continue;
        }
        // A signature that ends without a body is a trait's.
        let mut ends = lines[start..].iter().map(|line| line.trim_end());
        if ends
            .find(|line| line.ends_with([';', '{', '}']))
            .is_some_and(|line| line.ends_with(';'))
        {
            continue;
        }
        let end = format!("{}}}", &line[..line.len() - code.len()]);
        let Some(length) = lines[start..].iter().position(|line| *line == end) else {
            continue;
        };
        let name = words
            .get(at + 1)
            .unwrap_or(&"")
            .split(['(', '<'])
            .next()
            .unwrap_or("");
        found.push((name.to_string(), start + 1, length + 1));
    }
    found
}

#[test]
fn functions_are_found_and_measured() {
    let first = "pub(super) fn a<T>(\n    x: T,\n) {\n    if x {\n    }\n}\n\n";
    let code = format!("{first}fn b() {{\n}}\n\nfn c(\n) -> u8;\n");
    let expected = [("a".to_string(), 1, 6), ("b".to_string(), 8, 2)];
    assert_eq!(functions(&code), expected);
}

/// Lines of the fenced blocks of the README.
pub fn commands(readme: &str) -> Vec<Vec<&str>> {
    let blocks = readme.split("```").skip(1).step_by(2);
    blocks
        .map(|block| {
            block
                .lines()
                .skip(1)
                .filter(|line| !line.is_empty())
                .collect()
        })
        .collect()
}
