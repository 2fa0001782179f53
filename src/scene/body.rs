//! Bodies of a scene file.

use super::cursor::Cursor;
use super::error::{Mistakes, SceneError};
use super::quantity::Unit;
use super::tree::Node;
use super::{Body, Dimension, Domain, Motion, Shape, conform};

/// Colours of bodies that name none, in file order; beyond, they repeat.
const COLOURS: [[u8; 3]; 6] = [
    [0x1f, 0x77, 0xb4],
    [0xd6, 0x27, 0x28],
    [0x2c, 0xa0, 0x2c],
    [0xff, 0x7f, 0x0e],
    [0x94, 0x67, 0xbd],
    [0x8c, 0x56, 0x4b],
];

/// Reads all bodies, in file order.
pub fn all(
    table: &Cursor<'_>,
    dimension: Dimension,
    domain: &Domain,
) -> Result<Vec<Body>, SceneError> {
    let mut bodies: Vec<Body> = Vec::new();
    for (name, body) in table.entries() {
        let shape = shape(&body, dimension, domain, &bodies)?;
        let colour = match body.get("colour") {
            Some(colour) => conform::colour(colour.node, &colour.path)?,
            None => COLOURS[bodies.len() % COLOURS.len()],
        };
        let motion = motion(&body, dimension)?;
        bodies.push(Body {
            name: name.to_string(),
            shape,
            motion,
            colour,
        });
    }
    Ok(bodies)
}

/// Names of supports, in a file that has other mistakes and is not resolved.
pub fn supports(root: &Node, found: &mut Mistakes) {
    let mut earlier: Vec<&str> = Vec::new();
    for body in root.get("body").map_or(&[][..], Node::entries) {
        for shape in body.node.entries() {
            let path = format!("body.{}.{}.above", body.key, shape.key);
            if let Some(above) = shape.node.get("above")
                && let Ok(below) = conform::text(above, &path)
                && !earlier.contains(&below)
            {
                found.add(no_support(above, &path, &earlier));
            }
        }
        earlier.push(&body.key);
    }
}

fn no_support(above: &Node, path: &str, earlier: &[&str]) -> SceneError {
    let remedy = format!("bodies earlier in the file: {}", earlier.join(", "));
    let problem = "is no body that stands earlier in the file";
    conform::fault(above, path, problem, &remedy)
}

/// The shape's key decides; 2-D and 3-D have words of their own.
fn shape(
    body: &Cursor<'_>,
    dimension: Dimension,
    domain: &Domain,
    earlier: &[Body],
) -> Result<Shape, SceneError> {
    const PAIRS: [(&str, &str); 3] = [
        ("sphere", "disc"),
        ("ellipsoid", "ellipse"),
        ("block", "rectangle"),
    ];
    for (spatial, planar) in PAIRS {
        let (wrong, right) = match dimension {
            Dimension::Two => (spatial, planar),
            Dimension::Three => (planar, spatial),
        };
        if let Some(shape) = body.get(wrong) {
            let problem = format!("is no shape of a {}-D scene", dimension.count());
            return Err(shape.fault(&problem, &format!("use `{right}`")));
        }
        let Some(shape) = body.get(right) else {
            continue;
        };
        return match spatial {
            "sphere" => sphere(&shape, dimension, domain, earlier),
            "ellipsoid" => Ok(Shape::Ellipsoid {
                centre: shape.need("centre")?.vector(Unit::Length, dimension)?,
                semi_axes: shape.need("semi_axes")?.vector(Unit::Length, dimension)?,
            }),
            _ => block(&shape, dimension),
        };
    }
    let depth = body.need("layer")?.quantity_at("depth", Unit::Length)?;
    Ok(Shape::Layer { depth })
}

fn block(shape: &Cursor<'_>, dimension: Dimension) -> Result<Shape, SceneError> {
    let low = shape.need("low")?.vector(Unit::Length, dimension)?;
    let high = shape.need("high")?.vector(Unit::Length, dimension)?;
    if dimension.axes().iter().any(|&axis| low[axis] >= high[axis]) {
        let high = shape.need("high")?;
        return Err(high.fault("is not above `low`", "give the highest corner"));
    }
    Ok(Shape::Block { low, high })
}

/// By its centre, or hanging at a gap above an earlier body, in the middle of the box.
fn sphere(
    shape: &Cursor<'_>,
    dimension: Dimension,
    domain: &Domain,
    earlier: &[Body],
) -> Result<Shape, SceneError> {
    let radius = shape.quantity_at("diameter", Unit::Length)? / 2.0;
    if let Some(centre) = shape.get("centre") {
        if let Some(gap) = ["gap", "above", "offset"]
            .iter()
            .find_map(|key| shape.get(key))
        {
            return Err(gap.fault(
                "is given beside `centre`",
                "give either; `centre` is absolute",
            ));
        }
        let centre = centre.vector(Unit::Length, dimension)?;
        return Ok(Shape::Sphere { centre, radius });
    }
    let above = shape.need("above").map_err(|_| SceneError::Missing {
        place: shape.node.place.clone(),
        key: conform::dotted(&shape.path, "centre"),
        remedy: "give `centre`, or `gap` and `above` = \"NAME\" of an earlier body".to_string(),
    })?;
    let below = above.text()?;
    let Some(support) = earlier.iter().find(|body| body.name == below) else {
        let names: Vec<&str> = earlier.iter().map(|body| body.name.as_str()).collect();
        return Err(no_support(above.node, &above.path, &names));
    };
    let top = support.shape.bounds(domain, dimension).1[2];
    let gap = shape.quantity_at("gap", Unit::Length)?;
    let mut centre = [
        domain.size[0] / 2.0,
        domain.size[1] / 2.0,
        top + gap + radius,
    ];
    if let Some(offset) = shape.get("offset") {
        let values = offset.quantities(Unit::Length)?;
        if values.len() != dimension.count() - 1 {
            let remedy = format!("give {}", dimension.count() - 1);
            return Err(offset.fault(&format!("has {} components", values.len()), &remedy));
        }
        values
            .iter()
            .enumerate()
            .for_each(|(axis, value)| centre[axis] += value);
    }
    Ok(Shape::Sphere { centre, radius })
}

fn motion(body: &Cursor<'_>, dimension: Dimension) -> Result<Motion, SceneError> {
    let ways = ["velocity", "taylor_green", "stretch"];
    let given: Vec<Cursor<'_>> = ways.iter().filter_map(|key| body.get(key)).collect();
    if let [_, second, ..] = given.as_slice() {
        let remedy = "give at most one of velocity, taylor_green, stretch";
        return Err(second.fault("is a second initial velocity", remedy));
    }
    if let Some(vortex) = body.get("taylor_green") {
        let speed = vortex.quantity_at("speed", Unit::Speed)?;
        return Ok(Motion::TaylorGreen { speed });
    }
    if let Some(stretch) = body.get("stretch") {
        let rate = stretch.quantity_at("rate", Unit::Rate)?;
        return Ok(Motion::Stretch { rate });
    }
    let Some(velocity) = body.get("velocity") else {
        return Ok(Motion::Uniform([0.0; 3]));
    };
    if let super::tree::Value::List(_) = velocity.node.value {
        return Ok(Motion::Uniform(velocity.vector(Unit::Speed, dimension)?));
    }
    // A zero without a sign: -0 and 0 are one velocity.
    let downward = 0.0 - velocity.quantity(Unit::Speed)?;
    Ok(Motion::Uniform([0.0, 0.0, downward]))
}
