//! Quantities with units: `"3.13 m/s"` to SI and back.
//!
//! A unit of this table is a power of ten of the SI unit, so a conversion shifts the decimal
//! exponent in the text and rounds once: `"0.9 mm"` and `"0.0009 m"` give the same `f64`.
//! (`0.9 * 1e-3` does not: equal quantities would get unequal keys.)

/// The physical dimension of a setting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// m.
    Length,
    /// s.
    Time,
    /// m/s.
    Speed,
    /// m/s^2.
    Acceleration,
    /// kg/m^3.
    Density,
    /// Dynamic viscosity, Pa s.
    Viscosity,
    /// Surface tension, N/m.
    Tension,
    /// Energy per mass, J/kg.
    SpecificEnergy,
    /// 1/s.
    Rate,
    /// Degrees.
    Angle,
    /// No unit.
    One,
}

/// Spellings and powers of ten, SI first.
type Table = &'static [(&'static str, i32)];

const LENGTH: Table = &[
    ("m", 0),
    ("mm", -3),
    ("um", -6),
    ("nm", -9),
    ("cm", -2),
    ("km", 3),
];
const TIME: Table = &[("s", 0), ("ms", -3), ("us", -6), ("ns", -9)];
const SPEED: Table = &[
    ("m/s", 0),
    ("mm/s", -3),
    ("um/s", -6),
    ("cm/s", -2),
    ("km/s", 3),
];
const ACCELERATION: Table = &[("m/s^2", 0), ("mm/s^2", -3), ("cm/s^2", -2), ("m/s2", 0)];
const DENSITY: Table = &[
    ("kg/m^3", 0),
    ("g/cm^3", 3),
    ("g/ml", 3),
    ("kg/l", 3),
    ("kg/m3", 0),
    ("g/cm3", 3),
];
const VISCOSITY: Table = &[
    ("Pa s", 0),
    ("mPa s", -3),
    ("uPa s", -6),
    ("cP", -3),
    ("P", -1),
    ("kg/(m s)", 0),
];
const TENSION: Table = &[
    ("N/m", 0),
    ("mN/m", -3),
    ("uN/m", -6),
    ("dyn/cm", -3),
    ("J/m^2", 0),
    ("mJ/m^2", -3),
];
const SPECIFIC_ENERGY: Table = &[
    ("J/kg", 0),
    ("mJ/kg", -3),
    ("uJ/kg", -6),
    ("nJ/kg", -9),
    ("kJ/kg", 3),
    ("m^2/s^2", 0),
];
const RATE: Table = &[
    ("1/s", 0),
    ("1/ms", 3),
    ("/s", 0),
    ("s^-1", 0),
    ("Hz", 0),
    ("kHz", 3),
];
const ANGLE: Table = &[("deg", 0), ("degrees", 0), ("degree", 0), ("\u{b0}", 0)];

const ALL: [Unit; 10] = [
    Unit::Length,
    Unit::Time,
    Unit::Speed,
    Unit::Acceleration,
    Unit::Density,
    Unit::Viscosity,
    Unit::Tension,
    Unit::SpecificEnergy,
    Unit::Rate,
    Unit::Angle,
];

