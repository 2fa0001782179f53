//! The measures of a scene, and one row of them for a frame.

use super::contact::Contact;
use super::drop::{Front, Shape, Spread};
use super::energy;
use super::force::{self, Impulse};
use super::pool::{self, Axis, Pool};
use super::raster::Raster;
use super::region::Region;
use super::series::Row;
use crate::particle::Frame;
use crate::scene::{Body, Clock, Dimension, Motion, Scene, Shape as Geometry, Side};

/// Kind of a scene, from its bodies.
#[derive(Clone, Copy, Debug)]
pub enum Kind {
    /// A drop falls into a pool: crater, crown, jet.
    Pool(Axis),
    /// A drop falls on a dry wall: spread.
    Wall(Axis),
    /// Drops and blocks in free space: shape.
    Shape,
    /// A column that collapses: front.
    Front,
    /// Liquid at rest under gravity: its level.
    Level,
    /// No surface.
    Bulk,
}

impl Kind {
    /// The kind of `scene`, from its bodies and its box.
    pub fn new(scene: &Scene) -> Kind {
        let layer = scene
            .bodies
            .iter()
            .any(|b| matches!(b.shape, Geometry::Layer { .. }));
        let drop = drop(scene);
        let wets = scene.effects.wetting.is_some();
        let down = wets || scene.effects.gravity.is_some_and(|g| g[2] < 0.0);
        let floor = scene.domain.boundary[2][0] == Side::Wall;
        match drop {
            Some((_, axis)) if layer => Kind::Pool(axis),
            Some((body, axis)) if floor && (down || speed_down(body) > 0.0) => Kind::Wall(axis),
            Some(_) => Kind::Shape,
            None if layer && floor => Kind::Level,
            None => Kind::of_blocks(scene, down && floor),
        }
    }

    fn of_blocks(scene: &Scene, falls: bool) -> Kind {
        let size = scene.domain.size;
        let near = 0.5 * scene.spacing;
        let spans = |axis: usize| {
            let flat = axis == 1 && scene.dimension == Dimension::Two;
            flat || scene.bodies.iter().any(|body| match body.shape {
                Geometry::Block { low, high } => low[axis] < near && high[axis] > size[axis] - near,
                Geometry::Layer { depth } => axis < 2 || depth > size[2] - near,
                _ => false,
            })
        };
        match (spans(0) && spans(1), spans(2), falls) {
            (true, true, _) => Kind::Bulk,
            (true, false, true) => Kind::Level,
            (false, _, true) => Kind::Front,
            _ => Kind::Shape,
        }
    }
}

/// The body that is measured as the drop, with its axis: the falling drop that arrives first, else
/// the first of the file.
fn drop(scene: &Scene) -> Option<(&Body, Axis)> {
    let bodies = scene.bodies.iter();
    let drops = bodies.filter_map(|body| axis(scene, body).map(|axis| (body, axis)));
    let key = |body: &Body| arrival(scene, body).unwrap_or(f64::INFINITY);
    drops.min_by(|(a, _), (b, _)| key(a).total_cmp(&key(b)))
}

/// Axis of a drop, or of a block that becomes a drop on a wall with a contact angle: with the
/// diameter of equal volume.
fn axis(scene: &Scene, body: &Body) -> Option<Axis> {
    let (centre, diameter) = match &body.shape {
        Geometry::Sphere { centre, radius } => (*centre, 2.0 * radius),
        Geometry::Ellipsoid { centre, semi_axes } => (*centre, 2.0 * semi_axes[0]),
        Geometry::Block { low, high } if scene.effects.wetting.is_some() => {
            let radius = body.shape.equivalent_radius(&scene.domain, scene.dimension);
            ([0, 1, 2].map(|a| 0.5 * (low[a] + high[a])), 2.0 * radius)
        }
        _ => return None,
    };
    Some(Axis {
        at: [centre[0], centre[1]],
        diameter,
    })
}

fn speed_down(body: &Body) -> f64 {
    match body.motion {
        Motion::Uniform(v) => -v[2],
        _ => 0.0,
    }
}

/// The axes of all drops but the one that is measured.
fn other_drops(scene: &Scene, measured: &Axis) -> Vec<Axis> {
    let all = scene.bodies.iter().filter_map(|body| axis(scene, body));
    all.filter(|axis| axis.at != measured.at).collect()
}

/// [`contact`], 0 if it never happens. Plots count from it, and references with
/// [`Clock::Contact`](crate::scene::Clock::Contact).
pub fn contact_time(scene: &Scene) -> f64 {
    contact(scene).unwrap_or(0.0)
}

