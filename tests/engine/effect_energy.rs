//! The tension that derives from an energy: its work, its momentum, and what its energy is.

use super::cloud::{CHANNEL, Cloud, OPEN, Random, length};
use super::method_scene::{disturbed, words};
use super::pack_scene::{S0, scene};
use coronet::effect::Account;
use coronet::effect::tension::Tension;
use coronet::effect::tension::energy::density;
use coronet::effect::tension::shore::Shore;
use coronet::kernel::{plane, slope, value};
use coronet::method::{self, Phase, Solver, surface_of};
use coronet::particle::State;
use coronet::scene::{Dimension, KernelName, Shape, Side, TensionForm, file};
use std::path::Path;

const SIGMA: f64 = 0.067;
const DENSITY: f64 = 1100.0;
/// H in spacings.
const LENGTH: f64 = 2.625;
const KERNEL: KernelName = KernelName::WendlandC2;

/// Place in spacings, velocity, change of density.
type Point = ([f64; 3], [f64; 4]);

/// Disordered liquid where `keep` says, with a random velocity each.
fn points(dimension: Dimension, cells: [f64; 3], keep: impl Fn([f64; 3]) -> bool) -> Vec<Point> {
    let mut random = Random(3);
    let count = cells.map(|n| n.round().max(1.0) as usize);
    let mut points = Vec::new();
    for i in 0..count.iter().product::<usize>() {
        let place = [
            i / count[2] / count[1],
            i / count[2] % count[1],
            i % count[2],
        ];
        let mut at = place.map(|c| c as f64 + 0.5 + 0.2 * random.signed());
        let mut velocity = [0; 3].map(|_| random.signed());
        if dimension == Dimension::Two {
            (at[1], velocity[1]) = (0.0, 0.0);
        }
        if keep(at) {
            points.push((at, [velocity[0], velocity[1], velocity[2], 0.0]));
        }
    }
    points
}

struct Scene {
    dimension: Dimension,
    cells: [f64; 3],
    sides: [[Side; 2]; 3],
    points: Vec<Point>,
    /// Of the contact angle.
    cosine: Option<f64>,
}

impl Scene {
    fn drop(dimension: Dimension, radius: f64) -> Self {
        let size = 2.0 * radius + 4.0;
        let width = match dimension {
            Dimension::Two => 0.0,
            Dimension::Three => size,
        };
        let cells = [size, width, size];
        let inside = |x: [f64; 3]| length([0, 1, 2].map(|a| x[a] - 0.5 * cells[a])) < radius;
        Scene {
            dimension,
            cells,
            sides: OPEN,
            points: points(dimension, cells, inside),
            cosine: None,
        }
    }

    /// A pool between walls below and above.
    fn pool() -> Self {
        let cells = [16.0, 0.0, 24.0];
        Scene {
            dimension: Dimension::Two,
            cells,
            sides: CHANNEL,
            points: points(Dimension::Two, cells, |x| x[2] < 12.0),
            cosine: None,
        }
    }

    /// Rings that are a drop about the axis, above a floor.
    fn rings() -> Self {
        let cells = [16.0, 0.0, 20.0];
        let inside = |x: [f64; 3]| x[0].hypot(x[2] - 7.0) < 8.0;
        Scene {
            dimension: Dimension::Two,
            cells,
            sides: [
                [Side::Axis, Side::Open],
                [Side::Open; 2],
                [Side::Wall, Side::Open],
            ],
            points: points(Dimension::Two, cells, inside),
            cosine: None,
        }
    }

    /// Liquid in the corner of two walls of 60 degrees.
    fn corner() -> Self {
        let cells = [24.0, 0.0, 24.0];
        Scene {
            dimension: Dimension::Two,
            cells,
            sides: [
                [Side::Wall, Side::Open],
                [Side::Open; 2],
                [Side::Wall, Side::Open],
            ],
            points: points(Dimension::Two, cells, |x| x[0] + x[2] < 14.0),
            cosine: Some(0.5),
        }
    }

