//! What is measured of a scene, and when its drop meets pool or wall.

use super::pool::Axis;
use crate::scene::{Body, Dimension, Motion, Scene, Shape as Geometry, Side};

/// Kind of a scene, from its bodies.
#[derive(Clone, Copy, Debug)]
pub enum Kind {
    /// A drop falls into a pool: crater, crown, jet.
    Pool(Axis),
    /// A drop falls on a dry wall: spread.
    Wall(Axis),
    /// Drops and blocks in free space: shape.
    Shape,
    /// A column that collapses: front.
    Front,
    /// Liquid at rest under gravity: its level.
    Level,
    /// No surface.
    Bulk,
}

impl Kind {
    /// The kind of `scene`, from its bodies and its box.
    pub fn new(scene: &Scene) -> Kind {
        let layer = scene
            .bodies
            .iter()
            .any(|b| matches!(b.shape, Geometry::Layer { .. }));
        let drop = drop(scene);
        let wets = scene.effects.wetting.is_some();
        let down = wets || scene.effects.gravity.is_some_and(|g| g[2] < 0.0);
        let floor = scene.domain.boundary[2][0] == Side::Wall;
        match drop {
            Some((_, axis)) if layer => Kind::Pool(axis),
            Some((body, axis)) if floor && (down || speed_down(body) > 0.0) => Kind::Wall(axis),
            Some(_) => Kind::Shape,
            None if layer && floor => Kind::Level,
            None => Kind::of_blocks(scene, down && floor),
        }
    }

    fn of_blocks(scene: &Scene, falls: bool) -> Kind {
        let size = scene.domain.size;
        let near = 0.5 * scene.spacing;
        let spans = |axis: usize| {
            let flat = axis == 1 && scene.dimension == Dimension::Two;
            flat || scene.bodies.iter().any(|body| match body.shape {
                Geometry::Block { low, high } => low[axis] < near && high[axis] > size[axis] - near,
                Geometry::Layer { depth } => axis < 2 || depth > size[2] - near,
                _ => false,
            })
        };
        match (spans(0) && spans(1), spans(2), falls) {
            (true, true, _) => Kind::Bulk,
            (true, false, true) => Kind::Level,
            (false, _, true) => Kind::Front,
            _ => Kind::Shape,
        }
    }
}

/// The body that is measured as the drop, with its axis: the falling drop that arrives first, else
/// the first of the file.
fn drop(scene: &Scene) -> Option<(&Body, Axis)> {
    let bodies = scene.bodies.iter();
    let drops = bodies.filter_map(|body| axis(scene, body).map(|axis| (body, axis)));
    let key = |body: &Body| arrival(scene, body).unwrap_or(f64::INFINITY);
    drops.min_by(|(a, _), (b, _)| key(a).total_cmp(&key(b)))
}

/// Axis of a drop, or of a block that becomes a drop on a wall with a contact angle, with the
/// diameter of equal volume.
fn axis(scene: &Scene, body: &Body) -> Option<Axis> {
    let equal = || 2.0 * body.shape.equivalent_radius(&scene.domain, scene.dimension);
    let (centre, diameter) = match &body.shape {
        Geometry::Sphere { centre, radius } => (*centre, 2.0 * radius),
        Geometry::Ellipsoid { centre, .. } => (*centre, equal()),
        Geometry::Block { low, high } if scene.effects.wetting.is_some() => {
            ([0, 1, 2].map(|a| 0.5 * (low[a] + high[a])), equal())
        }
        _ => return None,
    };
    Some(Axis {
        at: [0, 1].map(|a| landing(scene, body, a, centre[a])),
        diameter,
    })
}

/// Where along axis `a` a body that starts at `from` arrives, m: by the law of free fall.
fn landing(scene: &Scene, body: &Body, a: usize, from: f64) -> f64 {
    let (Motion::Uniform(velocity), Some(time)) = (&body.motion, arrival(scene, body)) else {
        return from;
    };
    let (pull, time) = (
        scene.effects.gravity.map_or(0.0, |g| g[a]),
        time.min(scene.impact.end),
    );
    let way = velocity[a] * time + 0.5 * pull * time * time;
    match (way == 0.0, scene.domain.boundary[a] == [Side::Periodic; 2]) {
        (true, _) => from,
        (_, true) => (from + way).rem_euclid(scene.domain.size[a]),
        (_, false) => (from + way).clamp(0.0, scene.domain.size[a]),
    }
}

