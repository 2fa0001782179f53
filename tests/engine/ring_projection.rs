//! Projections of rings: their pressure equation against harmonic functions, liquid at rest, the
//! energy of a splash, restarts.

use super::cloud::Random;
use super::method_scene::{disturbed, words};
use coronet::kernel::{Kernel, WendlandC2};
use coronet::method::{self, Phase, Solver};
use coronet::particle::pack::pack;
use coronet::scene::{Scene, file};
use coronet::simulate::Simulation;
use std::ops::ControlFlow::Continue;
use std::path::Path;

const METHODS: [&str; 2] = ["isph", "mps"];

/// Liquid in a cylinder of 12 mm and 10 mm, as rings of `spacing` mm.
fn scene(method: &str, bodies: &str, effects: &str, spacing: f64) -> Scene {
    let text = format!(
        "[box]\nsize = ['12 mm', '12 mm', '10 mm']\nx = 'wall'\ny = 'wall'\nsymmetry = 'axis'\n\
         [liquid]\ndensity = '998 kg/m^3'\n{effects}\n\
         [effects.viscosity]\ndynamic = '20 mPa s'\n{bodies}\n\
         [pack]\nspacing = '{spacing} mm'\narrangement = 'lattice'\n\
         [impact]\nend = '6 ms'\n[frames]\ninterval = '1 ms'\n[method]\nname = '{method}'\n"
    );
    let loaded = file::read(&text, Path::new("rings.toml"), &[]);
    loaded
        .unwrap_or_else(|error| panic!("{error}\n{text}"))
        .scene
}

const POOL: &str = "[body.pool]\nlayer = { depth = '5 mm' }\n";
const DROP: &str = "[body.drop]\nsphere = { diameter = '4 mm', \
                    centre = ['6 mm', '6 mm', '5 mm'] }\n";
const GRAVITY: &str = "[effects.gravity]\nacceleration = '9.81 m/s^2'\n";
const TENSION: &str = "[effects.tension]\ncoefficient = '72.8 mN/m'\n";

/// A solver on the lattice as it was packed.
fn solver(scene: &Scene) -> Box<dyn Solver> {
    let bodies: Vec<_> = (0..scene.bodies.len())
        .map(|body| {
            let packed = pack(&scene.pack_input(body), &mut |_| Continue(()));
            packed.unwrap().0
        })
        .collect();
    let state = method::initial(&scene.impact_input(), &bodies);
    method::build(scene, state, Phase::Impact, Some(1.0 / 0.955)).unwrap()
}

/// A function of r and z with its name, its Laplacian, and how far from that its sums may be.
type Case<'a> = (&'a str, &'a dyn Fn(f64, f64) -> f64, f64, f64);

/// J0 by its series.
fn bessel(x: f64) -> f64 {
    let mut term = 1.0;
    let mut sum = 1.0;
    for k in 1..30 {
        term *= -x * x / (4.0 * (k * k) as f64);
        sum += term;
    }
    sum
}

#[test]
fn the_equation_of_rings_is_the_laplacian_on_the_axis_and_off() {
    for method in METHODS {
        let scene = scene(method, POOL, GRAVITY, 0.25);
        let mut solver = solver(&scene);
        solver.advance(&mut |_| ()).unwrap();
        let state = solver.state();
        let (p, n) = (&state.particles, state.particles.len());
        let h = scene.method.sph().smoothing * scene.spacing;
        let inside: Vec<usize> = (0..n)
            .filter(|&i| {
                let reach = 2.2 * h;
                let z = p.position[2][i];
                p.position[0][i] < 6e-3 - reach && z > reach && z < 5e-3 - reach
            })
            .collect();
        let (equation, _) = solver.equation().unwrap();
        let (x, z) = (&equation.place[0], &equation.place[2]);
        let of = |q: &dyn Fn(f64, f64) -> f64| {
            let values: Vec<f64> = (0..equation.len()).map(|i| q(x[i], z[i])).collect();
            let row = |&i: &usize| -equation.row(i, &values) / p.weight[i];
            inside.iter().map(row).collect::<Vec<f64>>()
        };
        let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
        let square = of(&|_, z| z * z);
        // Two of these are a Laplacian of 2.
        let unit = mean(&square) / 2.0;
        if method == "isph" {
            let exact = scene.spacing.powi(3) * WendlandC2::norm(3) / h.powi(5);
            let ratio = 1.0 / (2.0 * exact * unit);
            assert!((ratio - 1.0).abs() < 0.02, "{ratio}");
        }
        let k = 500.0;
        let cases: [Case; 4] = [
            ("z^2", &|_, z| z * z, 2.0, 0.06),
            ("r^2", &|r, _| r * r, 4.0, 0.06),
            ("r^2 - 2 z^2", &|r, z| r * r - 2.0 * z * z, 0.0, 0.12),
            // Over k^2, as the parts of its Laplacian are.
            (
                "J0 cosh",
                &|r, z| bessel(k * r) * (k * (z - 2.5e-3)).cosh() / (k * k),
                0.0,
                0.05,
            ),
        ];
        for (name, q, exact, most) in cases {
            let found = of(q);
            let wrong = found.iter().map(|f| (f / unit - exact).abs());
            let worst = wrong.fold(0.0, f64::max);
            println!("{method}: {name}: {worst:.4} of {exact}");
            assert!(worst < most, "{method}: {name}: {worst} of {exact}");
        }
    }
}

