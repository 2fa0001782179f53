//! Contact angle on walls.

/// Smallest angle of the continued surface, degrees; the cosine of zero is 3 % larger.
const FLATTEST: f64 = 15.0;

/// Wetting of all walls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wetting {
    /// Contact angle through the liquid, degrees; with hysteresis that of the mean cosine.
    pub angle: f64,
    /// Advancing and receding angle, degrees: between them a contact line rests.
    pub hysteresis: Option<[f64; 2]>,
    /// L1, L2 and L3 of the four types of particles of Xie Eq. 18, in spacings; `None`: Young's
    /// force.
    pub layers: Option<[f64; 3]>,
}

impl Wetting {
    /// One angle in both directions of the contact line, degrees, by Young's force.
    pub fn of(angle: f64) -> Self {
        Wetting {
            angle,
            hysteresis: None,
            layers: None,
        }
    }

    /// Advancing and receding angle, degrees, by Young's force.
    pub fn between(angles: [f64; 2]) -> Self {
        let [advancing, receding] = cosines(angles);
        Wetting {
            angle: (0.5 * (advancing + receding)).acos().to_degrees(),
            hysteresis: Some(angles),
            layers: None,
        }
    }

    /// The angle at which a contact line advances, degrees.
    pub fn advancing(&self) -> f64 {
        self.hysteresis
            .map_or(self.angle, |[advancing, _]| advancing)
    }

    /// Half the difference of the cosines of receding and advancing angle: the friction of a
    /// contact line over the tension.
    pub fn friction(&self) -> f64 {
        let [advancing, receding] = self.cosines();
        0.5 * (receding - advancing)
    }

    /// Advancing and receding angle; equal without hysteresis.
    pub fn cosines(&self) -> [f64; 2] {
        cosines(self.hysteresis.unwrap_or([self.angle; 2]))
    }

    /// cot(angle) of the surface that is continued into the wall at `angle`, degrees, at least
    /// [`FLATTEST`] from it: a smaller angle would continue it for many kernels. Young's force uses
    /// the angle itself.
    pub fn cotangent(angle: f64) -> f64 {
        let angle = angle.clamp(FLATTEST, 180.0 - FLATTEST);
        let (sine, cosine) = angle.to_radians().sin_cos();
        cosine / sine
    }

    /// The largest |cot| of the angles of a contact line.
    pub fn steepest(&self) -> f64 {
        let angles = self.hysteresis.unwrap_or([self.angle; 2]);
        let [advancing, receding] = angles.map(|angle| Self::cotangent(angle).abs());
        advancing.max(receding)
    }

    /// Largest ratio of a distance to its image under a shear by the largest |cot|: the shear's
    /// larger principal stretch, (|k| + sqrt(k^2 + 4)) / 2.
    pub fn stretch(&self) -> f64 {
        let shear = self.steepest();
        0.5 * (shear + (shear * shear + 4.0).sqrt())
    }
}

/// Of two angles in degrees.
fn cosines(angles: [f64; 2]) -> [f64; 2] {
    angles.map(|angle| angle.to_radians().cos())
}
