//! What a scene becomes: the kernel and the viscosity it names, with their coefficients.

use super::method_scene::{EFFECTS, drop_scene};
use coronet::effect::select::{Visitor, pair, tension};
use coronet::effect::viscosity::PairViscosity;
use coronet::kernel::Kernel;
use coronet::scene::{Effects, KernelName, Sph, SurfaceTension, Viscosity, ViscosityForm};
use coronet::space::lane::{Lanes, Portable, Real};

const H: f64 = 0.5e-3;
const MU: f64 = 3.5e-3;

/// What a chosen viscosity gives for one pair: d = (0.6, 0, 0.8), v = (1, 0, 0), slope = 2,
/// 1/rho_a^2 + 1/rho_b^2 = 3.
struct Probe;

impl Visitor for Probe {
    /// w(0.5) x norm in 3-D, whether there is any viscosity, its force.
    type Out = (f64, bool, [f32; 3]);
    fn visit<K: Kernel, V: PairViscosity>(self, viscosity: V) -> Self::Out {
        let [slope, q2, weight] = [2.0, 1.0, 3.0].map(|x| Portable::new().splat(x));
        let mut sum = q2.splat3([0.0; 3]);
        let (d, v) = (q2.splat3([0.6, 0.0, 0.8]), q2.splat3([1.0, 0.0, 0.0]));
        viscosity.add(slope, q2, d, v, weight, &mut sum);
        let force = sum.map(|sum| sum.to_array()[0]);
        (K::norm(3) * K::w(0.5), V::PRESENT, force)
    }
}

fn settings() -> Sph {
    drop_scene("modern", 3, EFFECTS).method.sph()
}

fn effects(form: Option<ViscosityForm>) -> Effects {
    Effects {
        viscosity: form.map(|form| Viscosity { dynamic: MU, form }),
        ..Effects::default()
    }
}

fn close(got: [f32; 3], wanted: [f64; 3]) {
    for (got, wanted) in got.into_iter().zip(wanted) {
        assert!(
            (got as f64 - wanted).abs() < 1e-5 * MU / H * 6.0,
            "{got}, not {wanted}"
        );
    }
}

#[test]
fn each_word_becomes_its_viscosity() {
    let whole = 6.0 * MU / H;
    for d in [2, 3] {
        let n = d as f64;
        let m2 = if d == 2 { 5.0 / 9.0 } else { 4.0 / 5.0 };
        for (form, x, z) in [
            (ViscosityForm::Morris, 1.0, 0.0),
            // zeta d (v . d), over q^2 + 0.01.
            (
                ViscosityForm::Cleary,
                0.36 / 1.01 * (n + 2.0),
                0.48 / 1.01 * (n + 2.0),
            ),
            // d / m2 d (v . d); m2 of Wendland C2.
            (ViscosityForm::Central, 0.36 * n / m2, 0.48 * n / m2),
            // v + d (v . d), over q^2 + 0.01.
            (ViscosityForm::TwoTerm, 1.36 / 1.01, 0.48 / 1.01),
            // Times (d+2)/(d+3).
            (
                ViscosityForm::TwoTermExact,
                1.36 / 1.01 * (n + 2.0) / (n + 3.0),
                0.48 / 1.01 * (n + 2.0) / (n + 3.0),
            ),
        ] {
            let (_, present, force) = pair(&effects(Some(form)), &settings(), d, H, Probe);
            assert!(present);
            close(force, [whole * x, 0.0, whole * z]);
        }
    }
}

#[test]
fn without_viscosity_there_is_none() {
    let (_, present, force) = pair(&effects(None), &settings(), 3, H, Probe);
    assert!(!present);
    assert_eq!(force, [0.0; 3]);
}

#[test]
fn each_word_becomes_its_kernel() {
    use std::f64::consts::PI;
    // 1 - 1.5 q^2 + 0.75 q^3 over pi; (1 - q/2)^4 (1 + 2 q) x 21 / (16 pi).
    let cubic = (1.0 - 0.375 + 0.09375) / PI;
    let wendland = 0.75f64.powi(4) * 2.0 * 21.0 / (16.0 * PI);
    for (kernel, wanted) in [
        (KernelName::CubicSpline, cubic),
        (KernelName::WendlandC2, wendland),
    ] {
        for viscosity in [None, Some(ViscosityForm::Morris)] {
            let mut settings = settings();
            settings.kernel = kernel;
            let (found, ..) = pair(&effects(viscosity), &settings, 3, H, Probe);
            assert!((found - wanted).abs() < 1e-12, "{kernel:?}: {found}");
        }
    }
}

#[test]
fn tension_is_built_only_where_the_scene_has_it() {
    let settings = settings();
    assert!(tension(&effects(None), &settings, 3, H, 1100.0, 2.0).is_none());
    let asked = SurfaceTension {
        smoothing: 1.7,
        ..super::pack_scene::tension(0.067)
    };
    let with = Effects {
        tension: Some(asked),
        ..Effects::default()
    };
    let built = tension(&with, &settings, 3, H, 1100.0, 2.0).unwrap();
    assert_eq!((built.coefficient, built.strength), (0.067, 2.0));
    assert_eq!(built.length, 1.7 * H);
    assert_eq!(built.support(), 2.0 * built.length);
    assert_eq!((built.form, built.kernel), (asked.form, settings.kernel));
}
