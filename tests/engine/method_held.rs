//! Walls that attract liquid: lone particles on them gain no energy, and a box of any size has
//! walls of the density of the liquid.

use coronet::particle::wall::{self, Lattice};
use coronet::scene::{Dimension, Scene};
use coronet::simulate::{Simulation, scene};

const LIQUID: &str = "[liquid]
density = '998 kg/m^3'
[effects.gravity]
acceleration = '9.81 m/s^2'
[effects.viscosity]
dynamic = '1 mPa s'
[effects.tension]
coefficient = '72.8 mN/m'
[effects.wetting]
angle = '60 deg'
[method]
name = 'wcsph'
";

/// Particles that the edge of a film leaves behind sink into the wall. Where they were put back on
/// its surface, they sank again: at the end of this run 28 % of its energy came from that.
#[test]
fn lone_particles_gain_no_energy_from_a_wall() {
    let text = format!(
        "dimension = 3
[box]
size = ['12 mm', '12 mm', '5 mm']
x = 'open'
y = 'open'
symmetry = 'axis'
{LIQUID}[body.drop]
sphere = {{ diameter = '2 mm', centre = ['6 mm', '6 mm', '1.2 mm'] }}
velocity = '0.6 m/s'
[pack]
spacing = '0.125 mm'
tolerance = '1 kg/m^3'
[impact]
end = '16 ms'
[frames]
interval = '0.5 ms'
"
    );
    let mut simulation = Simulation::new(&scene(&text).unwrap()).unwrap();
    let series = simulation.run(|_, _| {}).unwrap();
    let column = |name: &str| series.column(name).unwrap();
    let whole = column("kinetic_energy_J")[0] + column("surface_energy_J")[0];
    let most = column("energy_unexplained_J")
        .iter()
        .fold(0.0, |a: f64, b| a.max(*b));
    println!("from nowhere: {:.3}", most / whole);
    assert!(most < 0.07 * whole, "{}", most / whole);
}

fn pool(dimension: Dimension, width: &str) -> Scene {
    let (count, lateral, sides) = match dimension {
        Dimension::Two => (2, format!("'{width}'"), "x = 'wall'"),
        Dimension::Three => (3, format!("'{width}', '{width}'"), "x = 'wall'\ny = 'wall'"),
    };
    let text = format!(
        "dimension = {count}
[box]
size = [{lateral}, '6 mm']
{sides}
{LIQUID}[body.pool]
layer = {{ depth = '3 mm' }}
[pack]
spacing = '0.4 mm'
[impact]
end = '1 ms'
[frames]
interval = '1 ms'
"
    );
    scene(&text).unwrap()
}

/// Away from corners, whatever the box.
#[test]
fn a_wall_has_the_density_of_the_liquid() {
    for dimension in [Dimension::Two, Dimension::Three] {
        for width in ["6.4 mm", "6.2 mm", "6.01 mm", "6.59 mm"] {
            let scene = pool(dimension, width);
            let (size, spacing) = (scene.domain.size, scene.spacing);
            let lattice = Lattice::new(&scene.domain, dimension, spacing);
            assert_eq!(lattice.is_stretched(), width != "6.4 mm");
            let axes = if dimension == Dimension::Two { 2 } else { 3 };
            let wall = wall::build(&scene);
            let [x, y, z] = &wall.position;
            let is_under = |i: usize| {
                let beside = |a: usize, at: f64| axes < 3 && a == 1 || (0.0..size[a]).contains(&at);
                beside(0, x[i]) && beside(1, y[i]) && z[i] < 0.0
            };
            let under: Vec<usize> = (0..x.len()).filter(|&i| is_under(i)).collect();
            let deepest = under.iter().map(|&i| z[i]).fold(0.0, f64::min);
            let depth = 0.5 * lattice.layer[2] - deepest;
            let area = if axes == 2 {
                size[0]
            } else {
                size[0] * size[1]
            };
            let each = area * depth / under.len() as f64;
            let part = each / spacing.powi(axes);
            assert!((part - 1.0).abs() < 1e-9, "{dimension:?}, {width}: {part}");
            // A cell is found by its middle.
            for i in under {
                for a in (0..3).filter(|&a| lattice.pitch[a] > 0.0) {
                    let at = wall.position[a][i];
                    let found = lattice.middle(a, lattice.index(a, at));
                    assert!((found - at).abs() < 1e-12, "{found} for {at}");
                }
            }
        }
    }
}