impl Unit {
    /// Spellings with their powers of ten, SI first.
    pub fn spellings(self) -> &'static [(&'static str, i32)] {
        match self {
            Unit::Length => LENGTH,
            Unit::Time => TIME,
            Unit::Speed => SPEED,
            Unit::Acceleration => ACCELERATION,
            Unit::Density => DENSITY,
            Unit::Viscosity => VISCOSITY,
            Unit::Tension => TENSION,
            Unit::SpecificEnergy => SPECIFIC_ENERGY,
            Unit::Rate => RATE,
            Unit::Angle => ANGLE,
            Unit::One => &[],
        }
    }

    /// As in "a length is expected".
    pub fn name(self) -> &'static str {
        match self {
            Unit::Length => "a length",
            Unit::Time => "a time",
            Unit::Speed => "a speed",
            Unit::Acceleration => "an acceleration",
            Unit::Density => "a density",
            Unit::Viscosity => "a dynamic viscosity",
            Unit::Tension => "a surface tension",
            Unit::SpecificEnergy => "an energy per mass",
            Unit::Rate => "a rate",
            Unit::Angle => "an angle",
            Unit::One => "a number",
        }
    }

    /// The unit with this [`Unit::noun`].
    pub fn called(noun: &str) -> Option<Unit> {
        ALL.into_iter().find(|unit| unit.noun() == noun)
    }

    /// As in "a unit of length".
    pub fn noun(self) -> &'static str {
        let name = self.name();
        name.split_once(' ').map_or(name, |(_, noun)| noun)
    }

    /// A value with a unit, as an example of what may be written.
    pub fn example(self) -> &'static str {
        match self {
            Unit::Length => "\"4.0 mm\"",
            Unit::Time => "\"40 ms\"",
            Unit::Speed => "\"3.13 m/s\"",
            Unit::Acceleration => "\"9.81 m/s^2\"",
            Unit::Density => "\"1100 kg/m^3\"",
            Unit::Viscosity => "\"3.5 mPa s\"",
            Unit::Tension => "\"67 mN/m\"",
            Unit::SpecificEnergy => "\"1 uJ/kg\"",
            Unit::Rate => "\"500 1/s\"",
            Unit::Angle => "\"60 deg\"",
            Unit::One => "1.5",
        }
    }

    /// The units that `human` writes: powers of a thousand at most 1.
    fn scales(self) -> &'static [(&'static str, i32)] {
        let count = match self {
            Unit::Length | Unit::Time | Unit::SpecificEnergy => 4,
            Unit::Viscosity | Unit::Tension => 3,
            Unit::One => 0,
            _ => 1,
        };
        &self.spellings()[..count]
    }
}

/// Why a text is not a quantity of the expected dimension.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum QuantityError {
    /// The text does not start with a number.
    #[error("does not start with a number")]
    NoNumber,
    /// There is a number, but no unit.
    #[error("has no unit where {} is expected", .0.name())]
    NoUnit(Unit),
    /// The unit belongs to another dimension.
    #[error("`{unit}` is the unit of {}, where {} is expected", is.name(), wanted.name())]
    WrongUnit {
        /// The unit as written.
        unit: String,
        /// Its dimension.
        is: Unit,
        /// The expected dimension.
        wanted: Unit,
    },
    /// The unit is not in the tables.
    #[error("`{unit}` is not a known unit of {}", wanted.noun())]
    UnknownUnit {
        /// The unit as written.
        unit: String,
        /// The expected dimension.
        wanted: Unit,
    },
    /// The number overflows.
    #[error("is not finite")]
    NotFinite,
}

/// Converts `text`, a number with a unit of `wanted`, to SI.
///
/// # Errors
/// See [`QuantityError`].
pub fn parse(text: &str, wanted: Unit) -> Result<f64, QuantityError> {
    let text = text.trim();
    let (mantissa, exponent, rest) = split_number(text).ok_or(QuantityError::NoNumber)?;
    let unit = canonical(rest);
    if unit.is_empty() {
        return if wanted == Unit::One {
            finite(mantissa, exponent)
        } else {
            Err(QuantityError::NoUnit(wanted))
        };
    }
    if let Some(power) = power_of(&unit, wanted) {
        return finite(mantissa, exponent.saturating_add(power));
    }
    match ALL
        .into_iter()
        .find(|other| power_of(&unit, *other).is_some())
    {
        Some(is) => Err(QuantityError::WrongUnit { unit, is, wanted }),
        None => Err(QuantityError::UnknownUnit { unit, wanted }),
    }
}

