//! Colours of quantities. What is never negative goes from dark to light; what has a sign goes from
//! blue over grey at zero to red.

use super::canvas::Colour;
use crate::record::log::viridis;

/// A quantity is shown with its sign if its lowest value is this part of its largest or more.
const SIGNED: f64 = 0.05;

/// Cool to warm (Moreland 2009, Diverging color maps for scientific visualization, Table 1), at
/// quarters.
const DIVERGING: [[f64; 3]; 5] = [
    [59.0, 76.0, 192.0],
    [141.0, 176.0, 254.0],
    [221.0, 221.0, 221.0],
    [244.0, 152.0, 122.0],
    [180.0, 4.0, 38.0],
];

/// Dark blue over green to yellow, with even steps of lightness; light enough for dark arrows.
const PALE: [[f64; 3]; 6] = [
    [70.0, 92.0, 160.0],
    [62.0, 134.0, 178.0],
    [72.0, 176.0, 166.0],
    [132.0, 206.0, 130.0],
    [208.0, 226.0, 104.0],
    [254.0, 240.0, 150.0],
];

/// Colours of what has no sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Plain {
    /// The map viridis.
    Viridis,
    /// Lighter, for what is drawn over it.
    Pale,
}

/// From values to colours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// The lowest and the highest value that are told apart.
    pub range: [f64; 2],
    /// `None`: the values have a sign.
    plain: Option<Plain>,
}

impl Scale {
    /// For values in `range`; from zero on if they have no sign worth showing.
    pub fn new([low, high]: [f64; 2], plain: Plain) -> Scale {
        let is_signed = low < -SIGNED * high.abs();
        let high = match (high > 0.0, low < 0.0) {
            (true, _) => high,
            (_, true) => -SIGNED * low,
            // Of nothing but zeros.
            _ => 1.0,
        };
        match is_signed {
            true => Scale {
                range: [low, high],
                plain: None,
            },
            false => Scale {
                range: [0.0, high],
                plain: Some(plain),
            },
        }
    }

    /// Colour of a value. Equal distances from zero have equal strength.
    pub fn colour(&self, value: f64) -> Colour {
        let [low, high] = self.range;
        match self.plain {
            None => between(&DIVERGING, 0.5 + 0.5 * value / high.max(-low)),
            Some(Plain::Viridis) => viridis((value / high) as f32),
            Some(Plain::Pale) => between(&PALE, value / high),
        }
    }
}

/// Colour at a part of the way through evenly placed ones.
fn between(stops: &[[f64; 3]], part: f64) -> Colour {
    let place = part.clamp(0.0, 1.0) * (stops.len() - 1) as f64;
    let low = (place as usize).min(stops.len() - 2);
    let t = place - low as f64;
    [0, 1, 2].map(|c| (stops[low][c] + t * (stops[low + 1][c] - stops[low][c])).round() as u8)
}

/// The nearest of 1, 2, 5 times a power of ten.
pub fn round_number(value: f64) -> f64 {
    let power = 10f64.powf(value.log10().floor());
    power
        * match value / power {
            part if part < 1.5 => 1.0,
            part if part < 3.5 => 2.0,
            part if part < 7.5 => 5.0,
            _ => 10.0,
        }
}

/// A multiple of `step`, with as many digits as it needs.
pub fn tick(value: f64, step: f64) -> String {
    let digits = (-step.log10().floor()).clamp(0.0, 6.0) as usize;
    let text = format!("{value:.digits$}");
    let is_zero = !text.contains(|c: char| ('1'..='9').contains(&c));
    match is_zero {
        true => text.replace('-', ""),
        false => text.replace('-', "\u{2212}"),
    }
}
