//! From a tree with defaults to a `Scene`.

use super::cursor::Cursor;
use super::error::{Mistakes, SceneError};
use super::quantity::Unit;
use super::{
    Arrangement, Clock, Colour, Dimension, Domain, Effects, Frames, Impact, Pack, Post, Reference,
    Relax, Scene, Side, Wetting, body, preset, symmetry,
};

/// Keys of `[box]` for the sides of each axis.
pub const AXES: [&str; 3] = ["x", "y", "z"];
/// Ends of the keys of `[box.wall_velocity]`.
pub const ENDS: [&str; 2] = ["low", "high"];

/// The scene of a tree that conforms to the format and has its defaults.
///
/// # Errors
/// The first mistake of each part.
pub fn scene(root: &Cursor<'_>, name: &str) -> Result<Scene, SceneError> {
    let dimension = dimension(root)?;
    let domain = domain(&root.need("box")?, dimension)?;
    let mut found = Mistakes::default();
    let bodies = found.take(body::all(&root.need("body")?, dimension, &domain));
    let effects = found.take(effects(&root.need("effects")?, dimension));
    let method = found.take(preset::method(root));
    let frames = found.take(frames(&root.need("frames")?));
    let post = found.take(post(&root.need("post")?));
    found.told()?;
    let known = "told otherwise";
    let mut scene = Scene {
        name: name.to_string(),
        title: root.text_at("title")?.to_string(),
        dimension,
        density: root.need("liquid")?.quantity_at("density", Unit::Density)?,
        effects: effects.expect(known),
        bodies: bodies.expect(known),
        pack: pack(&root.need("pack")?)?,
        relax: root.get("relax").map(|table| relax(&table)).transpose()?,
        impact: impact(&root.need("impact")?)?,
        frames: frames.expect(known),
        post: post.expect(known),
        method: method.expect(known),
        pairs: preset::pairs(&root.need("method")?)?,
        domain,
    };
    symmetry::cut(&mut scene, root)?;
    Ok(scene)
}

fn dimension(root: &Cursor<'_>) -> Result<Dimension, SceneError> {
    let dimension = root.need("dimension")?;
    match dimension.count()? {
        2 => Ok(Dimension::Two),
        3 => Ok(Dimension::Three),
        _ => Err(dimension.fault("is no dimension", "write 2 or 3")),
    }
}

fn domain(table: &Cursor<'_>, dimension: Dimension) -> Result<Domain, SceneError> {
    let size = table.need("size")?.vector(Unit::Length, dimension)?;
    let mut boundary = [[Side::Periodic; 2]; 3];
    for &axis in dimension.axes() {
        boundary[axis] = sides(&table.need(AXES[axis])?)?;
    }
    let mut wall_velocity = [[[0.0; 3]; 2]; 3];
    let walls = table.need("wall_velocity")?;
    for (key, velocity) in walls.entries() {
        let axis = AXES
            .iter()
            .position(|axis| key.starts_with(axis))
            .unwrap_or(0);
        let end = usize::from(key.ends_with(ENDS[1]));
        if boundary[axis][end] != Side::Wall {
            let remedy = format!("make side {} of `box.{}` a wall", ENDS[end], AXES[axis]);
            return Err(velocity.fault("is the velocity of a side that is no wall", &remedy));
        }
        let components = velocity.vector(Unit::Speed, dimension)?;
        if components[axis] != 0.0 {
            let remedy = format!("a wall slides in its own plane: make the {} 0", AXES[axis]);
            return Err(velocity.fault("moves the wall through the liquid", &remedy));
        }
        wall_velocity[axis][end] = components;
    }
    Ok(Domain {
        size,
        boundary,
        wall_velocity,
    })
}

fn sides(value: &Cursor<'_>) -> Result<[Side; 2], SceneError> {
    let side = |item: &Cursor<'_>| -> Result<Side, SceneError> {
        match item.text()? {
            "periodic" => Ok(Side::Periodic),
            "open" => Ok(Side::Open),
            "mirror" => Ok(Side::Mirror),
            _ => Ok(Side::Wall),
        }
    };
    let sides = match value.items().as_slice() {
        [low, high] => [side(low)?, side(high)?],
        _ => [side(value)?; 2],
    };
    let periodic = sides.iter().filter(|side| **side == Side::Periodic).count();
    if periodic == 1 {
        return Err(value.fault(
            "is periodic on one side only",
            "write \"periodic\" for the axis, or another word for both sides",
        ));
    }
    Ok(sides)
}

