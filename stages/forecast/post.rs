//! Forecast of the evaluation: measures and pictures.

use coronet::draw::player::SHOTS;
use coronet::draw::section;
use coronet::pipeline::Work;
use coronet::scene::{Dimension, FigureStyle, Scene};

use super::memory::BASE;
use super::{frames, measure, whole, work};

/// CPU seconds of an instant that the report plays, and per particle; per ring.
const SHOT: [f64; 2] = [0.05, 2e-6];
const SHOT_OF_RINGS: f64 = 10e-6;
/// CPU seconds of a section over its pixels, up to the highest body; of a view and of the title
/// picture over the square of a section's width; of the surface in each of them per particle;
/// factor where no pool fills them, and of rings; of a field.
const SECTION: f64 = 0.09e-6;
const VIEW: f64 = 3.9e-6;
const TITLE: f64 = 6.5e-6;
const SURFACE: f64 = 4e-6;
const DRY: f64 = 0.45;
const ROUND: f64 = 0.42;
const FIELD: f64 = 0.12;
/// CPU seconds of the plots at the default size and resolution, over their pixels; bytes of the
/// plots, of a panel, which the report has too, and of an instant that the report plays in three
/// dimensions.
const PLOTS: f64 = 0.12 / (1654.0 * 1063.0);
const PLOTS_BYTES: f64 = 6e5;
const PANEL_BYTES: f64 = 8e5;
const SHOT_BYTES: f64 = 5e4;
/// Bytes of memory of a particle of the whole that is drawn.
const PICTURE: f64 = 1100.0;

/// CPU seconds of the liquid of the report's player.
fn shots(scene: &Scene) -> f64 {
    let count = frames(scene).min(SHOTS);
    match (scene.domain.is_axial(), scene.dimension) {
        (true, _) => count * SHOT_OF_RINGS * whole(scene),
        (false, Dimension::Three) => count * (SHOT[0] + SHOT[1] * whole(scene)),
        (false, Dimension::Two) => 0.0,
    }
}

/// CPU seconds of the plots.
fn plots(scene: &Scene) -> f64 {
    let FigureStyle {
        width, height, dpi, ..
    } = scene.post.figures;
    PLOTS * width * height * (dpi / INCH).powi(2)
}

/// m.
const INCH: f64 = 0.0254;

/// CPU seconds of the section of a panel.
fn section(scene: &Scene) -> f64 {
    let width = section::width(&scene.whole()) as f64;
    let tops = scene.bodies.iter();
    let tops = tops.map(|body| body.shape.bounds(&scene.domain, scene.dimension).1[2]);
    let height = tops.fold(0.0, f64::max) / scene.whole().domain.size[0];
    SECTION * width * width * height
}

/// CPU seconds of the views of panels and the title picture.
fn views(scene: &Scene, panels: f64) -> f64 {
    if scene.solid().dimension == Dimension::Two || panels == 0.0 {
        return 0.0;
    }
    let width = section::width(&scene.whole()) as f64;
    let surface = SURFACE * whole(scene);
    let (covered, surface) = match scene.domain.is_axial() {
        true => (ROUND, 0.0),
        false if scene.pool_depth().unwrap_or(0.0) > 0.0 => (1.0, surface),
        false => (DRY, surface),
    };
    covered * width * width * (VIEW * panels + TITLE) + surface * (panels + 1.0)
}

/// Cost of measuring, drawing and plotting the frames, which show the whole of a symmetric scene.
pub fn post(scene: &Scene) -> Option<Work> {
    let before_end = |times: &[f64]| {
        let shown = times.iter().filter(|time| **time <= scene.impact.end);
        shown.count() as f64
    };
    let panels = before_end(&scene.post.panels);
    let pictures = panels * section(scene) + views(scene, panels);
    let fields = before_end(&scene.post.fields) * FIELD;
    let played = match scene.solid().dimension {
        Dimension::Two => 0.0,
        Dimension::Three => frames(scene).min(SHOTS) * SHOT_BYTES,
    };
    // One thread measures while another reads.
    let work = work(
        scene,
        frames(scene) * measure(scene) + shots(scene) + pictures + fields + plots(scene),
        0.0,
        [0.0, PLOTS_BYTES + panels * PANEL_BYTES + played],
    )?;
    let memory = BASE + whole(scene) * PICTURE;
    Some(Work {
        threads: 1,
        memory,
        ..work
    })
}
