//! Contact angle of liquid on the floor, by two methods that share only the raster.
//!
//! Fitted: a circle (2-D) or sphere (3-D) through the outline of the main body where it is higher
//! than [`CUT`], its centre at `z_c`, its radius `R`:
//! (1) cos θ = −z_c / R
//! Least squares of the distances to it: Gauss-Newton from Kåsa's algebraic fit. Gravity flattens a
//! drop: then (1) is the angle of the nearest circle, and fits on either side of a plane drop, up
//! to [`FLANK`], follow the profile where it meets the wall.
//!
//! From base and height, of a cap: half-base b, height H:
//! (2) θ = 2 atan(H / b)
//! The base lies between the feet of the outline: where circles through it below [`FLANK`], on
//! either side or (3-D) about the axis of the sphere, meet the wall. The raster does not resolve
//! feet: its liquid is mirrored at the wall, and the base of an ideal cap of 150° is 7 % too wide
//! (2-D, 15 spacings) or 16 % (3-D, 6 spacings), with these circles 2 % too wide and 7 % too
//! narrow.
//! Test: tests/engine/measure_contact.rs.

use nalgebra::{DMatrix, DVector};

use super::raster::{LEVEL, Raster};
use super::region::{Class, Region};

/// Lowest outline that is fitted, spacings: liquid is mirrored at the wall, and the kernel of the
/// raster is this wide.
pub const CUT: f64 = 2.6;

/// Highest outline of the fits on either side, spacings.
pub const FLANK: f64 = 12.0;

/// How far from the outline a foot may be, spacings: the lowest outline of a cap of 10 degrees is
/// 15 from it.
const FAR: f64 = 20.0;

/// Largest |cos θ| of (1) that is one of 180 degrees: outlines are uncertain by that.
const TOUCHES: f64 = 1.02;

/// Largest root mean square distance of the outline from its circle, spacings: half of what the
/// outline resolves. Flat caps of rings at coarse spacings are above it, too.
const ROUND: f64 = 0.5;

/// Least number of points of a fit for each unknown.
const FEWEST: usize = 3;

/// Gauss-Newton steps: from Kåsa's fit two or three reach round-off.
const STEPS: usize = 8;

/// Angles through the liquid, degrees; `None` where there is too little outline, or no drop on the
/// floor: a film has hollow edges, or no edge.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Contact {
    /// (1).
    pub fitted: Option<f64>,
    /// (2).
    pub built: Option<f64>,
    /// (1) at the low and the high side in x (2-D only).
    pub flanks: [Option<f64>; 2],
    /// Diameter of the base, m.
    pub base: Option<f64>,
}

impl Contact {
    /// `diameter`: of the area within the contact line, for (2) where the outline has no feet;
    /// `apex`: highest liquid, m.
    pub fn new(region: &Region, diameter: f64, apex: Option<f64>) -> Contact {
        if diameter <= 0.0 {
            return Contact::default();
        }
        let raster = region.raster;
        let reach = FAR * raster.particle_spacing;
        let [cut, flank] = [CUT, FLANK].map(|at| at * raster.particle_spacing);
        let mut above = outline(region);
        above.retain(|p| p[2] > cut);
        let low = above.iter().filter(|p| p[2] < flank);
        let mut contact = Contact::default();
        let top = above.iter().fold(0.0, |top: f64, p| top.max(p[2]));
        let nearly = ROUND * raster.particle_spacing;
        let is_round = |Round { centre, rms, .. }: &&Round| {
            *rms <= nearly && centre.last().is_some_and(|height| *height <= top)
        };
        if raster.count[1] == 1 {
            let whole = round(&above, &[0, 2]);
            contact.fitted = whole.as_ref().filter(is_round).and_then(angle);
            let middle = above.iter().map(|p| p[0]).sum::<f64>() / above.len().max(1) as f64;
            let sides = [-1.0, 1.0].map(|side| {
                let beside = low.clone().map(|p| [side * (p[0] - middle), 0.0, p[2]]);
                let points: Vec<[f64; 3]> = beside.filter(|p| p[0] > 0.0).collect();
                (round(&points, &[0, 2]), points)
            });
            contact.flanks = sides.each_ref().map(|(side, points)| {
                let drop = side.as_ref().filter(|side| is_convex(side, points));
                drop.and_then(angle)
            });
            let feet = sides.each_ref().map(|(side, points)| {
                let side = side.as_ref()?;
                foot(side, points, reach)
            });
            contact.base = feet[0].zip(feet[1]).map(|(low, high)| low + high);
        } else if let Some(sphere) = round(&above, &[0, 1, 2]) {
            contact.fitted = Some(&sphere).filter(is_round).and_then(angle);
            let [x, y] = [sphere.centre[0], sphere.centre[1]];
            let about = low.map(|p| [(p[0] - x).hypot(p[1] - y), 0.0, p[2]]);
            let about: Vec<[f64; 3]> = about.collect();
            let foot = round(&about, &[0, 2]).and_then(|side| foot(&side, &about, reach));
            contact.base = foot.map(|foot| 2.0 * foot);
        }
        let base = contact.base.unwrap_or(diameter);
        contact.built = apex.map(|height| 2.0 * height.atan2(0.5 * base).to_degrees());
        contact
    }
}

/// Where the level φ = 1/2 of the main body crosses the lines between nodes, m.
fn outline(region: &Region) -> Vec<[f64; 3]> {
    let raster = region.raster;
    let mut points = Vec::new();
    for block in (0..raster.code.len()).filter(|&block| raster.is_summed(block)) {
        raster.for_nodes(block, |node| {
            if region.class(node) == Class::Main {
                for axis in (0..3).filter(|&axis| raster.count[axis] > 1) {
                    points.extend([false, true].map(|up| crossing(raster, node, axis, up)));
                }
            }
        });
    }
    points.into_iter().flatten().collect()
}