fn effects(table: &Cursor<'_>, dimension: Dimension) -> Result<Effects, SceneError> {
    let gravity = table
        .get("gravity")
        .map(|table| gravity(&table, dimension))
        .transpose()?;
    let coefficient = |effect: &str, key: &str, unit| {
        table
            .get(effect)
            .map(|table| table.quantity_at(key, unit))
            .transpose()
    };
    Ok(Effects {
        gravity,
        viscosity: coefficient("viscosity", "dynamic", Unit::Viscosity)?,
        tension: coefficient("tension", "coefficient", Unit::Tension)?,
        wetting: table
            .get("wetting")
            .map(|table| wetting(&table))
            .transpose()?,
    })
}

fn wetting(table: &Cursor<'_>) -> Result<Wetting, SceneError> {
    let angle = |key: &str| {
        let given = table.get(key);
        given.map(|angle| angle.quantity(Unit::Angle)).transpose()
    };
    match (angle("angle")?, angle("advancing")?, angle("receding")?) {
        (Some(angle), None, None) => Ok(Wetting::of(angle)),
        (None, Some(advancing), Some(receding)) if receding <= advancing => {
            Ok(Wetting::between([advancing, receding]))
        }
        (None, Some(_), Some(_)) => {
            let receding = table.need("receding")?;
            Err(receding.fault("is above the advancing angle", "exchange the two angles"))
        }
        _ => {
            let remedy = "give `angle` alone, or `advancing` and `receding`";
            Err(table.fault("needs one contact angle or two", remedy))
        }
    }
}

fn gravity(table: &Cursor<'_>, dimension: Dimension) -> Result<[f64; 3], SceneError> {
    let acceleration = table.quantity_at("acceleration", Unit::Acceleration)?;
    let Some(direction) = table.get("direction") else {
        return Ok([0.0, 0.0, -acceleration]);
    };
    let vector = direction.vector(Unit::One, dimension)?;
    let length = vector.iter().map(|each| each * each).sum::<f64>().sqrt();
    if !(length > 0.0 && length.is_finite()) {
        return Err(direction.fault("has no direction", "give a vector that is not zero"));
    }
    // + 0.0 turns -0 into 0.
    Ok(vector.map(|each| acceleration * (each / length) + 0.0))
}

fn pack(table: &Cursor<'_>) -> Result<Pack, SceneError> {
    Ok(Pack {
        spacing: table.quantity_at("spacing", Unit::Length)?,
        arrangement: match table.text_at("arrangement")? {
            "lattice" => Arrangement::Lattice,
            _ => Arrangement::Poisson,
        },
        tolerance: table.quantity_at("tolerance", Unit::Density)?,
        seed: table.need("seed")?.count()?,
        iterations: table.need("iterations")?.count()? as usize,
    })
}

fn relax(table: &Cursor<'_>) -> Result<Relax, SceneError> {
    Ok(Relax {
        time: table.quantity_at("time", Unit::Time)?,
        kinetic_energy: table.quantity_at("kinetic_energy", Unit::SpecificEnergy)?,
        density_spread: table.quantity_at("density_spread", Unit::Density)?,
        damping: table.quantity_at("damping", Unit::Rate)?,
    })
}

fn impact(table: &Cursor<'_>) -> Result<Impact, SceneError> {
    Ok(Impact {
        end: table.quantity_at("end", Unit::Time)?,
        checkpoint_every: table.quantity_at("checkpoint_every", Unit::Time)?,
    })
}

fn frames(table: &Cursor<'_>) -> Result<Frames, SceneError> {
    Ok(Frames {
        interval: table.quantity_at("interval", Unit::Time)?,
        time_scale: table.number_at("time_scale")?,
        colour: match table.text_at("colour")? {
            "speed" => Colour::Speed,
            "pressure" => Colour::Pressure,
            _ => Colour::Body,
        },
    })
}

fn clock_of(word: &Cursor<'_>) -> Result<Clock, SceneError> {
    Ok(match word.text()? {
        "contact" => Clock::Contact,
        _ => Clock::Start,
    })
}

fn post(table: &Cursor<'_>) -> Result<Post, SceneError> {
    let references = table.need("references")?;
    let reference = |item: &Cursor<'_>| -> Result<Reference, SceneError> {
        Ok(Reference {
            label: item.text_at("label")?.to_string(),
            path: item.text_at("path")?.into(),
            clock: item
                .get("clock")
                .map(|clock| clock_of(&clock))
                .transpose()?,
        })
    };
    Ok(Post {
        panels: table.need("panels")?.quantities(Unit::Time)?,
        fields: table.need("fields")?.quantities(Unit::Time)?,
        references: references
            .items()
            .iter()
            .map(reference)
            .collect::<Result<_, _>>()?,
    })
}
