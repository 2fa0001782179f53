//! The region that a body fills while it is packed.
//!
//! Spheres and ellipsoids are packed about the origin, so that their packing is independent of
//! their position and velocity and of the box. Layers and blocks touch the sides of the box and are
//! packed in box coordinates. A 2-D region lies in the x-z plane and its volume is an area.

use crate::scene::input::PackInput;
use crate::scene::{Dimension, Domain, Shape, Side};

/// What lies behind one face of a box-shaped region.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Face {
    /// Nothing: a free surface.
    Free,
    /// The wall particles of the box.
    Wall,
    /// The region itself, repeated.
    Periodic,
    /// The image of the region.
    Mirror,
}

/// Form of a region, m.
#[derive(Clone, Debug, PartialEq)]
pub enum Form {
    /// About the origin; all of its surface is free.
    Ellipsoid {
        /// Half lengths along x, y and z.
        semi_axes: [f64; 3],
    },
    /// `face[axis] = [low, high]`. In 2-D the y axis is degenerate and periodic.
    Block {
        /// Lowest corner.
        low: [f64; 3],
        /// Highest corner.
        high: [f64; 3],
        /// What lies behind each face.
        face: [[Face; 2]; 3],
    },
}

/// A region to be filled with particles.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    /// Number of space dimensions.
    pub dimension: Dimension,
    /// Shape and size.
    pub form: Form,
    /// Along each axis the side of a mirror plane through the centre of an ellipsoid: the liquid
    /// lies on the other side.
    pub cut: [Option<usize>; 3],
}

impl Region {
    /// The region of a body. A face of a layer or block belongs to a side of the box
    /// when it is nearer to it than half a particle spacing.
    pub fn new(input: &PackInput) -> Region {
        let domain = &input.domain;
        let form = match &input.shape {
            Shape::Sphere { radius, .. } => Form::Ellipsoid {
                semi_axes: [*radius; 3],
            },
            Shape::Ellipsoid { semi_axes, .. } => Form::Ellipsoid {
                semi_axes: *semi_axes,
            },
            Shape::Block { low, high } => block(input, *low, *high),
            Shape::Layer { depth } => {
                block(input, [0.0; 3], [domain.size[0], domain.size[1], *depth])
            }
        };
        Region {
            dimension: input.dimension,
            form,
            cut: input.shape.cuts(domain),
        }
    }

    /// The region with all lengths multiplied by `factor`.
    pub fn scaled(&self, factor: f64) -> Region {
        let form = match &self.form {
            Form::Ellipsoid { semi_axes } => Form::Ellipsoid {
                semi_axes: semi_axes.map(|a| a * factor),
            },
            Form::Block { low, high, face } => Form::Block {
                low: low.map(|x| x * factor),
                high: high.map(|x| x * factor),
                face: *face,
            },
        };
        Region {
            dimension: self.dimension,
            form,
            cut: self.cut,
        }
    }

