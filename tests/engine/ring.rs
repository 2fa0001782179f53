//! Rings about an axis: their kernel, and what is derived from it.

use super::method_scene::{disturbed, words};
use coronet::kernel::ring::{FAR, Rings};
use coronet::kernel::{Kernel, WendlandC2};
use coronet::measure::series::Series;
use coronet::method::{self, Phase, Solver};
use coronet::particle::{State, ring};
use coronet::scene::{Precision, Scene, file};
use coronet::simulate::Simulation;
use coronet::space::lane::{self, Job, Lanes, Real, WIDTH};
use std::f64::consts::PI;
use std::path::Path;

/// The first and second derivatives at eight pairs of y and p.
struct Eight<'a> {
    y: [f32; WIDTH],
    p: [f32; WIDTH],
    is_far: bool,
    out: &'a mut [[f32; WIDTH]; 6],
}

impl Job for Eight<'_> {
    fn run<L: Lanes>(self, lanes: L) {
        let one = lanes.splat(1.0);
        let (y, p) = (one.of_array(self.y), one.of_array(self.p));
        let rings = Rings::default();
        let first = rings.first(self.is_far, y, p);
        let second = rings.second(self.is_far, y, p);
        for (out, found) in self.out.iter_mut().zip(first.into_iter().chain(second)) {
            *out = found.to_array();
        }
    }
}

fn found(y: [f64; WIDTH], p: [f64; WIDTH], is_far: bool) -> [[f32; WIDTH]; 6] {
    let mut out = [[0.0; WIDTH]; 6];
    let (y, p) = (y.map(|y| y as f32), p.map(|p| p as f32));
    let job = Eight {
        y,
        p,
        is_far,
        out: &mut out,
    };
    lane::run(Precision::Mixed, job);
    out
}

/// F by the midpoint rule over the angle, which converges fast for a periodic function.
fn exact(y: f64, p: f64) -> f64 {
    const POINTS: usize = 20_000;
    let at = |k: usize| {
        let f = PI * (k as f64 + 0.5) / POINTS as f64;
        WendlandC2::w((y + 2.0 * p * (1.0 - f.cos())).sqrt())
    };
    (0..POINTS).map(at).sum::<f64>() / POINTS as f64
}

#[test]
fn the_kernel_of_rings_is_the_mean_over_the_angle() {
    let y = [0.01, 0.09, 0.3, 0.7, 1.2, 2.0, 3.0, 3.8];
    let far = (FAR as f64 - 2.0) * FAR as f64;
    for p in [0.02, 0.3, 1.0, 4.0, 20.0, 90.0, far, 400.0, 1e4] {
        let is_far = p >= far;
        let out = found(y, [p; WIDTH], is_far);
        let size = exact(0.0, p);
        for k in 0..WIDTH {
            let e = 1e-3 * y[k].max(0.1);
            let by_y = (exact(y[k] + e, p) - exact(y[k] - e, p)) / (2.0 * e);
            let e = 1e-3 * p;
            let by_p = (exact(y[k], p + e) - exact(y[k], p - e)) / (2.0 * e);
            for (c, (exact, scale)) in [
                (exact(y[k], p), size),
                (by_y, size),
                (by_p, size / p.max(0.5)),
            ]
            .into_iter()
            .enumerate()
            {
                let error = (out[c][k] as f64 - exact).abs() / scale;
                assert!(error < 2e-3, "p {p}, y {}: {c}: {error:e}", y[k]);
            }
        }
    }
}

