//! Meshes of triangles, and their files: PLY, OBJ, glTF (binary, `.glb`), VTP.

mod gltf;
mod obj;
mod ply;
mod vtp;

use std::path::Path;

use super::atomic::{self, FileError};

/// A surface of triangles, counter-clockwise as seen from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Simulated time, s.
    pub time: f64,
    /// Vertices, m.
    pub points: Vec<[f32; 3]>,
    /// Unit normals at the vertices, outward.
    pub normals: Vec<[f32; 3]>,
    /// sRGB colours of the vertices; or empty.
    pub colours: Vec<[u8; 3]>,
    /// Three vertices each.
    pub triangles: Vec<[u32; 3]>,
}

/// A format of meshes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Polygon file format, binary little-endian.
    Ply,
    /// Wavefront OBJ, text.
    Obj,
    /// glTF 2.0 in one binary file; y is up there.
    Glb,
    /// VTK XML PolyData, data appended raw.
    Vtp,
}

impl Format {
    /// The format of files with this extension.
    pub fn of(extension: &str) -> Option<Format> {
        match extension {
            "ply" => Some(Format::Ply),
            "obj" => Some(Format::Obj),
            "glb" => Some(Format::Glb),
            "vtp" => Some(Format::Vtp),
            _ => None,
        }
    }
}

impl Mesh {
    /// Writes the mesh to `path`, atomically.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write(&self, format: Format, path: &Path) -> Result<(), FileError> {
        atomic::write_with(path, |out| match format {
            Format::Ply => ply::write(self, out),
            Format::Obj => obj::write(self, out),
            Format::Glb => gltf::write(self, out),
            Format::Vtp => vtp::write(self, out),
        })
    }

    /// The enclosed volume, m^3.
    pub fn volume(&self) -> f64 {
        let point = |i: u32| self.points[i as usize].map(f64::from);
        let six = self.triangles.iter().map(|corners| {
            let [a, b, c] = corners.map(point);
            a[0] * (b[1] * c[2] - b[2] * c[1])
                + a[1] * (b[2] * c[0] - b[0] * c[2])
                + a[2] * (b[0] * c[1] - b[1] * c[0])
        });
        six.sum::<f64>() / 6.0
    }
}

/// Numbers, little-endian.
fn numbers(values: &[[f32; 3]]) -> Vec<u8> {
    let all = values.as_flattened().iter();
    all.flat_map(|value| value.to_le_bytes()).collect()
}

/// Vertices of the triangles, little-endian.
fn indices(triangles: &[[u32; 3]]) -> Vec<u8> {
    let all = triangles.as_flattened().iter();
    all.flat_map(|index| index.to_le_bytes()).collect()
}
