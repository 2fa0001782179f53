//! Contact angle on walls.

/// How the liquid wets every wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wetting {
    /// Contact angle through the liquid, degrees.
    pub angle: f64,
}

impl Wetting {
    /// How much longer a distance can be than its image under a shear by cot(angle): the shear's
    /// larger principal stretch, (|k| + sqrt(k^2 + 4)) / 2.
    pub fn stretch(&self) -> f64 {
        let (sine, cosine) = self.angle.to_radians().sin_cos();
        let shear = (cosine / sine).abs();
        0.5 * (shear + (shear * shear + 4.0).sqrt())
    }
}