#[test]
fn second_derivatives_are_those_of_the_first() {
    let y = [0.2, 0.3, 0.4, 0.8, 1.3, 2.0, 2.9, 3.6];
    for p in [0.05, 0.5, 2.0, 30.0, 200.0, 2e3] {
        let is_far = p > 130.0;
        let at = |y: [f64; WIDTH], p: f64| found(y, [p; WIDTH], is_far);
        let now = at(y, p);
        let (dy, dp) = (0.04, 0.04 * p);
        let (high, low) = (at(y.map(|y| y + dy), p), at(y.map(|y| y - dy), p));
        let (more, less) = (at(y, p + dp), at(y, p - dp));
        for k in 0..WIDTH {
            let along = |c: usize| (high[c][k] - low[c][k]) as f64 / (2.0 * dy);
            let across = |c: usize| (more[c][k] - less[c][k]) as f64 / (2.0 * dp);
            let size = exact(0.0, p);
            for (c, by, scale) in [
                (3, along(1), size * 3.0),
                (4, across(1), size / p.max(0.3)),
                (4, along(2), size / p.max(0.3)),
                (5, across(2), size / (p * p).max(0.3)),
            ] {
                let error = (now[c][k] as f64 - by).abs() / scale;
                assert!(error < 0.03, "p {p}, y {}: {c}: {error:e}", y[k]);
            }
        }
    }
}

#[test]
fn a_ring_sees_itself_as_the_table_does() {
    for radius in [0.05, 0.4, 1.0, 3.0, 9.0, 20.0] {
        let p: f64 = radius * radius;
        let [value, turn, second, slope] = Rings::default().own(radius);
        let e = 0.01 * p;
        let (low, mid, high) = (exact(0.0, p - e), exact(0.0, p), exact(0.0, p + e));
        let (by, twice) = ((high - low) / (2.0 * e), (high - 2.0 * mid + low) / (e * e));
        let along = (exact(1e-3, p) - mid) / 1e-3;
        assert!(
            (slope - along).abs() < 0.02 * along.abs(),
            "{radius}: {slope} {along}"
        );
        assert!((value - mid).abs() < 1e-4 * mid, "{radius}: {value} {mid}");
        assert!((turn - by).abs() < 1e-3 * by.abs(), "{radius}: {turn} {by}");
        assert!(
            (second - twice).abs() < 0.02 * twice.abs(),
            "{radius}: {second} {twice}"
        );
    }
}

/// A drop falls on a pool in a cylinder, all of it rings, with tension.
fn splash(more: &str) -> Scene {
    splash_of(&format!(
        "[effects.tension]\ncoefficient = '72.8 mN/m'\n{more}"
    ))
}

/// The same without tension unless `more` has it.
fn splash_of(more: &str) -> Scene {
    let text = format!(
        "[box]\nsize = ['12 mm', '12 mm', '10 mm']\nx = 'wall'\ny = 'wall'\nsymmetry = 'axis'\n\
         [liquid]\ndensity = '998 kg/m^3'\n[effects.gravity]\nacceleration = '9.81 m/s^2'\n\
         [effects.viscosity]\ndynamic = '1 mPa s'\n\
         [body.pool]\nlayer = {{ depth = '3 mm' }}\n\
         [body.drop]\nsphere = {{ diameter = '2.4 mm', gap = '0.3 mm', above = 'pool' }}\n\
         velocity = '2 m/s'\n\
         [pack]\nspacing = '0.2 mm'\narrangement = 'lattice'\n\
         [impact]\nend = '6 ms'\n[frames]\ninterval = '1 ms'\n{more}"
    );
    let loaded = file::read(&text, Path::new("splash.toml"), &[]);
    loaded
        .unwrap_or_else(|error| panic!("{error}\n{text}"))
        .scene
}

fn start(scene: &Scene, state: State) -> Box<dyn Solver> {
    method::build(scene, state, Phase::Impact, Some(1.0 / 0.955)).unwrap()
}

#[test]
fn rings_have_the_mass_of_their_bodies_of_revolution() {
    let scene = splash("");
    let state = disturbed(&scene, 0.0);
    let p = &state.particles;
    let of = |body: u8| {
        let weights = p.weight.iter().zip(&p.body).filter(|(_, b)| **b == body);
        p.mass * weights.map(|(weight, _)| weight).sum::<f64>()
    };
    let exact = [
        998.0 * PI * 0.006f64.powi(2) * 0.003,
        998.0 * PI / 6.0 * 0.0024f64.powi(3),
    ];
    for (body, exact) in exact.into_iter().enumerate() {
        let error = of(body as u8) / exact - 1.0;
        assert!(error.abs() < 1e-12, "body {body}: {error:e}");
    }
}

