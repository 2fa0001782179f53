//! The measures of a scene, and one row of them for a frame.

use super::contact::Contact;
use super::drop::{Front, Shape, Spread};
use super::energy;
use super::force::{self, Impulse};
use super::kind::{Kind, contact, other_drops};
use super::piece::Piece;
use super::pool::{self, Axis, Pool};
use super::raster::Raster;
use super::region::Region;
use super::series::Row;
use crate::particle::Frame;
use crate::scene::{Clock, Dimension, Scene};
use std::borrow::Cow;

/// Measures frames of one scene, in their order.
pub struct Gauge {
    scene: Scene,
    /// [`contact`].
    contact: Option<f64>,
    /// Which measures are taken.
    pub kind: Kind,
    /// Reference values from the first frame.
    pub start: Start,
}

/// Reference values from the first frame, and from the last one.
#[derive(Clone, Copy, Debug, Default)]
pub struct Start {
    /// Initial level of the pool above the floor, m.
    pub level: Option<f64>,
    /// Energies of motion, height, compression and surface less the work done until then, J.
    pub energy: Option<f64>,
    /// Momentum in the last frame.
    pub impulse: Option<Impulse>,
}

impl Gauge {
    /// A gauge for the frames of `scene`.
    pub fn new(scene: &Scene) -> Gauge {
        Gauge {
            scene: scene.clone(),
            contact: contact(scene),
            kind: Kind::new(scene),
            start: Start::default(),
        }
    }

    /// Measures a frame. The first one sets [`Gauge::start`].
    pub fn measure(&mut self, frame: &Frame) -> Row {
        let (row, start) = self.look(frame, None);
        self.start = start;
        row
    }

    /// Measures a frame without changing the gauge; returns the row and the reference values.
    /// `before`: the frame before it, if that is not the one that the gauge measured last.
    pub fn look(&self, frame: &Frame, before: Option<&Frame>) -> (Row, Start) {
        let mut start = self.start;
        if let Some(before) = before {
            start.impulse = Impulse::of(before);
        }
        let mut row = Table::default();
        row.put("time_s", frame.time);
        let after = Clock::after_contact(frame.time, self.contact);
        row.put_some("time_after_contact_s", after);
        let mut area = None;
        if !matches!(self.kind, Kind::Bulk) {
            let scene = &self.scene;
            let piece = self.piece(frame);
            let raster = Raster::new(scene, &piece.frame);
            let region = Region::new(&raster);
            self.measure_region(&region, &piece, &mut start.level, &mut row);
            if scene.effects.tension.is_some() {
                area = Some(raster.surface_area());
            }
        }
        if !frame
            .scalars
            .iter()
            .any(|(name, _)| name == "speed_max_m_s")
        {
            row.put("speed_max_m_s", speed_max(frame));
        }
        energy::put(&self.scene, frame, area, &mut row.0);
        // Sigma times the area of the surface does not include the energy of wet walls.
        let is_whole = self.scene.effects.wetting.is_none()
            || frame
                .scalars
                .iter()
                .any(|(name, _)| name == "surface_energy_J");
        if let Some(energy) = energy::explained(&row.0).filter(|_| is_whole) {
            let first = *start.energy.get_or_insert(energy);
            row.put("energy_unexplained_J", energy - first);
        }
        start.impulse = force::put(&self.scene, frame, start.impulse, &mut row.0);
        (row.0, start)
    }

    /// What the shape of the liquid is: the columns that need the particles of a frame alone. The
    /// first frame sets the level in [`Gauge::start`].
    pub fn figures(&mut self, frame: &Frame) -> Row {
        let mut row = Table::default();
        if !matches!(self.kind, Kind::Bulk) {
            let scene = &self.scene;
            let piece = self.piece(frame);
            let raster = Raster::new(scene, &piece.frame);
            let mut level = self.start.level;
            self.measure_region(&Region::new(&raster), &piece, &mut level, &mut row);
            self.start.level = level;
        }
        row.0
    }

