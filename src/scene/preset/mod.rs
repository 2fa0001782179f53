//! Presets: fragments of a scene file that supply what the user's file leaves out.
//!
//! `paper` is the printed method, `corrected` that method with its known errors removed, `modern`
//! what a specialist would use today. A fragment is TOML in the format of the scene file, with the
//! source of each value beside it. The user's keys take precedence; a table of the fragment that
//! the user's file lacks, such as that of an effect, is left out.

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::method::{MethodName, Preset};
use super::schema::property;
use super::tree::{Tree, Value, child};

/// Replacements where a preset's own choice is not possible.
const RAW_COLOUR: &str = "effects.tension.form = \"raw-colour\"";
const STRESS: &str = include_str!("mps-stress.toml");

/// The fragments of a preset, the first one on top.
pub fn fragments(name: MethodName, preset: Preset) -> &'static [&'static str] {
    match (name, preset) {
        (MethodName::Wcsph, Preset::Paper) => &[include_str!("wcsph-paper.toml")],
        (MethodName::Wcsph, Preset::Corrected) => &[
            include_str!("wcsph-corrected.toml"),
            include_str!("wcsph-paper.toml"),
        ],
        (MethodName::Wcsph, Preset::Modern) => &[include_str!("wcsph-modern.toml")],
        (MethodName::Isph, Preset::Paper) => &[include_str!("isph-paper.toml")],
        (MethodName::Isph, Preset::Corrected) => &[
            include_str!("isph-corrected.toml"),
            include_str!("isph-paper.toml"),
        ],
        (MethodName::Isph, Preset::Modern) => &[include_str!("isph-modern.toml")],
        (MethodName::Mps, Preset::Paper) => &[include_str!("mps-paper.toml")],
        (MethodName::Mps, Preset::Corrected) => &[
            include_str!("mps-corrected.toml"),
            include_str!("mps-paper.toml"),
        ],
        (MethodName::Mps, Preset::Modern) => &[include_str!("mps-modern.toml")],
    }
}

/// The scene completed by its preset; `schema`: of scene files.
pub fn laid_under<'a>(tree: &Tree<'a>, schema: &serde_json::Value) -> Tree<'a> {
    let word = |key: &str| tree.text_at(key);
    let mut names = METHODS.into_iter();
    let name = names.find(|name| word("method.name") == Some(name.word()));
    let name = name.unwrap_or_default();
    let preset = match word("method.preset") {
        Some("paper") => Preset::Paper,
        Some("corrected") => Preset::Corrected,
        _ => Preset::Modern,
    };
    let adapted = adapted(tree, name, preset);
    let fragments = adapted.iter().chain(fragments(name, preset));
    let mut full = tree.clone();
    let here = full.root.span();
    if let DeValue::Table(root) = full.root.get_mut()
        && let DeValue::Table(method) = child(root, "method", &here).get_mut()
    {
        // Settings of other methods are checked, but not used.
        let settings = std::mem::take(method).into_iter();
        *method = settings
            .filter(|(key, _)| !is_other(key.get_ref(), name))
            .collect();
        child(method, name.word(), &here);
    }
    for fragment in fragments {
        // A test reads every fragment.
        let table = DeTable::parse(fragment).map(Spanned::into_inner);
        lay(&mut full.root, table.unwrap_or_default(), schema);
    }
    full
}

const METHODS: [MethodName; 3] = [MethodName::Wcsph, MethodName::Isph, MethodName::Mps];

fn is_other(key: &str, name: MethodName) -> bool {
    key != name.word() && METHODS.iter().any(|method| key == method.word())
}

/// Changes of a preset that the user's settings require.
fn adapted(tree: &Tree<'_>, name: MethodName, preset: Preset) -> Option<&'static str> {
    let form = tree.text_at("effects.tension.form");
    let is_modern = preset == Preset::Modern;
    let is_axial = tree.text_at("box.symmetry") == Some("axis");
    match form {
        // Rings have no other gradient and no other form.
        None | Some("surface-energy") if is_modern && is_axial => transposed(name),
        Some("surface-energy") => transposed(name),
        None if is_modern && !bears_energy(tree, name) => Some(RAW_COLOUR),
        None if is_modern && tree.get("effects.tension").is_some() => transposed(name),
        _ => {
            // Young's force requires the stress.
            let wets = tree.get("effects.wetting").is_some();
            let is_counted = name == MethodName::Mps && preset == Preset::Corrected;
            (wets && is_counted).then_some(STRESS)
        }
    }
}

/// The gradient of the pressure that derives from an energy too.
fn transposed(name: MethodName) -> Option<&'static str> {
    match name {
        MethodName::Wcsph => None,
        MethodName::Isph => Some("method.isph.gradient = \"transposed\""),
        MethodName::Mps => Some("method.mps.gradient = \"transposed\""),
    }
}

/// Whether `modern` has a tension that is the derivative of an energy with the user's settings:
/// Wendland's kernel, dual stepping and a density from its rate, or the pressure equation of a
/// transposed gradient.
fn bears_energy(tree: &Tree<'_>, name: MethodName) -> bool {
    let is = |key: &str, value: &str| {
        let key = format!("method.{}.{key}", name.word());
        tree.get(&key).is_none() || tree.text_at(&key) == Some(value)
    };
    let has = |table: &str, key: &str| {
        let table = format!("method.{}.{table}", name.word());
        tree.get(&table).is_none() || tree.get(&format!("{table}.{key}")).is_some()
    };
    match name {
        MethodName::Wcsph => {
            let is_controlled = tree.text_at("method.wcsph.pressure") == Some("controlled");
            let has_rate = has("time_stepping", "dual") && has("density", "continuity");
            let sees = is("kernel", "wendland-c2") && is("wall_pressure", "extrapolated");
            has_rate && sees && !is_controlled
        }
        MethodName::Isph | MethodName::Mps => {
            let words = [
                ("kernel", "wendland-c2"),
                ("gradient", "transposed"),
                ("closure", "completed"),
                ("pressure", "signed"),
            ];
            words.into_iter().all(|(key, value)| is(key, value)) && has("source", "divergence")
        }
    }
}

/// Adds the missing keys of a table from a fragment.
fn lay<'a>(under: &mut Value<'a>, fragment: DeTable<'a>, schema: &serde_json::Value) {
    let DeValue::Table(table) = under.get_mut() else {
        return;
    };
    for (key, value) in fragment {
        let Some(schema) = property(schema, key.get_ref()) else {
            continue;
        };
        let is_plain = schema["type"] == "object";
        match (value.into_inner(), table.get_mut(&key)) {
            (DeValue::Table(inner), Some(under)) if is_plain => lay(under, inner, schema),
            (DeValue::Table(_), None) if is_plain => {}
            (_, Some(_)) => {}
            (value, None) => {
                table.insert(key, Spanned::new(0..0, value));
            }
        }
    }
}
