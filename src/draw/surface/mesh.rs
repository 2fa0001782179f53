//! A mesh of the surface: naive surface nets, one vertex in each cell that the surface crosses.
//!
//! Around the grid are nodes outside the liquid (two layers behind the last nodes, where the
//! library needs them), and vertices that come to lie there are put on the sides of the box: so the
//! mesh is closed, and flat at walls and cuts. The mesh of a field of revolution is its outline,
//! turned about the axis.

use fast_surface_nets::ndshape::RuntimeShape;
use fast_surface_nets::{SurfaceNetsBuffer, surface_nets};
use rayon::prelude::*;

use super::contour::Contour;
use super::{Field, LEVEL};
use crate::draw::render::encoded;
use crate::draw::render::trace::{Tracer, V};
use crate::record::mesh::Mesh;

/// How far the edges of a body of revolution may lie inside it, spacings.
const FLATNESS: f32 = 0.05;
/// Its sectors at least.
const SECTORS: usize = 96;

impl Field {
    /// The surface at `time` s as triangles; with colours if the field has them.
    pub fn mesh(&self, time: f64) -> Mesh {
        let tracer = Tracer::without_rays(self);
        let (points, triangles) = match self.axis {
            Some(axis) => self.turned(axis),
            None => self.net(&tracer),
        };
        let normal = |p: &V| {
            tracer
                .closing_normal(p)
                .unwrap_or_else(|| tracer.normal(p))
                .into()
        };
        let colour = |p: &V| encoded(&V::from(tracer.colour(p)));
        Mesh {
            time,
            normals: points.par_iter().map(normal).collect(),
            colours: match self.colours.is_empty() {
                true => Vec::new(),
                false => points.par_iter().map(colour).collect(),
            },
            points: points.into_iter().map(V::into).collect(),
            triangles,
        }
    }

    /// Points and triangles in three dimensions.
    fn net(&self, tracer: &Tracer) -> (Vec<V>, Vec<[u32; 3]>) {
        let padded = self.count.map(|n| n as u32 + 3);
        // The library's first axis is the one along which nodes follow each other.
        let shape = RuntimeShape::<u32, 3>::new([padded[2], padded[1], padded[0]]);
        let [_, rows, row] = padded.map(|n| n as usize);
        let mut depth = vec![LEVEL; padded.iter().map(|n| *n as usize).product()];
        for (n, values) in self.values.chunks(self.count[2]).enumerate() {
            let (i, j) = (n / self.count[1] + 1, n % self.count[1] + 1);
            let start = (i * rows + j) * row + 1;
            let out = depth[start..start + values.len()].iter_mut();
            out.zip(values)
                .for_each(|(out, value)| *out = LEVEL - value);
        }
        let mut net = SurfaceNetsBuffer::default();
        let last = [padded[2] - 1, padded[1] - 1, padded[0] - 1];
        surface_nets(&depth, &shape, [0; 3], last, &mut net);
        let [low, high] = tracer.corners();
        let place = |[z, y, x]: [f32; 3]| {
            let at = V::new(x - 1.0, y - 1.0, z - 1.0).component_mul(&self.step);
            (low + at).zip_zip_map(&low, &high, |c, low, high| c.clamp(low, high))
        };
        let points = net.positions.par_iter().map(|p| place(*p)).collect();
        (points, triangles(&net.indices))
    }

    /// Points and triangles of the outline, turned about the axis.
    fn turned(&self, [x, y]: [f32; 2]) -> (Vec<V>, Vec<[u32; 3]>) {
        let Contour { points, lines } = self.contour(LEVEL);
        let widest = points.iter().map(|p| p[0]).fold(0.0, f32::max);
        let step = (1.0 - FLATNESS * self.spacing / widest).max(0.0).acos();
        let sectors = ((std::f32::consts::PI / step).ceil() as usize).max(SECTORS);
        // A point on the axis is one vertex, any other one in each sector.
        let mut first = Vec::new();
        let mut vertices = Vec::new();
        for [r, z] in points {
            first.push(vertices.len() as u32);
            let count = if r > 0.0 { sectors } else { 1 };
            for k in 0..count {
                let (sin, cos) = (std::f32::consts::TAU * k as f32 / sectors as f32).sin_cos();
                vertices.push(V::new(x + r * cos, y + r * sin, z));
            }
        }
        first.push(vertices.len() as u32);
        let mut triangles = Vec::new();
        for line in lines {
            for k in 0..sectors as u32 {
                let [[a, b], [c, d]] = line.map(|point| {
                    let [first, end] = [0, 1].map(|n| first[point as usize + n]);
                    [k, k + 1].map(|k| first + k % (end - first))
                });
                if a != b {
                    triangles.push([a, b, d]);
                }
                if c != d {
                    triangles.push([a, d, c]);
                }
            }
        }
        (vertices, triangles)
    }
}

/// With the axes in reverse order, what was counter-clockwise is clockwise.
fn triangles(indices: &[u32]) -> Vec<[u32; 3]> {
    let corners = indices.chunks_exact(3);
    corners.map(|c| [c[0], c[2], c[1]]).collect()
}
