//! The virial of the tension's pair forces: what it is calibrated by.

use super::Tension;
use super::pass::Virial;
use crate::effect::surface::Surface;
use crate::kernel::{CubicSpline, Kernel, WendlandC2};
use crate::scene::KernelName;
use crate::space::sweep;
use std::marker::PhantomData;

impl Tension {
    /// SUM of every particle's share of sigma_eff A, J (N in 2-D), times its weight, of the last
    /// update without [`super::level`]. `place`: unit normal of the surface at a particle, and
    /// weight.
    pub fn virial(&self, flow: &Surface, place: impl Fn(usize) -> ([f64; 3], f64)) -> f64 {
        match self.kernel {
            KernelName::CubicSpline => self.virial_with::<CubicSpline>(flow, place),
            KernelName::WendlandC2 => self.virial_with::<WendlandC2>(flow, place),
        }
    }

    fn virial_with<K: Kernel>(
        &self,
        flow: &Surface,
        place: impl Fn(usize) -> ([f64; 3], f64),
    ) -> f64 {
        let n = flow.density.len();
        let mut normals = vec![[0.0; 3]; n];
        let mut weights = Vec::with_capacity(self.reached.len());
        for &i in &self.reached {
            let (normal, weight) = place(i as usize);
            weights.push(weight);
            normals[i as usize] = normal.map(|n| n as f32);
        }
        let mut parts = vec![0.0f64; self.reached.len()];
        let pass = Virial::<K> {
            normals: &normals,
            scale: 1.0 / (self.dimension as f32 - 1.0),
            kernel: PhantomData,
        };
        let field = self.field(flow, self.force_length);
        sweep::runs(field, &self.reached, &pass, &mut parts);
        let sum: f64 = parts.iter().zip(&weights).map(|(part, w)| part * w).sum();
        -0.5 * flow.mass * self.force_length * self.force_factor::<K>(flow.mass) * sum
    }
}
