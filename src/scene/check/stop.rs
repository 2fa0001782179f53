//! Whether a scene can meet the conditions of `impact.stop_when`.

use super::super::error::{Mistakes, SceneError};
use super::super::tree::Tree;
use super::super::{Motion, Scene, Shape, Side, StopWhen};

/// Each condition needs what its measure is taken of.
pub fn check(scene: &Scene, tree: &Tree<'_>) -> Result<(), SceneError> {
    let whole = scene.whole();
    let mut found = Mistakes::default();
    for (index, condition) in scene.impact.stop_when.iter().enumerate() {
        let lacking = match condition {
            StopWhen::CraterDeepest | StopWhen::LevelCrossed => no_crater(&whole),
            StopWhen::Rebound => no_rebound(&whole),
            StopWhen::Rest => None,
        };
        if let Some((lack, remedy)) = lacking {
            let key = format!("impact.stop_when[{index}]");
            let remedy = format!("remove this word, or {remedy}");
            found.add(tree.fault(&key, lack, &remedy));
        }
    }
    found.told()
}

/// A sphere or an ellipsoid, or on a wall with a contact angle a block.
fn is_drop(scene: &Scene, shape: &Shape) -> bool {
    match shape {
        Shape::Block { .. } => scene.effects.wetting.is_some(),
        _ => shape.is_free(),
    }
}

/// Why there is no crater, and what to do.
fn no_crater(scene: &Scene) -> Option<(&'static str, &'static str)> {
    let has = |is: &dyn Fn(&Shape) -> bool| scene.bodies.iter().any(|body| is(&body.shape));
    if !has(&|shape| matches!(shape, Shape::Layer { .. })) {
        let remedy = "add a pool, as in `[body.pool]` with `layer = { depth = \"10 mm\" }`";
        return Some((
            "is about a crater, and no body of the scene is a pool",
            remedy,
        ));
    }
    let lack = "is about a crater, and no body of the scene is a drop";
    let remedy = "add a drop, a body with a `sphere` (a `disc` in 2-D)";
    (!has(&|shape| is_drop(scene, shape))).then_some((lack, remedy))
}

/// Why there is no rebound, and what to do.
fn no_rebound(scene: &Scene) -> Option<(&'static str, &'static str)> {
    let [body] = scene.bodies.as_slice() else {
        let remedy = "make a scene of one drop";
        return Some((
            "is about a drop alone on a wall, and the scene has several bodies",
            remedy,
        ));
    };
    if !is_drop(scene, &body.shape) {
        let remedy = "give the body a `sphere` (a `disc` in 2-D)";
        return Some(("is about a drop, and the body is none", remedy));
    }
    if scene.domain.boundary[2][0] != Side::Wall {
        let remedy = "let `box.z` begin with \"wall\"";
        return Some((
            "is about a drop on a wall, and the floor of the box is none",
            remedy,
        ));
    }
    let falls = match body.motion {
        Motion::Uniform(velocity) => velocity[2] < 0.0,
        _ => false,
    };
    let pulled = scene.effects.gravity.is_some_and(|g| g[2] < 0.0);
    let lack = "is about a drop on a wall, and nothing moves the drop there";
    let remedy = "give the drop a `velocity`";
    (!falls && !pulled && scene.effects.wetting.is_none()).then_some((lack, remedy))
}
