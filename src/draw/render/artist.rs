//! Pictures and meshes of the frames of a run, all seen in the same way.

use std::borrow::Cow;

use super::camera::{Camera, View};
use super::flat::Sheet;
use super::overlay::Overlay;
use super::trace::V;
use super::{Look, Material, draw, linear};
use crate::draw::canvas::{Canvas, Colour};
use crate::draw::scale::{Plain, Scale};
use crate::draw::section::body_colour;
use crate::draw::surface::Field;
use crate::measure::kind::contact_time;
use crate::measure::whole::Unfold;
use crate::particle::Frame;
use crate::record::mesh::Mesh;
use crate::scene::{Dimension, Scene, Side};

/// Style of pictures.
#[derive(Clone, Debug)]
pub struct Style {
    /// Of the liquid.
    pub material: Material,
    /// Width and height, pixels.
    pub size: [usize; 2],
    /// Direction of the view.
    pub view: View,
    /// Point in the middle of the picture, m; without it, that of the liquid.
    pub target: Option<[f64; 3]>,
    /// Behind the liquid.
    pub background: Colour,
    /// Whether light and shadow fall on the floor.
    pub has_shadows: bool,
    /// Whether there is a bar of a round length.
    pub has_scale: bool,
    /// Whether the instant is shown, from the contact of the drop.
    pub has_clock: bool,
    /// Text below.
    pub caption: Option<String>,
    /// Rays a pixel along each side.
    pub samples: usize,
}

impl Default for Style {
    fn default() -> Style {
        Style {
            material: Material::Water,
            size: [1280, 720],
            view: View::default(),
            target: None,
            background: [226, 230, 236],
            has_shadows: true,
            has_scale: false,
            has_clock: false,
            caption: None,
            samples: 2,
        }
    }
}

/// What frames show together: the space that the liquid takes, and its largest values.
#[derive(Clone, Debug, Default)]
pub struct Survey {
    /// Low and high corner, without the last thousandth of the particles on each side, m.
    corners: Option<[V; 2]>,
    /// Exceeded by a hundredth of the particles, m/s.
    speed: f64,
    /// A hundredth of the particles are below, a hundredth above, Pa.
    pressure: [f64; 2],
}

/// Height above a pool that a picture has room for, over the width of its box.
const CROWN: f64 = 0.3;

/// The value that a part of all exceed; 0 of none.
fn exceeded(mut values: Vec<f32>, part: f64) -> f32 {
    values.retain(|v| v.is_finite());
    if values.is_empty() {
        return 0.0;
    }
    let place = ((1.0 - part) * (values.len() - 1) as f64).round() as usize;
    *values.select_nth_unstable_by(place, f32::total_cmp).1
}

impl Survey {
    /// Of frames that are not known: the box, up to where its bodies or a crown may reach.
    pub fn of_box(part: &Scene) -> Survey {
        let scene = part.solid();
        let size = scene.domain.size;
        let bodies = part.bodies.iter();
        let tops = bodies.map(|body| body.shape.bounds(&part.domain, part.dimension).1[2]);
        let bodies = tops.fold(0.0, f64::max);
        let crown = part
            .pool_depth()
            .map(|depth| depth + CROWN * size[0].max(size[1]));
        let top = bodies.max(crown.unwrap_or(0.0)).min(size[2]);
        let corner = V::from([size[0], size[1], top].map(|c| c as f32));
        Survey {
            corners: Some([V::zeros(), corner]),
            ..Survey::default()
        }
    }

    /// Takes a frame, of the simulated part of the scene.
    pub fn add(&mut self, part: &Scene, frame: &Frame) {
        let is_axial = part.domain.is_axial();
        let frame = match is_axial {
            true => Cow::Borrowed(frame),
            false => Unfold::new(part).whole(frame),
        };
        if frame.id.is_empty() {
            return;
        }
        let end = |part: f64| V::from([0, 1, 2].map(|a| exceeded(frame.position[a].clone(), part)));
        let half = V::repeat(0.5 * part.spacing as f32);
        let [mut low, mut high] = [end(0.999) - half, end(0.001) + half];
        if is_axial {
            let (middle, reach) = (part.domain.size[0] as f32, high.x);
            (low.x, low.y) = (middle - reach, middle - reach);
            (high.x, high.y) = (middle + reach, middle + reach);
        }
        self.corners = Some(match self.corners {
            Some([l, h]) => [l.inf(&low), h.sup(&high)],
            None => [low, high],
        });
        let [x, y, z] = &frame.velocity;
        let speed = (0..x.len()).map(|i| V::new(x[i], y[i], z[i]).norm());
        self.speed = self.speed.max(f64::from(exceeded(speed.collect(), 0.01)));
        let pressure = |part: f64| f64::from(exceeded(frame.pressure.clone(), part));
        let [low, high] = self.pressure;
        self.pressure = [low.min(pressure(0.99)), high.max(pressure(0.01))];
    }
}