/// The crossing between a node in the liquid and its neighbour along `axis`.
fn crossing(raster: &Raster, node: [usize; 3], axis: usize, up: bool) -> Option<[f64; 3]> {
    let mut next = node;
    next[axis] = match (up, node[axis]) {
        (true, k) if k + 1 < raster.count[axis] => k + 1,
        (false, k) if k > 0 => k - 1,
        _ => return None,
    };
    let (here, there) = (raster.value(node), raster.value(next));
    if there >= LEVEL {
        return None;
    }
    let part = f64::from((here - LEVEL) / (here - there)) * raster.spacing[axis];
    let mut point = [0, 1, 2].map(|a| raster.coordinate(a, node[a]));
    point[axis] += if up { part } else { -part };
    Some(point)
}

/// A circle or sphere through points, m.
struct Round {
    centre: Vec<f64>,
    radius: f64,
    /// Of the distances of the points from it.
    rms: f64,
}

/// (1); `None` if the circle is above the wall.
fn angle(Round { centre, radius, .. }: &Round) -> Option<f64> {
    let cosine = -centre[centre.len() - 1] / radius;
    (cosine.abs() <= TOUCHES).then(|| cosine.clamp(-1.0, 1.0).acos().to_degrees())
}

/// Whether the centre of a circle through points of one side, which are at x > 0, is on the side of
/// the liquid: where a drop runs out into a film, it is not.
fn is_convex(Round { centre, .. }: &Round, points: &[[f64; 3]]) -> bool {
    let middle = points.iter().map(|p| p[0]).sum::<f64>() / points.len().max(1) as f64;
    centre[0] < middle
}

/// Where a circle through `points` meets the wall, nearest to the lowest of them, m (where a film
/// extends from a drop the circle lies outside); `None` if it does not meet it on this side, within
/// `reach` m of that.
fn foot(Round { centre, radius, .. }: &Round, points: &[[f64; 3]], reach: f64) -> Option<f64> {
    let lowest = points.iter().min_by(|a, b| a[2].total_cmp(&b[2]))?;
    let half = (radius * radius - centre[1] * centre[1]).sqrt();
    let feet = [centre[0] + half, centre[0] - half];
    let far = |foot: &f64| (foot - lowest[0]).abs();
    let found = feet
        .into_iter()
        .filter(|foot| *foot > 0.0 && far(foot) <= reach);
    found.min_by(|a, b| far(a).total_cmp(&far(b)))
}

/// The circle or sphere that fits `points`, with its centre along `axes`.
fn round(points: &[[f64; 3]], axes: &[usize]) -> Option<Round> {
    let (n, d) = (points.len(), axes.len());
    if n < FEWEST * (d + 1) {
        return None;
    }
    let origin: Vec<f64> = axes
        .iter()
        .map(|&a| points.iter().map(|p| p[a]).sum::<f64>() / n as f64)
        .collect();
    let scale = points
        .iter()
        .map(|p| square(p, axes, &origin))
        .fold(0.0, f64::max)
        .sqrt();
    let local = |p: &[f64; 3], k: usize| (p[axes[k]] - origin[k]) / scale;
    // Kåsa: 2 c . x + (R^2 - c^2) = x^2 is linear in c and the bracket.
    let design = DMatrix::from_fn(n, d + 1, |i, k| match k {
        k if k < d => 2.0 * local(&points[i], k),
        _ => 1.0,
    });
    let squares = DVector::from_fn(n, |i, _| square(&points[i], axes, &origin) / scale.powi(2));
    let kasa = solve(&design, &squares)?;
    let mut centre: Vec<f64> = (0..d).map(|k| kasa[k]).collect();
    let mut radius = (kasa[d] + centre.iter().map(|c| c * c).sum::<f64>()).sqrt();
    let away = |i: usize, centre: &[f64]| {
        let to: Vec<f64> = (0..d).map(|k| local(&points[i], k) - centre[k]).collect();
        let far = to.iter().map(|x| x * x).sum::<f64>().sqrt();
        (to, far)
    };
    for _ in 0..STEPS {
        let design = DMatrix::from_fn(n, d + 1, |i, k| {
            let (to, far) = away(i, &centre);
            if k < d { to[k] / far } else { 1.0 }
        });
        let residual = DVector::from_fn(n, |i, _| away(i, &centre).1 - radius);
        let step = solve(&design, &residual)?;
        (0..d).for_each(|k| centre[k] += step[k]);
        radius += step[d];
    }
    let squares = (0..n).map(|i| (away(i, &centre).1 - radius).powi(2));
    let rms = scale * (squares.sum::<f64>() / n as f64).sqrt();
    let centre: Vec<f64> = (0..d).map(|k| origin[k] + scale * centre[k]).collect();
    let known = centre.iter().all(|c| c.is_finite()) && radius > 0.0;
    let radius = scale * radius;
    known.then_some(Round {
        centre,
        radius,
        rms,
    })
}

fn square(p: &[f64; 3], axes: &[usize], origin: &[f64]) -> f64 {
    let pairs = axes.iter().zip(origin);
    pairs.map(|(&a, o)| (p[a] - o).powi(2)).sum()
}

/// Least squares by the normal equations.
fn solve(design: &DMatrix<f64>, wanted: &DVector<f64>) -> Option<DVector<f64>> {
    let normal = design.transpose() * design;
    normal
        .cholesky()
        .map(|c| c.solve(&(design.transpose() * wanted)))
}
