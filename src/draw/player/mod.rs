//! The liquid of some frames, small enough for a page that plays them: numbers are quantised,
//! written as differences and compressed.
//!
//! | kind | points | faces | of |
//! |---|---|---|---|
//! | `mesh` | x, y, z | three points each | three dimensions |
//! | `outline` | distance from the axis, z | two points each | rings |
//! | `points` | x, z | none | two dimensions: the particles |
//!
//! A shot is, before its compression (zlib), for each coordinate of its points a column of 16 bits
//! between [`Shot::low`] and `low + size`, for each component of its normals a column of 8 bits (0
//! to 254 for -1 to 1; of `points` instead one column with their bodies), and the corners of its
//! faces as one column of 32 bits. A column holds the differences of each value to the one before
//! (the first: to 0, all modulo its range), first their lowest bytes, then the next ones.

use std::io::Write;

use flate2::Compression;
use flate2::write::ZlibEncoder;

use crate::draw::render::trace::{Tracer, V};
use crate::draw::surface::{Field, LEVEL};
use crate::measure::whole::Unfold;
use crate::particle::Frame;
use crate::scene::{Dimension, Scene};

/// Shots of a film, about.
pub const SHOTS: f64 = 40.0;
/// Points of a mesh, about, and of a cloud at most.
const POINTS: f64 = 30_000.0;
/// Bytes of all shots at most; then every second one is left out.
const BYTES: usize = 8 << 20;
/// Nodes in a spacing of the outline of rings.
const NODES: f64 = 2.0;
/// From how many spacings between nodes on particles are shared among nodes.
const COARSE: f64 = 1.5;

/// What a shot consists of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Triangles.
    Mesh,
    /// Lines beside an axis.
    Outline,
    /// Particles.
    Points,
}

impl Kind {
    /// Its name in the page.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Mesh => "mesh",
            Kind::Outline => "outline",
            Kind::Points => "points",
        }
    }
}

/// The liquid of a frame.
#[derive(Clone, Debug)]
pub struct Shot {
    /// Simulated time, s.
    pub time: f64,
    /// Low corner, m.
    pub low: Vec<f32>,
    /// Extent, m.
    pub size: Vec<f32>,
    /// Number of points.
    pub points: usize,
    /// Number of faces.
    pub faces: usize,
    /// See [`self`].
    pub bytes: Vec<u8>,
}

/// Makes the shots of a run.
pub struct Player {
    scene: Scene,
    part: Scene,
    unfold: Unfold,
    /// Of how many frames one is shown.
    every: u64,
}

impl Player {
    /// For frames of `part`, the simulated part of a scene.
    pub fn new(part: &Scene) -> Player {
        // A condition may end the run long before.
        let frames = match part.impact.stop_when.is_empty() {
            true => (part.impact.end / part.frames.interval).floor() + 1.0,
            false => 1.0,
        };
        Player {
            scene: part.solid(),
            unfold: Unfold::new(part),
            part: part.clone(),
            every: (frames / SHOTS).ceil().max(1.0) as u64,
        }
    }

    /// Whether the frame with this number, from 0, is shown.
    pub fn shows(&self, frame: u64) -> bool {
        frame.is_multiple_of(self.every)
    }

    /// Leaves out every second shot, then and from now on, if there are too many.
    pub fn limit(&mut self, shots: &mut Vec<Shot>) {
        if shots.len() as f64 > 2.0 * SHOTS {
            halve(shots);
            self.every *= 2;
        }
    }

    /// What the shots are.
    pub fn kind(&self) -> Kind {
        match (self.part.domain.is_axial(), self.scene.dimension) {
            (true, _) => Kind::Outline,
            (false, Dimension::Three) => Kind::Mesh,
            (false, Dimension::Two) => Kind::Points,
        }
    }

    /// Edges of the box of the whole, m.
    pub fn size(&self) -> [f64; 3] {
        self.scene.domain.size
    }

    /// The shot of a frame; `None` without liquid.
    pub fn shot(&self, frame: &Frame) -> Option<Shot> {
        match self.kind() {
            Kind::Mesh => self.mesh(frame),
            Kind::Outline => self.outline(frame),
            Kind::Points => Some(self.points(&self.unfold.whole(frame))),
        }
    }

    fn mesh(&self, frame: &Frame) -> Option<Shot> {
        let (scene, whole) = (&self.scene, self.unfold.whole(frame));
        let extent = [0, 1, 2].map(|a| extent(&whole.position[a]));
        let [x, y, z] = extent.map(|[low, high]| f64::from(high - low) + scene.spacing);
        // The surface crosses about as many cells as its box has squares on its sides.
        let fitting = (2.0 * (x * y + y * z + z * x) / POINTS).sqrt();
        let cell = fitting.max(0.5 * scene.spacing);
        let field = match cell < COARSE * scene.spacing {
            true => Field::with_nodes(scene, &whole, &[], cell)?,
            false => Field::coarse(scene, &whole, cell)?,
        };
        let mesh = field.mesh(frame.time);
        let faces: Vec<u32> = mesh.triangles.concat();
        let sides = columns(&mesh.normals);
        Some(shot(frame.time, &mesh.points, &sides, &faces, 3))
    }

