//! The pressure whose gradient is the transpose of the divergence: its work, and a deep pool.

use super::cloud::{CHANNEL, Cloud, OPEN};
use coronet::kernel::WendlandC2;
use coronet::method::mps::pass::Steep;
use coronet::method::projection::transposed::{
    Divergence, Flowing, OfKernel, Pressing, PressureForce, Weight,
};
use coronet::method::{self, Phase};
use coronet::particle::pack::pack;
use coronet::scene::{Dimension, file};
use coronet::space::sweep::rows;
use std::marker::PhantomData;
use std::ops::ControlFlow::Continue;
use std::path::Path;

/// SUM v . G p and SUM p D v of a cloud in disorder, walls with a pressure and at rest.
fn works<W: Weight>(cloud: &mut Cloud, weight: W) -> [f64; 2] {
    let (n, count) = (cloud.flow.liquid(), cloud.records());
    let mut random = || cloud.random.signed() as f32;
    let pressure: Vec<f32> = (0..count).map(|_| 3.0 + random()).collect();
    let velocity: Vec<[f32; 3]> = (0..count)
        .map(|i| [0; 3].map(|_| if i < n { random() } else { 0.0 }))
        .collect();
    let carried: Vec<[f32; 5]> = pressure.iter().map(|p| [*p, 0.0, 0.0, 0.0, 0.0]).collect();
    cloud.pack::<Pressing>(&carried);
    let scale = cloud.flow.grid.scale(cloud.h);
    let mut force = vec![[0.0f32; 3]; n];
    let pass = PressureForce {
        weight,
        factor: 1.0,
    };
    rows(
        &cloud.flow.records,
        &cloud.flow.rows,
        scale,
        &pass,
        &mut force,
    );
    let carried: Vec<[f32; 5]> = velocity
        .iter()
        .map(|v| [v[0], v[1], v[2], 0.0, 0.0])
        .collect();
    cloud.pack::<Flowing>(&carried);
    let pass = Divergence {
        weight,
        factor: 1.0,
    };
    let mut flux = vec![0.0; n];
    rows(
        &cloud.flow.records,
        &cloud.flow.rows,
        scale,
        &pass,
        &mut flux,
    );
    let mut at_walls = vec![0.0; cloud.flow.walls()];
    rows(
        &cloud.flow.records,
        &cloud.flow.wall_rows,
        scale,
        &pass,
        &mut at_walls,
    );
    let dot = |i: usize| {
        (0..3)
            .map(|a| (velocity[i][a] * force[i][a]) as f64)
            .sum::<f64>()
    };
    flux.extend(at_walls);
    let of_volumes = flux.iter().zip(&pressure).map(|(flux, p)| flux * *p as f64);
    [(0..n).map(dot).sum(), of_volumes.sum()]
}

#[test]
fn the_work_of_the_pressure_is_that_of_the_volumes() {
    for (dimension, sides) in [(Dimension::Two, CHANNEL), (Dimension::Three, OPEN)] {
        let depth = if dimension == Dimension::Two {
            0.0
        } else {
            8.0
        };
        let cells = [12.0, depth, 8.0];
        let mut cloud = Cloud::new(dimension, cells, sides, [1.5, 0.3], |_| true);
        let kernel = OfKernel::<WendlandC2>(PhantomData);
        let steep = Steep {
            reach: 2.0,
            core: 0.4,
        };
        for [force, volumes] in [works(&mut cloud, kernel), works(&mut cloud, steep)] {
            assert!((force / volumes - 1.0).abs() < 1e-4, "{force} {volumes}");
        }
    }
}

/// 40 layers of water burst where the equation had another gradient than the force.
#[test]
fn a_deep_pool_stays_at_rest() {
    for name in ["isph", "mps"] {
        let text = format!(
            "dimension = 2\n[box]\nsize = ['4 mm', '14 mm']\nx = 'periodic'\n\
             z = ['wall', 'open']\n[liquid]\ndensity = '998 kg/m^3'\n\
             [effects.gravity]\nacceleration = '9.81 m/s^2'\n\
             [effects.viscosity]\ndynamic = '1 mPa s'\n\
             [effects.tension]\ncoefficient = '72.8 mN/m'\n\
             [body.pool]\nlayer = {{ depth = '10 mm' }}\n[pack]\nspacing = '0.25 mm'\n\
             [impact]\nend = '1 s'\n[frames]\ninterval = '1 s'\n[method]\nname = '{name}'\n"
        );
        let scene = file::read(&text, Path::new("deep.toml"), &[])
            .unwrap()
            .scene;
        let pool = pack(&scene.pack_input(0), &mut |_| Continue(())).unwrap().0;
        let state = method::initial(&scene.impact_input(), &[pool]);
        let mut solver = method::build(&scene, state, Phase::Impact, Some(1.0)).unwrap();
        let count = solver.len();
        while solver.time() < 4e-3 {
            solver.advance(&mut |_| ()).unwrap();
        }
        let mass = solver.state().particles.mass * count as f64;
        let (energy, _) = solver.unrest();
        assert_eq!(solver.len(), count, "{name}");
        assert!(energy / mass < 2e-4, "{name}: {} J/kg", energy / mass);
    }
}
