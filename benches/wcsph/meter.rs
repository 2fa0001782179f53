//! What is read, printed and kept.

pub use coronet::pipeline::machine::cpu_seconds;

#[path = "../../tests/validation/table.rs"]
mod table;

/// Prints `name value unit`. The row of CORONET_INTO has particles and threads apart, which are
/// `n1000` and `t2` in the name.
pub fn line(name: &str, value: f64, unit: &str) {
    let value = match value.abs() {
        v if v >= 1e5 => format!("{value:.3e}"),
        v if v >= 100.0 => format!("{value:.0}"),
        _ => format!("{value:.3}"),
    };
    println!("{name} {value} {unit}");
    let (mut parts, mut particles, mut threads) = (Vec::new(), "", "");
    for part in name.split('.') {
        let count = |letter: char| {
            part.strip_prefix(letter)
                .filter(|n| n.parse::<u64>().is_ok())
        };
        match (count('n'), count('t')) {
            (Some(n), _) => particles = n,
            (_, Some(n)) => threads = n,
            _ => parts.push(part),
        }
    }
    let method = parts.remove(0);
    let columns = ["of", "measure", "particles", "threads", "value", "unit"];
    let row = [method, &parts.join("."), particles, threads, &value, unit];
    table::keep(&command(), &columns, &row);
}

/// The command that runs this bench.
fn command() -> String {
    let mut words = std::env::args();
    let program = words.next().unwrap_or_default();
    let name = program.rsplit('/').next().unwrap_or_default();
    let name = name.rsplit_once('-').map_or(name, |(name, _)| name);
    let words: Vec<String> = words.filter(|word| word != "--bench").collect();
    let tail = match words.is_empty() {
        true => String::new(),
        false => format!(" -- {}", words.join(" ")),
    };
    format!("cargo bench --bench {name}{tail}")
}