    /// Energy and its rate, and per particle place, velocity and force, of where they are `ahead`
    /// later.
    fn look(&self, ahead: f64) -> (Account, Vec<[[f64; 3]; 3]>) {
        self.look_at(true, ahead)
    }

    /// The same, with all particles or none at the surface.
    fn look_at(&self, is_surface: bool, ahead: f64) -> (Account, Vec<[[f64; 3]; 3]>) {
        let moved = |(at, v): &Point| ([0, 1, 2].map(|a| at[a] + ahead * v[a]), *v);
        let points: Vec<Point> = self.points.iter().map(moved).collect();
        let cloud = Cloud::of(self.dimension, self.cells, self.sides, LENGTH, &points);
        let mut tension = Tension::new(
            TensionForm::SurfaceEnergy,
            KERNEL,
            [LENGTH * S0, S0],
            SIGMA,
            1.0,
            match self.sides[0][0] {
                Side::Axis => 3,
                _ => self.dimension.count(),
            },
            DENSITY,
        );
        if let Some(cosine) = self.cosine {
            let mut domain = scene(self.dimension, self.cells, Shape::Layer { depth: S0 })
                .problem
                .domain;
            domain.boundary = self.sides;
            domain.boundary[1] = [Side::Periodic; 2];
            tension.energy.carried = 1.0;
            tension.energy.shore = Some(Shore::new(cosine, domain, self.dimension, S0));
        }
        let (flow, sources) = (&cloud.flow, cloud.flow.sources());
        tension.update(&surface_of(flow, &sources), |_| is_surface);
        let mut a = vec![[0.0; 3]; flow.liquid()];
        tension.add(&mut a);
        let (p, mass) = (&flow.particles, flow.particles.mass);
        let of = |i: usize| {
            let velocity = [0, 1, 2].map(|k| p.velocity[k][i]);
            let force = a[i].map(|a| mass * p.weight(i) * a as f64);
            [flow.position(i), velocity, force]
        };
        (tension.account(p), (0..a.len()).map(of).collect())
    }
}

