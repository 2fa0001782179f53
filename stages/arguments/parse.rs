//! Values of arguments, from text.

use coronet::scene::Rgb;
use coronet::scene::quantity::{self, Unit};

/// Parses a time, s.
pub fn time(text: &str) -> Result<f64, String> {
    quantity::parse(text, Unit::Time).map_err(|error| error.to_string())
}

/// Parses an angle, degrees.
pub fn angle(text: &str) -> Result<f64, String> {
    quantity::parse(text, Unit::Angle).map_err(|error| error.to_string())
}

/// Parses the size of a picture.
pub fn size(text: &str) -> Result<[usize; 2], String> {
    let numbers = text.split_once('x').and_then(|(width, height)| {
        let number = |text: &str| text.parse::<usize>().ok();
        Some([number(width)?, number(height)?])
    });
    let fits = |size: &[usize; 2]| size.iter().all(|length| (16..=8192).contains(length));
    let problem = "give width and height from 16 to 8192 pixels, as 1280x720";
    numbers.filter(fits).ok_or_else(|| problem.to_string())
}

/// Parses a colour.
pub fn colour(text: &str) -> Result<[u8; 3], String> {
    Rgb::parse(text).ok_or_else(|| "write it as #rrggbb".to_string())
}

/// Parses a point, m.
pub fn point(text: &str) -> Result<[f64; 3], String> {
    let length = |text: &str| quantity::parse(text, Unit::Length).map_err(|e| e.to_string());
    let parts = text
        .split(',')
        .map(length)
        .collect::<Result<Vec<f64>, String>>()?;
    let wrong = |_| "give three lengths, as \"20 mm, 20 mm, 10 mm\"".to_string();
    parts.try_into().map_err(wrong)
}

/// Parses a number in a range.
fn number(text: &str, low: f64, high: f64) -> Result<f64, String> {
    let found = text.parse().ok().filter(|n| (low..=high).contains(n));
    found.ok_or_else(|| format!("give a number from {low} to {high}"))
}

/// Parses the pictures a second.
pub fn rate(text: &str) -> Result<f64, String> {
    number(text, 0.1, 240.0)
}

/// Parses an enlargement.
pub fn zoom(text: &str) -> Result<f64, String> {
    number(text, 0.01, 100.0)
}

/// Parses the time between two exported frames, s.
pub fn step(text: &str) -> Result<f64, String> {
    let step = quantity::parse(text, Unit::Time).map_err(|error| error.to_string())?;
    let is_step = step.is_finite() && step > 0.0;
    is_step
        .then_some(step)
        .ok_or_else(|| "give a time above zero, as \"5 ms\"".to_string())
}

/// Parses the most points of a ring.
pub fn points(text: &str) -> Result<usize, String> {
    let found = text.parse().ok().filter(|n| (1..=100_000).contains(n));
    found.ok_or_else(|| "give a number from 1 to 100000".to_string())
}
