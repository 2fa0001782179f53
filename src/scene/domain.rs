//! `[box]`: the box and its boundary conditions.

use schemars::transform::{RecursiveTransform, Transform};
use schemars::{JsonSchema, Schema};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::Dimension;
use super::error::SceneError;
use super::schema::positive;
use super::tree::Tree;
use super::unit::{Length, Speed, Vector};

/// Names of the axes in a scene file.
pub const AXES: [&str; 3] = ["x", "y", "z"];
/// Names of the sides of an axis in a scene file.
pub const ENDS: [&str; 2] = ["low", "high"];

/// Boundary condition at one side of the box.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Side {
    /// What leaves here enters at the opposite side; an axis has both sides periodic, or neither.
    Periodic,
    /// No-slip wall made of fixed particles outside the box.
    Wall,
    /// No wall; a particle that leaves is removed and its mass recorded.
    Open,
    /// Plane of symmetry (x and y), with the image of the liquid behind it.
    Mirror,
    /// Axis of revolution (low side of x): what `symmetry = "axis"` makes of a scene.
    #[schemars(skip)]
    Axis,
}

/// The box `[0, size_x] x [0, size_y] x [0, size_z]`, m. In 2-D `size[1] == 0` and y is periodic.
#[derive(Clone, Debug, PartialEq)]
pub struct Domain {
    /// Lengths of the sides, m.
    pub size: [f64; 3],
    /// `boundary[axis] = [low side, high side]`.
    pub boundary: [[Side; 2]; 3],
    /// Velocity of each wall, m/s, `wall_velocity[axis][low/high][component]`; zero at rest.
    pub wall_velocity: [[[f64; 3]; 2]; 3],
    /// Of a box that is a section through an axis of revolution: what its rings may become.
    pub revolved: Option<Rings>,
}

/// Areas of rings in the half-plane, in cells of the lattice, beyond which they merge or split.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Rings {
    /// A ring with less merges with one beside it; 0: never.
    #[schemars(extend("minimum" = 0.0, "maximum" = 1.0))]
    pub merge: f64,
    /// A ring with more becomes two; a large number: never.
    #[schemars(extend("minimum" = 1.0))]
    pub split: f64,
}

impl Default for Rings {
    fn default() -> Self {
        Rings {
            merge: 0.5,
            split: std::f64::consts::SQRT_2,
        }
    }
}

/// One word for both sides, or one for each.
#[derive(Clone, Copy, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Sides {
    Both(Side),
    Each([Side; 2]),
}

impl Sides {
    fn each(self) -> [Side; 2] {
        match self {
            Sides::Both(side) => [side; 2],
            Sides::Each(sides) => sides,
        }
    }
}

/// The part of a symmetric scene that is simulated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Symmetry {
    Half,
    Quarter,
    Axis,
}

/// The box [0, size] that contains the simulation.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
pub struct BoxTable {
    /// Lengths along x, y, z (x, z in 2-D).
    #[schemars(transform = positive)]
    pub size: Vector<Length>,
    /// Low and high side in x: periodic, wall, open or mirror.
    #[serde(default = "BoxTable::lateral")]
    pub x: Sides,
    /// Low and high side in y (3-D).
    #[serde(default = "BoxTable::lateral")]
    pub y: Sides,
    /// Low and high side in z.
    #[serde(default = "BoxTable::vertical")]
    #[schemars(transform = without_mirror)]
    pub z: Sides,
    /// Simulates a part of a symmetric scene: half in x, a quarter in x and y, or, of a scene that
    /// is a body of revolution about the vertical through its middle, the half-plane from that axis
    /// on, in which particles are rings; walls in x and y are then one cylinder.
    #[serde(default)]
    pub symmetry: Option<Symmetry>,
    /// Of rings: areas beyond which they merge or split, over that of a cell; 0.5 and the root
    /// of 2 if left out.
    #[serde(default)]
    pub rings: Option<Rings>,
    /// Velocities of sliding walls.
    #[serde(default)]
    pub wall_velocity: WallVelocity,
}

/// Velocities of the walls, all components each.
#[derive(Debug, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct WallVelocity {
    /// Velocity of the wall at x = 0.
    pub x_low: Option<Vector<Speed>>,
    /// Velocity of the wall at the far end of x.
    pub x_high: Option<Vector<Speed>>,
    /// Velocity of the wall at y = 0.
    pub y_low: Option<Vector<Speed>>,
    /// Velocity of the wall at the far end of y.
    pub y_high: Option<Vector<Speed>>,
    /// Velocity of the floor.
    pub z_low: Option<Vector<Speed>>,
    /// Velocity of the lid.
    pub z_high: Option<Vector<Speed>>,
}

