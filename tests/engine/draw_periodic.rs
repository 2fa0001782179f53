//! The surface of liquid that goes through a periodic box.

use std::path::Path;

use coronet::draw::surface::Field;
use coronet::scene::file;

use super::draw_surface::frame;

/// Images behind the last nodes are of particles far from them, too.
#[test]
fn a_jet_through_a_periodic_box_has_the_same_section_at_both_ends() {
    for axis in ["x", "y", "z"] {
        let place = "xyz".find(axis).unwrap();
        let mut high = ["5 mm"; 3];
        high[place] = "8 mm";
        let low = high.map(|high| if high == "8 mm" { "0 mm" } else { "3 mm" });
        let text = format!(
            "dimension = 3\n[box]\nsize = ['8 mm', '8 mm', '8 mm']\n{axis} = 'periodic'\n\
             [liquid]\ndensity = '1000 kg/m^3'\n[body.jet]\n\
             block = {{ low = {low:?}, high = {high:?} }}\n\
             [pack]\nspacing = '0.4 mm'\narrangement = 'lattice'\n[impact]\nend = '1 s'\n\
             [frames]\ninterval = '1 s'\n[method]\nname = 'wcsph'\npreset = 'modern'\n"
        );
        let sets: Vec<String> = ["x", "y", "z"]
            .iter()
            .filter(|other| **other != axis)
            .map(|other| format!("box.{other}=open"))
            .collect();
        let scene = file::read(&text, Path::new("jet.toml"), &sets)
            .unwrap()
            .scene;
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
        assert!(
            ends[0] > 0.5 && (ends[0] - ends[1]).abs() < 1e-3,
            "{axis}: {ends:?}"
        );
    }
}
