//! Settings of a method that do not go together are refused, with what to set.

use super::scene_file::{SMALL, small};
use coronet::scene::{file, sanity};
use std::path::Path;

/// The error of `SMALL` with these settings; none if it is read.
fn refused(sets: &[&str]) -> String {
    let sets: Vec<String> = sets.iter().map(|set| set.to_string()).collect();
    match file::read(SMALL, Path::new("small.toml"), &sets) {
        Ok(_) => String::new(),
        Err(error) => error.to_string(),
    }
}

#[test]
fn unstable_combinations_are_refused() {
    let no_tension = "effects.tension.form=raw-colour";
    for (sets, parts) in [
        (
            &[
                "method.wcsph.time_stepping={ adaptive = {} }",
                "method.wcsph.shifting=4",
                no_tension,
            ][..],
            &["method.wcsph.shifting", "single-rate"][..],
        ),
        (
            &["method.name=isph", "method.isph.smoothing=1.1", no_tension],
            &["method.isph.smoothing", "too narrow"],
        ),
        (
            &[
                "method.name=mps",
                "method.mps.radius=2.1",
                "method.mps.laplacian_radius=2.1",
            ],
            &["laplacian_radius", "too narrow"],
        ),
        (
            &[
                "method.name=mps",
                "method.mps.gradient=symmetric",
                no_tension,
            ],
            &["method.mps.gradient", "negative pressure"],
        ),
        (
            &["method.name=isph", "method.isph.theta=0.5"],
            &["method.isph.theta", "0.55"],
        ),
        (
            &[
                "method.name=isph",
                "method.isph.source={ divergence = { density = 0.3 } }",
            ],
            &["density", "0.2"],
        ),
        (&["method.slack=0"], &["method.slack", "0.02"]),
        (
            &["method.name=mps", "method.mps.core=1"],
            &["method.mps.core", "0.9"],
        ),
    ] {
        let error = refused(sets);
        for part in parts {
            assert!(
                error.contains(part),
                "{sets:?}: {part:?} is not in {error:?}"
            );
        }
    }
    let single = ["method.wcsph.time_stepping={ adaptive = {} }", no_tension];
    assert_eq!(refused(&single), "");
}

#[test]
fn what_leaks_or_loses_its_surface_is_warned_of() {
    for (sets, key) in [
        (
            [
                "method.wcsph.wall_pressure=summation",
                "effects.tension.form=raw-colour",
            ],
            "method.wcsph.wall_pressure",
        ),
        (
            ["method.name=isph", "method.isph.closure=mirrored"],
            "method.isph.closure",
        ),
        (
            ["method.name=mps", "method.mps.closure=threshold"],
            "method.mps.closure",
        ),
    ] {
        let warnings = sanity::warnings(&small(&sets).scene);
        assert!(warnings.iter().any(|warning| warning.key == key), "{key}");
    }
}