/// Hardly any energy is unexplained at the end.
fn keeps_energy(series: &Series) {
    let whole = series.column("kinetic_energy_J").unwrap()[0];
    let unexplained = *series
        .column("energy_unexplained_J")
        .unwrap()
        .last()
        .unwrap();
    println!("unexplained {unexplained:e} of {whole:e} J");
    assert!(unexplained.abs() < 0.03 * whole);
}

#[test]
fn a_splash_of_rings_keeps_its_energy_and_its_mass() {
    let scene = splash("");
    let mut simulation = Simulation::resume(&scene, disturbed(&scene, 0.0)).unwrap();
    let count = simulation.state().particles.len();
    let series = simulation.run(|_, _| ()).unwrap();
    keeps_energy(series);
    let mass = series.column("mass_kg").unwrap();
    let lost = series.column("mass_removed_kg").unwrap();
    let gone = mass[0] - mass.last().unwrap() - lost.last().unwrap();
    assert!(gone.abs() < 1e-12 * mass[0], "{gone:e}");
    // Rings that became small have merged.
    assert!(simulation.state().particles.len() < count);
}

#[test]
fn rings_without_tension_keep_their_energy() {
    let scene = splash_of("");
    let mut simulation = Simulation::resume(&scene, disturbed(&scene, 0.0)).unwrap();
    let series = simulation.run(|_, _| ()).unwrap();
    keeps_energy(series);
}

#[test]
fn rings_whose_limits_are_wide_neither_merge_nor_split() {
    let mut scene = splash("");
    scene.domain.revolved = Some(coronet::scene::Rings {
        merge: 0.0,
        split: 1e9,
    });
    let mut simulation = Simulation::resume(&scene, disturbed(&scene, 0.0)).unwrap();
    let count = simulation.state().particles.len();
    let series = simulation.run(|_, _| ()).unwrap();
    assert_eq!(
        *series.column("mass_removed_kg").unwrap().last().unwrap(),
        0.0
    );
    assert_eq!(simulation.state().particles.len(), count);
}

#[test]
fn limits_of_rings_belong_to_an_axis() {
    let text = "[box]\nsize = ['8 mm', '8 mm', '8 mm']\nrings = { merge = 0.5, split = 2 }\n\
                [liquid]\ndensity = '998 kg/m^3'\n[pack]\nspacing = '0.2 mm'\n\
                [impact]\nend = '6 ms'\n[frames]\ninterval = '1 ms'\n\
                [body.pool]\nlayer = { depth = '2 mm' }\n";
    let error = file::read(text, Path::new("axis.toml"), &[]).err().unwrap();
    assert!(error.to_string().contains("box.rings"), "{error}");
}

#[test]
fn an_interruption_and_threads_change_no_bit_of_rings() {
    let scene = splash("");
    let run = |threads: usize, pause: bool| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().unwrap().install(|| {
            let mut solver = start(&scene, disturbed(&scene, 0.3));
            for k in 0..40 {
                solver.advance(&mut |_| ()).unwrap();
                if pause && k == 17 {
                    solver = start(&scene, solver.state());
                }
            }
            words(&solver.state())
        })
    };
    let plain = run(1, false);
    assert_eq!(plain, run(2, false));
    assert_eq!(plain, run(2, true));
}