/// Writes an SI value with a readable unit and exact digits: `parse` returns the same value.
pub fn human(value: f64, unit: Unit) -> String {
    let scales = unit.scales();
    let Some(&(si, _)) = scales.first() else {
        return format!("{value}");
    };
    if value == 0.0 || !value.is_finite() {
        return format!("{value} {si}");
    }
    let magnitude = value.abs();
    let (name, power) = *scales
        .iter()
        .find(|(name, power)| magnitude >= least(name) * 10f64.powi(*power) * (1.0 - 1e-12))
        .unwrap_or(&scales[0]);
    format!("{} {name}", shifted(value, -power))
}

/// Rounds to 12 digits, so that 40 mm / 80 is shown as 0.5 mm.
pub fn rounded(value: f64) -> f64 {
    format!("{value:.11e}").parse().unwrap_or(value)
}

/// [`human`] of a value that was computed, for readers.
pub fn legible(value: f64, unit: Unit) -> String {
    human(rounded(value), unit)
}

/// The least number that is written with a unit: 0.25 mm, but 250 us.
fn least(unit: &str) -> f64 {
    if unit == "mm" { 0.01 } else { 1.0 }
}

/// `value` x 10^`power` in the shortest digits that identify `value`.
fn shifted(value: f64, power: i32) -> String {
    let text = format!("{value:e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let exponent = exponent.parse::<i32>().unwrap_or(0) + power;
    if !(-4..15).contains(&exponent) {
        return format!("{mantissa}e{exponent}");
    }
    let (sign, mantissa) = match mantissa.strip_prefix('-') {
        Some(rest) => ("-", rest),
        None => ("", mantissa),
    };
    let digits = mantissa.replace('.', "");
    let point = 1 + exponent;
    if point <= 0 {
        return format!(
            "{sign}0.{}{digits}",
            "0".repeat(point.unsigned_abs() as usize)
        );
    }
    let point = point as usize;
    if point >= digits.len() {
        return format!("{sign}{digits}{}", "0".repeat(point - digits.len()));
    }
    format!("{sign}{}.{}", &digits[..point], &digits[point..])
}

/// Mantissa text, decimal exponent, and what follows the number.
fn split_number(text: &str) -> Option<(&str, i32, &str)> {
    let bytes = text.as_bytes();
    let digits = |mut at: usize| {
        while bytes.get(at).is_some_and(u8::is_ascii_digit) {
            at += 1;
        }
        at
    };
    let start = usize::from(matches!(bytes.first(), Some(b'+' | b'-')));
    let mut end = digits(start);
    let mut count = end - start;
    if bytes.get(end) == Some(&b'.') {
        let after = digits(end + 1);
        count += after - end - 1;
        end = after;
    }
    if count == 0 {
        return None;
    }
    let mantissa = &text[..end];
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let signed = end + 1 + usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        let after = digits(signed);
        if after > signed {
            let exponent = text[end + 1..after].parse().ok()?;
            return Some((mantissa, exponent, &text[after..]));
        }
    }
    Some((mantissa, 0, &text[end..]))
}

fn finite(mantissa: &str, exponent: i32) -> Result<f64, QuantityError> {
    let value: f64 = format!("{mantissa}e{exponent}")
        .parse()
        .map_err(|_| QuantityError::NoNumber)?;
    if value.is_finite() {
        Ok(value)
    } else {
        Err(QuantityError::NotFinite)
    }
}

fn power_of(unit: &str, of: Unit) -> Option<i32> {
    let found = of.spellings().iter().find(|(name, _)| *name == unit);
    found.map(|(_, power)| *power)
}

/// One spelling for micro, products and powers.
fn canonical(unit: &str) -> String {
    let unit: String = unit
        .chars()
        .map(|letter| match letter {
            '\u{b5}' | '\u{3bc}' => 'u',
            '\u{b7}' | '*' | '\u{22c5}' => ' ',
            other => other,
        })
        .collect();
    let unit = unit.replace('\u{b2}', "^2").replace('\u{b3}', "^3");
    unit.split_whitespace().collect::<Vec<_>>().join(" ")
}
