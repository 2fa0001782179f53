//! `[body.NAME]`: bodies of liquid, their shapes and initial velocities.

mod read;

use indexmap::IndexMap;
use schemars::{JsonSchema, Schema};
use serde::{Deserialize, Serialize};

use super::Dimension;
use super::schema::{not_negative, positive};
use super::unit::{Colour, Length, List, Maybe, Rate, Speed, Vector};
pub use read::{all, supports};

/// Geometry of a body, m, in box coordinates.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// Sphere, or disc in 2-D.
    Sphere {
        /// Centre, m.
        centre: [f64; 3],
        /// Radius, m.
        radius: f64,
    },
    /// Semi-axes; ellipse in 2-D.
    Ellipsoid {
        /// Centre, m.
        centre: [f64; 3],
        /// Half lengths along x, y and z, m.
        semi_axes: [f64; 3],
    },
    /// Axis-parallel block, rectangle in 2-D.
    Block {
        /// Lowest corner, m.
        low: [f64; 3],
        /// Highest corner, m.
        high: [f64; 3],
    },
    /// Liquid from z = 0 to `depth` over the whole lateral extent of the box.
    Layer {
        /// Height of the surface above the floor, m.
        depth: f64,
    },
}

impl Shape {
    /// Puts the centre of a free shape at `place`, m.
    pub fn move_to(&mut self, place: [f64; 3]) {
        if let Shape::Sphere { centre, .. } | Shape::Ellipsoid { centre, .. } = self {
            *centre = place;
        }
    }
}

/// Initial velocity of a body, m/s.
#[derive(Clone, Debug, PartialEq)]
pub enum Motion {
    /// The same velocity everywhere, m/s.
    Uniform([f64; 3]),
    /// u = -U cos(kx) sin(kz), w = U sin(kx) cos(kz), k = 2 pi / size_x.
    TaylorGreen {
        /// Amplitude U, m/s.
        speed: f64,
    },
    /// Velocity that deforms a drop in its n = 2 mode: u = -a x (per lateral axis of d-1), w = +a z
    /// made divergence-free, about the body's centre; `rate` a in 1/s.
    Stretch {
        /// Strain rate a, 1/s.
        rate: f64,
    },
}

/// One body of liquid.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// Name in the scene file: NAME in `[body.NAME]`.
    pub name: String,
    /// Initial region.
    pub shape: Shape,
    /// Initial velocity.
    pub motion: Motion,
    /// Display colour of the body, RGB.
    pub colour: [u8; 3],
}

/// Bodies of liquid, by name, in the order of the file.
pub type BodyTables = IndexMap<String, BodyTable>;

/// A body of liquid: one shape, at most one initial velocity.
#[derive(Debug, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
#[schemars(transform = one_shape)]
pub struct BodyTable {
    /// Liquid on the floor, from side to side.
    pub layer: Option<Layer>,
    /// A sphere (3-D).
    pub sphere: Option<Sphere>,
    /// A disc (2-D).
    pub disc: Option<Sphere>,
    /// An ellipsoid along the axes (3-D).
    pub ellipsoid: Option<Ellipsoid>,
    /// An ellipse along the axes (2-D).
    pub ellipse: Option<Ellipsoid>,
    /// A block along the axes (3-D).
    pub block: Option<Block>,
    /// A rectangle along the axes (2-D).
    pub rectangle: Option<Block>,
    /// Initial velocity: a speed downward, or all components.
    pub velocity: Option<Velocity>,
    /// Initial velocity: Taylor-Green vortices.
    pub taylor_green: Option<TaylorGreen>,
    /// Initial velocity: stretching along z.
    pub stretch: Option<Stretch>,
    /// Colour in pictures and viewers, "#rrggbb".
    pub colour: Option<Colour>,
}

/// Keys of the shapes, of which a body has one.
pub const SHAPES: [&str; 7] = [
    "layer",
    "sphere",
    "disc",
    "ellipsoid",
    "ellipse",
    "block",
    "rectangle",
];

fn one_shape(schema: &mut Schema) {
    let choice = SHAPES.map(|shape| serde_json::json!({ "required": [shape] }));
    schema.insert("oneOf".to_string(), choice.to_vec().into());
}

