//! Hysteresis of the contact angle, as dry friction of the contact line.
//!
//! A line on a real wall rests while its angle theta_d is between the receding and the advancing
//! one. There nothing drives it, for the surface goes on into the wall at the angle that it has
//! ([`super::line`]) and Young's force ((4) of [`super`]) has only what lies beyond the two. What
//! resists the motion is the force of hysteresis (as in de Gennes, Rev. Mod. Phys. 57, 827 (1985),
//! Section II.C): along the unit vector e, with y_a the share of particle a in Young's force and
//! theta_Y the angle of the mean cosine,
//! (1) |a_a| = y_a (f - D . e),  f = sigma (cos theta_R - cos theta_A) / 2,
//!     D = nu sigma (cos theta_Y - cos theta_d) within -f .. f,
//! which is sigma (cos theta_d - cos theta_A) against a line that advances, so that one at its
//! advancing angle is free to, and likewise where it recedes.
//! A force for theta_Y, which drives, and friction up to f, which resists, have the same sum; but
//! the first would reach pressures before the second takes it back.
//!
//! A line that rolls forward has particles at rest at the wall, which friction cannot slow. So what
//! they do not take of (1) goes to those that move: with v along the wall (1) is
//! (2) max(1, |v_a| SUM y_b W / SUM y_b |v_b| W) times as large.
//! It only ever stops what moves (Coulomb), so it needs no time step of its own. v is relative to
//! the wall, and in three dimensions what of it crosses the line: along itself a line does not
//! advance or recede.
//!
//! Cannot fail; absent, it costs nothing. Test: tests/engine/effect_wetting.rs.

use super::mean::Means;
use crate::effect::surface::Surface;
use crate::kernel::Kernel;
use crate::particle::column::Entry;
use serde::{Deserialize, Serialize};

/// What holds a particle at a contact line, m/s^2.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Hold {
    /// f y along each axis of its wall, 0 across it.
    pub most: [f32; 3],
    /// D y.
    pub drive: [f32; 3],
    /// Unit vector along the wall and across the line; zero where all along the wall is.
    pub across: [f32; 3],
    /// Velocity of the wall, m/s.
    pub wall: [f32; 3],
}

impl Entry for Hold {}

impl Hold {
    fn size(&self) -> f32 {
        self.most[0].max(self.most[1]).max(self.most[2])
    }

    /// What friction acts on of a velocity, m/s.
    fn part(&self, velocity: [f64; 3]) -> [f64; 3] {
        let slip = |a: usize| match self.most[a] > 0.0 {
            true => velocity[a] - self.wall[a] as f64,
            false => 0.0,
        };
        let (slip, across) = ([0, 1, 2].map(slip), self.across.map(f64::from));
        if across == [0.0; 3] {
            return slip;
        }
        let speed: f64 = (0..3).map(|a| slip[a] * across[a]).sum();
        across.map(|a| speed * a)
    }

    /// [`Hold::part`] and its size, m/s.
    fn moving(&self, velocity: [f64; 3]) -> ([f64; 3], f64) {
        let part = self.part(velocity);
        let squares = part.map(|v| v.powi(2));
        (part, squares.iter().sum::<f64>().sqrt())
    }

    /// Velocity, m/s, of a particle after friction acted on it for `dt` s.
    #[inline(always)]
    pub fn slowed(&self, velocity: [f64; 3], dt: f64) -> [f64; 3] {
        let (part, speed) = self.moving(velocity);
        if speed == 0.0 {
            return velocity;
        }
        let drive = (0..3).map(|a| self.drive[a] as f64 * part[a] / speed);
        let most = (self.size() as f64 - drive.sum::<f64>()).max(0.0);
        let left = (1.0 - dt * most / speed).max(0.0);
        std::array::from_fn(|a| match self.most[a] > 0.0 {
            true => velocity[a] - part[a] + left * part[a],
            false => velocity[a],
        })
    }
}

/// Friction of the particles at contact lines.
#[derive(Clone, Debug, Default)]
pub struct Friction {
    /// (1) of each.
    pub hold: Vec<Hold>,
    /// y and y |v| of all points.
    means: Means,
}

impl Friction {
    /// Bytes held.
    pub fn memory(&self) -> usize {
        std::mem::size_of::<Hold>() * self.hold.capacity() + self.means.memory()
    }

    /// Fills `into`, by liquid particle, with (2). `lines`: the particles at contact lines;
    /// `length`: H, m; velocity in m/s.
    pub fn share<K: Kernel>(
        &mut self,
        flow: &Surface,
        (lines, length): (&[u32], f64),
        velocity: &[Vec<f64>; 3],
        into: &mut [Hold],
    ) {
        self.means.clear(flow);
        let speed = |i: usize, hold: &Hold| hold.moving([0, 1, 2].map(|a| velocity[a][i])).1;
        for (&i, hold) in lines.iter().zip(&self.hold) {
            let weight = hold.size();
            let moving = weight * speed(i as usize, hold) as f32;
            self.means.set(i as usize, [weight, moving]);
        }
        let sums = self.means.sum::<K>(flow, (flow.position, lines), length);
        for ((&i, hold), [all, moving]) in lines.iter().zip(&self.hold).zip(sums) {
            let part = match *moving > 0.0 {
                true => (speed(i as usize, hold) as f32 * all / moving).max(1.0),
                false => 1.0,
            };
            let [most, drive] = [hold.most, hold.drive].map(|f| f.map(|f| part * f));
            into[i as usize] = Hold {
                most,
                drive,
                ..*hold
            };
        }
    }
}
