//! From bodies to states and back: where a body stands while it relaxes, and the state at t = 0.

use super::Phase;
use super::model::Model;
use crate::particle::{Particles, State, pack, ring, wall};
use crate::scene::input::{ImpactInput, Start};
use crate::scene::{Body, Dimension, Method, Motion, Problem, Shape, Side};
use std::borrow::Cow;

fn shift(particles: &mut Particles, by: [f64; 3]) {
    for (x, by) in particles.position.iter_mut().zip(by) {
        x.iter_mut().for_each(|x| *x += by);
    }
}

/// The state in which a packed body starts to relax: with its pressure at rest, so that no sound
/// wave has to die out first. `problem`: [`Problem::resting`].
pub fn resting(problem: &Problem, body: &Particles) -> State {
    let mut particles = body.clone();
    particles.mass = mass(problem);
    particles.body.fill(0);
    let spec = &problem.bodies[0];
    weigh(problem, spec, &mut particles);
    if let Some(model) = evolving(problem, AT_REST) {
        particles.density = rest_density(problem, &model, spec, body);
    }
    shift(&mut particles, centre(&spec.shape));
    State {
        particles,
        ..State::default()
    }
}

/// Mass of a particle of a problem, kg.
fn mass(problem: &Problem) -> f64 {
    let sph = problem.method.sph();
    pack::mass(problem.space(), problem.density, problem.spacing, sph)
}

/// Gives the particles of a packed body the masses of rings where the box is a half-plane beside an
/// axis: the body has its volume, and areas of the plane have the same mass.
fn weigh(problem: &Problem, spec: &Body, body: &mut Particles) {
    if !problem.domain.is_axial() {
        return;
    }
    let spacing = problem.spacing;
    let pitch = wall::Lattice::new(&problem.domain, problem.dimension, spacing).pitch[0];
    let rings = body.position[0].iter_mut();
    let weights = rings.map(|r| ring::settle(r, pitch, spacing)).collect();
    body.weight = weights;
    let whole = spec.shape.revolved(&problem.domain) / spacing.powi(3);
    let part = whole / body.weight.iter().sum::<f64>();
    body.weight.iter_mut().for_each(|weight| *weight *= part);
}

const AT_REST: Phase = Phase::Relax { damping: 0.0 };

/// The model of a method in which density has an equation of its own.
fn evolving(problem: &Problem, phase: Phase) -> Option<Model> {
    let Method::Wcsph(settings) = &problem.method else {
        return None;
    };
    let model = Model::new(problem, settings, phase);
    model.diffusion().is_some().then_some(model)
}

/// Density of `body` in packed coordinates under its pressure at rest, kg/m^3: of the column above
/// (Stevin) in a body that stands on walls, (d-1) sigma / R (Young, Laplace) in a round one.
fn rest_density(problem: &Problem, model: &Model, spec: &Body, body: &Particles) -> Vec<f64> {
    let d = problem.space() as f64;
    let laplace = |radius: f64| {
        let pressure = (d - 1.0) * problem.effects.sigma().unwrap_or(0.0) / radius;
        vec![model.density_at(pressure); body.len()]
    };
    let (low, high) = match &spec.shape {
        Shape::Sphere { radius, .. } => return laplace(*radius),
        Shape::Ellipsoid { semi_axes: a, .. } if problem.domain.is_axial() => {
            return laplace((a[0] * a[0] * a[2]).cbrt());
        }
        Shape::Ellipsoid { semi_axes: a, .. } => {
            let product: f64 = a.iter().filter(|a| **a > 0.0).product();
            return laplace(product.powf(1.0 / d));
        }
        Shape::Block { low, high } => (*low, *high),
        Shape::Layer { depth } => {
            let [x, y, _] = problem.domain.size;
            ([0.0; 3], [x, y, *depth])
        }
    };
    let g = problem.effects.gravity.unwrap_or([0.0; 3]);
    let column = |i: usize, a: usize| {
        let top = if g[a] < 0.0 { high[a] } else { low[a] };
        g[a] * (body.position[a][i] - top)
    };
    let stands = |a: &usize| problem.domain.boundary[*a] != [Side::Periodic; 2];
    let pressure = |i| model.density * (0..3).filter(stands).map(|a| column(i, a)).sum::<f64>();
    (0..body.len())
        .map(|i| model.density_at(pressure(i)))
        .collect()
}

/// The body of a relaxing state, back about its own origin; at rest, sorted by id.
pub fn relaxed(problem: &Problem, state: &State) -> Particles {
    let mut body = by_id(&at_home(problem, state));
    body.velocity.iter_mut().for_each(|v| v.fill(0.0));
    body
}

/// The first body of a state about its own origin.
pub(super) fn at_home(problem: &Problem, state: &State) -> Particles {
    let mut particles = state.particles.clone();
    if let Some(index) = particles.body.first().copied() {
        let home = centre(&problem.bodies[index as usize].shape);
        shift(&mut particles, home.map(|x| -x));
    }
    particles
}

