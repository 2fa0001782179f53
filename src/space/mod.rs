//! Where things are: fixed-point coordinates, cells, neighbour rows, lanes.
//!
//! Reading order: [`grid`] (fixed-point positions and cells), [`sort`] (particles along cells),
//! [`column`] (cells about a point), [`dilate`] (largest values about a cell), [`component`]
//! (bodies that no pair connects), [`eights`] (packed indices), [`row`] (neighbour lists),
//! [`sweep`] (pair sums over lists or over cell runs), [`mirror`] (images of points), [`ranks`]
//! (several processes), [`lane`].

pub mod column;
pub mod component;
pub mod dilate;
pub mod eights;
pub mod grid;
pub mod lane;
pub mod larger;
pub mod mirror;
pub mod parallel;
pub mod ranks;
pub mod room;
pub mod row;
pub mod sort;
pub mod sparse;
pub mod sweep;