/// Time at which the freely falling drop meets pool or wall, s from the start of the run: by the
/// law of free fall, not by the particles, so that it is the same for all methods and spacings. 0
/// if they touch from the start, `None` if nothing falls on anything.
pub fn contact(scene: &Scene) -> Option<f64> {
    if !matches!(Kind::new(scene), Kind::Pool(_) | Kind::Wall(_)) {
        return None;
    }
    let (body, _) = drop(scene)?;
    let touches = drop_height(scene, body) <= 0.0;
    arrival(scene, body).or(touches.then_some(0.0))
}

/// Time at which a freely falling body meets pool or floor, s; `None` if it does not fall.
fn arrival(scene: &Scene, body: &Body) -> Option<f64> {
    let height = drop_height(scene, body).max(0.0);
    let pull = scene.effects.gravity.map_or(0.0, |g| -g[2]);
    let speed = speed_down(body);
    let square = speed * speed + 2.0 * pull * height;
    // The root of speed t + pull t^2 / 2 = height, in a form without cancellation.
    let mean = speed + square.sqrt();
    (mean > 0.0).then(|| 2.0 * height / mean)
}

/// Height of the lowest point of a body above the pool or the floor, m.
fn drop_height(scene: &Scene, body: &Body) -> f64 {
    body.shape.bounds(&scene.domain, scene.dimension).0[2] - scene.pool_depth().unwrap_or(0.0)
}

/// Whether a single drop falls on a dry wall: it moves towards it, or starts above it under
/// gravity. Without that there is neither a lamella nor a rebound.
pub fn strikes_wall(scene: &Scene) -> bool {
    let whole = scene.whole();
    let lone = whole.bodies.len() == 1 && matches!(Kind::new(&whole), Kind::Wall(_));
    lone && drop(&whole).is_some_and(|(body, _)| {
        let is_above = drop_height(&whole, body) > 0.5 * whole.spacing;
        arrival(&whole, body).is_some() && (is_above || speed_down(body) > 0.0)
    })
}

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
            let raster = Raster::new(
                scene.dimension,
                &scene.domain,
                scene.spacing,
                &frame.position,
            );
            let region = Region::new(&raster);
            self.measure_region(&region, frame, &mut start.level, &mut row);
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
            let (domain, spacing) = (&scene.domain, scene.spacing);
            let raster = Raster::new(scene.dimension, domain, spacing, &frame.position);
            let mut level = self.start.level;
            self.measure_region(&Region::new(&raster), frame, &mut level, &mut row);
            self.start.level = level;
        }
        row.0
    }

    fn measure_region(
        &self,
        region: &Region,
        frame: &Frame,
        level: &mut Option<f64>,
        row: &mut Table,
    ) {
        let scene = &self.scene;
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
                row.put("detached_part", region.detached(&frame.position));
                row.put("highest_particle_m", highest(frame) - level);
            }
            Kind::Wall(axis) => {
                let spread = Spread::new(region, axis.at, axis.diameter, scene.dimension);
                row.put("spread_factor", spread.wetted);
                row.put("dry_part", spread.dry);
                row.put("max_diameter_factor", spread.largest);
                // With several drops all but one are detached from the main body.
                if scene.bodies.len() == 1 {
                    row.put("detached_part", region.detached(&frame.position));
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
                row.put("pressure_max_Pa", pressure_max(frame));
            }
            Kind::Shape => self.measure_shape(frame, row),
            Kind::Bulk => {}
        }
    }

    fn measure_shape(&self, frame: &Frame, row: &mut Table) {
        let scene = &self.scene;
        let shape = Shape::new(frame, scene.dimension, scene.spacing);
        let names = ["centre_x_m", "centre_y_m", "centre_z_m"];
        for (axis, name) in names.iter().enumerate() {
            if axis != 1 || scene.dimension == Dimension::Three {
                row.put_some(name, shape.map(|s| s.centre[axis]));
            }
        }
        row.put_some(
            "aspect_ratio",
            shape.map(|s| s.aspect_ratio(scene.dimension)),
        );
        row.put_some("amplitude", shape.map(|s| s.amplitude(scene.dimension)));
        if let (Some(_), [drop]) = (scene.effects.tension, scene.bodies.as_slice()) {
            let radius = drop.shape.equivalent_radius(&scene.domain, scene.dimension);
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

fn pressure_max(frame: &Frame) -> f64 {
    f64::from(frame.pressure.iter().copied().fold(0.0, f32::max))
}

fn highest(frame: &Frame) -> f64 {
    f64::from(
        frame.position[2]
            .iter()
            .copied()
            .fold(f32::NEG_INFINITY, f32::max),
    )
}
