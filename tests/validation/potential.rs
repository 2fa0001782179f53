//! The collapse of a column without viscosity, by boundary elements: an answer to compare the dam
//! break with that shares nothing with particles.
//!
//! Velocity potential with d phi/dt = |u|^2 / 2 - g z along the free surface, moved with the fluid
//! (Longuet-Higgins & Cokelet 1976, Proc. R. Soc. A 350, 1-26); straight elements with linear
//! values, integrated exactly; wall (x = 0) and floor (z = 0) by mirror images. Lengths in widths a
//! of the column, times in sqrt(a / g).

use crate::flow::{MARTIN_MOYCE, between, front_error};
use nalgebra::{DMatrix, DVector};

/// Nodes of the free surface from the wall to the front: x, z and potential.
type Surface = [Vec<f64>; 3];

/// Sign of x, z and the potential in the mirrors at the first node (wall) and the last (floor).
const PARITY: [[f64; 2]; 3] = [[-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]];

/// Elements: the shortest, at the front, the longest, how much longer the next one may be; radius
/// of the upper corner.
pub struct Grid {
    pub shortest: f64,
    pub longest: f64,
    pub growth: f64,
    pub corner: f64,
}

impl Grid {
    /// A grid of this length at the front; a halved one moves the front by 0.3 %.
    pub fn new(shortest: f64) -> Self {
        Self {
            shortest,
            longest: 6.0 * shortest,
            growth: 1.0 + 8.0 * shortest,
            corner: 5.0 * shortest,
        }
    }

    /// Places of the nodes on a surface of this length.
    fn places(&self, length: f64) -> Vec<f64> {
        let (mut from_front, mut step) = (vec![0.0], self.shortest);
        while from_front[from_front.len() - 1] < length {
            from_front.push(from_front[from_front.len() - 1] + step);
            step = (step * self.growth).min(self.longest);
        }
        let stretch = length / from_front[from_front.len() - 1];
        let places = from_front.iter().rev().map(|d| length - stretch * d);
        places.collect()
    }

    /// The surface of a column at rest.
    fn column(&self, height: f64) -> Surface {
        let r = self.corner;
        let quarter = r * std::f64::consts::FRAC_PI_2;
        let (top, side) = (1.0 - r, height - r);
        let at = |s: f64| {
            if s < top {
                return (s, height);
            }
            if s < top + quarter {
                let (sin, cos) = ((s - top) / r).sin_cos();
                return (top + r * sin, side + r * cos);
            }
            (1.0, (side + top + quarter - s).max(0.0))
        };
        let places = self.places(top + quarter + side);
        let (x, z) = places.iter().map(|s| at(*s)).unzip();
        [x, z, vec![0.0; places.len()]]
    }