fn by_id(p: &Particles) -> Particles {
    let mut order: Vec<usize> = (0..p.len()).collect();
    order.sort_unstable_by_key(|&i| p.id[i]);
    let pick = |v: &Vec<f64>| order.iter().map(|&i| v[i]).collect::<Vec<f64>>();
    Particles {
        id: order.iter().map(|&i| p.id[i]).collect(),
        body: order.iter().map(|&i| p.body[i]).collect(),
        position: [
            pick(&p.position[0]),
            pick(&p.position[1]),
            pick(&p.position[2]),
        ],
        velocity: [
            pick(&p.velocity[0]),
            pick(&p.velocity[1]),
            pick(&p.velocity[2]),
        ],
        density: pick(&p.density),
        mass: p.mass,
        weight: match p.weight.is_empty() {
            true => Vec::new(),
            false => pick(&p.weight),
        },
    }
}

/// The state at t = 0: packed or relaxed bodies, in the order of the scene, at their places and
/// with their velocities.
pub fn initial(input: &ImpactInput, bodies: &[Particles]) -> State {
    let scene = &input.problem;
    let mut all = Particles {
        mass: mass(scene),
        ..Particles::default()
    };
    let impact = evolving(scene, Phase::Impact);
    for (index, body) in bodies.iter().enumerate() {
        let spec = &scene.bodies[index];
        let mut body = Cow::Borrowed(body);
        if scene.domain.is_axial() && body.weight.is_empty() {
            weigh(scene, spec, body.to_mut());
        }
        let body = body.as_ref();
        all.weight.extend_from_slice(&body.weight);
        let relax = evolving(&scene.resting(index), AT_REST);
        // The same pressure under the other sound speed.
        let density: Vec<f64> = match (&impact, relax, input.start) {
            (Some(impact), _, Start::Packed) => rest_density(scene, impact, spec, body),
            (Some(impact), Some(relax), Start::Relaxed) => {
                let ratio = (relax.sound_speed / impact.sound_speed).powi(2);
                let excess = |rho: &f64| scene.density + ratio * (rho - scene.density);
                body.density.iter().map(excess).collect()
            }
            _ => body.density.clone(),
        };
        let centre = centre(&spec.shape);
        let first = all.len() as u32;
        for i in 0..body.len() {
            let local = [0, 1, 2].map(|a| body.position[a][i]);
            let v = velocity(scene, &spec.motion, &spec.shape, local);
            for a in 0..3 {
                all.position[a].push(local[a] + centre[a]);
                all.velocity[a].push(v[a]);
            }
            all.density.push(density[i]);
            all.id.push(first + body.id[i]);
            all.body.push(index as u8);
        }
    }
    State {
        particles: all,
        ..State::default()
    }
}

/// Particles of one body inside another's shape by more than half a spacing, where relaxation has
/// brought them: body, the other, how many. None if there are none.
pub fn intruders(scene: &Problem, state: &State) -> Option<(usize, usize, usize)> {
    let (p, dimension) = (&state.particles, scene.dimension);
    let half = 0.5 * scene.spacing;
    let inside = |shape: &Shape, i: usize| {
        let x = [0, 1, 2].map(|a| p.position[a][i]);
        let beside = |a: usize, by: f64| {
            let mut x = x;
            x[a] += by;
            shape.contains(x, &scene.domain, dimension)
        };
        let axes = dimension.axes().iter();
        axes.flat_map(|&a| [(a, -half), (a, half)])
            .all(|(a, by)| beside(a, by))
    };
    let bodies = 0..scene.bodies.len();
    let mut pairs = bodies
        .clone()
        .flat_map(|a| bodies.clone().map(move |b| (a, b)));
    pairs.find_map(|(a, b)| {
        let shape = &scene.bodies[b].shape;
        let of = |&i: &usize| a != b && p.body[i] as usize == a && inside(shape, i);
        let count = (0..p.len()).filter(of).count();
        (count > 0).then_some((a, b, count))
    })
}

/// Where the packed origin goes.
pub(super) fn centre(shape: &Shape) -> [f64; 3] {
    match shape {
        Shape::Sphere { centre, .. } | Shape::Ellipsoid { centre, .. } => *centre,
        Shape::Block { .. } | Shape::Layer { .. } => [0.0; 3],
    }
}

/// Velocity of a point of a body in packed coordinates.
fn velocity(scene: &Problem, motion: &Motion, shape: &Shape, x: [f64; 3]) -> [f64; 3] {
    match motion {
        Motion::Uniform(v) => *v,
        Motion::TaylorGreen { speed } => {
            let k = std::f64::consts::TAU / scene.domain.size[0];
            let at = centre(shape);
            let (x, z) = (k * (x[0] + at[0]), k * (x[2] + at[2]));
            [-speed * x.cos() * z.sin(), 0.0, speed * x.sin() * z.cos()]
        }
        Motion::Stretch { rate } => {
            let lateral = if scene.space() == 2 { 1.0 } else { 0.5 };
            let y = if scene.dimension == Dimension::Two {
                0.0
            } else {
                x[1]
            };
            [-lateral * rate * x[0], -lateral * rate * y, rate * x[2]]
        }
    }
}