/// Liquid on the floor, from side to side.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
pub struct Layer {
    /// Depth of the liquid.
    #[serde(with = "Length")]
    #[schemars(transform = positive)]
    pub depth: f64,
}

/// A sphere or a disc, by its centre, or hanging above an earlier body.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
pub struct Sphere {
    /// Diameter.
    #[serde(with = "Length")]
    #[schemars(transform = positive)]
    pub diameter: f64,
    /// Centre, in place of `gap` and `above`.
    #[serde(default)]
    pub centre: Option<Vector<Length>>,
    /// Clear distance from the top of the body `above` which it hangs.
    #[serde(default, with = "Maybe::<Length>")]
    #[schemars(transform = not_negative)]
    pub gap: Option<f64>,
    /// Name of that body, which is earlier in the file.
    #[serde(default)]
    pub above: Option<String>,
    /// Lateral distance from the middle of the box, with `above`.
    #[serde(default)]
    pub offset: Option<Offset>,
}

/// One or two lateral components.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct Offset(
    #[serde(with = "List::<Length>")]
    #[schemars(length(min = 1, max = 2))]
    Vec<f64>,
);

/// An ellipsoid or an ellipse along the axes.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
pub struct Ellipsoid {
    /// Half lengths along x, y, z (x, z in 2-D).
    #[schemars(transform = positive)]
    pub semi_axes: Vector<Length>,
    /// Centre.
    pub centre: Vector<Length>,
}

/// A block or a rectangle along the axes.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
pub struct Block {
    /// Lowest corner.
    pub low: Vector<Length>,
    /// Highest corner.
    pub high: Vector<Length>,
}

/// A speed downward, or all components.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Velocity {
    Downward(#[serde(with = "Speed")] f64),
    Components(Vector<Speed>),
}

/// Taylor-Green vortices.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
pub struct TaylorGreen {
    /// Largest speed.
    #[serde(with = "Speed")]
    #[schemars(transform = positive)]
    pub speed: f64,
}

/// Stretching along z.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
pub struct Stretch {
    /// Rate of stretching along z.
    #[serde(with = "Rate")]
    pub rate: f64,
}

impl BodyTable {
    /// The table that describes a body, in canonical form.
    pub fn of(body: &Body, dimension: Dimension) -> BodyTable {
        let mut table = BodyTable::of_shape(&body.shape, dimension);
        match body.motion {
            Motion::Uniform([x, y, z]) if x == 0.0 && y == 0.0 && z <= 0.0 => {
                table.velocity = Some(Velocity::Downward(0.0 - z));
            }
            Motion::Uniform(velocity) => {
                table.velocity = Some(Velocity::Components(dimension.components(velocity)));
            }
            Motion::TaylorGreen { speed } => table.taylor_green = Some(TaylorGreen { speed }),
            Motion::Stretch { rate } => table.stretch = Some(Stretch { rate }),
        }
        table
    }

    /// The table of a shape alone, in canonical form.
    pub fn of_shape(shape: &Shape, dimension: Dimension) -> BodyTable {
        let mut table = BodyTable::default();
        let vector = |vector: [f64; 3]| dimension.components(vector);
        let is_plane = dimension == Dimension::Two;
        match *shape {
            Shape::Layer { depth } => table.layer = Some(Layer { depth }),
            Shape::Sphere { centre, radius } => {
                let sphere = Some(Sphere {
                    diameter: 2.0 * radius,
                    centre: Some(vector(centre)),
                    gap: None,
                    above: None,
                    offset: None,
                });
                let place = if is_plane {
                    &mut table.disc
                } else {
                    &mut table.sphere
                };
                *place = sphere;
            }
            Shape::Ellipsoid { centre, semi_axes } => {
                let ellipsoid = Some(Ellipsoid {
                    semi_axes: vector(semi_axes),
                    centre: vector(centre),
                });
                let place = if is_plane {
                    &mut table.ellipse
                } else {
                    &mut table.ellipsoid
                };
                *place = ellipsoid;
            }
            Shape::Block { low, high } => {
                let block = Some(Block {
                    low: vector(low),
                    high: vector(high),
                });
                let place = if is_plane {
                    &mut table.rectangle
                } else {
                    &mut table.block
                };
                *place = block;
            }
        }
        table
    }
}
