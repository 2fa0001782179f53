//! Frames, and the pictures that are made of them.

use super::Warning;
use crate::scene::quantity::{Unit, legible};
use crate::scene::{Scene, numbers};

/// A log with one frame only.
pub(super) fn frames(scene: &Scene) -> Option<Warning> {
    let (interval, end) = (scene.frames.interval, scene.impact.end);
    (interval > end).then(|| {
        let end = legible(end, Unit::Time);
        let why = format!("the run ends after {end}: only the first frame is recorded");
        let remedy = "make it shorter, a fiftieth of `impact.end` or less";
        Warning::new(
            "frames.interval",
            legible(interval, Unit::Time),
            &why,
            remedy,
        )
    })
}

/// Pictures of instants at which there is no frame.
pub(super) fn pictures(scene: &Scene) -> Vec<Warning> {
    let interval = scene.frames.interval;
    let asked = [
        ("post.panels", &scene.post.panels),
        ("post.fields", &scene.post.fields),
    ];
    let off = asked.into_iter().filter_map(|(key, instants)| {
        let is_between = |at: &&f64| {
            let frames = **at / interval;
            **at <= scene.impact.end && (frames - frames.round()).abs() > 1e-6
        };
        let at = *instants.iter().find(is_between)?;
        // The earlier one of two, as pictures are taken.
        let nearest = (at / interval - 0.5)
            .ceil()
            .min((scene.impact.end / interval).floor());
        // No negative zero.
        let nearest = numbers::short(nearest.abs() * interval, Unit::Time);
        let why = format!(
            "no frame is taken then; the picture shows the frame at {nearest}, the nearest"
        );
        let remedy = "choose a `frames.interval` of which all instants are multiples";
        Some(Warning::new(key, legible(at, Unit::Time), &why, remedy))
    });
    off.collect()
}
