//! Young's force on contact lines: (4) and (5) of [`super`].

use super::Wetting;
use crate::effect::depth;

/// The most that (5) adds: more is no curvature but a corner.
const MOST_RISE: f64 = 0.3;

impl Wetting {
    /// (4) and [`super::friction::Hold`] as multiples of 1 / (m norm / H^(d+1)), from u, SUM
    /// slope d over the wall, and H d cos / dz of (5). `at`: where, m.
    pub fn young(
        &self,
        u: [f64; 3],
        wall: [f64; 3],
        at: [f64; 3],
        rise: f64,
    ) -> ([f64; 3], [[f64; 3]; 2]) {
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let (size, root) = (dot(wall, wall).sqrt(), dot(u, u).sqrt());
        if size == 0.0 || root == 0.0 {
            return Default::default();
        }
        let (inward, n) = (wall.map(|w| w / size), u.map(|u| u / root));
        // grad c and the wall's point the same way where the angle is zero.
        let cosine = dot(n, inward);
        let along = [0, 1, 2].map(|a| cosine * inward[a] - n[a]);
        let rise = rise * self.height(at, inward) / self.setting.length;
        let away = self.cosine + rise.clamp(-MOST_RISE, MOST_RISE) - cosine;
        let half = self.setting.angle.friction();
        let within = away.clamp(-half, half);
        // |along| is sin theta_d.
        let strength = 2.0 * root * root * size;
        let mut most = [strength * dot(along, along).sqrt() * half; 3];
        most[normal_axis(inward)] = 0.0;
        let drive = along.map(|a| strength * within * a);
        (along.map(|a| strength * (away - within) * a), [most, drive])
    }

    /// Height of the surface that belongs to the stress at `at` over the wall in the direction
    /// `inward`, m.
    fn height(&self, at: [f64; 3], inward: [f64; 3]) -> f64 {
        let setting = &self.setting;
        let depth = depth::depths(setting.kernel, setting.dimension)[0] * setting.length;
        self.above(at, inward) + depth * self.cosine
    }

    /// Height of `at` over the wall in the direction `inward`, m.
    pub fn above(&self, at: [f64; 3], inward: [f64; 3]) -> f64 {
        let axis = normal_axis(inward);
        let height = match inward[axis] < 0.0 {
            true => at[axis],
            false => self.setting.domain.size[axis] - at[axis],
        };
        height.max(0.0)
    }
}

/// The axis that a wall in the direction `inward` is across.
fn normal_axis(inward: [f64; 3]) -> usize {
    (0..3).fold(0, |most, a| {
        if inward[a].abs() > inward[most].abs() {
            a
        } else {
            most
        }
    })
}
