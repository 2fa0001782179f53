//! What every solver reports: frames for the log, budgets, the particle that caused a fault.

use super::Diverged;
use super::flow::Flow;
use crate::particle::{Frame, Particles};
use crate::space::parallel::{sum, sum_in};
use crate::space::ranks::span::Span;
use serde::{Deserialize, Serialize};

/// Part of an interval below which two instants are the same.
const SAME: f64 = 1e-9;

/// When steps end at frames: at every multiple of an interval.
#[derive(Clone, Copy, Debug)]
pub struct Beat {
    /// s; infinite for none.
    pub interval: f64,
}

impl Default for Beat {
    fn default() -> Self {
        Beat {
            interval: f64::INFINITY,
        }
    }
}

impl Beat {
    /// At most `dt` s from `time` s on, so that steps end at the next instant: the last two before
    /// it are of one length.
    pub fn fit(&self, time: f64, dt: f64) -> f64 {
        if !self.interval.is_finite() {
            return dt;
        }
        let next = (time / self.interval + SAME).floor() + 1.0;
        let left = next * self.interval - time;
        match (dt >= left, 2.0 * dt > left) {
            (true, _) => left,
            (false, true) => 0.5 * left,
            (false, false) => dt,
        }
    }

    /// The instant that `time` s means, s, free of what a sum of steps rounds.
    pub fn exact(&self, time: f64) -> f64 {
        let k = (time / self.interval).round();
        match (time / self.interval - k).abs() < SAME && k > 0.0 {
            true => k * self.interval,
            false => time,
        }
    }
}

/// When frames are taken: frame k after the first step that ends at or after k times the interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Schedule {
    /// s.
    pub interval: f64,
    /// The k of the next one.
    pub next: u64,
}

impl Schedule {
    /// Frames from the start on; `interval` in s.
    pub fn new(interval: f64) -> Self {
        Schedule { interval, next: 0 }
    }

    /// Whether a frame is taken at `time` s; then that is past.
    pub fn takes(&mut self, time: f64) -> bool {
        let is_due = self.next as f64 * self.interval <= time;
        self.skip(time);
        is_due
    }

    /// Leaves out what is due at `time` s.
    pub fn skip(&mut self, time: f64) {
        while self.next as f64 * self.interval <= time {
            self.next += 1;
        }
    }
}

/// Per-particle fields that only the solver knows.
pub struct Fields<'a> {
    /// Pa, by particle index.
    pub pressure: &'a (dyn Fn(usize) -> f64 + Sync),
    /// Whether the particle is at the free surface.
    pub surface: &'a (dyn Fn(usize) -> bool + Sync),
}

/// A frame of `particles`, sorted by id.
pub fn of(time: f64, p: &Particles, fields: &Fields, scalars: Vec<(String, f64)>) -> Frame {
    let mut order: Vec<u32> = (0..p.len() as u32).collect();
    order.sort_unstable_by_key(|&i| p.id[i as usize]);
    let narrow = |v: &Vec<f64>| {
        order
            .iter()
            .map(|&i| v[i as usize] as f32)
            .collect::<Vec<f32>>()
    };
    Frame {
        time,
        id: order.iter().map(|&i| p.id[i as usize]).collect(),
        body: order.iter().map(|&i| p.body[i as usize]).collect(),
        position: [
            narrow(&p.position[0]),
            narrow(&p.position[1]),
            narrow(&p.position[2]),
        ],
        velocity: [
            narrow(&p.velocity[0]),
            narrow(&p.velocity[1]),
            narrow(&p.velocity[2]),
        ],
        pressure: order
            .iter()
            .map(|&i| (fields.pressure)(i as usize) as f32)
            .collect(),
        density: narrow(&p.density),
        surface: order
            .iter()
            .map(|&i| (fields.surface)(i as usize) as u8)
            .collect(),
        mass: match p.weight.is_empty() {
            true => Vec::new(),
            false => order
                .iter()
                .map(|&i| (p.mass * p.weight[i as usize]) as f32)
                .collect(),
        },
        scalars,
    }
}

