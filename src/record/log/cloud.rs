//! Particles as `foxglove.PointCloud`.

use std::collections::HashSet;
use std::f32::consts::TAU;

use foxglove::messages::packed_element_field::NumericType;
use foxglove::messages::{PackedElementField, PointCloud, Pose, Quaternion, Timestamp, Vector3};
use prost::Message as _;
use prost::encoding::{DecodeContext, decode_key, skip_field};

use super::LogSetup;
use crate::particle::{Frame, ring};
use crate::scene::Colouring;

/// Frame of reference of everything in the log.
pub const BOX: &str = "box";

/// Bytes of one particle; the last three are padding, so that every number is aligned.
const STRIDE: usize = 48;

/// Bytes of one ring: its mass follows.
const RING_STRIDE: usize = 52;

/// Name, offset and type of the numbers of a particle; the last is of rings alone.
const FIELDS: [(&str, usize, NumericType); 16] = [
    ("x", 0, NumericType::Float32),
    ("y", 4, NumericType::Float32),
    ("z", 8, NumericType::Float32),
    ("vx", 12, NumericType::Float32),
    ("vy", 16, NumericType::Float32),
    ("vz", 20, NumericType::Float32),
    ("speed", 24, NumericType::Float32),
    ("pressure", 28, NumericType::Float32),
    ("density", 32, NumericType::Float32),
    ("id", 36, NumericType::Uint32),
    ("red", 40, NumericType::Uint8),
    ("green", 41, NumericType::Uint8),
    ("blue", 42, NumericType::Uint8),
    ("alpha", 43, NumericType::Uint8),
    ("surface", 44, NumericType::Uint8),
    ("mass", STRIDE, NumericType::Float32),
];

/// How many [`FIELDS`] particles with or without a mass of their own have, and their bytes.
fn layout(has_mass: bool) -> (&'static [(&'static str, usize, NumericType)], usize) {
    match has_mass {
        true => (&FIELDS, RING_STRIDE),
        false => (&FIELDS[..FIELDS.len() - 1], STRIDE),
    }
}

/// Bytes of a point of the revolved cloud: x, y, z, vx, vy, vz and its colour.
const REVOLVED_STRIDE: usize = 28;

/// Most points of the revolved cloud, about.
const REVOLVED: f32 = 20_000.0;

/// Number of the repeated member `fields` of `foxglove.PointCloud`.
const FIELDS_TAG: u32 = 5;

/// Bytes of a wall particle: x, y, z and its colour.
const WALL_STRIDE: usize = 16;

const WALL_FIELDS: [(&str, usize, NumericType); 7] = [
    ("x", 0, NumericType::Float32),
    ("y", 4, NumericType::Float32),
    ("z", 8, NumericType::Float32),
    ("red", 12, NumericType::Uint8),
    ("green", 13, NumericType::Uint8),
    ("blue", 14, NumericType::Uint8),
    ("alpha", 15, NumericType::Uint8),
];

const WALL_COLOUR: [u8; 4] = [128, 128, 128, 48];

/// Anchors of the colour map viridis (S. van der Walt and N. Smith, 2015), at even distances.
const VIRIDIS: [[f32; 3]; 9] = [
    [68.0, 1.0, 84.0],
    [71.0, 44.0, 122.0],
    [59.0, 81.0, 139.0],
    [44.0, 113.0, 142.0],
    [33.0, 144.0, 141.0],
    [39.0, 173.0, 129.0],
    [92.0, 200.0, 99.0],
    [170.0, 220.0, 50.0],
    [253.0, 231.0, 37.0],
];

