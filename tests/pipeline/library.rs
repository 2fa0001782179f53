//! Calls without files give what the program gives.

use coronet::measure::series::Series;
use coronet::simulate::{Simulation, scene};

use crate::program::{Program, TINY};

/// The columns of the program's table are rounded; what `post` blanks afterwards is left out.
#[test]
fn a_simulation_from_rust_is_that_of_the_program() {
    let program = Program::new();
    program.run(&[]);
    let table = program.latest("post").join("measures.csv");
    let table = Series::read(&table).unwrap();

    let mut simulation = Simulation::new(&scene(TINY).unwrap()).unwrap();
    let mut frames = 0;
    let measures = simulation.run(|_, _| frames += 1).unwrap();
    assert_eq!(frames, table.len());
    assert_eq!(measures.names, table.names);
    for (name, column) in table.names.iter().zip(&table.columns) {
        let own = measures.column(name).unwrap();
        for (a, b) in own.iter().zip(column).filter(|(_, b)| !b.is_nan()) {
            assert!((a - b).abs() <= 1e-9 * b.abs(), "{name}: {a} and {b}");
        }
    }
}

#[test]
fn a_simulation_goes_on_from_its_state() {
    let scene = scene(TINY).unwrap();
    let mut whole = Simulation::new(&scene).unwrap();
    (0..3).for_each(|_| whole.advance().unwrap());
    let mut resumed = Simulation::resume(&scene, whole.state()).unwrap();
    (0..3).for_each(|_| whole.advance().unwrap());
    (0..3).for_each(|_| resumed.advance().unwrap());
    assert_eq!(whole.state(), resumed.state());
}

#[test]
fn a_mistake_in_a_scene_is_an_error_with_its_line() {
    let error = scene(&TINY.replace("1000 kg/m^3", "1000 kg")).unwrap_err();
    let text = error.to_string();
    assert!(
        text.contains("scene.toml:") && text.contains("liquid.density"),
        "{text}"
    );
}