#[test]
fn a_column_of_rings_stays_at_rest() {
    for method in METHODS {
        let scene = scene(method, POOL, GRAVITY, 0.25);
        let mut solver = solver(&scene);
        while solver.time() < 5e-3 {
            solver.advance(&mut |_| ()).unwrap();
        }
        let frame = solver.frame();
        let wrong = |near: f64| {
            let rings = (0..frame.id.len()).filter(|&i| (frame.position[0][i] as f64) < near);
            let errors = rings.map(|i| {
                let depth = 5e-3 - frame.position[2][i] as f64;
                (frame.pressure[i] as f64 / (998.0 * 9.81) - depth).powi(2)
            });
            let errors: Vec<f64> = errors.collect();
            (errors.iter().sum::<f64>() / errors.len() as f64).sqrt() / 5e-3
        };
        let (all, axis) = (wrong(1.0), wrong(1e-3));
        println!("{method}: {all:.4}, on the axis {axis:.4}");
        assert!(all < 0.012 && axis < 0.02, "{method}: {all} {axis}");
        let (energy, _) = solver.unrest();
        let mass = 998.0 * std::f64::consts::PI * 6e-3f64.powi(2) * 5e-3;
        assert!(energy / mass < 1e-5, "{method}: {} J/kg", energy / mass);
    }
}

#[test]
fn a_drop_of_rings_at_rest_has_the_pressure_of_its_tension() {
    for method in METHODS {
        let scene = scene(method, DROP, TENSION, 0.125);
        let mut solver = solver(&scene);
        let (mut sum, mut count) = (0.0, 0.0);
        while solver.time() < 7e-3 {
            solver.advance(&mut |_| ()).unwrap();
            if solver.time() < 5e-3 {
                continue;
            }
            let frame = solver.frame();
            for i in 0..frame.id.len() {
                let [r, z] = [frame.position[0][i], frame.position[2][i] - 5e-3];
                if r.hypot(z) < 1.2e-3 {
                    sum += (frame.mass[i] * frame.pressure[i]) as f64;
                    count += frame.mass[i] as f64;
                }
            }
        }
        let ratio = sum / count / (2.0 * 0.0728 / 2e-3);
        println!("{method}: {ratio:.4} of Laplace's pressure");
        assert!((ratio - 1.0).abs() < 0.08, "{method}: {ratio}");
    }
}

/// A drop on its way into a pool.
fn splash(method: &str) -> Scene {
    let drop = "[body.drop]\nsphere = { diameter = '2.5 mm', gap = '0.3 mm', above = 'pool' }\n\
                velocity = '2 m/s'\n";
    scene(
        method,
        &format!("{POOL}{drop}"),
        &format!("{GRAVITY}{TENSION}"),
        0.25,
    )
}

#[test]
fn a_splash_of_rings_gains_no_energy_and_loses_no_mass() {
    for method in METHODS {
        let scene = splash(method);
        let mut simulation = Simulation::resume(&scene, disturbed(&scene, 0.0)).unwrap();
        let series = simulation.run(|_, _| ()).unwrap();
        let column = |name: &str| series.column(name).unwrap().to_vec();
        let whole = column("kinetic_energy_J")[0];
        let unexplained = column("energy_unexplained_J");
        let last = unexplained.last().unwrap() / whole;
        println!("{method}: unexplained {last:.3} of the kinetic energy");
        assert!((-0.35..0.02).contains(&last), "{method}: {last}");
        let (mass, lost) = (column("mass_kg"), column("mass_removed_kg"));
        let gone = mass[0] - mass.last().unwrap() - lost.last().unwrap();
        assert!(gone.abs() < 1e-12 * mass[0], "{method}: {gone:e}");
    }
}

#[test]
fn an_interruption_and_threads_change_no_bit_of_projected_rings() {
    for method in METHODS {
        let scene = splash(method);
        let run = |threads: usize, pause: bool| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            pool.build().unwrap().install(|| {
                let mut random = Random(5);
                let mut state = disturbed(&scene, 0.1);
                let speeds = state.particles.velocity[0].iter_mut();
                speeds.for_each(|v| *v += 0.1 * random.signed());
                let build =
                    |state| method::build(&scene, state, Phase::Impact, Some(1.0 / 0.955)).unwrap();
                let mut solver = build(state);
                for k in 0..12 {
                    solver.advance(&mut |_| ()).unwrap();
                    if pause && k == 7 {
                        solver = build(solver.state());
                    }
                }
                words(&solver.state())
            })
        };
        let plain = run(1, false);
        assert_eq!(plain, run(2, false), "{method}");
        assert_eq!(plain, run(2, true), "{method}");
    }
}