fn scenes() -> [(&'static str, Scene); 5] {
    [
        ("disc", Scene::drop(Dimension::Two, 9.0)),
        ("sphere", Scene::drop(Dimension::Three, 7.0)),
        ("pool", Scene::pool()),
        ("corner of 60 degrees", Scene::corner()),
        ("rings", Scene::rings()),
    ]
}

#[test]
fn the_work_of_the_force_is_what_the_energy_falls_by() {
    for (name, scene) in scenes() {
        let (now, particles) = scene.look(0.0);
        let power: f64 = particles
            .iter()
            .flat_map(|[_, v, f]| (0..3).map(move |a| v[a] * f[a]))
            .sum();
        // Velocities are of spacings.
        let step = 1e-3;
        let energy = |ahead: f64| scene.look(ahead).0.energy;
        let rate = (energy(step) - energy(-step)) / (2.0 * step * S0);
        assert!(
            (now.rate + power).abs() < 1e-6 * power.abs(),
            "{name}: {now:?}"
        );
        let error = (power + rate) / rate;
        println!(
            "{name}: power {power:.6e}, minus the rate {:.6e}, {error:.1e}",
            -rate
        );
        assert!(error.abs() < 2e-3, "{name}: {error:.1e}");
    }
}

#[test]
fn in_two_dimensions_voids_and_particles_at_one_place_count() {
    let cells = [24.0, 0.0, 24.0];
    let beside = |x: [f64; 3]| length([x[0] - 12.0, 0.0, x[2] - 12.0]) > 1.6;
    let mut scene = Scene {
        dimension: Dimension::Two,
        cells,
        sides: CHANNEL,
        points: points(Dimension::Two, cells, beside),
        cosine: None,
    };
    let energy = |scene: &Scene, is_surface| scene.look_at(is_surface, 0.0).0.energy;
    let (marked, unmarked) = (energy(&scene, true), energy(&scene, false));
    println!("a void: {:.2} sigma s0", unmarked / (SIGMA * S0));
    assert!(unmarked > SIGMA * S0);
    assert_eq!(marked, unmarked);
    // A second particle as near to another as numbers can tell, and at its place.
    let (place, velocity) = scene.points[0];
    let mut of_pair = [1e-4, 0.0].map(|apart| {
        scene
            .points
            .push(([place[0] + apart, 0.0, place[2]], velocity));
        let energy = energy(&scene, true);
        scene.points.pop();
        energy
    });
    of_pair.sort_by(f64::total_cmp);
    let [low, high] = of_pair;
    assert!(high - low < 1e-4 * SIGMA * S0, "{of_pair:?}");
}

#[test]
fn a_drop_pulls_neither_itself_away_nor_round() {
    for (name, scene) in &scenes()[..2] {
        let (_, particles) = scene.look(0.0);
        let (mut push, mut turn, mut all) = ([0.0; 3], [0.0; 3], 0.0);
        for [x, _, f] in &particles {
            for a in 0..3 {
                let (b, c) = ((a + 1) % 3, (a + 2) % 3);
                push[a] += f[a];
                turn[a] += x[b] * f[c] - x[c] * f[b];
            }
            all += length(*f);
        }
        let lever = scene.cells[0] * S0;
        assert!(length(push) < 1e-5 * all, "{name}: {push:?} of {all:.1e}");
        assert!(length(turn) < 1e-5 * all * lever, "{name}: {turn:?}");
    }
}

#[test]
fn the_energy_of_a_flat_surface_is_sigma_times_its_area() {
    // Kernel sums under the surface of a continuous liquid, in units of H: phi' = W1, n = W1.
    const CELLS: usize = 2000;
    let step = 2.0 / CELLS as f64;
    for dimension in [2, 3] {
        let w1 = |k: usize| plane(KERNEL, dimension, (k as f64 + 0.5) * step);
        let (mut phi, mut energy) = (0.5, 0.0);
        for k in 0..CELLS {
            let n = w1(k);
            energy += density(dimension, phi + 0.5 * n * step, [0.0, 0.0, n]).energy * step;
            phi += n * step;
        }
        assert!((phi - 1.0).abs() < 1e-4, "{phi}");
        assert!((energy - 1.0).abs() < 2e-3, "{dimension}-D: {energy}");
        // Disorder costs nothing; a lone particle more than one at a surface.
        assert_eq!(density(dimension, 0.99, [0.02, 0.0, 0.03]).energy, 0.0);
        let [mut last, mut phi] = [0.0, 0.97];
        while phi > 0.1 {
            let e = density(dimension, phi, [0.0; 3]);
            assert!(e.energy > last && e.slope < 0.0, "phi = {phi}");
            (last, phi) = (e.energy, phi - 0.01);
        }
    }
}

/// Sheets of square layers, their energy over that of two surfaces: what is thinner than 2 H must
/// not be cheap, or liquid would become sheets and pipes.
#[test]
fn thin_sheets_cost_their_two_surfaces() {
    let reach = (2.0 * LENGTH).ceil() as i64;
    for dimension in [2, 3] {
        let depth = if dimension == 3 { reach } else { 0 };
        let ratio = |layers: i64| -> f64 {
            let of = |own: i64| {
                let (mut phi, mut n) = (0.0, 0.0);
                for layer in 0..layers {
                    for x in -reach..=reach {
                        for y in -depth..=depth {
                            let z = (own - layer) as f64;
                            let r = ((x * x + y * y) as f64 + z * z).sqrt();
                            phi += value(KERNEL, dimension, r, LENGTH);
                            n += slope(KERNEL, dimension, r, LENGTH) * z;
                        }
                    }
                }
                density(dimension, phi, [0.0, 0.0, LENGTH * n]).energy
            };
            (0..layers).map(of).sum::<f64>() / LENGTH / 2.0
        };
        let found = [1, 2, 3, 4, 6].map(ratio);
        println!("{dimension}-D: {found:.3?}");
        assert!(found.iter().all(|f| (0.8..1.1).contains(f)), "{found:?}");
    }
}

/// A pool of plain water, 0.1 mm apart, without a wall beside it.
fn water(form: &str) -> coronet::scene::Scene {
    let text = format!(
        "dimension = 2\n[box]\nsize = ['2 mm', '4 mm']\nx = 'periodic'\nz = ['wall', 'open']\n\
         [liquid]\ndensity = '998 kg/m^3'\n[effects.gravity]\nacceleration = '9.81 m/s^2'\n\
         [effects.viscosity]\ndynamic = '1 mPa s'\n\
         [effects.tension]\ncoefficient = '72.8 mN/m'\nform = '{form}'\n\
         [body.pool]\nlayer = {{ depth = '1.5 mm' }}\n\
         [pack]\nspacing = '0.1 mm'\narrangement = 'lattice'\n\
         [impact]\nend = '1 s'\n[frames]\ninterval = '1 s'\n\
         [method]\nname = 'wcsph'\n"
    );
    let loaded = file::read(&text, Path::new("water.toml"), &[]);
    loaded
        .unwrap_or_else(|error| panic!("{error}\n{text}"))
        .scene
}

fn start(scene: &coronet::scene::Scene, state: State) -> Box<dyn Solver> {
    method::build(scene, state, Phase::Impact, Some(1.0)).unwrap()
}

#[test]
fn a_pool_of_water_comes_to_rest_and_nobody_leaves_it() {
    let calm = |form: &str| {
        let scene = water(form);
        let mut solver = start(&scene, disturbed(&scene, 0.0));
        let count = solver.len();
        let mut energies = Vec::new();
        for time in [0.01, 0.02, 0.03, 0.04] {
            while solver.time() < time {
                solver.advance(&mut |_| ()).unwrap();
            }
            let (energy, _) = solver.unrest();
            energies.push(energy / (solver.state().particles.mass * count as f64));
        }
        println!("{form}: {energies:?} J/kg, {} of {count}", solver.len());
        (energies, solver.len() == count)
    };
    let (energies, complete) = calm("surface-energy");
    assert!(complete);
    assert!(energies.is_sorted_by(|a, b| a > b), "{energies:?}");
    assert!(energies[3] < 0.1 * energies[0] && energies[3] < 1e-5);
    // The test can fail: a stress that derives from no energy goes on stirring.
    let (restless, _) = calm("raw-colour");
    assert!(restless[3] > 4.0 * energies[3], "{restless:?}");
}

#[test]
fn an_interruption_changes_no_bit() {
    let scene = water("surface-energy");
    let mut whole = start(&scene, disturbed(&scene, 0.1));
    (0..6).for_each(|_| whole.advance(&mut |_| ()).unwrap());
    let mut resumed = start(&scene, whole.state());
    for solver in [&mut whole, &mut resumed] {
        (0..6).for_each(|_| solver.advance(&mut |_| ()).unwrap());
    }
    assert_eq!(words(&whole.state()), words(&resumed.state()));
}

#[test]
fn what_would_feed_it_is_refused_with_the_key() {
    let ways = [
        (
            "[method]\nname = 'mps'\n[method.mps]\ngradient = 'blended'\n",
            "transposed",
        ),
        (
            "[method]\nname = 'isph'\n[method.isph]\ngradient = 'corrected'\n",
            "transposed",
        ),
        (
            "[method]\nname = 'wcsph'\n[method.wcsph]\n\
             time_stepping = { adaptive = { safety = 1 } }\n",
            "dual stepping",
        ),
    ];
    for (method, problem) in ways {
        let text = format!(
            "dimension = 2\n[box]\nsize = ['8 mm', '8 mm']\nx = 'open'\nz = 'open'\n\
             [liquid]\ndensity = '998 kg/m^3'\n\
             [effects.tension]\ncoefficient = '72.8 mN/m'\nform = 'surface-energy'\n\
             [body.drop]\ndisc = {{ diameter = '2 mm', centre = ['4 mm', '4 mm'] }}\n\
             [pack]\nspacing = '0.2 mm'\n[impact]\nend = '1 s'\n\
             [frames]\ninterval = '1 s'\n{method}"
        );
        let error = file::read(&text, Path::new("a.toml"), &[]).err().unwrap();
        let error = error.to_string();
        assert!(error.contains("effects.tension.form"), "{error}");
        assert!(error.contains(problem), "{error}");
    }
}
