//! No particle gets through a wall or a mirror plane.

use super::Flow;
use crate::scene::Side;
use crate::space::parallel::each_mut;

/// How deep in a wall a particle may be, in spacings: there is the wall's first layer.
const BEHIND: f64 = 0.5;

impl Flow {
    /// What is deeper than [`BEHIND`] in a wall, where its layers push every way and not only
    /// out, comes back to there and keeps the velocity along it: what is shot at the wall, and lone
    /// particles on a wall that attracts liquid. Not farther back: a surface costs less in a wall
    /// that counts as liquid, so that they would fall again, for ever.
    pub(super) fn hold_back(&mut self) {
        let (domain, n) = (&self.domain, self.particles.len());
        let deep = BEHIND * self.lengths.spacing;
        let p = &mut self.particles;
        for a in (0..3).filter(|&a| domain.boundary[a].contains(&Side::Wall)) {
            let [low, high] = domain.boundary[a].map(|side| side == Side::Wall);
            let size = domain.size[a];
            let both = (&mut p.position[a][..n], &mut p.velocity[a][..n]);
            each_mut(both, |_, (x, v)| {
                if low && *x < -deep {
                    (*x, *v) = (-deep, v.max(0.0));
                } else if high && *x > size + deep {
                    (*x, *v) = (size + deep, v.min(0.0));
                }
            });
        }
    }

    /// Reflects what is beyond a mirror plane: places and velocities; lists what it was.
    pub(super) fn fold_back(&mut self) {
        self.reflected.clear();
        let Some(mirror) = &self.mirror else {
            return;
        };
        let p = &mut self.particles;
        for a in (0..3).filter(|&a| self.domain.fold(a).is_some()) {
            let both = p.position[a].iter_mut().zip(&mut p.velocity[a]);
            for (i, (x, v)) in both.enumerate() {
                if let Some(inside) = mirror.planes.back(a, *x) {
                    (*x, *v) = (inside, -*v);
                    self.reflected.push((i as u32, a as u8));
                }
            }
        }
    }
}