/// Draws the frames of a run.
pub struct Artist {
    /// The whole, and the part that was simulated.
    scene: Scene,
    part: Scene,
    unfold: Unfold,
    style: Style,
    corners: [V; 2],
    /// Colours of speed or pressure.
    scale: Scale,
}

impl Artist {
    /// For frames of `part`, the simulated part of a scene, that have been surveyed.
    pub fn new(part: &Scene, survey: &Survey, style: Style) -> Artist {
        let scene = part.solid();
        let size = V::from(scene.domain.size.map(|s| s as f32));
        let mut corners = survey.corners.unwrap_or([V::zeros(), size]);
        for a in 0..3 {
            // At a side the liquid is cut there, not half a spacing before.
            let [low, high] = scene.domain.boundary[a];
            if low != Side::Open && corners[0][a] < 2.0 * scene.spacing as f32 {
                corners[0][a] = 0.0;
            }
            if high != Side::Open && corners[1][a] > size[a] - 2.0 * scene.spacing as f32 {
                corners[1][a] = size[a];
            }
        }
        let range = match style.material {
            Material::Pressure => survey.pressure,
            _ => [0.0, survey.speed],
        };
        Artist {
            unfold: Unfold::new(part),
            part: part.clone(),
            scene,
            style,
            corners,
            scale: Scale::new(range, Plain::Viridis),
        }
    }

    /// Linear colours of the particles, if the material has them.
    fn colours(&self, frame: &Frame) -> Vec<[f32; 3]> {
        let map = |value: f32| linear(self.scale.colour(f64::from(value))).into();
        let velocity = |i: usize| V::from([0, 1, 2].map(|a| frame.velocity[a][i]));
        let all = 0..frame.id.len();
        match self.style.material {
            Material::Water | Material::Milk => Vec::new(),
            Material::Body => {
                let colour = |i: usize| linear(body_colour(&self.scene, frame.body[i])).into();
                all.map(colour).collect()
            }
            Material::Speed => all.map(|i| map(velocity(i).norm())).collect(),
            Material::Pressure => all.map(|i| map(frame.pressure[i])).collect(),
        }
    }

    fn field(&self, frame: &Frame) -> Option<Field> {
        if self.part.domain.is_axial() {
            return Field::revolved(&self.part, frame, &self.colours(frame));
        }
        let frame = self.unfold.whole(frame);
        Field::new(&self.scene, &frame, &self.colours(&frame))
    }

    /// The surface of a frame as a mesh; `None` in two dimensions, which have no such surface.
    pub fn mesh(&self, frame: &Frame) -> Option<Mesh> {
        if self.scene.dimension == Dimension::Two {
            return None;
        }
        let field = self.field(frame);
        Some(field.map_or_else(Mesh::default, |field| field.mesh(frame.time)))
    }

    /// A picture of a frame.
    pub fn picture(&self, frame: &Frame) -> Canvas {
        let style = &self.style;
        let field = self.field(frame);
        let (mut canvas, pixel) = match self.scene.dimension {
            Dimension::Two => {
                let sheet = Sheet::fitted(self.corners, style.view.zoom, style.size);
                (
                    sheet.draw(field.as_ref(), style.material, style.background),
                    sheet.pixel,
                )
            }
            Dimension::Three => {
                let middle = 0.5 * (self.corners[0] + self.corners[1]);
                let target = style
                    .target
                    .map_or(middle, |at| V::from(at.map(|c| c as f32)));
                let camera = Camera::fitted(self.corners, target, &style.view, style.size);
                let look = Look {
                    material: style.material,
                    background: style.background,
                    samples: style.samples,
                    floor: (self.scene.domain.boundary[2][0] == Side::Wall).then_some(0.0),
                    has_shadows: style.has_shadows,
                };
                let pixel = f64::from(camera.pixel(&target));
                (draw(field.as_ref(), &camera, &look), pixel)
            }
        };
        let mut overlay = Overlay::new(&mut canvas, style.background);
        if style.has_clock {
            let time = frame.time - contact_time(&self.part.whole());
            overlay.clock(time, self.part.impact.end);
        }
        if style.has_scale {
            overlay.scale(pixel);
        }
        if let Some(text) = &style.caption {
            overlay.caption(text);
        }
        match style.material {
            Material::Speed => overlay.colours(&self.scale, 1.0, "m/s"),
            Material::Pressure if self.scale.range[1] >= 2000.0 => {
                overlay.colours(&self.scale, 1e3, "kPa");
            }
            Material::Pressure => overlay.colours(&self.scale, 1.0, "Pa"),
            _ => {}
        }
        canvas
    }
}
