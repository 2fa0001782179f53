//! Converts the tables of bodies to bodies.

use super::{
    Block, Body, BodyTable, BodyTables, Motion, Offset, SHAPES, Shape, Sphere, Stretch,
    TaylorGreen, Velocity,
};
use crate::scene::error::{Mistakes, SceneError};
use crate::scene::tree::Tree;
use crate::scene::unit::{Colour, Length, Vector};
use crate::scene::{Dimension, Domain};

/// Default colours of bodies, in file order; they repeat.
const COLOURS: [[u8; 3]; 6] = [
    [0x1f, 0x77, 0xb4],
    [0xd6, 0x27, 0x28],
    [0x2c, 0xa0, 0x2c],
    [0xff, 0x7f, 0x0e],
    [0x94, 0x67, 0xbd],
    [0x8c, 0x56, 0x4b],
];

/// The table of a body, and the scene around it.
struct Reader<'a> {
    key: String,
    table: &'a BodyTable,
    dimension: Dimension,
    domain: &'a Domain,
    tree: &'a Tree<'a>,
}

/// All bodies of a file, in its order.
///
/// # Errors
/// The first mistake of the first body that has one.
pub fn all(
    tables: &BodyTables,
    dimension: Dimension,
    domain: &Domain,
    tree: &Tree<'_>,
) -> Result<Vec<Body>, SceneError> {
    let mut bodies: Vec<Body> = Vec::new();
    for (name, table) in tables {
        let key = format!("body.{name}");
        let reader = Reader {
            key,
            table,
            dimension,
            domain,
            tree,
        };
        let usual = COLOURS[bodies.len() % COLOURS.len()];
        bodies.push(Body {
            name: name.to_string(),
            shape: reader.shape(&bodies)?,
            motion: reader.motion()?,
            colour: table.colour.map_or(usual, |Colour(rgb)| rgb),
        });
    }
    Ok(bodies)
}

/// Names of supports, in a file that has other mistakes and is not resolved.
pub fn supports(tree: &Tree<'_>, found: &mut Mistakes) {
    let mut earlier: Vec<&str> = Vec::new();
    for body in tree.keys("body") {
        for shape in SHAPES {
            let key = format!("body.{body}.{shape}.above");
            if let Some(below) = tree.text_at(&key)
                && !earlier.contains(&below)
            {
                found.add(no_support(tree, &key, &earlier));
            }
        }
        earlier.push(body);
    }
}

fn no_support(tree: &Tree<'_>, key: &str, earlier: &[&str]) -> SceneError {
    let remedy = format!("bodies earlier in the file: {}", earlier.join(", "));
    let problem = "is not a body earlier in the file";
    tree.fault(key, problem, &remedy)
}

