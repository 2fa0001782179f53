//! Particles as named columns, from frames and checkpoints.

use crate::particle::Frame;
use crate::record::checkpoint::{Array, Checkpoint, CheckpointError};

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

impl From<Frame> for Table {
    fn from(frame: Frame) -> Self {
        let vector = |name: &str, components: [Vec<f32>; 3]| Column {
            name: name.into(),
            components: components.map(Array::F32).into(),
        };
        let column = |name: &str, array| Column {
            name: name.into(),
            components: vec![array],
        };
        Table {
            time: frame.time,
            position: vector("position", frame.position),
            columns: vec![
                column("id", Array::U32(frame.id)),
                column("body", Array::U8(frame.body)),
                vector("velocity", frame.velocity),
                column("pressure", Array::F32(frame.pressure)),
                column("density", Array::F32(frame.density)),
                column("surface", Array::U8(frame.surface)),
            ],
            scalars: frame.scalars,
        }
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
        Ok(Table {
            time: checkpoint.time,
            position,
            columns,
            scalars: checkpoint.scalars,
        })
    }
}

fn same_type(a: &Array, b: &Array) -> bool {
    std::mem::discriminant(a) == std::mem::discriminant(b)
}
