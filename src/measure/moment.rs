//! Instants for readers.

/// Runs that are shorter, s, have their times in microseconds.
const BRIEF: f64 = 1e-3;

/// Of a run whose end is not known: so many times an instant of it.
pub const LIKELY: f64 = 10.0;

/// An instant, s, for readers, with so many decimals, in a run that ends at `end` s.
pub fn moment(time: f64, end: f64, decimals: usize) -> String {
    let (factor, unit) = match end > 0.0 && end < BRIEF {
        true => (1e6, "us"),
        false => (1e3, "ms"),
    };
    // Not -0.
    let text = format!("{:.decimals$}", factor * time + 0.0);
    let is_zero = text.trim_matches(['-', '0', '.']).is_empty();
    format!(
        "{} {unit}",
        if is_zero {
            text.trim_start_matches('-')
        } else {
            &text
        }
    )
}
