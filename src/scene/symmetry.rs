//! Mirror planes: scenes that are a part of a symmetric whole.
//!
//! A lateral side of the box may be a plane of symmetry, [`Side::Mirror`]. The box is then half of
//! a whole that is unfolded about its low side, or about the high side if only that is a mirror; if
//! both are, the whole is periodic. The plane of unfolding cuts a round body whose centre lies in
//! it; a block that touches the plane continues behind it. `box.symmetry` cuts such a part from a
//! whole scene. Solvers, checkpoints and logs contain the part only; measures are those of the
//! whole, in which a body beside the plane has an image. An axis whose plane of unfolding cuts no
//! body is not unfolded: its mirrors are frictionless sides, and measures are those of the box.
//! Mist that crosses the plane of unfolding is reflected like all liquid; at the plane on the other
//! side of the box it is removed, as at the periodic sides of the whole.
//! Tests: tests/engine/scene_symmetry.rs, tests/engine/method_mirror.rs.

use super::domain::Symmetry;
use super::error::SceneError;
use super::tree::Tree;
use super::{AXES, Body, Dimension, Domain, Motion, Problem, Scene, Shape, Side};

/// Lengths that differ by less than this part of the box are equal.
const EQUAL: f64 = 1e-9;

impl Domain {
    /// Places of the mirror planes of an axis, low and high, m.
    pub fn mirrors(&self, axis: usize) -> [Option<f64>; 2] {
        let [low, high] = self.boundary[axis].map(|side| side == Side::Mirror);
        [low.then_some(0.0), high.then_some(self.size[axis])]
    }

    /// The side of an axis about which the box is unfolded; `None` without mirror planes there.
    pub fn fold(&self, axis: usize) -> Option<usize> {
        let sides = self.boundary[axis].iter();
        let folds = |side: &Side| matches!(side, Side::Mirror | Side::Axis);
        sides.clone().position(folds)
    }

    /// Whether the box is the half-plane beside an axis of revolution, x the distance from it.
    pub fn is_axial(&self) -> bool {
        self.boundary[0][0] == Side::Axis
    }

    /// Whether the plane of a 2-D box is a section through an axis of revolution.
    pub fn is_revolved(&self) -> bool {
        self.revolved.is_some()
    }

    /// Whether a side is a wall.
    pub fn has_wall(&self) -> bool {
        let mut sides = self.boundary.iter().flatten();
        sides.any(|side| *side == Side::Wall)
    }

    /// The same box with a mirror plane in place of an axis: areas of the half-plane are filled
    /// evenly.
    pub fn planar(mut self) -> Self {
        for side in self.boundary.iter_mut().flatten() {
            if *side == Side::Axis {
                *side = Side::Mirror;
            }
        }
        self
    }

    /// Whether any side is a mirror plane.
    pub fn is_part(&self) -> bool {
        (0..3).any(|axis| self.fold(axis).is_some())
    }

    /// Whether `x` m is beyond a side of the box from which mist does not return: any side but that
    /// of unfolding. A particle that crosses that one is still inside the whole.
    pub fn is_crossed(&self, axis: usize, x: f64) -> bool {
        let fold = self.fold(axis);
        let size = self.size[axis];
        size > 0.0 && ((x < 0.0 && fold != Some(0)) || (x >= size && fold != Some(1)))
    }

    /// Place of the plane of unfolding of an axis, m.
    fn plane(&self, axis: usize) -> Option<f64> {
        self.fold(axis).map(|side| [0.0, self.size[axis]][side])
    }
}

impl Shape {
    /// Along each axis the side at which a plane of unfolding cuts a round body in two.
    pub fn cuts(&self, domain: &Domain) -> [Option<usize>; 3] {
        let (Shape::Sphere { centre, .. } | Shape::Ellipsoid { centre, .. }) = self else {
            return [None; 3];
        };
        [0, 1, 2].map(|axis| {
            let near = |plane: &f64| (centre[axis] - plane).abs() <= EQUAL * domain.size[axis];
            domain.plane(axis).filter(near).and(domain.fold(axis))
        })
    }

