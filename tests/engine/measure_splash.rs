//! Splashes of known shape for the tests of measures: liquid where a formula says so.

use coronet::particle::Frame;
use coronet::scene::*;

use crate::pack_scene;

/// What a splash is made of, mm; z from the initial level. Zero is absent.
#[derive(Clone, Copy, Debug, Default)]
pub struct Splash {
    /// Radius of a hemispherical crater.
    pub crater: f64,
    /// Inner and outer radius and height of a crown.
    pub crown: [f64; 3],
    /// Radius and height of a jet.
    pub jet: [f64; 2],
    /// Radius and height of the centre of a ball above the ring of the crown, not connected.
    pub mist: [f64; 2],
    /// Radius and depth of a bubble under the surface.
    pub bubble: [f64; 2],
}

pub const DEPTH: f64 = 10.0;
pub const DIAMETER: f64 = 4.0;
pub const SIDE: f64 = 24.0;

impl Splash {
    /// Whether there is liquid at distance r from the axis and height z, mm.
    fn holds(&self, r: f64, z: f64) -> bool {
        let [inner, outer, crown] = self.crown;
        let [jet, top] = self.jet;
        let [mist, above] = self.mist;
        let [bubble, below] = self.bubble;
        let pool = z < 0.0 && r.hypot(z) > self.crater && r.hypot(z + below) > bubble;
        let ring = r > inner && r < outer && z > -1.0 && z < crown;
        let column = r < jet && z < top;
        let ball = (r - 0.5 * (inner + outer)).hypot(z - above) < mist;
        pool || ring || column || ball
    }
}

/// A pool with a drop above it; spacing in mm.
pub fn pool_scene(dimension: Dimension, spacing: f64) -> Scene {
    let mm = 1e-3;
    let flat = dimension == Dimension::Two;
    let centre = [
        0.5 * SIDE,
        if flat { 0.0 } else { 0.5 * SIDE },
        DEPTH + 2.0 + 0.313,
    ];
    let mut scene = pack_scene::scene(dimension, [1.0; 3], Shape::Layer { depth: DEPTH * mm });
    scene.domain.size = [SIDE * mm, if flat { 0.0 } else { SIDE * mm }, 30.0 * mm];
    scene.spacing = spacing * mm;
    scene.effects.gravity = Some([0.0, 0.0, -9.81]);
    scene.bodies[0].name = "pool".into();
    scene.bodies[0].colour = [70, 140, 200];
    scene.bodies.push(Body {
        name: "drop".into(),
        shape: Shape::Sphere {
            centre: centre.map(|x| x * mm),
            radius: 0.5 * DIAMETER * mm,
        },
        motion: Motion::Uniform([0.0, 0.0, -3.13]),
        colour: [230, 120, 50],
    });
    scene
}

/// Particles on a lattice wherever `holds(x, y, z)` (mm) says liquid.
pub fn lattice(scene: &Scene, holds: impl Fn(f64, f64, f64) -> bool) -> Frame {
    let s = scene.spacing * 1e3;
    let size = scene
        .domain
        .size
        .map(|x| (x * 1e3 / s).round().max(1.0) as usize);
    let flat = scene.dimension == Dimension::Two;
    let mut frame = Frame::default();
    for k in 0..size[2] {
        for j in 0..size[1] {
            for i in 0..size[0] {
                let at = |n: usize| (n as f64 + 0.5) * s;
                let (x, y, z) = (at(i), if flat { 0.0 } else { at(j) }, at(k));
                if holds(x, y, z) {
                    push(&mut frame, [x, y, z].map(|c| (c * 1e-3) as f32));
                }
            }
        }
    }
    frame
}

pub fn push(frame: &mut Frame, x: [f32; 3]) {
    frame.id.push(frame.id.len() as u32);
    frame.body.push(0);
    for (axis, value) in x.into_iter().enumerate() {
        frame.position[axis].push(value);
        frame.velocity[axis].push(0.0);
    }
    frame.pressure.push(0.0);
    frame.density.push(1100.0);
    frame.surface.push(0);
}

/// The splash in the pool of `scene`, about the drop's axis.
pub fn splash(scene: &Scene, splash: &Splash) -> Frame {
    let flat = scene.dimension == Dimension::Two;
    let centre = 0.5 * SIDE;
    lattice(scene, |x, y, z| {
        let r = (x - centre).hypot(if flat { 0.0 } else { y - centre });
        splash.holds(r, z - DEPTH)
    })
}
