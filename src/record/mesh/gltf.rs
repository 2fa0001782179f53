//! glTF 2.0 in a binary container (Khronos, 2021): a header, JSON, and the arrays. A node turns the
//! upward axis from z to y.

use std::io::{self, Write};

use serde_json::{Value, json};

use super::{Mesh, indices, numbers};
use crate::record::mark::MARK;

/// Component types and targets, as in OpenGL.
const FLOAT: u32 = 5126;
const UNSIGNED: u32 = 5125;
const BYTE: u32 = 5121;
const ARRAY: u32 = 34962;
const ELEMENTS: u32 = 34963;

pub fn write(mesh: &Mesh, out: &mut impl Write) -> io::Result<()> {
    let mut bytes = Vec::new();
    let mut views: Vec<Value> = Vec::new();
    let mut add = |data: Vec<u8>, target: u32| {
        views.push(json!({
            "buffer": 0, "byteOffset": bytes.len(), "byteLength": data.len(), "target": target
        }));
        bytes.extend(data);
    };
    add(numbers(&mesh.points), ARRAY);
    add(numbers(&mesh.normals), ARRAY);
    add(indices(&mesh.triangles), ELEMENTS);
    let count = mesh.points.len();
    let bound = |pick: fn(f32, f32) -> f32| {
        let all = mesh.points.iter().copied();
        all.reduce(|a, b| [0, 1, 2].map(|k| pick(a[k], b[k])))
            .unwrap_or_default()
    };
    let mut accessors = vec![
        json!({"bufferView": 0, "componentType": FLOAT, "count": count, "type": "VEC3",
               "min": bound(f32::min), "max": bound(f32::max)}),
        json!({"bufferView": 1, "componentType": FLOAT, "count": count, "type": "VEC3"}),
        json!({"bufferView": 2, "componentType": UNSIGNED, "count": 3 * mesh.triangles.len(),
               "type": "SCALAR"}),
    ];
    let mut attributes = json!({"POSITION": 0, "NORMAL": 1});
    if !mesh.colours.is_empty() {
        // Four bytes each: arrays of vertices are aligned.
        let data = mesh.colours.iter().flat_map(|[r, g, b]| [*r, *g, *b, 255]);
        add(data.collect(), ARRAY);
        accessors.push(
            json!({"bufferView": 3, "componentType": BYTE, "normalized": true,
                              "count": count, "type": "VEC4"}),
        );
        attributes["COLOR_0"] = json!(3);
    }
    let text = json!({
        "asset": {"version": "2.0", "generator": MARK},
        "extras": {"time_s": mesh.time},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "name": "liquid", "rotation": [-0.5f64.sqrt(), 0, 0, 0.5f64.sqrt()]}],
        "meshes": [{"primitives": [{"attributes": attributes, "indices": 2, "material": 0}]}],
        "materials": [{"name": "liquid", "pbrMetallicRoughness": {
            "metallicFactor": 0.0, "roughnessFactor": 0.1}}],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": bytes.len()}],
    });
    let mut text = text.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    bytes.resize(bytes.len().next_multiple_of(4), 0);
    let length = 12 + 8 + text.len() + 8 + bytes.len();
    let length = u32::try_from(length)
        .map_err(|_| io::Error::other("a .glb holds less than 4 GiB; write a .ply or .vtp"))?;
    out.write_all(b"glTF")?;
    for number in [2, length, text.len() as u32] {
        out.write_all(&number.to_le_bytes())?;
    }
    out.write_all(b"JSON")?;
    out.write_all(&text)?;
    out.write_all(&(bytes.len() as u32).to_le_bytes())?;
    out.write_all(b"BIN\0")?;
    out.write_all(&bytes)
}
