//! Several ranks pack the body of one process, bit for bit.

use crate::method_ranks::on_ranks;
use coronet::particle::pack::{PackError, pack, pack_shared};
use coronet::scene::{Scene, file};
use std::ops::ControlFlow::{self, Break, Continue};
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// A pool that is 24 spacings wide, and a drop.
fn scene(dimension: usize, sides: &str) -> Scene {
    let lateral = match dimension {
        3 => "'9.6 mm', '7.2 mm'",
        _ => "'19.2 mm'",
    };
    let text = format!(
        "dimension = {dimension}\n[box]\nsize = [{lateral}, '12 mm']\n{sides}\n[liquid]\n\
         density = '1100 kg/m^3'\n[body.pool]\nlayer = {{ depth = '2 mm' }}\n[body.drop]\n\
         {} = {{ diameter = '4.4 mm', gap = '1 mm', above = 'pool' }}\n[pack]\n\
         spacing = '0.4 mm'\narrangement = 'poisson'\n[impact]\nend = '1 s'\n[frames]\n\
         interval = '1 s'\n[method]\nname = 'wcsph'\n",
        if dimension == 3 { "sphere" } else { "disc" }
    );
    let loaded = file::read(&text, Path::new("ranks.toml"), &[]);
    let loaded = loaded.unwrap_or_else(|error| panic!("{error}\n{text}"));
    loaded.scene
}

fn go(_: &coronet::particle::pack::PackProgress) -> ControlFlow<()> {
    Continue(())
}

fn check(scene: &Scene) {
    for body in 0..scene.bodies.len() {
        let input = scene.pack_input(body);
        let (whole, report) = pack(&input, &mut go).unwrap();
        for ranks in [[1, 1], [2, 1], [3, 2], [7, 1]] {
            let mut all = on_ranks(ranks, |with| pack_shared(with, &input, &mut go).unwrap());
            let (first, found) = all.remove(0);
            let about = format!("{}, {ranks:?} ranks and threads", input.name);
            assert!(first == whole, "{about}");
            assert_eq!(found.to_string(), report.to_string(), "{about}");
            assert_eq!(found.nearest, report.nearest, "{about}");
            let others: usize = all.iter().map(|(_, report)| report.own).sum();
            assert_eq!(others + found.own, report.count, "{about}");
            // A drop has few slabs.
            let least = if ranks[0] > 1 { report.count / 10 } else { 0 };
            assert!(others >= least, "{about}: {others} of {}", report.count);
            assert!(all.iter().all(|(particles, _)| particles.is_empty()));
        }
    }
}

#[test]
fn two_dimensions() {
    for sides in ["x = 'periodic'", "x = 'wall'", "x = 'open'"] {
        check(&scene(2, sides));
    }
}

#[test]
fn three_dimensions() {
    for sides in ["y = 'wall'", "x = 'wall'"] {
        check(&scene(3, sides));
    }
}

#[test]
fn mirror_planes() {
    check(&scene(2, "symmetry = 'half'"));
    check(&scene(3, "symmetry = 'quarter'"));
}

#[test]
fn the_first_rank_stops_all() {
    let scene = scene(2, "x = 'periodic'");
    let input = scene.pack_input(0);
    let all = on_ranks([3, 1], |with| {
        let steps = AtomicUsize::new(0);
        let packed = pack_shared(
            with,
            &input,
            &mut |_| match steps.fetch_add(1, Relaxed) < 5 {
                true => Continue(()),
                false => Break(()),
            },
        );
        (
            matches!(packed, Err(PackError::Stopped { .. })),
            steps.into_inner(),
        )
    });
    assert_eq!(all, [(true, 6), (true, 0), (true, 0)]);
}
