//! The name of what `--set` changes.

use coronet::pipeline::name::is_plain_name;
use coronet::scene::variant;

fn name(sets: &[&str]) -> String {
    let sets: Vec<String> = sets.iter().map(|set| set.to_string()).collect();
    variant::name(&sets)
}

#[test]
fn a_quantity_is_readable_and_safe_in_a_path() {
    for (set, wanted) in [
        ("body.drop.velocity=2.42 m/s", "body.drop.velocity=2.42_m_s"),
        ("pack.spacing=0.25 mm", "pack.spacing=0.25_mm"),
        ("liquid.density=1100", "liquid.density=1100_kg_m_3"),
        ("box.symmetry=quarter", "box.symmetry=quarter"),
        ("pack.seed=2", "pack.seed=2"),
    ] {
        assert_eq!(name(&[set]), wanted);
    }
}

#[test]
fn equal_settings_have_one_name() {
    let wanted = name(&["body.drop.velocity=2.42 m/s", "pack.seed=3"]);
    for sets in [
        &["body.drop.velocity=242cm/s", "pack.seed=3"][..],
        &["body.drop.velocity='2.420 m/s'", "pack.seed=3"],
        &[" body.drop . velocity = 2.42", "pack.seed=3"],
        &["pack.seed=3", "body.drop.velocity=2.42 m/s"],
        &["pack.seed=1", "body.drop.velocity=2.42 m/s", "pack.seed=3"],
    ] {
        assert_eq!(name(sets), wanted, "{sets:?}");
    }
    let table = |text: &str| name(&[&format!("body.drop.disc={text}")]);
    assert_eq!(
        table("{ diameter = '2 mm', gap = '0.5 mm', above = 'pool' }"),
        table("{ above = 'pool', gap = 0.0005, diameter = 0.002 }")
    );
    let conditions = name(&["impact.stop_when=['crater-deepest', 'rest']"]);
    assert!(
        conditions.starts_with("impact.stop_when=crater-deepest_rest-"),
        "{conditions}"
    );
    let panels = |text: &str| name(&[&format!("post.panels={text}")]);
    assert_eq!(panels("['1 ms', '2 ms']"), panels("[0.001, 0.002]"));
    assert_eq!(name(&[]), "");
}

#[test]
fn different_settings_have_different_names() {
    let sets: &[&[&str]] = &[
        &["title=A drop"],
        &["title=A/drop"],
        &["title=A_drop"],
        &["title='A drop, again'"],
        &["title=../A drop"],
        &["post.panels=[]"],
        &["post.panels=['1 ms']"],
        &["post.panels=['1 ms', '2 ms']"],
        &["pack={ spacing = '1 mm' }", "pack.seed=1"],
        &["pack={ spacing = '1 mm', seed = 1 }"],
        &["pack.spacing=1 mm", "pack.seed=1"],
        &["effects.viscosity={ dynamic = \"1 mPa s\" }"],
        &["effects.viscosity.dynamic=1 mPa s"],
        &["box.wall_velocity={ x_low = [0, 0, 1] }"],
    ];
    let mut names: Vec<String> = sets.iter().map(|sets| name(sets)).collect();
    let long = |end: &str| format!("title={}{end}", "a long title ".repeat(40));
    names.push(name(&[&long("x")]));
    names.push(name(&[&long("y")]));
    for name in &names {
        assert!(is_plain_name(&format!("tiny,{name}")), "{name}");
        assert!(!name.contains([' ', '/', '[', '"', '\'']), "{name}");
        assert!(name.len() < 130, "{name}");
    }
    let count = names.len();
    names.sort();
    names.dedup();
    assert_eq!(names.len(), count, "{names:?}");
}
