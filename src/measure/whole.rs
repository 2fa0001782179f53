//! From the frames of a part of a symmetric scene to those of the whole, from which measures and
//! pictures are made. See [`crate::scene`], `symmetry`.

use std::borrow::Cow;

use crate::particle::Frame;
use crate::scene::Scene;

/// Unfolds the frames of a scene.
#[derive(Clone, Debug)]
pub struct Unfold {
    /// Axes with mirror planes, the side about which the box is unfolded, and its size, m.
    axes: Vec<(usize, usize, f32)>,
    /// Whether particles are rings, which have the mass of the whole.
    is_axial: bool,
}

impl Unfold {
    /// Finds the mirror planes of `scene`.
    pub fn new(scene: &Scene) -> Self {
        let domain = &scene.domain;
        let fold = |axis: usize| {
            let side = scene.unfolds(axis)?;
            Some((axis, side, domain.size[axis] as f32))
        };
        Unfold {
            axes: (0..3).filter_map(fold).collect(),
            is_axial: domain.is_axial(),
        }
    }

    /// Whether the whole was simulated.
    pub fn is_plain(&self) -> bool {
        self.axes.is_empty()
    }

    /// The frame of the whole: the same one if the whole was simulated.
    pub fn whole<'a>(&self, frame: &'a Frame) -> Cow<'a, Frame> {
        match self.is_plain() {
            true => Cow::Borrowed(frame),
            false => Cow::Owned(self.frame(frame)),
        }
    }

    /// The frame of the whole, of rings the section through the axis. Images have new ids, after
    /// those of the particles. Masses, energies and momenta are those of the whole: twice the
    /// part's for each axis, and zero momentum along it.
    pub fn frame(&self, frame: &Frame) -> Frame {
        let mut whole = frame.clone();
        if self.is_axial {
            // Each ring appears on both sides of the section.
            whole.mass.iter_mut().for_each(|mass| *mass *= 0.5);
        }
        for &(axis, side, size) in &self.axes {
            let count = whole.id.len();
            let next = whole.id.iter().max().map_or(0, |id| id + 1);
            whole.id.extend_from_within(..);
            whole.id[count..].iter_mut().for_each(|id| *id += next);
            whole.body.extend_from_within(..);
            whole.pressure.extend_from_within(..);
            whole.density.extend_from_within(..);
            whole.surface.extend_from_within(..);
            whole.mass.extend_from_within(..);
            for a in 0..3 {
                whole.position[a].extend_from_within(..);
                whole.velocity[a].extend_from_within(..);
            }
            let (points, images) = whole.position[axis].split_at_mut(count);
            match side {
                0 => {
                    points.iter_mut().for_each(|x| *x += size);
                    images.iter_mut().for_each(|x| *x = size - *x);
                }
                _ => images.iter_mut().for_each(|x| *x = 2.0 * size - *x),
            }
            whole.velocity[axis][count..]
                .iter_mut()
                .for_each(|v| *v = -*v);
            let across = format!("momentum_{}_kg_m_s", ["x", "y", "z"][axis]);
            for (name, value) in &mut whole.scalars {
                if *name == across {
                    *value = 0.0;
                } else if is_extensive(name) && !self.is_axial {
                    *value *= 2.0;
                }
            }
        }
        whole
    }
}

/// Whether a scalar adds up over parts.
fn is_extensive(name: &str) -> bool {
    name.ends_with("_energy_J")
        || name.ends_with("_work_J")
        || name.starts_with("mass_")
        || name.starts_with("momentum_")
}
