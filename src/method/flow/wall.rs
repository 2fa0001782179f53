//! No particle gets through a wall or a mirror plane.

use super::Flow;
use crate::scene::Side;
use crate::space::parallel::each_mut;

/// How deep in a wall a particle may be, in spacings: there is the wall's first layer.
const BEHIND: f64 = 0.5;

impl Flow {
    /// Whoever is deeper than [`BEHIND`] in a wall, where its layers push every way and not only
    /// out, goes to its surface and keeps the velocity along it. Only a particle that is shot at
    /// the wall gets there.
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
                    (*x, *v) = (0.0, v.max(0.0));
                } else if high && *x > size + deep {
                    (*x, *v) = (size, v.min(0.0));
                }
            });
        }
    }

    /// Reflects what is beyond a mirror plane: places, velocities,
    /// and the vectors `turned`, one for each particle or none at all.
    pub(super) fn fold_back(&mut self, turned: &mut [[f32; 3]]) {
        let Some(mirror) = &self.mirror else {
            return;
        };
        let (n, p) = (self.particles.len(), &mut self.particles);
        for a in (0..3).filter(|&a| self.domain.fold(a).is_some()) {
            let (position, velocity) = (&mut p.position[a][..n], &mut p.velocity[a][..n]);
            if turned.is_empty() {
                each_mut((position, velocity), |_, (x, v)| {
                    if let Some(inside) = mirror.planes.back(a, *x) {
                        (*x, *v) = (inside, -*v);
                    }
                });
                continue;
            }
            each_mut((position, velocity, &mut *turned), |_, (x, v, turned)| {
                if let Some(inside) = mirror.planes.back(a, *x) {
                    (*x, *v) = (inside, -*v);
                    turned[a] = -turned[a];
                }
            });
        }
    }
}