impl BoxTable {
    fn lateral() -> Sides {
        Sides::Both(Side::Periodic)
    }

    fn vertical() -> Sides {
        Sides::Each([Side::Wall, Side::Open])
    }

    /// The table that describes a domain, in canonical form.
    pub fn of(domain: &Domain, dimension: Dimension) -> BoxTable {
        let [x, y, z] = domain.boundary.map(Sides::Each);
        let velocity = |axis: usize, end: usize| {
            let velocity = domain.wall_velocity[axis][end];
            (velocity != [0.0; 3]).then(|| dimension.components(velocity))
        };
        BoxTable {
            size: dimension.components(domain.size),
            x,
            y,
            z,
            symmetry: None,
            rings: domain.revolved.filter(|rings| *rings != Rings::default()),
            wall_velocity: WallVelocity {
                x_low: velocity(0, 0),
                x_high: velocity(0, 1),
                y_low: velocity(1, 0),
                y_high: velocity(1, 1),
                z_low: velocity(2, 0),
                z_high: velocity(2, 1),
            },
        }
    }

    /// The domain of a scene of this dimension.
    ///
    /// # Errors
    /// If sides or velocities contradict each other; with their places in the file.
    pub fn domain(&self, dimension: Dimension, tree: &Tree<'_>) -> Result<Domain, SceneError> {
        let size = dimension.vector(&self.size, "box.size", tree)?;
        let mut boundary = [[Side::Periodic; 2]; 3];
        for &axis in dimension.axes() {
            boundary[axis] = [self.x, self.y, self.z][axis].each();
            if boundary[axis].contains(&Side::Axis) {
                let remedy = "write `box.symmetry = \"axis\"` in a scene of three dimensions";
                let key = format!("box.{}", AXES[axis]);
                return Err(tree.fault(&key, "has an axis of revolution for a side", remedy));
            }
            let is_periodic = boundary[axis].map(|side| side == Side::Periodic);
            if is_periodic[0] != is_periodic[1] {
                let problem = "is periodic on one side only";
                let remedy = "write \"periodic\" for the axis, or another word for both sides";
                return Err(tree.fault(&format!("box.{}", AXES[axis]), problem, remedy));
            }
        }
        let wall_velocity = self.velocities(&boundary, dimension, tree)?;
        Ok(Domain {
            size,
            boundary,
            wall_velocity,
            revolved: self.revolved(tree)?,
        })
    }

    fn revolved(&self, tree: &Tree<'_>) -> Result<Option<Rings>, SceneError> {
        match (self.symmetry, self.rings) {
            (Some(Symmetry::Axis), rings) => Ok(Some(rings.unwrap_or_default())),
            (_, None) => Ok(None),
            (_, Some(_)) => {
                let problem = "is for rings about an axis";
                let remedy = "write `box.symmetry = \"axis\"`, or remove it";
                Err(tree.fault("box.rings", problem, remedy))
            }
        }
    }

    fn velocities(
        &self,
        boundary: &[[Side; 2]; 3],
        dimension: Dimension,
        tree: &Tree<'_>,
    ) -> Result<[[[f64; 3]; 2]; 3], SceneError> {
        let walls = &self.wall_velocity;
        let given = [
            [&walls.x_low, &walls.x_high],
            [&walls.y_low, &walls.y_high],
            [&walls.z_low, &walls.z_high],
        ];
        let mut velocity = [[[0.0; 3]; 2]; 3];
        for (axis, end) in (0..3).flat_map(|axis| [(axis, 0), (axis, 1)]) {
            let Some(components) = given[axis][end] else {
                continue;
            };
            let key = format!("box.wall_velocity.{}_{}", AXES[axis], ENDS[end]);
            if boundary[axis][end] != Side::Wall {
                let remedy = format!("make side {} of `box.{}` a wall", ENDS[end], AXES[axis]);
                return Err(tree.fault(&key, "is the velocity of a side without a wall", &remedy));
            }
            let components = dimension.vector(components, &key, tree)?;
            if components[axis] != 0.0 {
                let remedy = format!("a wall slides in its own plane: make the {} 0", AXES[axis]);
                return Err(tree.fault(&key, "moves the wall through the liquid", &remedy));
            }
            velocity[axis][end] = components;
        }
        Ok(velocity)
    }
}

/// The sides in z, across which gravity acts.
fn without_mirror(schema: &mut Schema) {
    let is_mirror = |word: &Value| word == "mirror" || word["const"] == "mirror";
    let drop = |schema: &mut Schema| {
        for words in ["oneOf", "enum"] {
            if let Some(Value::Array(words)) = schema.get_mut(words) {
                words.retain(|word| !is_mirror(word));
            }
        }
    };
    RecursiveTransform(drop).transform(schema);
}