/// Point cloud of the particles of `body` in `frame`.
pub fn encode(frame: &Frame, body: u8, setup: &LogSetup, log_time: u64) -> Vec<u8> {
    let count = frame.body.iter().filter(|b| **b == body).count();
    let (fields, stride) = layout(!frame.mass.is_empty());
    let mut data = Vec::with_capacity(count * stride);
    let [x, y, z] = &frame.position;
    let [vx, vy, vz] = &frame.velocity;
    for i in 0..frame.id.len() {
        if frame.body[i] != body {
            continue;
        }
        let speed = (vx[i] * vx[i] + vy[i] * vy[i] + vz[i] * vz[i]).sqrt();
        let [r, g, b] = colour(frame, i, setup);
        let reals = [
            x[i],
            y[i],
            z[i],
            vx[i],
            vy[i],
            vz[i],
            speed,
            frame.pressure[i],
            frame.density[i],
        ];
        for real in reals {
            data.extend_from_slice(&real.to_le_bytes());
        }
        data.extend_from_slice(&frame.id[i].to_le_bytes());
        data.extend_from_slice(&[r, g, b, 255, frame.surface[i], 0, 0, 0]);
        if let Some(mass) = frame.mass.get(i) {
            data.extend_from_slice(&mass.to_le_bytes());
        }
    }
    message(fields, stride, data, log_time)
}

fn colour(frame: &Frame, i: usize, setup: &LogSetup) -> [u8; 3] {
    let [u, v, w] = [0, 1, 2].map(|a| frame.velocity[a][i]);
    match setup.colour {
        Colouring::Body => setup.bodies[usize::from(frame.body[i])].colour,
        Colouring::Speed => viridis((u * u + v * v + w * w).sqrt() / setup.speed_scale as f32),
        Colouring::Pressure => viridis(frame.pressure[i] / setup.pressure_scale as f32),
    }
}

/// Point cloud of the body of revolution of a frame of rings, near its surface: of a ring a point
/// each spacing, fewer if there were too many.
pub fn encode_revolved(frame: &Frame, setup: &LogSetup, log_time: u64) -> Vec<u8> {
    let spacing = setup.spacing as f32;
    let lengths = outer(frame, spacing).map(|i| TAU * frame.position[0][i] / spacing);
    let part = (REVOLVED / lengths.sum::<f32>()).min(1.0);
    let mut outer = outer(frame, spacing).peekable();
    // What is left of the number of points goes to the next ring.
    let mut rest = 0.0;
    let points = ring::points(frame, |i| {
        if outer.next_if_eq(&i).is_some() {
            rest += part * TAU * frame.position[0][i] / spacing;
        }
        let count = f32::floor(rest);
        rest -= count;
        count as usize
    });
    let mut data = Vec::with_capacity(points.id.len() * REVOLVED_STRIDE);
    for i in 0..points.id.len() {
        for component in points.position.iter().chain(&points.velocity) {
            data.extend_from_slice(&component[i].to_le_bytes());
        }
        let [r, g, b] = colour(&points, i, setup);
        data.extend_from_slice(&[r, g, b, 255]);
    }
    let colours = FIELDS[10..14].iter();
    let colours = colours.map(|(name, offset, number)| (*name, offset - 16, *number));
    let fields: Vec<_> = FIELDS[..6].iter().copied().chain(colours).collect();
    message(&fields, REVOLVED_STRIDE, data, log_time)
}

/// The rings near the outline of the section: beside their cell of two spacings is an empty one,
/// not behind the axis or the floor.
fn outer(frame: &Frame, spacing: f32) -> impl Iterator<Item = usize> {
    let [r, _, z] = &frame.position;
    let cell = move |i: usize| [r[i], z[i]].map(|x| (0.5 * x / spacing).floor() as i32);
    let filled: HashSet<[i32; 2]> = (0..r.len()).map(cell).collect();
    let is_outer = move |i: &usize| {
        let [x, z] = cell(*i);
        let mut about = (-1..=1).flat_map(|a| [-1, 0, 1].map(|b| [x + a, z + b]));
        about.any(|cell| cell.iter().all(|c| *c >= 0) && !filled.contains(&cell))
    };
    (0..r.len()).filter(is_outer)
}

/// Point cloud of the walls, at log time 0.
pub fn encode_wall(position: &[Vec<f64>; 3]) -> Vec<u8> {
    let mut data = Vec::with_capacity(position[0].len() * WALL_STRIDE);
    for i in 0..position[0].len() {
        for component in position {
            data.extend_from_slice(&(component[i] as f32).to_le_bytes());
        }
        data.extend_from_slice(&WALL_COLOUR);
    }
    message(&WALL_FIELDS, WALL_STRIDE, data, 0)
}