impl Reader<'_> {
    fn fault(&self, key: &str, problem: &str, remedy: &str) -> SceneError {
        self.tree
            .fault(&format!("{}.{key}", self.key), problem, remedy)
    }

    fn point(&self, point: &Vector<Length>, key: &str) -> Result<[f64; 3], SceneError> {
        let key = format!("{}.{key}", self.key);
        self.dimension.vector(point, &key, self.tree)
    }

    /// The key selects the shape; 2-D and 3-D have different keys.
    fn shape(&self, earlier: &[Body]) -> Result<Shape, SceneError> {
        let table = self.table;
        let pairs = [
            (
                "sphere",
                table.sphere.is_some(),
                "disc",
                table.disc.is_some(),
            ),
            (
                "ellipsoid",
                table.ellipsoid.is_some(),
                "ellipse",
                table.ellipse.is_some(),
            ),
            (
                "block",
                table.block.is_some(),
                "rectangle",
                table.rectangle.is_some(),
            ),
        ];
        for (spatial, is_spatial, planar, is_planar) in pairs {
            let (wrong, is_wrong, right) = match self.dimension {
                Dimension::Two => (spatial, is_spatial, planar),
                Dimension::Three => (planar, is_planar, spatial),
            };
            if is_wrong {
                let problem = format!("is not a shape of a {}-D scene", self.dimension.count());
                return Err(self.fault(wrong, &problem, &format!("use `{right}`")));
            }
        }
        let word = |spatial, planar| match self.dimension {
            Dimension::Two => planar,
            Dimension::Three => spatial,
        };
        if let Some(sphere) = table.sphere.as_ref().or(table.disc.as_ref()) {
            return self.sphere(sphere, word("sphere", "disc"), earlier);
        }
        if let Some(ellipsoid) = table.ellipsoid.as_ref().or(table.ellipse.as_ref()) {
            let word = word("ellipsoid", "ellipse");
            let centre = self.point(&ellipsoid.centre, &format!("{word}.centre"))?;
            let semi_axes = self.point(&ellipsoid.semi_axes, &format!("{word}.semi_axes"))?;
            return Ok(Shape::Ellipsoid { centre, semi_axes });
        }
        if let Some(block) = table.block.as_ref().or(table.rectangle.as_ref()) {
            return self.block(block, word("block", "rectangle"));
        }
        // The schema requires one shape.
        let depth = table.layer.as_ref().map_or(0.0, |layer| layer.depth);
        Ok(Shape::Layer { depth })
    }

    fn block(&self, block: &Block, word: &str) -> Result<Shape, SceneError> {
        let low = self.point(&block.low, &format!("{word}.low"))?;
        let high = self.point(&block.high, &format!("{word}.high"))?;
        let mut axes = self.dimension.axes().iter();
        if axes.any(|&axis| low[axis] >= high[axis]) {
            let remedy = "give the highest corner";
            return Err(self.fault(&format!("{word}.high"), "is not above `low`", remedy));
        }
        Ok(Shape::Block { low, high })
    }

    /// From `centre`, or from `gap` above an earlier body, in the middle of the box.
    fn sphere(&self, sphere: &Sphere, word: &str, earlier: &[Body]) -> Result<Shape, SceneError> {
        let radius = sphere.diameter / 2.0;
        if let Some(centre) = &sphere.centre {
            let mut beside = [
                ("gap", sphere.gap.is_some()),
                ("above", sphere.above.is_some()),
                ("offset", sphere.offset.is_some()),
            ]
            .into_iter();
            if let Some((key, _)) = beside.find(|(_, is_given)| *is_given) {
                let remedy = "give either; `centre` is absolute";
                let key = format!("{word}.{key}");
                return Err(self.fault(&key, "is given beside `centre`", remedy));
            }
            let centre = self.point(centre, &format!("{word}.centre"))?;
            return Ok(Shape::Sphere { centre, radius });
        }
        let (Some(below), Some(gap)) = (&sphere.above, sphere.gap) else {
            let remedy = "give `centre`, or `gap` and `above` = \"NAME\" of an earlier body";
            let key = format!("{}.{word}", self.key);
            return Err(self.tree.missing(&key, "centre", remedy));
        };
        let Some(support) = earlier.iter().find(|body| body.name == *below) else {
            let names: Vec<&str> = earlier.iter().map(|body| body.name.as_str()).collect();
            let key = format!("{}.{word}.above", self.key);
            return Err(no_support(self.tree, &key, &names));
        };
        let [x, y, _] = self.domain.size.map(|size| size / 2.0);
        let top = support.shape.bounds(self.domain, self.dimension).1[2];
        let mut centre = [x, y, top + gap + radius];
        let lateral = self.dimension.count() - 1;
        if let Some(Offset(offset)) = &sphere.offset {
            if offset.len() != lateral {
                let problem = format!("has {} components", offset.len());
                let key = format!("{word}.offset");
                return Err(self.fault(&key, &problem, &format!("give {lateral}")));
            }
            let moved = centre.iter_mut().zip(offset);
            moved.for_each(|(centre, by)| *centre += by);
        }
        Ok(Shape::Sphere { centre, radius })
    }

    fn motion(&self) -> Result<Motion, SceneError> {
        let table = self.table;
        let ways = [
            ("velocity", table.velocity.is_some()),
            ("taylor_green", table.taylor_green.is_some()),
            ("stretch", table.stretch.is_some()),
        ];
        let mut given = ways.iter().filter(|(_, is_given)| *is_given).skip(1);
        if let Some((second, _)) = given.next() {
            let remedy = "give at most one of velocity, taylor_green, stretch";
            return Err(self.fault(second, "is a second initial velocity", remedy));
        }
        if let Some(TaylorGreen { speed }) = table.taylor_green {
            return Ok(Motion::TaylorGreen { speed });
        }
        if let Some(Stretch { rate }) = table.stretch {
            return Ok(Motion::Stretch { rate });
        }
        Ok(Motion::Uniform(match &table.velocity {
            None => [0.0; 3],
            // A zero without a sign: -0 and 0 are one velocity.
            Some(Velocity::Downward(speed)) => [0.0, 0.0, 0.0 - speed],
            Some(Velocity::Components(components)) => {
                let key = format!("{}.velocity", self.key);
                self.dimension.vector(components, &key, self.tree)?
            }
        }))
    }
}
