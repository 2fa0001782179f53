//! The scene file: TOML with units, and the overrides of `--set`.

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
use super::{Dimension, Problem, Scene, ViscosityForm, check, conform, preset, symmetry};

/// Largest size of a scene file, bytes.
const LONGEST: u64 = 16 << 20;

/// The scene file, with its preset and defaults.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Document {
    /// Title of the run, shown in the report.
    #[serde(default)]
    pub title: String,
    /// 3, or 2 for the x-z plane.
    #[serde(default)]
    pub dimension: Dimension,
    /// The box [0, size] that contains the simulation.
    #[serde(rename = "box")]
    pub domain: BoxTable,
    /// The liquid of all bodies.
    pub liquid: Liquid,
    /// Effects, one table each; an absent table turns its effect off.
    #[serde(default)]
    pub effects: EffectTables,
    /// Bodies of liquid, by name.
    #[schemars(transform = named)]
    pub body: BodyTables,
    /// How the particles of a body are placed.
    pub pack: Pack,
    /// Relaxation at rest before the impact; none if absent.
    #[serde(default)]
    pub relax: Option<Relax>,
    /// The simulation of the impact.
    pub impact: Impact,
    /// What is recorded for viewers and measures.
    pub frames: Frames,
    /// What is drawn and compared.
    #[serde(default)]
    pub post: Post,
    /// The solver and its settings.
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
    /// The resolved scene.
    pub scene: Scene,
    /// TOML of this scene: the text of the file, or, after `--set`, rewritten.
    pub text: String,
    /// The scene file, as given.
    pub path: PathBuf,
}

/// Reads the scene file at `path` with the overrides `sets`, each `key.key=value`.
///
/// # Errors
/// [`SceneError`]: unreadable file, invalid TOML; all unknown keys, missing keys, wrong types,
/// units and ranges; or, without these, values that contradict each other.
pub fn load(path: &Path, sets: &[String]) -> Result<Loaded, SceneError> {
    let content = crate::file::read(path, LONGEST)?;
    let text = String::from_utf8(content).map_err(|_| SceneError::NotText {
        path: path.to_path_buf(),
    })?;
    read(&text, path, sets)
}

/// As [`load`], from a text; `path` names it, and reference curves are relative to its folder.
///
/// # Errors
/// As [`load`].
pub fn read(text: &str, path: &Path, sets: &[String]) -> Result<Loaded, SceneError> {
    let sources = Sources::new(text, path, sets);
    let tree = Tree::parse(&sources)?;
    let is_study = ["pipeline", "axis", "case"]
        .iter()
        .any(|key| tree.get(key).is_some());
    if is_study && tree.get("box").is_none() {
        return Err(SceneError::OtherKind {
            path: path.to_path_buf(),
            kind: "study",
            remedy: format!("run `coronet study {}`", path.display()),
        });
    }
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

/// Reads another kind of file, whose format is the type, and reports all its mistakes at once.
///
/// # Errors
/// [`SceneError`].
pub fn parse<T: DeserializeOwned + JsonSchema>(text: &str, path: &Path) -> Result<T, SceneError> {
    let sources = Sources::new(text, path, &[]);
    let tree = Tree::parse(&sources)?;
    if tree.get("box").is_some() && tree.get("body").is_some() {
        return Err(SceneError::OtherKind {
            path: path.to_path_buf(),
            kind: "scene",
            remedy: format!(
                "run `coronet run {}`, or name it as `pipeline` in a study",
                path.display()
            ),
        });
    }
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
        let known = "its mistake is reported";
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
        let form = self.effects.viscosity.map(|viscosity| viscosity.form);
        let of_mps = [ViscosityForm::Morris, ViscosityForm::Central];
        if let (Some(Method::Mps(_)), Some(form)) = (&method, form)
            && !of_mps.contains(&form)
            && tree.get("effects.viscosity.form").is_some()
        {
            let problem = "is no form of mps, which has Eq. 9 or pairs along their lines";
            let remedy = "set it to \"morris\" (Eq. 9) or \"central\"";
            return Err(tree.fault("effects.viscosity.form", problem, remedy));
        }
        let absent = || tree.fault("method", "has no settings", "give a preset");
        method.ok_or_else(absent)
    }
}