/// The cloud of a message of [`encode`].
pub fn parse(bytes: &[u8]) -> Result<PointCloud, String> {
    let described = count_fields(bytes).map_err(|error| error.to_string())?;
    if described + 1 < FIELDS.len() || described > FIELDS.len() {
        return Err("its point clouds have other fields".into());
    }
    let cloud = PointCloud::decode(bytes).map_err(|error| error.to_string())?;
    let (fields, stride) = layout(described == FIELDS.len());
    let fits = |(field, (name, offset, number)): (&PackedElementField, &(_, usize, _))| {
        field.name == *name && field.offset as usize == *offset && field.r#type == *number as i32
    };
    let same = cloud.fields.len() == fields.len() && cloud.fields.iter().zip(fields).all(fits);
    let is_whole = cloud.point_stride as usize == stride && cloud.data.len() % stride == 0;
    if !same || !is_whole {
        return Err("its point clouds have other fields".into());
    }
    Ok(cloud)
}

/// Adds the particles of a message of [`encode`] to `frame`.
pub fn decode(bytes: &[u8], body: u8, frame: &mut Frame) -> Result<(), String> {
    let cloud = parse(bytes)?;
    let real = |point: &[u8], at: usize| {
        f32::from_le_bytes(point[at..at + 4].try_into().expect("4 bytes"))
    };
    for point in cloud.data.chunks_exact(cloud.point_stride as usize) {
        for axis in 0..3 {
            frame.position[axis].push(real(point, 4 * axis));
            frame.velocity[axis].push(real(point, 12 + 4 * axis));
        }
        frame.pressure.push(real(point, 28));
        frame.density.push(real(point, 32));
        let id = u32::from_le_bytes(point[36..40].try_into().expect("4 bytes"));
        frame.id.push(id);
        frame.surface.push(point[44]);
        frame.body.push(body);
        if point.len() == RING_STRIDE {
            frame.mass.push(real(point, STRIDE));
        }
    }
    Ok(())
}

/// Number of fields that a message describes. A decoded empty field takes 16 times its length, so
/// fields are counted before decoding.
fn count_fields(mut bytes: &[u8]) -> Result<usize, prost::DecodeError> {
    let mut count = 0;
    while !bytes.is_empty() {
        let (tag, wire) = decode_key(&mut bytes)?;
        count += usize::from(tag == FIELDS_TAG);
        skip_field(wire, tag, &mut bytes, DecodeContext::default())?;
    }
    Ok(count)
}

/// `foxglove.PointCloud` timestamps and log times are the same instant.
pub fn timestamp(log_time: u64) -> Timestamp {
    let seconds = u32::try_from(log_time / 1_000_000_000).unwrap_or(u32::MAX);
    Timestamp::new(seconds, (log_time % 1_000_000_000) as u32)
}

fn message(
    fields: &[(&str, usize, NumericType)],
    stride: usize,
    data: Vec<u8>,
    log_time: u64,
) -> Vec<u8> {
    let field = |(name, offset, number): &(&str, usize, NumericType)| PackedElementField {
        name: name.to_string(),
        offset: *offset as u32,
        r#type: *number as i32,
    };
    let identity = Pose {
        position: Some(Vector3::default()),
        orientation: Some(Quaternion {
            w: 1.0,
            ..Quaternion::default()
        }),
    };
    PointCloud {
        timestamp: Some(timestamp(log_time)),
        frame_id: BOX.into(),
        pose: Some(identity),
        point_stride: stride as u32,
        fields: fields.iter().map(field).collect(),
        data: data.into(),
    }
    .encode_to_vec()
}

/// Colour of `value` in the map viridis, clamped to 0 to 1. NaN is black.
pub fn viridis(value: f32) -> [u8; 3] {
    if value.is_nan() {
        return [0; 3];
    }
    let steps = (VIRIDIS.len() - 1) as f32;
    let place = value.clamp(0.0, 1.0) * steps;
    let low = (place as usize).min(VIRIDIS.len() - 2);
    let part = place - low as f32;
    let mix = |k: usize| VIRIDIS[low][k] + part * (VIRIDIS[low + 1][k] - VIRIDIS[low][k]);
    [mix(0) as u8, mix(1) as u8, mix(2) as u8]
}
