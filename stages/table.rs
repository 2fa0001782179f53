//! Aligned columns of text.

/// Characters between two columns.
const GAP: &str = "  ";

/// The rows as lines, each column as wide as its widest cell; those named in `right` end at the
/// right.
pub fn lines(rows: &[Vec<String>], right: &[usize]) -> Vec<String> {
    let count = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| {
        let cells = rows.iter().filter_map(|row| row.get(column));
        cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..count).map(width).collect();
    let line = |row: &Vec<String>| {
        let cells = row.iter().zip(&widths).enumerate();
        let cells = cells.map(|(column, (cell, &width))| match right.contains(&column) {
            true => format!("{cell:>width$}"),
            false => format!("{cell:width$}"),
        });
        let line = cells.collect::<Vec<_>>().join(GAP);
        line.trim_end().to_string()
    };
    rows.iter().map(line).collect()
}

/// A text of at most `length` characters, with a mark where some were cut.
pub fn cut(text: &str, length: usize) -> String {
    if text.chars().count() <= length {
        return text.to_string();
    }
    let head: String = text.chars().take(length.saturating_sub(1)).collect();
    format!("{head}…")
}

/// Seconds for people, from seconds to days.
pub fn age(seconds: f64) -> String {
    match seconds {
        s if s < 120.0 => format!("{:.0} s", s.max(0.0)),
        s if s < 7200.0 => format!("{:.0} min", s / 60.0),
        s if s < 172_800.0 => format!("{:.0} h", s / 3600.0),
        s => format!("{:.0} d", s / 86_400.0),
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn columns_are_aligned() {
        let rows = [["a", "10 mm", ""], ["long", "1 mm", "end"]];
        let rows = rows.map(|row| row.map(str::to_string).to_vec());
        let lines = super::lines(&rows, &[1]);
        assert_eq!(lines, ["a     10 mm", "long   1 mm  end"]);
        assert_eq!(super::cut("µ-metre", 4), "µ-m…");
    }
}
