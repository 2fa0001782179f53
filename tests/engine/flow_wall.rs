//! What is shot into a wall comes back out of it.

use super::method_scene::{disturbed, splash_scene};
use coronet::method::{Phase, build};
use coronet::simulate::{Simulation, scene};

/// A lid slides over a full box: nothing is much faster than the lid, and no method has more than
/// half as much energy again as another. In the corner before it the liquid is pressed into walls.
#[test]
fn a_sliding_lid_drives_no_faster_than_itself() {
    let energies = ["wcsph", "isph", "mps"].map(|method| {
        let text = format!(
            "dimension = 2\n[box]\nsize = ['4 mm', '4 mm']\nx = 'wall'\nz = 'wall'\n\
             wall_velocity = {{ z_high = ['0.1 m/s', 0] }}\n\
             [liquid]\ndensity = '1000 kg/m^3'\n[effects.viscosity]\ndynamic = '1 mPa s'\n\
             [body.water]\nrectangle = {{ low = [0, 0], high = ['4 mm', '4 mm'] }}\n\
             [pack]\nspacing = '0.2 mm'\narrangement = 'lattice'\n\
             [impact]\nend = '60 ms'\n[frames]\ninterval = '1 ms'\n[method]\nname = '{method}'\n"
        );
        let (mut fastest, mut energy) = (0.0f64, 0.0);
        let mut run = Simulation::new(&scene(&text).unwrap()).unwrap();
        run.run(|_, measures| {
            let find = |name: &str| measures.iter().find(|(n, _)| n == name).unwrap().1;
            fastest = fastest.max(find("speed_max_m_s"));
            energy = find("kinetic_energy_J");
        })
        .unwrap();
        assert!(fastest < 0.12, "{method}: {fastest} m/s");
        energy
    });
    let most = energies.iter().copied().fold(0.0, f64::max);
    assert!(energies.iter().all(|e| 1.5 * e > most), "{energies:?}");
}

const VISCOSITY: &str = "[effects.viscosity]\ndynamic = '20 mPa s'\n";

#[test]
fn no_particle_stays_behind_the_first_layer_of_a_wall() {
    for method in ["wcsph modern", "wcsph corrected", "isph modern"] {
        let scene = splash_scene(method, 2, VISCOSITY);
        let (spacing, width) = (scene.spacing, scene.domain.size[0]);
        let mut state = disturbed(&scene, 0.0);
        // The first two of the pool: one below the floor, one beyond the right wall.
        let p = &mut state.particles;
        (p.position[2][0], p.velocity[2][0]) = (-1.2 * spacing, -2.0);
        (p.position[0][1], p.velocity[0][1]) = (width + 0.8 * spacing, 2.0);
        let mut solver = build(&scene, state, Phase::Impact, None).unwrap();
        solver.advance(&mut |_| ()).unwrap();
        let p = solver.state().particles;
        assert_eq!(p.len(), solver.len(), "{method}");
        let deepest = |i: usize| (-p.position[2][i]).max(p.position[0][i] - width);
        let deepest = (0..p.len()).map(deepest).fold(0.0, f64::max);
        assert!(deepest < 0.5 * spacing, "{method}: {deepest}");
    }
}

/// What is pushed into a corner does not end in one point, where it would have no pressure.
#[test]
fn particles_come_out_of_a_corner_apart() {
    let scene = splash_scene("isph modern", 2, VISCOSITY);
    let (spacing, width) = (scene.spacing, scene.domain.size[0]);
    let mut state = disturbed(&scene, 0.0);
    let ids = [0, 1].map(|i: usize| {
        let p = &mut state.particles;
        p.position[0][i] = width + (0.8 + 0.1 * i as f64) * spacing;
        p.position[2][i] = -(0.6 + 0.1 * i as f64) * spacing;
        p.id[i]
    });
    let mut solver = build(&scene, state, Phase::Impact, None).unwrap();
    solver.advance(&mut |_| ()).unwrap();
    let p = solver.state().particles;
    let [one, other] = ids.map(|id| p.id.iter().position(|found| *found == id).unwrap());
    let apart = [0, 2].map(|a| p.position[a][one] - p.position[a][other]);
    assert!(apart[0].hypot(apart[1]) > 0.05 * spacing, "{apart:?}");
    for i in [one, other] {
        let beyond = [p.position[0][i] - width, -p.position[2][i]];
        assert!(beyond.iter().any(|x| *x < 0.0), "{beyond:?}");
    }
}