#[test]
fn what_is_not_of_revolution_is_refused_with_the_reason() {
    let base = "[liquid]\ndensity = '998 kg/m^3'\n[pack]\nspacing = '0.2 mm'\n\
                [impact]\nend = '6 ms'\n[frames]\ninterval = '1 ms'\n";
    let cases = [
        (
            "[box]\nsize = ['8 mm', '8 mm', '8 mm']\nsymmetry = 'axis'\n\
             [body.drop]\nsphere = { diameter = '2 mm', centre = ['4 mm', '4 mm', '4 mm'] }\n",
            "periodic",
        ),
        (
            "[box]\nsize = ['8 mm', '9 mm', '8 mm']\nx = 'open'\ny = 'open'\nsymmetry = 'axis'\n\
             [body.drop]\nsphere = { diameter = '2 mm', centre = ['4 mm', '4.5 mm', '4 mm'] }\n",
            "differs in x and y",
        ),
        (
            "[box]\nsize = ['8 mm', '8 mm', '8 mm']\nx = 'open'\ny = 'open'\nsymmetry = 'axis'\n\
             [body.drop]\nsphere = { diameter = '2 mm', centre = ['3 mm', '4 mm', '4 mm'] }\n",
            "is not in the middle",
        ),
        (
            "[box]\nsize = ['8 mm', '8 mm', '8 mm']\nx = 'open'\ny = 'open'\nsymmetry = 'axis'\n\
             [method]\nname = 'mps'\nmps.gradient = 'corrected'\n\
             [body.drop]\nsphere = { diameter = '2 mm', centre = ['4 mm', '4 mm', '4 mm'] }\n",
            "needs the gradient `transposed`",
        ),
        (
            "dimension = 2\n[box]\nsize = ['8 mm', '8 mm']\nx = ['axis', 'open']\n\
             [body.drop]\ndisc = { diameter = '2 mm', centre = ['4 mm', '4 mm'] }\n",
            "axis",
        ),
    ];
    for (text, reason) in cases {
        let text = format!("{text}{base}");
        let error = match file::read(&text, Path::new("axis.toml"), &[]) {
            Ok(_) => panic!("accepted: {text}"),
            Err(error) => error.to_string(),
        };
        assert!(error.contains(reason), "{error}");
    }
}

/// No area is far above root 2 cells while a disc collapses to its axis and rises there, whatever
/// the length of a step.
#[test]
fn areas_of_rings_stay_near_their_limits() {
    for method in ["wcsph", "isph", "mps"] {
        let text = format!(
            "[box]\nsize = ['8 mm', '8 mm', '8 mm']\nx = 'open'\ny = 'open'\nz = 'open'\n\
             symmetry = 'axis'\n[liquid]\ndensity = '998 kg/m^3'\n\
             [effects.viscosity]\ndynamic = '1 mPa s'\n\
             [effects.tension]\ncoefficient = '72.8 mN/m'\n[body.drop]\n\
             ellipsoid = {{ semi_axes = ['3 mm', '3 mm', '0.5 mm'], centre = ['4 mm', '4 mm', \
             '4 mm'] }}\n[pack]\nspacing = '0.125 mm'\narrangement = 'lattice'\n\
             [impact]\nend = '8 ms'\n[frames]\ninterval = '0.1 ms'\n\
             [method]\nname = '{method}'\n"
        );
        let scene = coronet::simulate::scene(&text).unwrap();
        let mut run = Simulation::new(&scene).unwrap();
        let mut largest = 0.0_f64;
        run.run(|frame, _| {
            for i in 0..frame.id.len() {
                let radius = (frame.position[0][i] as f64).max(0.5 * 0.125e-3);
                let area = frame.mass[i] as f64 / (998.0 * 2.0 * PI * radius * 0.125e-3f64.powi(2));
                largest = largest.max(area);
            }
        })
        .unwrap();
        println!("{method}: {largest:.2} cells");
        assert!(largest < 1.8, "{method}: {largest}");
    }
}

/// Columns that are a pitch apart go where those of a lattice are at rest.
#[test]
fn columns_of_a_stretched_lattice_settle() {
    let [mut plain, mut stretched] = [0.5e-3, 0.55e-3];
    let mass = ring::settle(&mut plain, 1e-3, 1e-3);
    let wide = ring::settle(&mut stretched, 1.1e-3, 1e-3);
    assert!((stretched / plain - 1.1).abs() < 1e-12);
    assert!((wide / mass - 1.1).abs() < 1e-12);
}
