//! The scene file: TOML with units, and `--set` over it.

use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use schemars::JsonSchema;
use serde::Deserialize;
use serde::de::DeserializeOwned;

use super::body::{self, BodyTables};
use super::domain::BoxTable;
use super::effects::EffectTables;
use super::error::{Mistakes, SceneError};
use super::method::{Method, MethodTable};
use super::problem::Liquid;
use super::schema::{self, named};
use super::stage::{Frames, Impact, Pack, Post, Relax};
use super::tree::{Sources, Tree};
use super::{Dimension, Problem, Scene, check, conform, preset, symmetry};

/// No scene file is longer, bytes.
const LONGEST: u64 = 16 << 20;

/// The scene file, with its preset and defaults.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Document {
    /// What the run is about; stands on the report.
    #[serde(default)]
    pub title: String,
    /// 3, or 2 for the x-z plane.
    #[serde(default)]
    pub dimension: Dimension,
    /// The box [0, size] in which everything happens.
    #[serde(rename = "box")]
    pub domain: BoxTable,
    /// The liquid of all bodies.
    pub liquid: Liquid,
    /// What acts: a table each; absent is off.
    #[serde(default)]
    pub effects: EffectTables,
    /// Bodies of liquid, by name.
    #[schemars(transform = named)]
    pub body: BodyTables,
    /// How the particles of a body are placed.
    pub pack: Pack,
    /// Run at rest before the impact; absent is none.
    #[serde(default)]
    pub relax: Option<Relax>,
    /// The simulation proper.
    pub impact: Impact,
    /// What is recorded for viewers and measures.
    pub frames: Frames,
    /// What is drawn and compared.
    #[serde(default)]
    pub post: Post,
    /// Which solver, with which settings.
    #[serde(default)]
    pub method: MethodTable,
}

/// The schema of a scene file.
pub static SCHEMA: LazyLock<serde_json::Value> = LazyLock::new(|| {
    let mut schema = schema::of::<Document>("Coronet scene");
    schema.remove("description");
    schema.to_value()
});

/// The schema of a scene file as text, as shipped in `docs/pipeline.schema.json`.
pub fn json_schema() -> String {
    // `{:#}` of a JSON value is pretty-printed.
    format!("{:#}\n", *SCHEMA)
}

/// A scene with the text that it came from.
#[derive(Clone, Debug)]
pub struct Loaded {
    pub scene: Scene,
    /// TOML that gives the same scene: the file as it stands, or, after `--set`, rewritten.
    pub text: String,
    /// The scene file, as given.
    pub path: PathBuf,
}

/// Reads the scene file at `path` with the overrides `sets`, each `key.key=value`.
///
/// # Errors
/// [`SceneError`]: unreadable file, no TOML; all unknown keys, missing keys, wrong types, units and
/// ranges; or, of a file without these, what makes no sense.
pub fn load(path: &Path, sets: &[String]) -> Result<Loaded, SceneError> {
    let content = crate::file::read(path, LONGEST)?;
    let text = String::from_utf8(content).map_err(|_| SceneError::NotText {
        path: path.to_path_buf(),
    })?;
    read(&text, path, sets)
}

/// As [`load`], with the text at hand; `path` names it and leads to reference curves.
///
/// # Errors
/// As [`load`].
pub fn read(text: &str, path: &Path, sets: &[String]) -> Result<Loaded, SceneError> {
    let sources = Sources::new(text, path, sets);
    let tree = Tree::parse(&sources)?;
    let mut found = conform::check(&tree, &SCHEMA);
    if !found.is_empty() {
        body::supports(&tree, &mut found);
    }
    found.told()?;
    let document: Document = preset::laid_under(&tree, &SCHEMA).read()?;
    let name = path
        .file_stem()
        .map_or("scene".into(), |stem| stem.to_string_lossy());
    let scene = document.scene(&name, &tree)?;
    let folder = path.parent().unwrap_or(Path::new("."));
    check::scene(&scene, &tree, folder)?;
    let text = match sets.is_empty() {
        true => text.to_string(),
        false => tree.text(),
    };
    Ok(Loaded {
        scene,
        text,
        path: path.to_path_buf(),
    })
}

/// Reads another kind of file, whose type is its format, with all its mistakes at once.
///
/// # Errors
/// [`SceneError`].
pub fn parse<T: DeserializeOwned + JsonSchema>(text: &str, path: &Path) -> Result<T, SceneError> {
    let sources = Sources::new(text, path, &[]);
    let tree = Tree::parse(&sources)?;
    conform::check(&tree, &schema::of::<T>("").to_value()).told()?;
    tree.read()
}

impl Document {
    /// The scene, in SI units.
    ///
    /// # Errors
    /// The first mistake of each part, at its place in `tree`.
    fn scene(self, name: &str, tree: &Tree<'_>) -> Result<Scene, SceneError> {
        let dimension = self.dimension;
        let domain = self.domain.domain(dimension, tree)?;
        let mut found = Mistakes::default();
        let bodies = found.take(body::all(&self.body, dimension, &domain, tree));
        let effects = found.take(self.effects.effects(dimension, tree));
        let method = found.take(self.method(tree));
        found.told()?;
        let known = "told otherwise";
        let mut scene = Scene {
            name: name.to_string(),
            title: self.title,
            problem: Problem {
                dimension,
                domain,
                density: self.liquid.density,
                spacing: self.pack.spacing,
                effects: effects.expect(known),
                bodies: bodies.expect(known),
                method: method.expect(known),
                pairs: self.method.pairs,
            },
            pack: self.pack.packing,
            relax: self.relax,
            impact: self.impact,
            frames: self.frames,
            post: self.post,
        };
        if let Some(symmetry) = self.domain.symmetry {
            symmetry::cut(&mut scene, symmetry, tree)?;
        }
        Ok(scene)
    }

    fn method(&self, tree: &Tree<'_>) -> Result<Method, SceneError> {
        let method = self.method.method();
        if let Some(Method::Mps(_)) = method
            && tree.get("effects.viscosity.form").is_some()
        {
            let problem = "is not read by mps, which has Eq. 9";
            return Err(tree.fault("effects.viscosity.form", problem, "remove it"));
        }
        let absent = || tree.fault("method", "has no settings", "give a preset");
        method.ok_or_else(absent)
    }
}