    /// Axes along which the region extends: x, z or x, y, z.
    pub fn axes(&self) -> &'static [usize] {
        axes(self.dimension)
    }

    /// m^3, or m^2 in 2-D.
    pub fn volume(&self) -> f64 {
        match &self.form {
            Form::Ellipsoid { semi_axes: a } => {
                let whole = match self.dimension {
                    Dimension::Two => std::f64::consts::PI * a[0] * a[2],
                    Dimension::Three => 4.0 / 3.0 * std::f64::consts::PI * a[0] * a[1] * a[2],
                };
                whole * 0.5f64.powi(self.cut.iter().flatten().count() as i32)
            }
            Form::Block { low, high, .. } => {
                self.axes().iter().map(|&k| high[k] - low[k]).product()
            }
        }
    }

    /// Lowest and highest corner of the region, m.
    pub fn bounds(&self) -> ([f64; 3], [f64; 3]) {
        let (mut low, mut high) = match &self.form {
            Form::Ellipsoid { semi_axes: a } => (a.map(|a| -a), *a),
            Form::Block { low, high, .. } => (*low, *high),
        };
        for (k, side) in self.cut.into_iter().enumerate() {
            match side {
                Some(0) => low[k] = 0.0,
                Some(_) => high[k] = 0.0,
                None => {}
            }
        }
        if self.dimension == Dimension::Two {
            (low[1], high[1]) = (0.0, 0.0);
        }
        (low, high)
    }

    /// Mirror planes, `[low, high]` of each axis, m.
    pub fn mirrors(&self) -> [[Option<f64>; 2]; 3] {
        match &self.form {
            Form::Ellipsoid { .. } => {
                let plane = |k: usize, side: usize| (self.cut[k] == Some(side)).then_some(0.0);
                [0, 1, 2].map(|k| [plane(k, 0), plane(k, 1)])
            }
            Form::Block { low, high, face } => {
                let plane = |k: usize, side: usize| {
                    let is = face[k][side] == Face::Mirror;
                    is.then_some([low[k], high[k]][side])
                };
                [0, 1, 2].map(|k| [plane(k, 0), plane(k, 1)])
            }
        }
    }

    /// Period along each axis, m; `None` where the region does not repeat.
    pub fn period(&self) -> [Option<f64>; 3] {
        let mut period = [None; 3];
        if let Form::Block { low, high, face } = &self.form {
            for &k in self.axes() {
                if face[k][0] == Face::Periodic {
                    period[k] = Some(high[k] - low[k]);
                }
            }
        }
        period
    }

    /// Whether a face touches a wall of the box.
    pub fn touches_wall(&self) -> bool {
        match &self.form {
            Form::Ellipsoid { .. } => false,
            Form::Block { face, .. } => face.iter().flatten().any(|&f| f == Face::Wall),
        }
    }

    /// Whether it has no free surface.
    pub fn is_closed(&self) -> bool {
        match &self.form {
            Form::Ellipsoid { .. } => false,
            Form::Block { face, .. } => face.iter().flatten().all(|&f| f != Face::Free),
        }
    }

    /// Whether `x` is in the region when free surfaces, walls and mirrors are moved inwards by
    /// `inset` (m). The ellipsoid is shrunk along its axes, which is exact for a sphere.
    pub fn contains(&self, x: [f64; 3], inset: f64) -> bool {
        match &self.form {
            Form::Ellipsoid { semi_axes } => {
                let shrunk = |k: usize| (semi_axes[k] - inset).max(1e-3 * semi_axes[k]);
                let beyond = |k: &usize| match self.cut[*k] {
                    Some(0) => x[*k] < inset,
                    Some(_) => x[*k] > -inset,
                    None => false,
                };
                if self.axes().iter().any(beyond) {
                    return false;
                }
                self.axes()
                    .iter()
                    .map(|&k| (x[k] / shrunk(k)).powi(2))
                    .sum::<f64>()
                    <= 1.0
            }
            Form::Block { low, high, face } => self.axes().iter().all(|&k| {
                let margin = |side: usize| match face[k][side] {
                    Face::Periodic => 0.0,
                    Face::Free | Face::Wall | Face::Mirror => inset.min(0.49 * (high[k] - low[k])),
                };
                x[k] >= low[k] + margin(0) && x[k] < high[k] - margin(1)
            }),
        }
    }
}

/// Axes of a space: x, z or x, y, z.
pub fn axes(dimension: Dimension) -> &'static [usize] {
    match dimension {
        Dimension::Two => &[0, 2],
        Dimension::Three => &[0, 1, 2],
    }
}

fn block(input: &PackInput, low: [f64; 3], high: [f64; 3]) -> Form {
    let near = 0.5 * input.spacing;
    let mut face = [[Face::Periodic; 2]; 3];
    for &k in axes(input.dimension) {
        face[k] = faces(&input.domain, k, [low[k], high[k]], near);
    }
    Form::Block { low, high, face }
}

/// Faces of a block at `extent` (low, high) along axis `k`, m.
fn faces(domain: &Domain, k: usize, extent: [f64; 2], near: f64) -> [Face; 2] {
    let touches = [
        extent[0].abs() < near,
        (extent[1] - domain.size[k]).abs() < near,
    ];
    let face = |side: usize| match domain.boundary[k][side] {
        Side::Wall if touches[side] => Face::Wall,
        Side::Mirror if touches[side] => Face::Mirror,
        Side::Periodic if touches[0] && touches[1] => Face::Periodic,
        _ => Face::Free,
    };
    [face(0), face(1)]
}
