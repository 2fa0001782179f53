//! Reflection, refraction and absorption.
//!
//! (1) Fresnel's equations for unpolarised light, n = 1.33
//! (2) Beer and Lambert: `exp(-a d)` for each colour over a way of d

use super::trace::{Hit, Tracer, V};

/// Refractive index of water.
pub const INDEX: f32 = 1.33;

/// The mirrored direction.
pub fn reflect(along: &V, normal: &V) -> V {
    along - normal * (2.0 * along.dot(normal))
}

/// The refracted direction and the reflected part (1); `None` if all is reflected. `normal` is
/// towards where the ray comes from, `ratio`: index there over index beyond.
pub fn refract(along: &V, normal: &V, ratio: f32) -> Option<(V, f32)> {
    let cos = (-along.dot(normal)).clamp(0.0, 1.0);
    let square = 1.0 - ratio * ratio * (1.0 - cos * cos);
    if square <= 0.0 {
        return None;
    }
    let beyond = square.sqrt();
    let across = (ratio * cos - beyond) / (ratio * cos + beyond);
    let upright = (cos - ratio * beyond) / (cos + ratio * beyond);
    let part = 0.5 * (across * across + upright * upright);
    let refracted = along * ratio + normal * (ratio * cos - beyond);
    Some((refracted.normalize(), part))
}

/// Where light of the beam that has met the liquid reaches the floor, and how much of it. The
/// colour of the liquid is left to the rays of the camera. At the sides, where the box cuts the
/// liquid, light goes on as if it were repeated: what leaves on one side enters on the other.
pub(super) fn arrival(tracer: &Tracer, along: V, hit: Hit, floor: f32) -> Option<(V, f32)> {
    let size = tracer.corners()[1] - tracer.corners()[0];
    let (mut along, mut hit, mut light) = (along, hit, 1.0);
    for _ in 0..3 {
        let (inside, part) = refract(&along, &hit.normal, 1.0 / INDEX)?;
        light *= 1.0 - part;
        let mut exit = tracer.hit(&hit.at, &inside, true)?;
        for _ in 0..4 {
            if !exit.is_side || exit.normal.z != 0.0 {
                break;
            }
            let entry = exit.at - exit.normal.component_mul(&size);
            exit = tracer.hit(&entry, &inside, true)?;
        }
        if exit.is_side {
            let is_floor = exit.at.z - floor < tracer.offset();
            return is_floor.then_some((exit.at, light));
        }
        let (outside, part) = refract(&inside, &-exit.normal, INDEX)?;
        light *= 1.0 - part;
        if let Some(next) = tracer
            .hit(&exit.at, &outside, false)
            .filter(|next| !next.is_side)
        {
            (along, hit) = (outside, next);
            continue;
        }
        if outside.z >= 0.0 {
            return None;
        }
        let at = exit.at + outside * ((floor - exit.at.z) / outside.z);
        return Some((at, light));
    }
    None
}
