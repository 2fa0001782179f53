//! The virial of the tension's pair forces: what it is calibrated by.

use super::pass::Virial;
use super::{Surface, Tension};
use crate::kernel::{CubicSpline, Kernel, WendlandC2};
use crate::scene::KernelName;
use crate::space::sweep;
use std::marker::PhantomData;

impl Tension {
    /// sigma_eff A, J (N in 2-D), of the last update.
    pub fn virial(&self, flow: &Surface) -> f64 {
        self.virial_moment(flow, |_| 1.0)
    }

    /// The same with the share of every particle times `weight`.
    pub fn virial_moment(&self, flow: &Surface, weight: impl Fn(usize) -> f64) -> f64 {
        match self.kernel {
            KernelName::CubicSpline => self.virial_with::<CubicSpline>(flow, weight),
            KernelName::WendlandC2 => self.virial_with::<WendlandC2>(flow, weight),
        }
    }

    fn virial_with<K: Kernel>(&self, flow: &Surface, weight: impl Fn(usize) -> f64) -> f64 {
        let mut parts = vec![0.0f64; self.reached.len()];
        let pass = Virial::<K> {
            scale: 1.0 / (self.dimension as f32 - 1.0),
            kernel: PhantomData,
        };
        let field = self.field(flow, self.force_length);
        sweep::runs(field, &self.reached, &pass, &mut parts);
        let share = |(part, &i): (&f64, &u32)| part * weight(i as usize);
        let sum: f64 = parts.iter().zip(&self.reached).map(share).sum();
        -0.5 * flow.mass * self.force_length * self.force_factor::<K>(flow.mass) * sum
    }
}