    fn outline(&self, frame: &Frame) -> Option<Shot> {
        let field = Field::turned_with(&self.part, frame, &[], NODES)?;
        let (contour, tracer) = (field.contour(LEVEL), Tracer::without_rays(&field));
        let [x, y] = field.axis?;
        let normal = |[r, z]: &[f32; 2]| {
            let at = V::new(x + r, y, *z);
            let normal = tracer.closing_normal(&at);
            let normal = normal.unwrap_or_else(|| tracer.normal(&at));
            [normal.x, normal.z]
        };
        let normals: Vec<[f32; 2]> = contour.points.iter().map(normal).collect();
        let faces: Vec<u32> = contour.lines.concat();
        let sides = columns(&normals);
        Some(shot(frame.time, &contour.points, &sides, &faces, 2))
    }

    fn points(&self, frame: &Frame) -> Shot {
        let [x, _, z] = &frame.position;
        let every = (x.len() as f64 / POINTS).ceil().max(1.0) as usize;
        let all = (0..x.len()).step_by(every);
        let is_there = |i: &usize| x[*i].is_finite() && z[*i].is_finite();
        let shown: Vec<usize> = all.filter(is_there).collect();
        let points: Vec<[f32; 2]> = shown.iter().map(|&i| [x[i], z[i]]).collect();
        let bodies = shown.iter().map(|&i| frame.body[i]).collect();
        shot(frame.time, &points, &[bodies], &[], 1)
    }
}

/// The shots that fit into a page.
pub fn thinned(mut shots: Vec<Shot>) -> Vec<Shot> {
    while shots.len() > 2 && shots.iter().map(|shot| shot.bytes.len()).sum::<usize>() > BYTES {
        halve(&mut shots);
    }
    shots
}

/// Leaves out every second one.
fn halve(shots: &mut Vec<Shot>) {
    let mut keep = [true, false].into_iter().cycle();
    shots.retain(|_| keep.next().unwrap_or(true));
}

fn extent(values: &[f32]) -> [f32; 2] {
    let known = values.iter().filter(|v| v.is_finite());
    known.fold([f32::MAX, f32::MIN], |[low, high], v| {
        [low.min(*v), high.max(*v)]
    })
}

/// Columns of normals.
fn columns<const D: usize>(normals: &[[f32; D]]) -> [Vec<u8>; D] {
    let part = |a: usize| move |n: &[f32; D]| (127.0 + 127.0 * n[a]).round() as u8;
    std::array::from_fn(|a| normals.iter().map(part(a)).collect())
}

/// `sides`: columns of 8 bits; `corners`: of a face.
fn shot<const D: usize>(
    time: f64,
    points: &[[f32; D]],
    sides: &[Vec<u8>],
    faces: &[u32],
    corners: usize,
) -> Shot {
    let column = |a: usize| points.iter().map(|p| p[a]).collect::<Vec<f32>>();
    let (mut low, mut size, mut bytes) = (Vec::new(), Vec::new(), Vec::new());
    for a in 0..D {
        let values = column(a);
        let [from, to] = match values.is_empty() {
            true => [0.0; 2],
            false => extent(&values),
        };
        let length = (to - from).max(f32::MIN_POSITIVE);
        let quantised = values
            .iter()
            .map(|v| (65535.0 * (v - from) / length).round() as u32);
        put(&mut bytes, quantised, 2);
        low.push(from);
        size.push(length);
    }
    for side in sides {
        put(&mut bytes, side.iter().map(|value| u32::from(*value)), 1);
    }
    put(&mut bytes, faces.iter().copied(), 4);
    let mut packed = ZlibEncoder::new(Vec::new(), Compression::new(7));
    let written = packed.write_all(&bytes).and_then(|()| packed.finish());
    Shot {
        time,
        low,
        size,
        points: points.len(),
        faces: faces.len() / corners,
        bytes: written.expect("writing to memory does not fail"),
    }
}

/// A column of numbers of so many bytes.
fn put(bytes: &mut Vec<u8>, values: impl Iterator<Item = u32>, width: usize) {
    let mut before = 0;
    let steps: Vec<u32> = values
        .map(|value| {
            let step = value.wrapping_sub(before);
            before = value;
            step
        })
        .collect();
    for byte in 0..width {
        bytes.extend(steps.iter().map(|step| (step >> (8 * byte)) as u8));
    }
}
