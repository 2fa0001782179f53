//! What is read and what is printed.

pub use coronet::pipeline::machine::cpu_seconds;

/// `name value unit`.
pub fn line(name: &str, value: f64, unit: &str) {
    let value = match value.abs() {
        v if v >= 1e5 => format!("{value:.3e}"),
        v if v >= 100.0 => format!("{value:.0}"),
        _ => format!("{value:.3}"),
    };
    println!("{name} {value} {unit}");
}

pub fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    let n = values.len();
    0.5 * (values[(n - 1) / 2] + values[n / 2])
}