    /// What is no pool, in one piece.
    fn piece<'a>(&self, frame: &'a Frame) -> Piece<'a> {
        match self.kind {
            Kind::Wall(_) | Kind::Shape => Piece::of(&self.scene, frame),
            _ => Piece {
                frame: Cow::Borrowed(frame),
                moved: [0.0; 3],
            },
        }
    }

    fn measure_region(
        &self,
        region: &Region,
        piece: &Piece,
        level: &mut Option<f64>,
        row: &mut Table,
    ) {
        let (scene, frame) = (&self.scene, &*piece.frame);
        match self.kind {
            Kind::Pool(axis) => {
                let nominal = scene.pool_depth().unwrap_or(0.0);
                let first = || pool::far_level(region, &axis).unwrap_or(nominal);
                let level = *level.get_or_insert_with(first);
                let others = other_drops(scene, &axis);
                put_pool(
                    &Pool::beside(region, &axis, &others, scene.dimension, level),
                    row,
                );
                row.put("detached_part", region.detached(frame));
                row.put("highest_particle_m", highest(frame) - level);
            }
            Kind::Wall(axis) => {
                let at = [0, 1].map(|a| piece.moved(scene, a, axis.at[a]));
                let spread = Spread::new(region, at, axis.diameter, scene.dimension);
                row.put("spread_factor", spread.wetted);
                row.put("dry_part", spread.dry);
                row.put("max_diameter_factor", spread.largest);
                // With several drops all but one are detached from the main body.
                if scene.bodies.len() == 1 {
                    row.put("detached_part", region.detached(frame));
                }
                row.put_some("apex_height_m", spread.apex);
                row.put("highest_particle_m", highest(frame));
                if scene.effects.wetting.is_some() {
                    let diameter = spread.wetted * axis.diameter;
                    let contact = Contact::new(region, diameter, spread.apex);
                    put_contact(&contact, scene.dimension == Dimension::Two, row);
                }
            }
            Kind::Front => {
                let front = Front::new(region);
                row.put_some("front_m", front.map(|f| f.reach));
                row.put_some("column_height_m", front.map(|f| f.height));
            }
            Kind::Level => {
                let middle = Axis {
                    at: [0.5 * scene.domain.size[0], 0.5 * scene.domain.size[1]],
                    diameter: 0.0,
                };
                row.put_some("surface_level_m", pool::far_level(region, &middle));
                row.put_some("pressure_max_Pa", pressure_max(frame));
            }
            Kind::Shape => self.measure_shape(piece, row),
            Kind::Bulk => {}
        }
    }

    fn measure_shape(&self, piece: &Piece, row: &mut Table) {
        let (scene, frame) = (&self.scene, &*piece.frame);
        let is_revolved = scene.domain.is_revolved();
        let space = match is_revolved {
            true => Dimension::Three,
            false => scene.dimension,
        };
        let shape = Shape::new(frame, scene.dimension, is_revolved, scene.spacing);
        let names = ["centre_x_m", "centre_y_m", "centre_z_m"];
        for (axis, name) in names.iter().enumerate() {
            if axis != 1 || scene.dimension == Dimension::Three {
                let centre = shape.map(|s| piece.place(scene, axis, s.centre[axis]));
                row.put_some(name, centre);
            }
        }
        row.put_some(
            "aspect_ratio",
            shape.map(|s| s.aspect_ratio(scene.dimension)),
        );
        row.put_some(
            "amplitude",
            shape.map(|s| s.amplitude(scene.dimension, space)),
        );
        if let (Some(_), [drop]) = (scene.effects.tension, scene.bodies.as_slice()) {
            let radius = drop.shape.equivalent_radius(&scene.domain, scene.dimension);
            let shape = shape.filter(|_| has_pressure(frame));
            let pressure = shape.and_then(|s| s.core_pressure(frame, radius));
            row.put_some("core_pressure_Pa", pressure);
        }
    }
}

#[derive(Default)]
struct Table(Row);

impl Table {
    fn put(&mut self, name: &str, value: f64) {
        self.0.push((name.to_owned(), value));
    }

    fn put_some(&mut self, name: &str, value: Option<f64>) {
        self.put(name, value.unwrap_or(f64::NAN));
    }
}

fn put_contact(contact: &Contact, is_plane: bool, row: &mut Table) {
    row.put_some("contact_angle_deg", contact.fitted);
    row.put_some("contact_angle_base_deg", contact.built);
    row.put_some("contact_diameter_m", contact.base);
    if is_plane {
        row.put_some("contact_angle_low_x_deg", contact.flanks[0]);
        row.put_some("contact_angle_high_x_deg", contact.flanks[1]);
    }
}

fn put_pool(pool: &Pool, row: &mut Table) {
    let depth = pool.axis_level.filter(|z| *z < 0.0).map(|z| -z);
    let mean = pool.axis_level_mean.filter(|z| *z < 0.0).map(|z| -z);
    let from_far = depth.and_then(|d| pool.far_level.map(|far| far + d));
    row.put_some("axis_level_m", pool.axis_level);
    row.put_some("crater_depth_m", depth);
    row.put_some("crater_depth_mean_m", mean);
    row.put_some("crater_depth_far_m", from_far);
    row.put_some("crater_diameter_m", pool.crater_diameter);
    row.put_some("crown_height_m", pool.crown_height);
    row.put_some("jet_height_m", pool.jet_height);
    row.put_some("far_level_m", pool.far_level);
}

fn speed_max(frame: &Frame) -> f64 {
    f64::from(
        (0..frame.id.len())
            .map(|i| energy::speed_squared(frame, i))
            .fold(0.0, f32::max),
    )
    .sqrt()
}

fn pressure_max(frame: &Frame) -> Option<f64> {
    let most = frame.pressure.iter().copied().fold(0.0, f32::max);
    has_pressure(frame).then_some(f64::from(most))
}

/// Whether pressures are known: those of a projection not before its first step.
fn has_pressure(frame: &Frame) -> bool {
    let scalar = |wanted: &str| frame.scalars.iter().find(|(name, _)| name == wanted);
    let is_projected = scalar("pressure_iterations").is_some();
    !is_projected || scalar("steps").is_none_or(|(_, steps)| *steps > 0.0)
}

fn highest(frame: &Frame) -> f64 {
    f64::from(
        frame.position[2]
            .iter()
            .copied()
            .fold(f32::NEG_INFINITY, f32::max),
    )
}