/// The axes of all drops but the one that is measured.
pub(super) fn other_drops(scene: &Scene, measured: &Axis) -> Vec<Axis> {
    let all = scene.bodies.iter().filter_map(|body| axis(scene, body));
    all.filter(|axis| axis.at != measured.at).collect()
}

/// [`contact_within`], 0 if there is none. Plots count from it, and references with
/// [`Clock::Contact`](crate::scene::Clock::Contact).
pub fn contact_time(scene: &Scene) -> f64 {
    contact_within(scene).unwrap_or(0.0)
}

/// [`contact`], if it is before the end of the run.
pub fn contact_within(scene: &Scene) -> Option<f64> {
    contact(scene).filter(|time| *time < scene.impact.end)
}

/// Time at which the freely falling drop meets pool, wall or resting drop, s from the start: by the
/// law of free fall, not by the particles, so that it is the same for all methods and spacings. 0
/// if they touch from the start, `None` if nothing falls on anything.
pub fn contact(scene: &Scene) -> Option<f64> {
    if !matches!(Kind::new(scene), Kind::Pool(_) | Kind::Wall(_)) {
        return None;
    }
    let (body, _) = drop(scene)?;
    let touches = drop_height(scene, body) <= 0.0;
    arrival(scene, body).or(touches.then_some(0.0))
}

/// Time at which a freely falling body meets pool or floor, s; `None` if it does not fall.
fn arrival(scene: &Scene, body: &Body) -> Option<f64> {
    let height = drop_height(scene, body).max(0.0);
    let pull = scene.effects.gravity.map_or(0.0, |g| -g[2]);
    let speed = speed_down(body);
    let square = speed * speed + 2.0 * pull * height;
    // The root of speed t + pull t^2 / 2 = height, in a form without cancellation.
    let mean = speed + square.sqrt();
    (mean > 0.0).then(|| 2.0 * height / mean)
}

/// How far a body is above what is below it, m: the pool or the floor, or another body that rests
/// there.
fn drop_height(scene: &Scene, body: &Body) -> f64 {
    let ground = scene.pool_depth().unwrap_or(0.0);
    let low = |body: &Body| body.shape.bounds(&scene.domain, scene.dimension).0[2] - ground;
    let rests = |other: &&Body| {
        other.name != body.name
            && !matches!(other.shape, Geometry::Layer { .. })
            && matches!(other.motion, Motion::Uniform(v) if v == [0.0; 3])
            && low(other) < 0.5 * scene.spacing
    };
    let resting = scene.bodies.iter().filter(rests);
    let gaps = resting.filter_map(|other| gap(scene, body, other));
    gaps.fold(low(body), f64::min)
}

/// How far a body can fall before it meets another, m; `None` if it falls past or is below. Round
/// bodies that are no spheres, and blocks, count as their boxes.
fn gap(scene: &Scene, body: &Body, other: &Body) -> Option<f64> {
    let sphere = |body: &Body| match body.shape {
        Geometry::Sphere { centre, radius } => Some((centre, radius)),
        _ => None,
    };
    let gap = if let (Some((c, r)), Some((o, s))) = (sphere(body), sphere(other)) {
        let beside = (c[0] - o[0]).hypot(c[1] - o[1]);
        let square = (r + s).powi(2) - beside.powi(2);
        (square > 0.0).then(|| c[2] - o[2] - square.sqrt())
    } else {
        let bounds = |body: &Body| body.shape.bounds(&scene.domain, scene.dimension);
        let ((low, high), (base, top)) = (bounds(body), bounds(other));
        let meets = (0..2).all(|a| low[a] <= top[a] && base[a] <= high[a]);
        meets.then(|| low[2] - top[2])
    };
    gap.filter(|gap| *gap > -0.5 * scene.spacing)
}

/// Whether a single drop falls on a dry wall: it moves towards it, or starts above it under
/// gravity. Without that there is neither a lamella nor a rebound.
pub fn strikes_wall(scene: &Scene) -> bool {
    let whole = scene.whole();
    let lone = whole.bodies.len() == 1 && matches!(Kind::new(&whole), Kind::Wall(_));
    lone && drop(&whole).is_some_and(|(body, _)| {
        let is_above = drop_height(&whole, body) > 0.5 * whole.spacing;
        arrival(&whole, body).is_some() && (is_above || speed_down(body) > 0.0)
    })
}

/// m/s.
fn speed_down(body: &Body) -> f64 {
    match body.motion {
        Motion::Uniform(v) => -v[2],
        _ => 0.0,
    }
}
