//! A page in Markdown: its generated blocks, links, words and figures.

use std::path::Path;

use crate::table::Table;

const START: &str = "<!-- table ";
const END: &str = "<!-- end -->";

/// The page with its blocks rendered from the tables in `data`, and the number of blocks.
/// `to_data`: that folder, as the page links to it.
pub fn rewritten(page: &str, data: &Path, to_data: &str) -> Result<(String, usize), String> {
    let mut out = String::new();
    let mut count = 0;
    let mut lines = page.lines();
    while let Some(line) = lines.next() {
        out += &format!("{line}\n");
        let Some(order) = line.strip_prefix(START) else {
            continue;
        };
        let order = order
            .strip_suffix(" -->")
            .ok_or(format!("{line}: no `-->`"))?;
        if !lines.by_ref().any(|line| line == END) {
            return Err(format!("{line}: no `{END}`"));
        }
        let block = block(order, data, to_data).map_err(|error| format!("{line}: {error}"))?;
        out += &format!("\n{block}\n{END}\n");
        count += 1;
    }
    Ok((out, count))
}

fn block(order: &str, data: &Path, to_data: &str) -> Result<String, String> {
    let (name, rest) = order.split_once(' ').unwrap_or((order, ""));
    let mut table = Table::read(&data.join(format!("{name}.csv")))?;
    let list = |key: &str| -> Vec<&str> {
        let value = rest
            .split_once(&format!("{key}=\""))
            .map_or("", |(_, rest)| rest);
        let value = value.split('"').next().unwrap_or("");
        value.split("; ").filter(|part| !part.is_empty()).collect()
    };
    for condition in list("where") {
        table.keep(condition)?;
    }
    let (rows, columns, cells) = (list("rows"), list("columns"), list("cells"));
    let body = match rows.is_empty() {
        true => table.plain(&columns)?,
        false => table.crossed(&rows, &columns, &cells)?,
    };
    Ok(format!(
        "{body}\n{}\n",
        table.foot(&format!("{to_data}/{name}.csv"))
    ))
}

/// Lines outside generated blocks, tables and code.
pub fn prose(page: &str) -> Vec<String> {
    let (mut in_block, mut in_code) = (false, false);
    let mut found = Vec::new();
    for line in page.lines() {
        in_block |= line.starts_with(START);
        let is_fence = line.trim_start().starts_with("```");
        in_code ^= is_fence;
        let is_code = in_code || is_fence || line.starts_with("    ");
        if !in_block && !is_code && !line.starts_with('|') && !line.starts_with("<!--") {
            found.push(line.to_string());
        }
        in_block &= line != END;
    }
    found
}

/// Number of words, without tables, code blocks and targets of links.
pub fn words(page: &str) -> usize {
    let has_letter = |word: &&str| word.chars().any(char::is_alphanumeric);
    let count = |line: &String| {
        without_targets(line)
            .split_whitespace()
            .filter(has_letter)
            .count()
    };
    prose(page).iter().map(count).sum()
}

fn without_targets(line: &str) -> String {
    let mut parts = line.split("](");
    let first = parts.next().unwrap_or("").to_string();
    parts.fold(first, |text, part| {
        text + part.split_once(')').map_or("", |(_, rest)| rest)
    })
}

/// Decimal numbers and percentages of a line, outside code spans and links.
pub fn figures(line: &str) -> Vec<String> {
    let text = without_targets(line);
    let text: String = text.split('`').step_by(2).collect::<Vec<_>>().join(" ");
    let words: Vec<&str> = text.split_whitespace().collect();
    let is_figure = |k: usize| {
        let word = words[k].trim_matches(|c: char| !c.is_ascii_digit() && c != '%');
        let is_number = word.starts_with(|c: char| c.is_ascii_digit());
        let is_decimal = word.split_once('.').is_some_and(|(a, b)| {
            let digits = |part: &str| !part.is_empty() && part.bytes().all(|c| c.is_ascii_digit());
            digits(a) && digits(b)
        });
        let is_part = word.ends_with('%') || words.get(k + 1).is_some_and(|w| w.starts_with('%'));
        is_decimal || is_number && is_part
    };
    let found = (0..words.len()).filter(|k| is_figure(*k));
    found.map(|k| words[k].to_string()).collect()
}

/// Lines of code blocks and code spans that start with `program`, without it; lines that end with a
/// backslash go on.
pub fn commands(page: &str, program: &str) -> Vec<String> {
    let page = page.replace("\\\n", " ");
    let mut in_code = false;
    let mut found = Vec::new();
    for line in page.lines() {
        in_code ^= line.trim_start().starts_with("```");
        let parts: Vec<&str> = match in_code || line.starts_with("    ") {
            true => line.split([';', '&', '#']).collect(),
            false => line.split('`').skip(1).step_by(2).collect(),
        };
        let parts = parts
            .into_iter()
            .map(|part| part.trim().trim_start_matches("do "));
        let own = parts.filter_map(|part| part.strip_prefix(program));
        let own = own.filter(|rest| rest.starts_with(|c: char| c.is_ascii_lowercase()));
        found.extend(own.map(str::to_string));
    }
    found
}

/// Targets of the links and pictures of a page, outside code.
pub fn links(page: &str) -> Vec<String> {
    let mut in_code = false;
    let mut found = Vec::new();
    for line in page.lines() {
        in_code ^= line.trim_start().starts_with("```");
        if in_code {
            continue;
        }
        let parts = line.split("](").skip(1);
        found.extend(parts.filter_map(|part| Some(part.split_once(')')?.0.to_string())));
    }
    found
}

/// Anchors of the headings of a page.
pub fn anchors(page: &str) -> Vec<String> {
    let heads = page.lines().filter(|line| line.starts_with('#'));
    let slug = |line: &str| -> String {
        let text = line.trim_start_matches('#').trim().to_lowercase();
        let kept = text
            .chars()
            .filter(|c| c.is_alphanumeric() || " -_".contains(*c));
        kept.map(|c| if c == ' ' { '-' } else { c }).collect()
    };
    heads.map(slug).collect()
}

#[test]
fn prose_is_found_and_counted() {
    let page = "# A head\n\nTwo [words](a/b.md).\n\n| a table |\n\n```sh\ncode\n```\n\
                <!-- table x -->\n\n12 % of it\n<!-- end -->\nlast\n";
    assert_eq!(words(page), 5);
    assert_eq!(links(page), ["a/b.md"]);
    let code = "```sh\nfor x in 1; do coronet run --set a \\\n  --b; done\n```\n`coronet plan`\n";
    assert_eq!(commands(code, "coronet "), ["run --set a    --b", "plan"]);
    assert_eq!(anchors("## Where to add: `what`?"), ["where-to-add-what"]);
    assert_eq!(
        figures("off by 5 %, by 2.5 mm, at `3.13 m/s`, 10 mm, d/8, 0.4%."),
        ["5", "2.5", "0.4%."]
    );
}
