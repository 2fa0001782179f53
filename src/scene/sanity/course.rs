//! The path of a body from its initial velocity, if it falls freely and keeps its shape.

use super::super::{Body, Motion, Scene, Shape, Side};

/// End of the path of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Course {
    /// It meets another body, a wall, or its image behind a mirror.
    Meets,
    /// Its middle passes an open side at this time, s.
    Leaves(f64),
    /// Neither before the end of the run.
    Alone,
}

/// Part of its own size that a body moves in a step of the search, and bounds of their number.
const STRIDE: f64 = 0.2;
const STEPS: [f64; 2] = [100.0, 100_000.0];

/// Low and high corner, m.
type Bounds = ([f64; 3], [f64; 3]);

impl Course {
    /// The path of body number `index` until `impact.end`. Bounding boxes stand for shapes, so that
    /// bodies that may meet count as meeting.
    pub fn of(scene: &Scene, index: usize) -> Course {
        let end = scene.impact.end;
        let body = &scene.bodies[index];
        if matches!(body.shape, Shape::Layer { .. }) {
            return Course::Meets;
        }
        let (low, high) = body.shape.bounds(&scene.domain, scene.dimension);
        let axes = scene.dimension.axes();
        let size = |axis: &usize| high[*axis] - low[*axis];
        let least = axes.iter().map(size).fold(f64::INFINITY, f64::min);
        let path = |body: &Body| travel(scene, body, end).iter().map(|x| x * x).sum::<f64>();
        let longest = scene.bodies.iter().map(path).fold(0.0, f64::max).sqrt();
        let steps = (longest / (STRIDE * least))
            .clamp(STEPS[0], STEPS[1])
            .ceil();
        for step in 1..=steps as u64 {
            let time = end * step as f64 / steps;
            let here = moved(scene, body, time);
            let course = axes
                .iter()
                .find_map(|axis| passes(scene, &here, *axis, time));
            if let Some(course) = course {
                return course;
            }
            let others = scene
                .bodies
                .iter()
                .enumerate()
                .filter(|(other, _)| *other != index);
            let mut others = others.map(|(_, other)| moved(scene, other, time));
            if others.any(|other| overlap(scene, &here, &other)) {
                return Course::Meets;
            }
        }
        Course::Alone
    }
}

/// What happens to a body at the sides of an axis.
fn passes(scene: &Scene, (low, high): &Bounds, axis: usize, time: f64) -> Option<Course> {
    let size = scene.domain.size[axis];
    let near = 1e-9 * size;
    let middle = 0.5 * (low[axis] + high[axis]);
    let beyond = [
        (low[axis] < -near, middle < 0.0),
        (high[axis] > size + near, middle > size),
    ];
    let sides = scene.domain.boundary[axis].iter().zip(beyond);
    sides
        .into_iter()
        .find_map(|(side, (touches, is_out))| match side {
            Side::Wall | Side::Mirror if touches => Some(Course::Meets),
            Side::Open if is_out => Some(Course::Leaves(time)),
            _ => None,
        })
}

/// Displacement of a body, m; zero for a layer and for a block at rest.
fn travel(scene: &Scene, body: &Body, time: f64) -> [f64; 3] {
    let velocity = match body.motion {
        Motion::Uniform(velocity) => velocity,
        _ => [0.0; 3],
    };
    let stands = match body.shape {
        Shape::Layer { .. } => true,
        Shape::Block { .. } => velocity == [0.0; 3],
        _ => false,
    };
    if stands {
        return [0.0; 3];
    }
    let gravity = scene.effects.gravity.unwrap_or([0.0; 3]);
    [0, 1, 2].map(|axis| velocity[axis] * time + 0.5 * gravity[axis] * time * time)
}

fn moved(scene: &Scene, body: &Body, time: f64) -> Bounds {
    let (low, high) = body.shape.bounds(&scene.domain, scene.dimension);
    let by = travel(scene, body, time);
    let shifted = |corner: [f64; 3]| [0, 1, 2].map(|axis| corner[axis] + by[axis]);
    (shifted(low), shifted(high))
}

/// Whether two boxes have points in common, also through periodic sides.
fn overlap(scene: &Scene, a: &Bounds, b: &Bounds) -> bool {
    scene.dimension.axes().iter().all(|&axis| {
        let middle = |(low, high): &Bounds| 0.5 * (low[axis] + high[axis]);
        let half = |(low, high): &Bounds| 0.5 * (high[axis] - low[axis]);
        let (size, mut apart) = (scene.domain.size[axis], middle(a) - middle(b));
        if scene.domain.boundary[axis][0] == Side::Periodic {
            apart -= size * (apart / size).round();
        }
        apart.abs() < half(a) + half(b)
    })
}