    /// New nodes on the same surface, smoothed by five points as Longuet-Higgins & Cokelet do.
    fn spread(&self, surface: &Surface) -> Surface {
        let arc = arc(surface);
        let places = self.places(arc[arc.len() - 3]);
        std::array::from_fn(|c| {
            let f = mirrored(&surface[c], PARITY[c]);
            let value = |s: &f64| {
                let k = arc.partition_point(|a| a < s).clamp(2, arc.len() - 2) - 2;
                let weights = lagrange(&arc[k..k + 4], *s).0;
                dot(&weights, &f[k..k + 4])
            };
            let moved: Vec<_> = places.iter().map(value).collect();
            let smooth = |w: &[f64]| dot(w, &[-0.0625, 0.25, 0.625, 0.25, -0.0625]);
            mirrored(&moved, PARITY[c]).windows(5).map(smooth).collect()
        })
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Values with two mirror images before the first and after the last.
fn mirrored(f: &[f64], [first, last]: [f64; 2]) -> Vec<f64> {
    let n = f.len();
    let before = [first * f[2], first * f[1]];
    let after = [last * f[n - 2], last * f[n - 3]];
    [&before[..], f, &after[..]].concat()
}

/// Length along the surface at its nodes and their mirror images.
fn arc([x, z, _]: &Surface) -> Vec<f64> {
    let mut s = vec![0.0];
    for k in 1..x.len() {
        s.push(s[k - 1] + (x[k] - x[k - 1]).hypot(z[k] - z[k - 1]));
    }
    let n = s.len();
    let before = [-s[2], -s[1]];
    let after = [2.0 * s[n - 1] - s[n - 2], 2.0 * s[n - 1] - s[n - 3]];
    [&before[..], &s[..], &after[..]].concat()
}

/// Weights of value and slope at `x` of the polynomial through values at `nodes`.
fn lagrange(nodes: &[f64], x: f64) -> (Vec<f64>, Vec<f64>) {
    let weight = |j: usize| {
        let others = nodes.iter().enumerate().filter(|(k, _)| *k != j);
        others.fold((1.0, 0.0), |(value, slope), (_, node)| {
            let scale = 1.0 / (nodes[j] - node);
            (
                value * (x - node) * scale,
                (slope * (x - node) + value) * scale,
            )
        })
    };
    (0..nodes.len()).map(weight).unzip()
}

/// Integrals over an element of length `l` of ln r and of its normal derivative, each times 1 and
/// times the distance from its start over `l`; the point is `along` and `off` from the start.
fn integrals(along: f64, off: f64, l: f64) -> [f64; 4] {
    let at = |u: f64| {
        let square = u * u + off * off;
        let log = if square > 0.0 { square.ln() } else { 0.0 };
        let angle = if off == 0.0 { 0.0 } else { (u / off).atan() };
        [
            0.5 * (u * log - 2.0 * u + 2.0 * off * angle),
            0.25 * (square * log - u * u),
            -angle,
            -0.5 * off * log,
        ]
    };
    let (a, b) = (at(-along), at(l - along));
    let [s, su, d, du]: [f64; 4] = std::array::from_fn(|k| b[k] - a[k]);
    [s, (su + along * s) / l, d, (du + along * d) / l]
}

/// Single and double layer of the nodes' values at the nodes, images included.
fn layers([x, z, _]: &Surface) -> (DMatrix<f64>, DMatrix<f64>) {
    let n = x.len();
    let (mut single, mut double) = (DMatrix::zeros(n, n), DMatrix::zeros(n, n));
    for e in 0..n - 1 {
        let (dx, dz) = (x[e + 1] - x[e], z[e + 1] - z[e]);
        let l = dx.hypot(dz);
        for i in 0..n {
            for (sx, sz) in [(1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)] {
                let (rx, rz) = (sx * x[i] - x[e], sz * z[i] - z[e]);
                let (along, off) = ((rx * dx + rz * dz) / l, (rx * dz - rz * dx) / l);
                // A point of the element itself, up to round-off.
                let off = if off.abs() < 1e-13 { 0.0 } else { off };
                let [s, s_end, d, d_end] = integrals(along, off, l);
                single[(i, e)] += s - s_end;
                single[(i, e + 1)] += s_end;
                double[(i, e)] += d - d_end;
                double[(i, e + 1)] += d_end;
            }
        }
    }
    (single, double)
}

/// Velocity and growth of the potential at the nodes.
fn rates(surface: &Surface) -> Surface {
    let n = surface[0].len();
    let (single, double) = layers(surface);
    // Green's identity; the angle inside follows from a potential of one.
    let angle = double.column_sum();
    let phi = DVector::from_column_slice(&surface[2]);
    let right = &double * &phi - angle.component_mul(&phi);
    let flux = single.lu().solve(&right).expect("elements have lengths");
    let arc = arc(surface);
    let f: [_; 3] = std::array::from_fn(|c| mirrored(&surface[c], PARITY[c]));
    let mut rates: Surface = std::array::from_fn(|_| vec![0.0; n]);
    for i in 0..n {
        let weights = lagrange(&arc[i..i + 5], arc[i + 2]).1;
        let [tx, tz, slope] = std::array::from_fn(|c| dot(&weights, &f[c][i..i + 5]));
        let t = tx.hypot(tz);
        let (tx, tz, slope) = (tx / t, tz / t, slope / t);
        let u = flux[i] * tz + slope * tx;
        let w = -flux[i] * tx + slope * tz;
        rates[0][i] = if i == 0 { 0.0 } else { u };
        rates[1][i] = if i == n - 1 { 0.0 } else { w };
        rates[2][i] = 0.5 * (u * u + w * w) - surface[1][i];
    }
    rates
}

fn moved(surface: &Surface, rates: &Surface, dt: f64) -> Surface {
    let node = |c: usize, k: usize| surface[c][k] + dt * rates[c][k];
    std::array::from_fn(|c| (0..surface[c].len()).map(|k| node(c, k)).collect())
}

/// Time step: 0.4 of what brings two neighbours together, a tenth of sqrt(shortest / g), 0.02.
fn step(surface: &Surface, rates: &Surface, grid: &Grid) -> f64 {
    let apart = |f: &Surface, k: usize| (f[0][k] - f[0][k - 1]).hypot(f[1][k] - f[1][k - 1]);
    let meet = (1..surface[0].len()).map(|k| 0.4 * apart(surface, k) / apart(rates, k));
    meet.fold(f64::min(0.02, 0.1 * grid.shortest.sqrt()), f64::min)
}

/// Time and surface from the start to `until`, classical Runge-Kutta.
fn collapse(height: f64, until: f64, grid: &Grid, mut each: impl FnMut(f64, &Surface)) {
    let (mut surface, mut time) = (grid.column(height), 0.0);
    each(time, &surface);
    while time < until {
        let a = rates(&surface);
        let dt = step(&surface, &a, grid);
        let b = rates(&moved(&surface, &a, 0.5 * dt));
        let c = rates(&moved(&surface, &b, 0.5 * dt));
        let d = rates(&moved(&surface, &c, dt));
        for (rate, dt) in [
            (&a, dt / 6.0),
            (&b, dt / 3.0),
            (&c, dt / 3.0),
            (&d, dt / 6.0),
        ] {
            surface = moved(&surface, rate, dt);
        }
        surface = grid.spread(&surface);
        time += dt;
        each(time, &surface);
    }
}

/// Front of a column of this height over time, both over a: time t sqrt(2 g / a) and place.
pub fn front(height: f64, until: f64, grid: &Grid) -> Vec<(f64, f64)> {
    let clock = std::f64::consts::SQRT_2;
    let mut track = Vec::new();
    collapse(height, until / clock, grid, |t, [x, _, _]| {
        track.push((t * clock, x[x.len() - 1]));
    });
    track
}

/// The face of a column starts with 2 g / H sum tanh(k a) / k cos(k z), k = (n + 1/2) pi / H: the
/// pressure is harmonic, zero on face and top, and holds the weight at wall and floor.
#[test]
fn a_column_starts_as_the_series_says() {
    let height = 2.0;
    let surface = Grid::new(0.01).column(height);
    // Potential after a short time over that time: -g z.
    let pushed = [
        surface[0].clone(),
        surface[1].clone(),
        surface[1].iter().map(|z| -z).collect(),
    ];
    let outwards = &rates(&pushed)[0];
    let places = surface[0].iter().zip(&surface[1]).zip(outwards);
    let face = places.filter(|((x, z), _)| **x == 1.0 && (0.1..1.7).contains(*z));
    let mut worst = 0.0f64;
    for ((_, z), outwards) in face {
        let term = |n: u32| {
            let k = (f64::from(n) + 0.5) * std::f64::consts::PI / height;
            k.tanh() / k * (k * z).cos()
        };
        let theory = 2.0 / height * (0..20_000).map(term).sum::<f64>();
        worst = worst.max((outwards / theory - 1.0).abs());
    }
    println!("| start of a column by boundary elements | worst error of the face | {worst:.4} |");
    assert!(worst < 0.01);
}

/// Half the elements move the front by less than half a percent, and no liquid is lost.
#[test]
fn the_front_converges() {
    let coarse = front(2.0, 3.3, &Grid::new(0.02));
    let mut area = 0.0;
    let (mut fine, clock) = (Vec::new(), std::f64::consts::SQRT_2);
    collapse(2.0, 3.3 / clock, &Grid::new(0.01), |t, [x, z, _]| {
        fine.push((t * clock, x[x.len() - 1]));
        let strip = |k: usize| 0.5 * (z[k] + z[k - 1]) * (x[k] - x[k - 1]);
        area = (1..x.len()).map(strip).sum::<f64>();
    });
    let apart = |(t, z): &(f64, f64)| (between(&fine, *t) / z - 1.0).abs();
    let worst = coarse.iter().map(apart).fold(0.0, f64::max);
    println!("| front by boundary elements | moved by half the elements | {worst:.4} |");
    println!("| | area at the end, of 2 | {area:.4} |");
    let experiment = front_error(&fine, &MARTIN_MOYCE);
    println!("| | mean difference from the experiment by its clock | {experiment:.4} |");
    assert!(worst < 0.01 && (area - 2.0).abs() < 0.01);
}

/// The curve that `scenes/study/dam-break.toml` compares with is this solution (a = 57 mm); prints
/// the curve if it is not.
#[test]
fn the_study_compares_with_this_front() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let stored = std::fs::read_to_string(root.join("scenes/study/dam-break-theory.csv"));
    let (a, clock) = (0.057, (2.0 * 9.81f64 / 0.057).sqrt());
    let track = front(2.0, 3.4, &Grid::new(0.01));
    let row = |k: u32| {
        let t = 0.1 * f64::from(k);
        format!("{:.5},{:.5}\n", t / clock, a * between(&track, t))
    };
    let wanted = "time_s,front_m\n".to_string() + &(0..=33).map(row).collect::<String>();
    let same = stored.is_ok_and(|s| s == wanted);
    assert!(same, "dam-break-theory.csv should be\n{wanted}");
}
