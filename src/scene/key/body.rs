//! Settings of bodies.

use super::super::resolve::{AXES, ENDS};
use super::super::{Body, Dimension, Motion, Scene, Shape};
use super::flow::walls;
use super::{List, Unit};

/// What the packing of a body depends on: its size, and the box if it stands in it.
pub(super) fn size(list: &mut List, scene: &Scene, body: &Body) {
    form(list, scene, body, "body");
    for (axis, side) in body.shape.cuts(&scene.domain).into_iter().enumerate() {
        if let Some(side) = side {
            let (axis, end) = (AXES[axis], ENDS[side]);
            list.text(&format!("box.{axis}"), &format!("body.cut.{axis}"), end);
        }
    }
    if !body.shape.is_free() {
        place(list, scene, body, "body");
        walls(list, scene);
    }
}

pub(super) fn vector(scene: &Scene, vector: &[f64; 3]) -> Vec<f64> {
    scene
        .dimension
        .axes()
        .iter()
        .map(|&axis| vector[axis])
        .collect()
}

/// Form and size of a free shape.
pub(super) fn form(list: &mut List, scene: &Scene, body: &Body, tag: &str) {
    let name = format!("body.{}", body.name);
    let dimension = scene.dimension;
    match &body.shape {
        Shape::Sphere { radius, .. } => {
            let name = format!("{name}.{}.diameter", word(dimension, "sphere", "disc"));
            let tag = format!("{tag}.sphere");
            list.numbers(&name, &tag, &[2.0 * radius], Unit::Length);
        }
        Shape::Ellipsoid { semi_axes, .. } => {
            let name = format!(
                "{name}.{}.semi_axes",
                word(dimension, "ellipsoid", "ellipse")
            );
            let tag = format!("{tag}.ellipsoid");
            list.numbers(&name, &tag, &vector(scene, semi_axes), Unit::Length);
        }
        Shape::Block { .. } | Shape::Layer { .. } => {}
    }
}

/// Where a shape is; of layers and blocks, their size too.
pub(super) fn place(list: &mut List, scene: &Scene, body: &Body, tag: &str) {
    let name = format!("body.{}", body.name);
    let dimension = scene.dimension;
    let mut point = |shape: &str, key: &str, values: &[f64]| {
        let (name, tag) = (format!("{name}.{shape}.{key}"), format!("{tag}.{key}"));
        list.numbers(&name, &tag, values, Unit::Length);
    };
    match &body.shape {
        Shape::Sphere { centre, .. } => {
            point(
                word(dimension, "sphere", "disc"),
                "centre",
                &vector(scene, centre),
            );
        }
        Shape::Ellipsoid { centre, .. } => {
            point(
                word(dimension, "ellipsoid", "ellipse"),
                "centre",
                &vector(scene, centre),
            );
        }
        Shape::Block { low, high } => {
            let shape = word(dimension, "block", "rectangle");
            point(shape, "low", &vector(scene, low));
            point(shape, "high", &vector(scene, high));
        }
        Shape::Layer { depth } => point("layer", "depth", &[*depth]),
    }
}

/// The word of the file in 3-D and in 2-D.
fn word(dimension: Dimension, spatial: &'static str, planar: &'static str) -> &'static str {
    match dimension {
        Dimension::Three => spatial,
        Dimension::Two => planar,
    }
}

pub(super) fn motion(list: &mut List, scene: &Scene, body: &Body, tag: &str) {
    let name = format!("body.{}", body.name);
    match &body.motion {
        Motion::Uniform([x, y, z]) if *x == 0.0 && *y == 0.0 && *z <= 0.0 => {
            let tag = format!("{tag}.velocity");
            let downward = 0.0 - z;
            list.numbers(&format!("{name}.velocity"), &tag, &[downward], Unit::Speed);
        }
        Motion::Uniform(velocity) => {
            let values = vector(scene, velocity);
            let tag = format!("{tag}.velocity");
            list.numbers(&format!("{name}.velocity"), &tag, &values, Unit::Speed);
        }
        Motion::TaylorGreen { speed } => {
            let tag = format!("{tag}.taylor_green");
            list.numbers(
                &format!("{name}.taylor_green.speed"),
                &tag,
                &[*speed],
                Unit::Speed,
            );
        }
        Motion::Stretch { rate } => {
            let tag = format!("{tag}.stretch");
            list.numbers(&format!("{name}.stretch.rate"), &tag, &[*rate], Unit::Rate);
        }
    }
}

pub(super) fn body_colour(list: &mut List, body: &Body, tag: &str) {
    let [red, green, blue] = body.colour;
    let shown = format!("#{red:02x}{green:02x}{blue:02x}");
    list.text(
        &format!("body.{}.colour", body.name),
        &format!("{tag}.colour"),
        &shown,
    );
}
