//! Frames are taken at the instants that a scene asks for, whatever the steps are.

use super::method_scene::{EFFECTS, GRAVITY, disturbed, solver, splash_scene};
use coronet::method::frame::{Beat, Schedule};
use coronet::method::{self, Phase, Solver};
use coronet::scene::{Method, TensionIn, TimeStepping};
use proptest::prelude::*;

/// No multiple of any step, s.
const INTERVAL: f64 = 0.37e-3;

/// Times of frames to 4 ms, s, and the steps between them.
fn frames(solver: &mut dyn Solver) -> Vec<(f64, u64)> {
    let mut schedule = Schedule::new(INTERVAL);
    schedule.skip(0.0);
    let mut taken = Vec::new();
    while solver.time() < 4e-3 {
        let mut look = |solver: &dyn Solver| {
            if schedule.takes(solver.time()) {
                taken.push((solver.frame().time, solver.step_count()));
            }
        };
        solver.advance(&mut look).unwrap();
    }
    taken
}

#[test]
fn frames_are_of_the_asked_instants() {
    let once = TimeStepping::Adaptive {
        safety: 0.5,
        tension: TensionIn::Each,
    };
    for (preset, stepping) in [
        ("modern", None),
        ("modern", Some(once)),
        ("paper", None),
        ("isph modern", None),
        ("mps modern", None),
    ] {
        let mut scene = splash_scene(preset, 2, &format!("{GRAVITY}{EFFECTS}"));
        if let (Method::Wcsph(settings), Some(stepping)) = (&mut scene.method, stepping) {
            settings.time_stepping = stepping;
        }
        let fixed = match &scene.method {
            Method::Wcsph(settings) => match settings.time_stepping {
                TimeStepping::Fixed { step } => Some(step),
                _ => None,
            },
            _ => None,
        };
        let build = |state| method::build(&scene, state, Phase::Impact, Some(1.0)).unwrap();
        let mut solver = build(disturbed(&scene, 0.1));
        solver.meet(INTERVAL);
        let taken = frames(solver.as_mut());
        assert!(taken.len() >= 10, "{preset}: {taken:?}");
        for (k, (time, _)) in (1..).zip(&taken) {
            let late = time - k as f64 * INTERVAL;
            match fixed {
                None => assert_eq!(late, 0.0, "{preset}: frame {k} at {time}"),
                Some(step) => assert!((0.0..step).contains(&late), "{preset}: {k} at {time}"),
            }
        }
        // At most two steps more for every frame than without them.
        let mut free = build(disturbed(&scene, 0.1));
        frames(free.as_mut());
        let (met, more) = (solver.step_count(), taken.len() as f64);
        let most = 1.2 * free.step_count() as f64 + 2.0 * more;
        assert!((met as f64) < most, "{preset}: {met} steps, {most}");
    }
}

proptest! {
    /// Steps are never longer than allowed, and end at each instant, exactly and once.
    #[test]
    fn steps_end_at_every_instant(interval in 1e-6f64..1.0, part in 0.01f64..3.0) {
        let beat = Beat { interval };
        let (mut time, mut due) = (0.0, 1u64);
        let mut steps = 0;
        while due <= 50 {
            let longest = part * interval * (1.0 + 0.5 * (steps as f64).sin());
            let dt = beat.fit(time, longest);
            prop_assert!(dt > 0.0 && dt <= longest);
            time = beat.exact(time + dt);
            let at = due as f64 * interval;
            prop_assert!(time <= at);
            due += (time == at) as u64;
            steps += 1;
        }
        let least = 50.0 / (1.5 * part);
        prop_assert!((steps as f64) < 4.0 * least + 110.0, "{steps} of {least}");
    }

    /// Without instants a step stays what it is.
    #[test]
    fn no_instant_no_change(time in 0.0f64..1.0, dt in 1e-9f64..1.0) {
        prop_assert_eq!(Beat::default().fit(time, dt), dt);
        prop_assert_eq!(Beat::default().exact(time), time);
    }
}

/// Before the first step too, with a tension and without.
#[test]
fn the_first_frame_knows_the_surface() {
    for method in ["wcsph modern", "isph modern", "mps modern"] {
        for effects in [GRAVITY, &format!("{GRAVITY}{EFFECTS}")] {
            let scene = splash_scene(method, 2, effects);
            let first = solver(&scene, 0.0).frame();
            let [x, _, z] = &first.position;
            let pool =
                (0..x.len()).filter(|&i| first.body[i] == 0 && (x[i] - 2.4e-3).abs() > 1.4e-3);
            let (top, rest): (Vec<_>, Vec<_>) = pool.partition(|&i| z[i] > 1.2e-3);
            let inside: Vec<_> = rest.into_iter().filter(|&i| z[i] < 0.8e-3).collect();
            assert!(top.len() > 3 && inside.len() > 3);
            let marked = |of: &[usize]| of.iter().filter(|&&i| first.surface[i] == 1).count();
            assert_eq!(marked(&top), top.len(), "{method}, {effects}");
            assert_eq!(marked(&inside), 0, "{method}, {effects}");
        }
    }
}
