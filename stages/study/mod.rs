//! Studies: tables of runs over one store, with figures, promises and plots.

pub mod columns;
pub mod copies;
pub mod cost;
pub mod doubt;
pub mod figures;
pub mod finding;
pub mod origin;
pub mod page;
pub mod points;
pub mod promise;
pub mod target;
pub mod trial;
pub mod verdict;