    /// Number of equal parts of which this is one: a factor of 2 for each plane of unfolding.
    pub fn parts(&self, domain: &Domain) -> f64 {
        let met = (0..3).filter(|axis| self.is_met(domain, *axis)).count();
        2f64.powi(met as i32)
    }

    /// Whether the plane of unfolding of an axis cuts this, or is one of its sides.
    fn is_met(&self, domain: &Domain, axis: usize) -> bool {
        match self {
            Shape::Block { low, high } => match domain.fold(axis) {
                Some(0) => low[axis] <= EQUAL * domain.size[axis],
                Some(_) => high[axis] >= (1.0 - EQUAL) * domain.size[axis],
                None => false,
            },
            Shape::Layer { .. } => domain.fold(axis).is_some(),
            _ => self.cuts(domain)[axis].is_some(),
        }
    }
}

impl Scene {
    /// The side about which an axis is unfolded to the whole: that of an axis of revolution, or of
    /// a mirror plane that cuts a body or touches a block. A layer alone touches every side and
    /// does not count.
    pub fn unfolds(&self, axis: usize) -> Option<usize> {
        let is_cut = |body: &Body| body.shape.is_met(&self.domain, axis);
        let solid = |body: &&Body| !matches!(body.shape, Shape::Layer { .. });
        let fold = self.domain.fold(axis)?;
        let mut bodies = self.bodies.iter().filter(solid);
        let is_axis = self.domain.boundary[axis][fold] == Side::Axis;
        (is_axis || bodies.any(is_cut)).then_some(fold)
    }

    /// The whole of which this scene is a part; the scene itself if no mirror plane cuts it. Images
    /// of bodies that the planes do not touch come after all other bodies.
    pub fn whole(&self) -> Scene {
        let mut whole = self.clone();
        for axis in 0..3 {
            let Some(fold) = self.unfolds(axis) else {
                continue;
            };
            let is_beside = |body: &Body| !body.shape.is_met(&self.domain, axis);
            let beside: Vec<bool> = whole.bodies.iter().map(is_beside).collect();
            let (size, sides) = (self.domain.size[axis], self.domain.boundary[axis]);
            whole.domain.size[axis] = 2.0 * size;
            whole.domain.boundary[axis] = match sides[1 - fold] {
                Side::Mirror => [Side::Periodic; 2],
                side => [side; 2],
            };
            let velocity = self.domain.wall_velocity[axis][1 - fold];
            whole.domain.wall_velocity[axis] = [velocity; 2];
            for body in &mut whole.bodies {
                unfold(body, &self.domain, axis, fold);
            }
            let unfolded = whole.bodies.iter().zip(beside);
            let images = unfolded.filter(|(_, is_beside)| *is_beside);
            let images: Vec<Body> = images.map(|(body, _)| image(body, axis, size)).collect();
            whole.bodies.extend(images);
        }
        whole
    }

    /// The whole in three dimensions: of rings the body of revolution in the box from which its
    /// half-plane was cut, else [`Scene::whole`]. Places of its bodies are those of the half-plane.
    pub fn solid(&self) -> Scene {
        if !self.domain.is_axial() {
            return self.whole();
        }
        let mut solid = self.clone();
        solid.dimension = Dimension::Three;
        let (radius, side) = (self.domain.size[0], self.domain.boundary[0][1]);
        for axis in 0..2 {
            solid.domain.size[axis] = 2.0 * radius;
            solid.domain.boundary[axis] = [side; 2];
            solid.domain.wall_velocity[axis] = [self.domain.wall_velocity[0][1]; 2];
        }
        solid
    }
}

/// The image of a body behind a plane across an axis at `plane` m.
fn image(body: &Body, axis: usize, plane: f64) -> Body {
    let mut image = body.clone();
    image.name = format!("{} (image)", body.name);
    match &mut image.shape {
        Shape::Sphere { centre, .. } | Shape::Ellipsoid { centre, .. } => {
            centre[axis] = 2.0 * plane - centre[axis];
        }
        Shape::Block { low, high } => {
            (low[axis], high[axis]) = (2.0 * plane - high[axis], 2.0 * plane - low[axis]);
        }
        Shape::Layer { .. } => {}
    }
    if let Motion::Uniform(velocity) = &mut image.motion {
        velocity[axis] = 0.0 - velocity[axis];
    }
    image
}

