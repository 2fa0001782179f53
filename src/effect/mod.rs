//! One physical effect a file. An absent effect is the type `()` or is not built at all.

pub mod band;
pub mod depth;
pub mod gravity;
pub mod normal;
pub mod select;
pub mod surface;
pub mod tension;
pub mod viscosity;
pub mod wetting;
