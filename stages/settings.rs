//! What each stage reads, for its key.

use coronet::pipeline::Setting;
use coronet::scene::key;

/// Settings of the scene as the pipeline knows them.
pub fn list(settings: Vec<key::Setting>) -> Vec<Setting> {
    let setting = |setting: key::Setting| Setting {
        name: setting.name,
        shown: setting.value,
        canonical: setting.canonical,
    };
    settings.into_iter().map(setting).collect()
}

/// The number at the end of a setting's canonical bytes, from their hexadecimal form.
pub fn number(canonical: &str) -> Option<f64> {
    let digits = canonical.get(canonical.len().checked_sub(16)?..)?;
    let bits = u64::from_str_radix(digits, 16).ok()?;
    Some(f64::from_bits(bits.swap_bytes()))
}