/// Kinetic and potential energy, J, and momentum, kg m/s, of the liquid. `gravity`: m/s^2.
pub fn budget(flow: &Flow, gravity: Option<[f64; 3]>) -> [f64; 5] {
    let (p, m) = (&flow.particles, flow.particles.mass);
    let g = gravity.unwrap_or([0.0; 3]);
    sum(flow.span(), |i| {
        let v = [p.velocity[0][i], p.velocity[1][i], p.velocity[2][i]];
        let x = flow.position(i);
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let m = m * p.weight(i);
        [
            0.5 * m * dot(v, v),
            -m * dot(g, x),
            m * v[0],
            m * v[1],
            m * v[2],
        ]
    })
}

/// Work of what changes the velocity `free` to `after` on a particle that moves by the mean of
/// `before` and `after`, J/kg; velocities in m/s. What holds a particle where it is does none.
pub fn work(before: [f64; 3], free: [f64; 3], after: [f64; 3]) -> f64 {
    let along = |a: usize| (before[a] + after[a]) * (after[a] - free[a]);
    0.5 * (0..3).map(along).sum::<f64>()
}

/// Power of accelerations beyond a `uniform` one, W, and its rate from what they do to velocities,
/// W/s.
pub fn power(
    (p, span): (&Particles, Span),
    acceleration: &[[f32; 3]],
    uniform: [f64; 3],
    parts: &mut Vec<[f64; 2]>,
) -> [f64; 2] {
    let of = |i: usize| {
        let beyond = |a: usize| (acceleration[i][a] - uniform[a] as f32) as f64;
        let pairs = [0, 1, 2].map(|a| [p.velocity[a][i], beyond(a)]);
        let sums = |f: fn(&[f64; 2]) -> f64| p.weight(i) * pairs.iter().map(f).sum::<f64>();
        [sums(|[v, a]| v * a), sums(|[_, a]| a * a)]
    };
    sum_in(parts, span, of).map(|sum| p.mass * sum)
}

/// Energy of motion, of height, and `own` of each particle, J/kg, J.
pub fn stored(
    (p, span): (&Particles, Span),
    gravity: Option<[f64; 3]>,
    own: impl Fn(usize) -> f64 + Sync,
    parts: &mut Vec<[f64; 1]>,
) -> f64 {
    let g = gravity.unwrap_or_default();
    let [energy] = sum_in(parts, span, |i| {
        let part = |a: usize| 0.5 * p.velocity[a][i].powi(2) - g[a] * p.position[a][i];
        [p.weight(i) * ((0..3).map(part).sum::<f64>() + own(i))]
    });
    p.mass * energy
}

/// Standard deviation of density from `density`, both kg/m^3, of the particles that `is` names.
pub fn deviation(flow: &Flow, density: f64, is: impl Fn(usize) -> bool + Sync) -> f64 {
    let [squares, count] = sum(flow.span(), |i| {
        let d = flow.particles.density[i] - density;
        if is(i) { [d * d, 1.0] } else { [0.0, 0.0] }
    });
    (squares / count.max(1.0)).sqrt()
}

/// A particle that moves.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Mover {
    /// m/s; infinite if it is not a number.
    pub speed: f64,
    id: u32,
    at: [f64; 3],
}

/// The fastest particle of all.
pub fn fastest(flow: &Flow) -> Mover {
    let mover = |i: usize| {
        let speed = flow.particles.speed(i);
        Mover {
            speed: if speed.is_nan() { f64::INFINITY } else { speed },
            id: flow.particles.id[i],
            at: flow.position(i),
        }
    };
    let order = |a: &Mover, b: &Mover| a.speed.total_cmp(&b.speed);
    let own = (0..flow.liquid()).map(mover).max_by(order);
    let all = match &flow.ranks {
        None => vec![own],
        Some(ranks) => ranks.gather(&own),
    };
    let nothing = Mover {
        speed: 0.0,
        id: 0,
        at: [0.0; 3],
    };
    all.into_iter().flatten().max_by(order).unwrap_or(nothing)
}

/// Physics gone wrong, most likely where a particle is fastest.
pub fn fault(mover: Mover, (time, step): (f64, u64), what: String, remedy: &str) -> Diverged {
    let [x, y, z] = mover.at;
    Diverged {
        time,
        step,
        particle: mover.id,
        x,
        y,
        z,
        what,
        remedy: remedy.into(),
    }
}
