//! Units: exact in both directions.

use coronet::scene::quantity::{QuantityError, Unit, human, parse};
use proptest::prelude::*;

#[test]
fn units_scale_by_exact_powers_of_ten() {
    for (text, unit, value) in [
        ("3.13 m/s", Unit::Speed, 3.13),
        ("313 cm/s", Unit::Speed, 3.13),
        ("0.9 mm", Unit::Length, 0.0009),
        ("900 um", Unit::Length, 0.0009),
        ("900 \u{b5}m", Unit::Length, 0.0009),
        ("900\u{3bc}m", Unit::Length, 0.0009),
        ("9e-4 m", Unit::Length, 0.0009),
        ("9E-1mm", Unit::Length, 0.0009),
        ("-.5 mm", Unit::Length, -0.0005),
        ("67 mN/m", Unit::Tension, 0.067),
        ("67 dyn/cm", Unit::Tension, 0.067),
        ("3.5 mPa s", Unit::Viscosity, 0.0035),
        ("3.5 mPa\u{b7}s", Unit::Viscosity, 0.0035),
        ("3.5 cP", Unit::Viscosity, 0.0035),
        ("1.1 g/cm^3", Unit::Density, 1100.0),
        ("1.1 g/cm\u{b3}", Unit::Density, 1100.0),
        ("9.81 m/s2", Unit::Acceleration, 9.81),
        ("40 ms", Unit::Time, 0.04),
        ("500 1/s", Unit::Rate, 500.0),
        ("1 uJ/kg", Unit::SpecificEnergy, 1e-6),
    ] {
        assert_eq!(parse(text, unit), Ok(value), "{text}");
    }
}

#[test]
fn every_tenth_of_a_millimetre_is_the_number_in_metres() {
    for tenths in 0..10_000 {
        let millimetres = format!("{}.{} mm", tenths / 10, tenths % 10);
        let metres: f64 = format!("{tenths}e-4").parse().unwrap();
        assert_eq!(
            parse(&millimetres, Unit::Length),
            Ok(metres),
            "{millimetres}"
        );
    }
}

#[test]
fn wrong_units_are_told_from_unknown_ones() {
    let wrong = parse("3.13 mm", Unit::Speed).unwrap_err();
    assert_eq!(
        wrong.to_string(),
        "`mm` is the unit of a length, where a speed is expected"
    );
    let unknown = parse("3.13 furlong", Unit::Speed).unwrap_err();
    assert_eq!(
        unknown.to_string(),
        "`furlong` is not a known unit of speed"
    );
    assert_eq!(
        parse("3.13", Unit::Speed),
        Err(QuantityError::NoUnit(Unit::Speed))
    );
    for text in ["", "m/s", "- m/s", ". m/s", "e5 m/s"] {
        assert_eq!(
            parse(text, Unit::Speed),
            Err(QuantityError::NoNumber),
            "{text:?}"
        );
    }
    assert_eq!(
        parse("1e999 m/s", Unit::Speed),
        Err(QuantityError::NotFinite)
    );
}

#[test]
fn people_see_the_unit_they_would_choose() {
    for (value, unit, text) in [
        (0.004, Unit::Length, "4 mm"),
        (0.00025, Unit::Length, "0.25 mm"),
        (2.5e-6, Unit::Length, "2.5 um"),
        (3.13, Unit::Speed, "3.13 m/s"),
        (-3.13, Unit::Speed, "-3.13 m/s"),
        (0.067, Unit::Tension, "67 mN/m"),
        (0.0035, Unit::Viscosity, "3.5 mPa s"),
        (0.04, Unit::Time, "40 ms"),
        (0.0, Unit::Time, "0 s"),
        (1e-6, Unit::Time, "1 us"),
        (1100.0, Unit::Density, "1100 kg/m^3"),
        (4.5, Unit::One, "4.5"),
    ] {
        assert_eq!(human(value, unit), text);
    }
}

proptest! {
    #[test]
    fn what_people_see_reads_back_to_the_same_bits(value in any::<f64>()) {
        prop_assume!(value.is_finite());
        for unit in [Unit::Length, Unit::Time, Unit::Tension, Unit::Speed, Unit::One] {
            let shown = human(value, unit);
            prop_assert_eq!(parse(&shown, unit).unwrap(), value, "{}", shown);
        }
    }
}
