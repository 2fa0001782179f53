//! Hysteresis of the contact angle, as dry friction of the contact line.
//!
//! A line on a real wall rests while its angle is between the receding and the advancing one. With
//! Young's force for the mean of their cosines ((4) of [`super`]), that is what friction does that
//! takes up to
//! (1) f = sigma (cos theta_R - cos theta_A) / 2 per length
//! against the motion along the wall (the force of hysteresis, as in de Gennes, Rev. Mod. Phys.
//! 57, 827 (1985), Section II.C): a line advances once sigma (cos theta_Y - cos theta_d) passes -f,
//! which is at theta_A, and recedes from theta_R on.
//!
//! A line that rolls forward has particles at rest at the wall, which friction cannot slow. So what
//! they do not take of (1) goes to those that move: with y_a the share of particle a in Young's
//! force and v along the wall
//! (2) |a_a| = f y_a max(1, |v_a| SUM y_b W / SUM y_b |v_b| W).
//! It only ever stops what moves (Coulomb), so it needs no time step of its own.
//!
//! Cannot fail; absent, it costs nothing. Test: tests/engine/effect_wetting.rs.

use crate::effect::tension::Surface;
use crate::kernel::Kernel;
use crate::space::lane::Lanes;
use crate::space::sweep::{self, Field, Pair, Pass};
use std::marker::PhantomData;

/// Friction of the particles at contact lines.
#[derive(Clone, Debug, Default)]
pub struct Friction {
    /// f y of each, along each axis of its wall, 0 across it, m/s^2.
    pub most: Vec<[f32; 3]>,
    /// y and y |v| of all points.
    words: [Vec<f32>; 2],
    sums: Vec<[f32; 2]>,
}

impl Friction {
    /// Bytes held.
    pub fn memory(&self) -> usize {
        let pairs = self.words[0].capacity() + self.sums.capacity();
        12 * self.most.capacity() + 8 * pairs
    }

    /// Fills `into`, by liquid particle, with (2). `lines`: who is at a contact line; `length`: H,
    /// m; velocity in m/s.
    pub fn share<K: Kernel>(
        &mut self,
        flow: &Surface,
        (lines, length): (&[u32], f64),
        velocity: &[Vec<f64>; 3],
        into: &mut [[f32; 3]],
    ) {
        for words in &mut self.words {
            words.clear();
            words.resize(flow.at[0].len(), 0.0);
        }
        let speed = |i: usize, most: [f32; 3]| along([0, 1, 2].map(|a| velocity[a][i]), most);
        for (&i, most) in lines.iter().zip(&self.most) {
            let weight = most[0].max(most[1]);
            self.words[0][i as usize] = weight;
            self.words[1][i as usize] = weight * speed(i as usize, *most) as f32;
        }
        self.words.iter_mut().for_each(|words| flow.share(words));
        self.sums.resize(lines.len(), [0.0; 2]);
        let field = Field {
            grid: flow.grid,
            at: flow.at,
            payload: &self.words,
            sources: flow.of_liquid(),
            position: flow.position,
            own: &self.words,
            cutoff: 2.0 * length + flow.slack,
            scale: flow.grid.scale(length),
        };
        sweep::runs(field, lines, &Shares::<K>(PhantomData), &mut self.sums);
        for ((&i, most), [all, moving]) in lines.iter().zip(&self.most).zip(&self.sums) {
            let part = match *moving > 0.0 {
                true => (speed(i as usize, *most) as f32 * all / moving).max(1.0),
                false => 1.0,
            };
            into[i as usize] = most.map(|f| part * f);
        }
    }
}

/// Speed along the wall, m/s.
#[inline(always)]
fn along(velocity: [f64; 3], most: [f32; 3]) -> f64 {
    let moves = (0..3).filter(|a| most[*a] > 0.0);
    moves.map(|a| velocity[a].powi(2)).sum::<f64>().sqrt()
}

/// Velocity, m/s, of a particle after friction acted on it for `dt` s; `most`: the largest
/// deceleration along each axis of the wall, m/s^2, 0 across it.
#[inline(always)]
pub fn slowed(velocity: [f64; 3], most: [f32; 3], dt: f64) -> [f64; 3] {
    let speed = along(velocity, most);
    if speed == 0.0 {
        return velocity;
    }
    let left = (1.0 - dt * most[0].max(most[1]) as f64 / speed).max(0.0);
    std::array::from_fn(|a| match most[a] > 0.0 {
        true => left * velocity[a],
        false => velocity[a],
    })
}

/// SUM w of both words.
struct Shares<K>(PhantomData<K>);

impl<K: Kernel> Pass<2> for Shares<K> {
    type Out = [f32; 2];
    #[inline(always)]
    unsafe fn pair<L: Lanes>(&self, pair: &Pair<L>, sum: &mut [L::F; 2]) {
        unsafe {
            let w = K::w_lanes::<L>(L::sqrt(pair.q2));
            sum[0] = L::fma(w, pair.other[0], sum[0]);
            sum[1] = L::fma(w, pair.other[1], sum[1]);
        }
    }
    #[inline(always)]
    fn finish(&self, _: usize, sum: [f32; 2], out: &mut [f32; 2]) {
        *out = sum;
    }
}
