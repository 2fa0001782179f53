//! Particles as named columns, from frames and checkpoints.

use std::f64::consts::PI;

use crate::particle::Frame;
use crate::record::checkpoint::{Array, Checkpoint, CheckpointError};
use crate::scene::Dimension;

/// A quantity of every particle: one array for each component (1 or 3), of equal type and length.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Name of the quantity.
    pub name: String,
    /// Values, one array for each component.
    pub components: Vec<Array>,
}

/// Particles at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Simulated time, s.
    pub time: f64,
    /// Time after contact, s; `None` before it, and where it is not known.
    pub after_contact: Option<f64>,
    /// Positions, m, three components.
    pub position: Column,
    /// The other quantities.
    pub columns: Vec<Column>,
    /// Named numbers of the whole set.
    pub scalars: Vec<(String, f64)>,
}

impl Table {
    /// Number of particles.
    pub fn len(&self) -> usize {
        self.position.components[0].len()
    }

    /// Whether there is no particle.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Name and values of every component: `position_x`, ..., `density`, ...
    pub fn flat(&self) -> impl Iterator<Item = (String, &Array)> {
        std::iter::once(&self.position)
            .chain(&self.columns)
            .flat_map(|column| {
                let vector = column.components.len() == 3;
                column.components.iter().enumerate().map(move |(k, array)| {
                    let axis = ["_x", "_y", "_z"][k];
                    let suffix = if vector { axis } else { "" };
                    (format!("{}{suffix}", column.name), array)
                })
            })
    }
}

impl Table {
    /// The particles of a frame; those with masses of their own are rings in two dimensions and
    /// points in three. Without a scalar `mass_kg` they have neither mass nor radius.
    pub fn of_frame(frame: Frame, dimension: Dimension) -> Table {
        let vector = |name: &str, components: [Vec<f32>; 3]| Column {
            name: name.into(),
            components: components.map(Array::F32).into(),
        };
        let column = |name: &str, array| Column {
            name: name.into(),
            components: vec![array],
        };
        let mut scalars = frame.scalars.iter();
        let total = scalars.find(|(name, _)| name == "mass_kg");
        let mass = total.map(|(_, total)| total / frame.id.len() as f64);
        let mut columns = vec![
            column("id", Array::U32(frame.id)),
            column("body", Array::U8(frame.body)),
            vector("velocity", frame.velocity),
            column("pressure", Array::F32(frame.pressure)),
        ];
        if !frame.mass.is_empty() {
            let [r, ..] = &frame.position;
            let rings = frame.mass.iter().zip(&frame.density).zip(r);
            let radii = rings.map(|((m, rho), r)| {
                let [m, rho, r] = [*m, *rho, *r].map(f64::from);
                let radius = match dimension {
                    Dimension::Two => section_radius([m, rho, r]),
                    Dimension::Three => radius(m, rho, dimension),
                };
                radius as f32
            });
            columns.push(column("radius", Array::F32(radii.collect())));
            columns.push(column("mass", Array::F32(frame.mass)));
        } else if let Some(mass) = mass {
            let radius = |density: &f32| radius(mass, f64::from(*density), dimension) as f32;
            let radii = frame.density.iter().map(radius).collect();
            let masses = vec![mass as f32; frame.density.len()];
            columns.push(column("mass", Array::F32(masses)));
            columns.push(column("radius", Array::F32(radii)));
        }
        columns.push(column("density", Array::F32(frame.density)));
        columns.push(column("surface", Array::U8(frame.surface)));
        Table {
            time: frame.time,
            after_contact: None,
            position: vector("position", frame.position),
            columns,
            scalars: frame.scalars,
        }
    }

    /// Removes the particles of all other bodies, and the scalars that count them too. A table
    /// without a column `body` stays as it is.
    pub fn keep_bodies(&mut self, bodies: &[u8]) {
        let own = self.columns.iter().find(|column| column.name == "body");
        let Some([Array::U8(own)]) = own.map(|column| column.components.as_slice()) else {
            return;
        };
        let kept: Vec<bool> = own.iter().map(|body| bodies.contains(body)).collect();
        self.scalars.retain(|(name, _)| !is_of_all(name));
        fn keep<T>(values: &mut Vec<T>, kept: &[bool]) {
            let mut kept = kept.iter();
            values.retain(|_| *kept.next().expect("columns of one length"));
        }
        let columns = std::iter::once(&mut self.position).chain(&mut self.columns);
        for array in columns.flat_map(|column| &mut column.components) {
            match array {
                Array::F64(values) => keep(values, &kept),
                Array::F32(values) => keep(values, &kept),
                Array::U64(values) => keep(values, &kept),
                Array::U32(values) => keep(values, &kept),
                Array::U8(values) => keep(values, &kept),
            }
        }
    }

