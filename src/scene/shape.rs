//! Geometry of shapes: bounds, volumes, points inside.

use super::{Dimension, Domain, Shape};
use std::f64::consts::PI;

impl Shape {
    /// True for free shapes, which are packed about the origin: only the impact uses their
    /// position. Layers and blocks touch sides of the box and are packed in box coordinates.
    pub fn is_free(&self) -> bool {
        matches!(self, Shape::Sphere { .. } | Shape::Ellipsoid { .. })
    }

    /// Lowest and highest corner of the bounding box, m, of the part inside mirror planes. y is 0
    /// in 2-D.
    pub fn bounds(&self, domain: &Domain, dimension: Dimension) -> ([f64; 3], [f64; 3]) {
        let around = |centre: &[f64; 3], half: [f64; 3]| {
            let low = std::array::from_fn(|axis| centre[axis] - half[axis]);
            let high = std::array::from_fn(|axis| centre[axis] + half[axis]);
            (low, high)
        };
        let (mut low, mut high): ([f64; 3], [f64; 3]) = match self {
            Shape::Sphere { centre, radius } => around(centre, [*radius; 3]),
            Shape::Ellipsoid { centre, semi_axes } => around(centre, *semi_axes),
            Shape::Block { low, high } => (*low, *high),
            Shape::Layer { depth } => ([0.0; 3], [domain.size[0], domain.size[1], *depth]),
        };
        for (axis, side) in self.cuts(domain).into_iter().enumerate() {
            match side {
                Some(0) => low[axis] = 0.0,
                Some(_) => high[axis] = domain.size[axis],
                None => {}
            }
        }
        if dimension == Dimension::Two {
            (low[1], high[1]) = (0.0, 0.0);
        }
        (low, high)
    }

    /// Volume inside mirror planes, m^3; area, m^2, in 2-D.
    pub fn volume(&self, domain: &Domain, dimension: Dimension) -> f64 {
        let (low, high) = self.bounds(domain, dimension);
        let [x, y, z] = std::array::from_fn(|axis| high[axis] - low[axis]);
        let full = match dimension {
            Dimension::Two => x * z,
            Dimension::Three => x * y * z,
        };
        match (self, dimension) {
            (Shape::Layer { .. } | Shape::Block { .. }, _) => full,
            (_, Dimension::Two) => PI / 4.0 * full,
            (_, Dimension::Three) => PI / 6.0 * full,
        }
    }

    /// Volume of the body of revolution about the axis of an axial box, m^3.
    pub fn revolved(&self, domain: &Domain) -> f64 {
        match self {
            Shape::Sphere { radius, .. } => 4.0 / 3.0 * PI * radius.powi(3),
            Shape::Ellipsoid { semi_axes: a, .. } => 4.0 / 3.0 * PI * a[0] * a[0] * a[2],
            Shape::Block { low, high } => {
                PI * (high[0] * high[0] - low[0] * low[0]) * (high[2] - low[2])
            }
            Shape::Layer { depth } => PI * domain.size[0] * domain.size[0] * depth,
        }
    }

    /// Radius of the sphere (3-D) or disc (2-D) of the volume of the whole body, m.
    pub fn equivalent_radius(&self, domain: &Domain, dimension: Dimension) -> f64 {
        if let Shape::Sphere { radius, .. } = self {
            return *radius;
        }
        let volume = self.parts(domain) * self.volume(domain, dimension);
        match dimension {
            Dimension::Two if domain.is_revolved() => {
                let [a, _, c] = match self {
                    Shape::Ellipsoid { semi_axes, .. } => *semi_axes,
                    _ => [0.0; 3],
                };
                (a * a * c).cbrt()
            }
            Dimension::Two => (volume / PI).sqrt(),
            Dimension::Three => (volume / (4.0 / 3.0 * PI)).cbrt(),
        }
    }

    /// True if the point, m, is inside.
    pub fn contains(&self, point: [f64; 3], domain: &Domain, dimension: Dimension) -> bool {
        let axes = dimension.axes();
        match self {
            Shape::Sphere { centre, radius } => {
                let square = |axis: &usize| ((point[*axis] - centre[*axis]) / radius).powi(2);
                axes.iter().map(square).sum::<f64>() < 1.0
            }
            Shape::Ellipsoid { centre, semi_axes } => {
                let square =
                    |axis: &usize| ((point[*axis] - centre[*axis]) / semi_axes[*axis]).powi(2);
                axes.iter().map(square).sum::<f64>() < 1.0
            }
            Shape::Block { .. } | Shape::Layer { .. } => {
                let (low, high) = self.bounds(domain, dimension);
                axes.iter()
                    .all(|&axis| point[axis] > low[axis] && point[axis] < high[axis])
            }
        }
    }
}

/// Number of points of the unit lattice about the origin in an ellipsoid, its surface included;
/// along cut axes the lattice starts half a cell from the plane, on one side.
pub(super) fn lattice(dimension: Dimension, semi_axes: [f64; 3], is_cut: [bool; 2]) -> u64 {
    let [x, y, z] = semi_axes;
    let off = is_cut.map(|cut| if cut { 0.5 } else { 0.0 });
    let reach = |axis: f64, a: usize| (axis - off[a] + 1e-9).floor() as i64;
    let from = |axis: f64, a: usize| if is_cut[a] { 0 } else { -reach(axis, a) };
    let across = match dimension {
        Dimension::Two => 0..=0,
        Dimension::Three => from(y, 1)..=reach(y, 1),
    };
    let mut count = 0;
    for i in from(x, 0)..=reach(x, 0) {
        for j in across.clone() {
            let (i, j) = (i as f64 + off[0], j as f64 + off[1]);
            let across = if j == 0.0 { 0.0 } else { j / y };
            let left = 1.0 - (i / x).powi(2) - across.powi(2);
            if left >= -1e-12 {
                count += 2 * (z * left.max(0.0).sqrt() + 1e-9).floor() as u64 + 1;
            }
        }
    }
    count
}
