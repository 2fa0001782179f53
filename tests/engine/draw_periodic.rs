//! The surface of liquid, and the raster of measures, in boxes with all kinds of sides.

use std::path::Path;

use coronet::draw::surface::Field;
use coronet::measure::raster::Raster;
use coronet::particle::Frame;
use coronet::scene::{Scene, file};
use proptest::prelude::*;
use proptest::sample::select;

use super::draw_surface::frame;

/// A box of 8 mm with a jet of 2 mm through it along an axis.
fn scene(axes: &str, along: char, sides: &[&str]) -> Scene {
    let ends = |of: &dyn Fn(bool) -> &'static str| {
        let ends: Vec<&str> = axes.chars().map(|axis| of(axis == along)).collect();
        format!("['{}']", ends.join("', '"))
    };
    let named = axes.chars().zip(sides);
    let sides: String = named
        .map(|(axis, side)| format!("{axis} = '{side}'\n"))
        .collect();
    let text = format!(
        "dimension = {}\n[box]\nsize = {}\n{sides}[liquid]\ndensity = '1000 kg/m^3'\n[body.jet]\n\
         {} = {{ low = {}, high = {} }}\n[pack]\nspacing = '0.4 mm'\narrangement = 'lattice'\n\
         [impact]\nend = '1 s'\n[frames]\ninterval = '1 s'\n\
         [method]\nname = 'wcsph'\npreset = 'modern'\n",
        axes.len(),
        ends(&|_| "8 mm"),
        if axes.len() == 2 {
            "rectangle"
        } else {
            "block"
        },
        ends(&|is_along| if is_along { "0 mm" } else { "3 mm" }),
        ends(&|is_along| if is_along { "8 mm" } else { "5 mm" }),
    );
    file::read(&text, Path::new("jet.toml"), &[]).unwrap().scene
}

/// Images behind the last nodes are of particles far from them, too.
#[test]
fn a_jet_through_a_periodic_box_has_the_same_section_at_both_ends() {
    for (place, along) in "xyz".chars().enumerate() {
        let mut sides = ["open"; 3];
        sides[place] = "periodic";
        let scene = scene("xyz", along, &sides);
        let jet = frame(&scene, |at| {
            let is_in = |a: usize| a == place || (at[a] > 3e-3 && at[a] < 5e-3);
            (0..3).all(is_in).then_some(0)
        });
        let field = Field::new(&scene, &jet, &[]).unwrap();
        let middle = field.count.map(|count| count / 2);
        let end = |n: usize| {
            let mut node = middle;
            node[place] = n;
            field.values[field.index(node)]
        };
        let ends = [end(0), end(field.count[place] - 1)];
        let difference = (ends[0] - ends[1]).abs();
        assert!(ends[0] > 0.5 && difference < 1e-3, "{along}: {ends:?}");
    }
}

/// A coordinate over the size of the box, mostly near it.
fn coordinate() -> impl Strategy<Value = f32> {
    prop_oneof![
        20 => -0.2f32..1.2,
        1 => -3.0f32..4.0,
        1 => select(vec![f32::NAN, f32::INFINITY, 1e30, -1e30, 0.0, 1.0]),
    ]
}

/// It is one node across.
#[test]
fn liquid_at_the_end_of_a_flat_periodic_box_has_a_coarse_field() {
    let scene = scene("xz", 'x', &["periodic", "periodic"]);
    let frame = Frame {
        id: vec![0, 1],
        body: vec![0, 0],
        pressure: vec![1.0; 2],
        position: [vec![0.0, 7.86e-3], vec![0.0; 2], vec![0.0; 2]],
        velocity: [vec![0.0; 2], vec![0.0; 2], vec![0.0; 2]],
        ..Frame::default()
    };
    let field = Field::coarse(&scene, &frame, 0.5e-3).unwrap();
    assert!(field.values.iter().all(|value| value.is_finite()));
    assert!(field.values.iter().any(|value| *value > 0.0));
    // Nothing is left to see where all particles are far away along one axis.
    let gone = Frame {
        position: [vec![0.0; 2], vec![0.0; 2], vec![1e30; 2]],
        ..frame
    };
    assert!(Field::coarse(&scene, &gone, 0.5e-3).is_none());
    assert!(Field::new(&scene, &gone, &[]).is_none());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn any_particles_in_any_box_have_a_surface_or_none(
        sides in prop::array::uniform3(select(vec!["periodic", "open", "wall"])),
        is_flat in any::<bool>(),
        depth in select(vec![0.1, 0.2, 0.5, 1.0]),
        at in prop::collection::vec(prop::array::uniform3(coordinate()), 1..40),
    ) {
        let axes = if is_flat { "xz" } else { "xyz" };
        let scene = scene(axes, 'x', &sides);
        let mut frame = Frame::default();
        for (id, at) in at.iter().enumerate() {
            frame.id.push(id as u32);
            frame.body.push(0);
            frame.pressure.push(1.0);
            for a in 0..3 {
                let is_there = a != 1 || !is_flat;
                frame.position[a].push(if is_there { 8e-3 * at[a] } else { 0.0 });
                frame.velocity[a].push(0.0);
            }
        }
        let colours = vec![[1.0; 3]; at.len()];
        for colours in [&[][..], &colours] {
            if let Some(field) = Field::new(&scene, &frame, colours) {
                prop_assert!(field.values.iter().all(|value| value.is_finite()));
                if is_flat {
                    field.contour(0.5);
                }
            }
        }
        let coarse = Field::coarse(&scene, &frame, 0.5e-3);
        if let Some(field) = coarse.filter(|_| !is_flat) {
            field.mesh(0.0);
        }
        let mut deep = scene.clone();
        deep.domain.size[1] *= depth;
        Raster::new(&deep, &frame);
    }
}
