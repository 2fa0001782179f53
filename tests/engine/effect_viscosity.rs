//! Viscosity at a free surface: no shear stress, no torque, and the rates at which viscous drops
//! become round.

use coronet::particle::Frame;
use coronet::simulate::{Simulation, scene};

/// A body of `shape` alone in an open box, with a `motion`, in the dimensions and with the symmetry
/// of `head`.
fn alone(method: &str, viscosity: &str, head: &str, shape: &str) -> Simulation {
    let text = format!(
        "{head}
[liquid]
density = '1000 kg/m^3'
[effects.viscosity]
dynamic = '{viscosity}'
[effects.tension]
coefficient = '70 mN/m'
[body.drop]
{shape}
[pack]
spacing = '0.2 mm'
[impact]
end = '20 ms'
[frames]
interval = '1 ms'
[method]
name = '{method}'
"
    );
    Simulation::new(&scene(&text).unwrap()).unwrap()
}

const PLANE: &str = "dimension = 2
[box]
size = ['8 mm', '8 mm']
x = 'open'
z = 'open'";

const RINGS: &str = "dimension = 3
[box]
size = ['8 mm', '8 mm', '8 mm']
x = 'open'
y = 'open'
z = 'open'
symmetry = 'axis'";

/// SUM m (z v_x - x v_z) about the centre, kg m^2/s over the nominal mass.
fn turning(frame: &Frame) -> f64 {
    let mean = |values: &[f32]| values.iter().map(|v| *v as f64).sum::<f64>() / values.len() as f64;
    let [x, _, z] = &frame.position;
    let [u, _, w] = &frame.velocity;
    let centre = [mean(x), mean(z)];
    let of = |i: usize| {
        let [x, z] = [x[i] as f64 - centre[0], z[i] as f64 - centre[1]];
        z * u[i] as f64 - x * w[i] as f64
    };
    (0..x.len()).map(of).sum()
}

/// A lattice vortex in the middle of its cell turns the disc about like a solid body. A Laplacian
/// of velocities stops it within 15 ms.
#[test]
fn a_disc_goes_on_turning() {
    for method in ["wcsph", "isph", "mps"] {
        let shape = "disc = { diameter = '3 mm', centre = ['4 mm', '4 mm'] }
taylor_green = { speed = '0.15 m/s' }";
        let closed = PLANE.replace("open", "periodic");
        let mut run = alone(method, "50 mPa s", &closed, shape);
        let (mut first, mut last) = (None, 0.0);
        run.run(|frame, _| {
            last = turning(frame);
            first.get_or_insert(last);
        })
        .unwrap();
        let kept = last / first.unwrap();
        println!("{method}: {kept:.4} of the angular momentum");
        assert!((kept - 1.0).abs() < 0.02, "{method}: {kept}");
    }
}

/// How far a body is from round: along z against across, by its second moments.
fn flattening(frame: &Frame) -> f64 {
    let [x, _, z] = &frame.position;
    let is_ring = !frame.mass.is_empty();
    let mass = |i: usize| frame.mass.get(i).map_or(1.0, |m| *m as f64);
    let whole: f64 = (0..x.len()).map(mass).sum();
    let mean =
        |of: &dyn Fn(usize) -> f64| (0..x.len()).map(|i| mass(i) * of(i)).sum::<f64>() / whole;
    let middle = [x, z].map(|v| mean(&|i| v[i] as f64));
    let across = match is_ring {
        true => 0.5 * mean(&|i| (x[i] as f64).powi(2)),
        false => mean(&|i| (x[i] as f64 - middle[0]).powi(2)),
    };
    let along = mean(&|i| (z[i] as f64 - middle[1]).powi(2));
    (along - across) / (along + across)
}

/// Stokes flow: n sigma / (2 mu R) of a disc (n = 2), 20/19 sigma / (mu R) of a sphere; inertia
/// adds 1 %. With mu dv/dn = 0 at the surface it would be 1.7 and 1.9 times that.
#[test]
fn viscous_drops_become_round_as_in_stokes_flow() {
    let disc = "ellipse = { semi_axes = ['1.82 mm', '2.2 mm'], centre = ['4 mm', '4 mm'] }";
    let sphere = "ellipsoid = { semi_axes = ['1.87 mm', '1.87 mm', '2.29 mm'], \
                  centre = ['4 mm', '4 mm', '4 mm'] }";
    let rate = 70e-3 / (2.0 * 2e-3);
    for (head, shape, theory) in [(PLANE, disc, rate), (RINGS, sphere, rate * 20.0 / 19.0)] {
        let mut run = alone("wcsph", "2 Pa s", head, shape);
        let mut seen = Vec::new();
        run.run(|frame, _| seen.push((frame.time, flattening(frame).ln())))
            .unwrap();
        let ((from, high), (to, low)) = (seen[5], seen[20]);
        let found = (high - low) / (to - from);
        println!("{found:.2} 1/s, in theory {theory:.2}");
        assert!((found / theory - 1.0).abs() < 0.1, "{found} {theory}");
    }
}

/// Vortices of a liquid so viscous that its limit rules the step die out with every form, with the
/// single-rate scheme and with MPS whose Laplacian is narrower than its gradient: modes of one
/// spacing must not grow.
#[test]
fn a_step_at_the_viscous_limit_is_stable() {
    let wcsph = "[method.wcsph]
time_stepping = { adaptive = { safety = 1 } }";
    let mps = "[method.mps]
radius = 3.1
laplacian_radius = 2.1";
    let cases = [
        ("wcsph", wcsph, "morris"),
        ("wcsph", wcsph, "two-term"),
        ("wcsph", wcsph, "two-term-exact"),
        ("wcsph", wcsph, "cleary"),
        ("wcsph", wcsph, "central"),
        ("mps", mps, "morris"),
        ("mps", mps, "central"),
    ];
    for (method, settings, form) in cases {
        let text = format!(
            "dimension = 2
[box]
size = ['10 mm', '10 mm']
x = 'periodic'
z = 'periodic'
[liquid]
density = '1000 kg/m^3'
[effects.viscosity]
dynamic = '2 Pa s'
form = '{form}'
[body.liquid]
rectangle = {{ low = [0, 0], high = ['10 mm', '10 mm'] }}
taylor_green = {{ speed = '0.1 m/s' }}
[pack]
spacing = '0.5 mm'
arrangement = 'lattice'
[impact]
end = '10 ms'
[frames]
interval = '5 ms'
[method]
name = '{method}'
{settings}
"
        );
        let mut run = Simulation::new(&scene(&text).unwrap()).unwrap();
        let (mut first, mut last) = (None, 0.0);
        run.run(|frame, _| {
            let squares = |v: &Vec<f32>| v.iter().map(|v| (*v as f64).powi(2)).sum::<f64>();
            last = frame.velocity.iter().map(squares).sum();
            first.get_or_insert(last);
        })
        .unwrap();
        let left = last / first.unwrap();
        println!("{method} {form}: {left:.1e} of the kinetic energy is left");
        assert!(left < 1e-4, "{method} {form}: {left}");
    }
}