/// Moves a body of the part to its place in the whole.
fn unfold(body: &mut Body, domain: &Domain, axis: usize, fold: usize) {
    let size = domain.size[axis];
    let (shift, near) = ([size, 0.0][fold], EQUAL * size);
    match &mut body.shape {
        Shape::Sphere { centre, .. } | Shape::Ellipsoid { centre, .. } => centre[axis] += shift,
        Shape::Block { low, high } => {
            let meets = [low[axis] <= near, high[axis] >= size - near][fold];
            (low[axis], high[axis]) = (low[axis] + shift, high[axis] + shift);
            match (meets, fold) {
                (true, 0) => low[axis] = 2.0 * size - high[axis],
                (true, _) => high[axis] = 2.0 * size - low[axis],
                _ => {}
            }
        }
        Shape::Layer { .. } => {}
    }
}

/// Cuts a whole scene as `box.symmetry` requires; its low sides become mirror planes.
///
/// # Errors
/// [`SceneError`] if the scene is not symmetric about its middle.
pub(super) fn cut(
    scene: &mut Problem,
    symmetry: Symmetry,
    tree: &Tree<'_>,
) -> Result<(), SceneError> {
    let key = "box.symmetry";
    let axes = match (symmetry, scene.dimension) {
        (Symmetry::Half, _) => 0..1,
        (Symmetry::Quarter, Dimension::Three) => 0..2,
        (Symmetry::Axis, Dimension::Three) => return revolve(scene, tree),
        (Symmetry::Axis, Dimension::Two) => {
            let remedy = "make it `dimension = 3`; the run is a plane all the same";
            return Err(tree.fault(key, "is of a scene of three dimensions", remedy));
        }
        _ => return Err(tree.fault(key, "is for three dimensions", "write \"half\"")),
    };
    for axis in axes {
        if let Some((what, remedy)) = lopsided(scene, axis) {
            let problem = format!("needs a scene that is symmetric in {}: {what}", AXES[axis]);
            return Err(tree.fault(key, &problem, &format!("{remedy}, or leave `{key}` out")));
        }
        halve(scene, axis);
    }
    Ok(())
}

/// Turns a scene of revolution into the half-plane beside its axis.
fn revolve(scene: &mut Problem, tree: &Tree<'_>) -> Result<(), SceneError> {
    let faults = (0..2).find_map(|axis| lopsided(scene, axis));
    if let Some((what, remedy)) = faults.or_else(|| angular(scene)) {
        let problem = format!("needs a scene of revolution about the vertical: {what}");
        let remedy = format!("{remedy}, or leave `box.symmetry` out");
        return Err(tree.fault("box.symmetry", &problem, &remedy));
    }
    halve(scene, 0);
    let domain = &mut scene.domain;
    domain.boundary[0][0] = Side::Axis;
    domain.boundary[1] = [Side::Periodic; 2];
    domain.size[1] = 0.0;
    domain.wall_velocity[1] = Default::default();
    scene.dimension = Dimension::Two;
    for body in &mut scene.bodies {
        match &mut body.shape {
            Shape::Sphere { centre, .. } => centre[1] = 0.0,
            Shape::Ellipsoid { centre, semi_axes } => (centre[1], semi_axes[1]) = (0.0, 0.0),
            Shape::Block { low, high } => (low[1], high[1]) = (0.0, 0.0),
            Shape::Layer { .. } => {}
        }
    }
    Ok(())
}

/// What of a scene that is symmetric in x and y is not of revolution, and a remedy.
fn angular(scene: &Problem) -> Option<(String, String)> {
    let domain = &scene.domain;
    let [x, y, _] = domain.boundary;
    if domain.size[0] != domain.size[1] || x != y {
        let what = "the box differs in x and y".to_string();
        return Some((
            what,
            "give `box.size` and the sides the same x and y".into(),
        ));
    }
    if x[0] == Side::Periodic {
        let what = "periodic sides are not of revolution".to_string();
        let remedy = "make `box.x` and `box.y` \"wall\", which is a cylinder then, or \"open\"";
        return Some((what, remedy.into()));
    }
    if domain.wall_velocity[0] != domain.wall_velocity[1] {
        let what = "the walls in x and y slide differently".to_string();
        let remedy = "give all four of `box.wall_velocity` the same";
        return Some((what, remedy.into()));
    }
    scene.bodies.iter().find_map(|body| match &body.shape {
        Shape::Ellipsoid { semi_axes: a, .. } if a[0] != a[1] => {
            let what = format!("the semi-axes of body `{}` differ in x and y", body.name);
            Some((what, "make the first two the same".into()))
        }
        Shape::Block { .. } => {
            let what = format!("body `{}` is a block", body.name);
            Some((what, "use a layer, a sphere or an ellipsoid".into()))
        }
        _ => None,
    })
}

