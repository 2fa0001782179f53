//! Theory of the thickness of the lamella of a drop on a dry wall.
//!
//! Roisman, Rioboo & Tropea (2002), as Xie, Koshizuka & Oka (2007) quote it and extend it to two
//! dimensions. At t = D0 / U0 the liquid is a lamella of mean thickness h1 D0 and diameter d1 D0:
//! (1) 3 We + 5 (1 - cos theta) Re h1 = 10 Re We h1^3,  d1 = sqrt(2 / (3 h1))  Eqs. 19, 20
//! (2) 3 We + 2 (1 - cos theta) Re h1 = 4 Re We h1^3,  d1 = pi / (4 h1)  2-D: Eqs. 21, 22
//! Derived again from the assumptions stated there (a rigid drop squeezes a film of constant
//! thickness; the momentum that it loses is the film's pressure and that of a meniscus as high as
//! the lamella, sigma (1 - cos theta) / (h1 D0)), the second terms are
//! (3) 10 (1 - cos theta) Re h1^2 in (1), 4 (1 - cos theta) Re h1^2 in (2);
//! the others come out as printed.
//!
//! Holds while there is a film, h1 well below 1/2. Test: tests/engine/measure_lamella.rs.

use super::{Dimension, Problem};

/// Dimensions of the space in which a drop spreads: three where particles are rings.
pub fn spreads_in(problem: &Problem) -> Dimension {
    match problem.space() {
        3 => Dimension::Three,
        _ => Dimension::Two,
    }
}

/// h1: mean thickness over the diameter of the drop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thickness {
    /// (1) or (2).
    pub printed: f64,
    /// (3) in place of the second term.
    pub corrected: f64,
}

impl Thickness {
    /// We and Re of the drop's diameter; `angle`: contact angle, degrees.
    pub fn new(dimension: Dimension, weber: f64, reynolds: f64, angle: f64) -> Thickness {
        let (cubic, linear) = match dimension {
            Dimension::Three => (10.0, 5.0),
            Dimension::Two => (4.0, 2.0),
        };
        // Divided by We, which may be infinite.
        let meniscus = (1.0 - angle.to_radians().cos()) * reynolds / weber;
        let thickness = |capillary: &dyn Fn(f64) -> f64| {
            positive_root(|h| cubic * reynolds * h.powi(3) - 3.0 - capillary(h) * meniscus)
        };
        Thickness {
            printed: thickness(&|h| linear * h),
            corrected: thickness(&|h| 2.0 * linear * h * h),
        }
    }
}

/// The only positive root of a function that is negative at 0 and increases beyond the root.
fn positive_root(f: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    while f(high) < 0.0 {
        (low, high) = (high, 2.0 * high);
    }
    // To round-off.
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if f(middle) < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}