    /// Adds mass and radius to the particles of a checkpoint that holds the mass of one and the
    /// density of each. A checkpoint does not state its dimension: in 2-D all y are equal.
    fn add_mass(&mut self) {
        let named = |name: &str| self.columns.iter().find(|column| column.name == name);
        let mass = self.scalars.iter().find(|(name, _)| name == "mass");
        let density = named("density").map(|column| column.components.as_slice());
        let (Some((_, mass)), Some([Array::F64(density)])) = (mass, density) else {
            return;
        };
        if named("mass").is_some() || named("radius").is_some() {
            return;
        }
        let is_plane = match &self.position.components[1] {
            Array::F64(y) => y.windows(2).all(|pair| pair[0] == pair[1]),
            _ => return,
        };
        let dimension = if is_plane {
            Dimension::Two
        } else {
            Dimension::Three
        };
        let weight = named("weight").map(|column| column.components.as_slice());
        let (radii, masses) = match (weight, &self.position.components[0]) {
            (Some([Array::F64(weight)]), Array::F64(r)) => {
                let masses: Vec<f64> = weight.iter().map(|weight| mass * weight).collect();
                let rings = masses.iter().zip(density).zip(r);
                let radii = rings.map(|((m, rho), r)| section_radius([*m, *rho, *r]));
                (radii.collect(), masses)
            }
            _ => {
                let radii = density
                    .iter()
                    .map(|density| radius(*mass, *density, dimension));
                (radii.collect(), vec![*mass; density.len()])
            }
        };
        for (name, values) in [("mass", masses), ("radius", radii)] {
            self.columns.push(Column {
                name: name.into(),
                components: vec![Array::F64(values)],
            });
        }
    }
}

/// Radius of a disc of the area that a ring has in the half-plane, m: of its mass, kg, density,
/// kg/m^3, and distance from the axis, m.
fn section_radius([mass, density, distance]: [f64; 3]) -> f64 {
    (mass / density / (2.0 * PI * distance) / PI).sqrt()
}

/// Radius of a sphere or, in 2-D, of a disc of the volume mass over density, m.
fn radius(mass: f64, density: f64, dimension: Dimension) -> f64 {
    let volume = mass / density;
    match dimension {
        Dimension::Two => (volume / PI).sqrt(),
        Dimension::Three => (0.75 * volume / PI).cbrt(),
    }
}

impl TryFrom<Checkpoint> for Table {
    type Error = CheckpointError;

    /// Accepts any checkpoint with the arrays `position_x`, `_y` and `_z`: takes all arrays of
    /// their length, those named `NAME_x`, `NAME_y`, `NAME_z` as one vector.
    fn try_from(checkpoint: Checkpoint) -> Result<Self, CheckpointError> {
        let missing = CheckpointError::WrongContent {
            kind: checkpoint.kind.clone(),
            expected: "set of particles",
            what: "no array position_x".into(),
        };
        let Some(count) = checkpoint.array("position_x").map(Array::len) else {
            return Err(missing);
        };
        let mut columns: Vec<Column> = Vec::new();
        let arrays = checkpoint.arrays.into_iter();
        let mut arrays = arrays.filter(|(_, array)| array.len() == count).peekable();
        while let Some((name, array)) = arrays.next() {
            let mut column = Column {
                name,
                components: vec![array],
            };
            if let Some(stem) = column.name.strip_suffix("_x").map(str::to_string) {
                let follows = |end: &str| format!("{stem}{end}");
                for end in ["_y", "_z"] {
                    let next = arrays.next_if(|(name, array)| {
                        *name == follows(end) && same_type(array, &column.components[0])
                    });
                    column.components.extend(next.map(|(_, array)| array));
                }
                if column.components.len() == 3 {
                    column.name = stem;
                }
            }
            if column.components.len() == 2 {
                // An incomplete vector becomes two columns.
                let array = column.components.pop().expect("two");
                let name = column.name.replace("_x", "_y");
                columns.push(column);
                column = Column {
                    name,
                    components: vec![array],
                };
            }
            columns.push(column);
        }
        let position = columns
            .iter()
            .position(|column| column.name == "position" && column.components.len() == 3);
        let position = position.map(|index| columns.remove(index)).ok_or(missing)?;
        let mut table = Table {
            time: checkpoint.time,
            after_contact: None,
            position,
            columns,
            scalars: checkpoint.scalars,
        };
        table.add_mass();
        Ok(table)
    }
}

/// Whether a scalar of a frame is of all its particles, not of the run.
fn is_of_all(name: &str) -> bool {
    name.ends_with("_J")
        || name.starts_with("mass_")
        || name.starts_with("momentum_")
        || name == "speed_max_m_s"
}

fn same_type(a: &Array, b: &Array) -> bool {
    std::mem::discriminant(a) == std::mem::discriminant(b)
}