/// What is not symmetric about the middle of an axis, and a remedy.
pub(super) fn lopsided(scene: &Problem, axis: usize) -> Option<(String, String)> {
    let (domain, name) = (&scene.domain, AXES[axis]);
    let [low, high] = domain.boundary[axis];
    if low != high || low == Side::Mirror {
        let remedy = format!("write \"periodic\", \"wall\" or \"open\" for `box.{name}`");
        return Some((format!("the sides in {name} differ or are mirrors"), remedy));
    }
    let [low, high] = domain.wall_velocity[axis];
    if low != high {
        let what = format!("the walls in {name} slide differently");
        let remedy = format!("give {name}_low and {name}_high of `box.wall_velocity` the same");
        return Some((what, remedy));
    }
    if let Some((what, remedy)) = crosswise(scene, axis) {
        return Some((what, remedy));
    }
    let middle = 0.5 * domain.size[axis];
    let near = |x: f64| (x - middle).abs() <= EQUAL * domain.size[axis];
    scene.bodies.iter().find_map(|body| {
        let centred = match &body.shape {
            Shape::Sphere { centre, .. } | Shape::Ellipsoid { centre, .. } => near(centre[axis]),
            Shape::Block { low, high } => near(0.5 * (low[axis] + high[axis])),
            Shape::Layer { .. } => true,
        };
        let what = format!("body `{}` is not in the middle", body.name);
        (!centred).then(|| (what, format!("move it to {name} = half of `box.size`")))
    })
}

/// What moves or acts across the planes of an axis, and a remedy.
pub(super) fn crosswise(scene: &Problem, axis: usize) -> Option<(String, String)> {
    let name = AXES[axis];
    let domain = &scene.domain;
    let mut forces = scene.effects.body_forces().into_iter();
    if forces.any(|force| force[axis] != 0.0) {
        let remedy = "let its `direction` point along the planes".to_string();
        return Some((format!("a body force acts along {name}"), remedy));
    }
    if domain
        .wall_velocity
        .iter()
        .flatten()
        .any(|v| v[axis] != 0.0)
    {
        let remedy = format!("make the {name} of `box.wall_velocity` 0");
        return Some((format!("a wall slides along {name}"), remedy));
    }
    scene.bodies.iter().find_map(|body| {
        let across = match body.motion {
            // A body beside the plane collides with its image.
            Motion::Uniform(v) => {
                let meets = domain.fold(axis).is_none() || body.shape.parts(domain) > 1.0;
                v[axis] != 0.0 && meets
            }
            Motion::TaylorGreen { .. } => true,
            Motion::Stretch { .. } => false,
        };
        let what = format!("body `{}` moves along {name}", body.name);
        across.then(|| (what, format!("give it no velocity along {name}")))
    })
}

/// Keeps the high half along `axis`.
fn halve(scene: &mut Problem, axis: usize) {
    let domain = &mut scene.domain;
    let half = 0.5 * domain.size[axis];
    domain.size[axis] = half;
    domain.boundary[axis] = match domain.boundary[axis][1] {
        Side::Periodic => [Side::Mirror; 2],
        side => [Side::Mirror, side],
    };
    domain.wall_velocity[axis][0] = [0.0; 3];
    for body in &mut scene.bodies {
        match &mut body.shape {
            Shape::Sphere { centre, .. } | Shape::Ellipsoid { centre, .. } => centre[axis] = 0.0,
            Shape::Block { low, high } => {
                (low[axis], high[axis]) = (0.0, high[axis] - half);
            }
            Shape::Layer { .. } => {}
        }
    }
}
