//! Theory of the lamella of a drop on a dry wall.

use coronet::measure::lamella::Lamella;
use coronet::scene::Dimension;

/// The equations hold for what is found, and a lamella without a meniscus has its closed form.
#[test]
fn the_lamella_solves_its_equations() {
    for (we, re) in [(5.0, 10.0), (20.0, 20.0), (80.0, 40.0), (320.0, 80.0)] {
        for angle in [0.0f64, 60.0, 120.0, 180.0] {
            let wetted = 1.0 - angle.to_radians().cos();
            for (dimension, cubic) in [(Dimension::Two, 4.0), (Dimension::Three, 10.0)] {
                let found = Lamella::new(dimension, we, re, angle);
                let thickness = |d1: f64| match dimension {
                    Dimension::Two => std::f64::consts::PI / (4.0 * d1),
                    Dimension::Three => 2.0 / (3.0 * d1 * d1),
                };
                let residual = |h: f64, capillary: f64| {
                    let left = 3.0 * we + capillary * wetted * re;
                    (left - cubic * re * we * h.powi(3)).abs() / left
                };
                let (a, b) = (thickness(found.printed), thickness(found.corrected));
                assert!(
                    residual(a, 0.5 * cubic * a) < 1e-12,
                    "{dimension:?} {we} {angle}"
                );
                assert!(
                    residual(b, cubic * b * b) < 1e-12,
                    "{dimension:?} {we} {angle}"
                );
                // They meet where h1 = 1/2, and the printed meniscus is the stronger one below.
                assert_eq!(a < 0.5 || wetted == 0.0, found.printed <= found.corrected);
                if wetted == 0.0 {
                    let closed = (3.0 / (cubic * re)).cbrt();
                    assert!((a / closed - 1.0).abs() < 1e-12);
                }
            }
        }
    }
}
