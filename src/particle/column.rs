//! Columns: what is kept for each particle, declared once.
//!
//! A struct made by [`columns!`](crate::columns) names each of its arrays with a [`Role`]. Sorting,
//! removal, reflection, rollback, checkpoints, restart and memory are [`Visitor`]s of that
//! declaration. An empty column is absent: it costs nothing and is in no checkpoint.

use super::State;
pub use super::scalar::{Scalar, Scalars};
use crate::space::room::make_room;
use crate::space::sort::Cells;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::any::Any;
use std::mem::size_of;

/// What is done with a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// In checkpoints, under this name; follows its particle; rolled back with a rejected step.
    Persistent(&'static str),
    /// Follows its particle; rolled back with a rejected step.
    RolledBack,
    /// Follows its particle.
    Held,
    /// Of no use after particles were sorted.
    Scratch,
}

/// A value of a column.
pub trait Entry: Copy + Default + Send + Sync + Serialize + DeserializeOwned + 'static {
    /// What its parts add to the name of a persistent column.
    const PARTS: &'static [&'static str] = &[];
    /// Part `k`, as checkpoints hold it.
    fn part(&self, _k: usize) -> f64 {
        0.0
    }
    /// Sets part `k`.
    fn set_part(&mut self, _k: usize, _value: f64) {}
    /// Turns it round behind a mirror plane across `axis`.
    fn reflect(&mut self, _axis: usize) {}
    /// Goes a `part` of the way to another value, if there is anything between the two.
    fn blend(&mut self, _other: Self, _part: f64) {}
}

macro_rules! numbers {
    ($($number:ty $(, $blend:ident)?;)*) => { $(
        impl Entry for $number {
            const PARTS: &'static [&'static str] = &[""];
            fn part(&self, _: usize) -> f64 {
                *self as f64
            }
            fn set_part(&mut self, _: usize, value: f64) {
                *self = value as $number;
            }
            $(fn $blend(&mut self, other: Self, part: f64) {
                *self += part as $number * (other - *self);
            })?
        }
    )* };
}
numbers!(f64, blend; f32, blend; u32; u8;);

impl Entry for bool {}

impl Entry for [f32; 3] {
    const PARTS: &'static [&'static str] = &["_x", "_y", "_z"];
    fn part(&self, k: usize) -> f64 {
        self[k] as f64
    }
    fn set_part(&mut self, k: usize, value: f64) {
        self[k] = value as f32;
    }
    fn reflect(&mut self, axis: usize) {
        self[axis] = -self[axis];
    }
    fn blend(&mut self, other: Self, part: f64) {
        (0..3).for_each(|a| self[a].blend(other[a], part));
    }
}

/// What is done with all columns of a struct.
pub trait Visitor {
    /// Called with each column.
    fn visit<T: Entry>(&mut self, role: Role, column: &mut Vec<T>);
}

/// What looks at all columns of a struct.
pub trait Viewer {
    /// Called with each column.
    #[expect(clippy::ptr_arg, reason = "its room is memory, too")]
    fn view<T: Entry>(&mut self, role: Role, column: &Vec<T>);
}

/// Arrays of one entry a particle, and their roles.
pub trait Columns {
    /// Shows each column to a visitor.
    fn visit(&mut self, visitor: &mut impl Visitor);
    /// Shows each column to a viewer.
    fn view(&self, viewer: &mut impl Viewer);
}

/// Declares a struct of columns, `field: entry => role`. A role may read the struct as `this`, and
/// fields after `with` are no columns.
#[macro_export]
macro_rules! columns {
    (
        $(#[$about:meta])*
        $visible:vis struct $name:ident $(<$generic:ident>)? as $this:ident {
            $($(#[$doc:meta])* $see:vis $field:ident: $entry:ty => $role:expr,)*
        }
        $(with { $($(#[$note:meta])* $show:vis $extra:ident: $kind:ty,)* })?
    ) => {
        $(#[$about])*
        $visible struct $name $(<$generic: $crate::particle::column::Entry>)? {
            $($(#[$doc])* $see $field: Vec<$entry>,)*
            $($($(#[$note])* $show $extra: $kind,)*)?
        }

        impl $(<$generic: $crate::particle::column::Entry>)? $crate::particle::column::Columns
            for $name $(<$generic>)?
        {
            fn visit(&mut self, visitor: &mut impl $crate::particle::column::Visitor) {
                $(
                    let role = {
                        let $this = &*self;
                        let _ = $this;
                        $role
                    };
                    visitor.visit(role, &mut self.$field);
                )*
            }

            fn view(&self, viewer: &mut impl $crate::particle::column::Viewer) {
                let $this = self;
                $(viewer.view($role, &$this.$field);)*
            }
        }
    };
}

type Array = Box<dyn Any + Send + Sync>;

/// Bytes of an array of `T`.
fn bytes<T: Entry>(array: &Array) -> usize {
    let array = array.downcast_ref::<Vec<T>>();
    array.map_or(0, |array| size_of::<T>() * array.capacity())
}

/// Arrays of any type, each with what counts its bytes.
type Arrays = Vec<(Array, fn(&Array) -> usize)>;

/// Room for one array of each type, so that a sort allocates nothing.
#[derive(Default)]
pub struct Spare(Arrays);

impl Spare {
    fn of<T: Entry>(&mut self) -> &mut Vec<T> {
        let known = self.0.iter().position(|(each, _)| each.is::<Vec<T>>());
        let index = known.unwrap_or_else(|| {
            self.0.push((Box::new(Vec::<T>::new()), bytes::<T>));
            self.0.len() - 1
        });
        let found = self.0[index].0.downcast_mut();
        found.expect("the type that was looked for")
    }

    /// Bytes held.
    pub fn memory(&self) -> usize {
        self.0.iter().map(|(array, bytes)| bytes(array)).sum()
    }
}

/// Puts columns into the order of the last sort of `cells`.
pub struct Sort<'a> {
    /// Which hold the order.
    pub cells: &'a Cells,
    /// Room.
    pub spare: &'a mut Spare,
}

impl Visitor for Sort<'_> {
    fn visit<T: Entry>(&mut self, role: Role, column: &mut Vec<T>) {
        if role != Role::Scratch && !column.is_empty() {
            self.cells.permute(column, self.spare.of());
        }
    }
}

/// Keeps the entries of these particles, in this order.
pub struct Retain<'a>(pub &'a [u32]);

impl Visitor for Retain<'_> {
    fn visit<T: Entry>(&mut self, role: Role, column: &mut Vec<T>) {
        if role == Role::Scratch || column.is_empty() {
            return;
        }
        for (new, &old) in self.0.iter().enumerate() {
            column[new] = column[old as usize];
        }
        column.truncate(self.0.len());
    }
}

/// Adds a copy of each of these particles behind all.
pub struct Duplicate<'a>(pub &'a [u32]);

impl Visitor for Duplicate<'_> {
    fn visit<T: Entry>(&mut self, role: Role, column: &mut Vec<T>) {
        if role == Role::Scratch || column.is_empty() {
            return;
        }
        for &i in self.0 {
            column.push(column[i as usize]);
        }
    }
}

/// Takes particle `i` a `part` of the way to particle `j`.
pub struct Blend {
    /// The one that changes.
    pub i: usize,
    /// The one that is left as it is.
    pub j: usize,
    /// Between 0 and 1.
    pub part: f64,
}

impl Visitor for Blend {
    fn visit<T: Entry>(&mut self, role: Role, column: &mut Vec<T>) {
        if role != Role::Scratch && !column.is_empty() {
            let other = column[self.j];
            column[self.i].blend(other, self.part);
        }
    }
}

/// Turns vectors of particles that were reflected: particle and axis.
pub struct Reflect<'a>(pub &'a [(u32, u8)]);

impl Visitor for Reflect<'_> {
    fn visit<T: Entry>(&mut self, role: Role, column: &mut Vec<T>) {
        if role == Role::Scratch || column.is_empty() {
            return;
        }
        for &(i, axis) in self.0 {
            column[i as usize].reflect(axis as usize);
        }
    }
}

/// Copies of what is rolled back.
#[derive(Default)]
pub struct Rollback(Arrays);

impl Rollback {
    /// Bytes held.
    pub fn memory(&self) -> usize {
        self.0.iter().map(|(array, bytes)| bytes(array)).sum()
    }

    /// Copies the columns of `of` that are rolled back.
    pub fn remember(&mut self, of: &impl Columns) {
        of.view(&mut Remember {
            kept: &mut self.0,
            next: 0,
        });
    }

    /// Gives `to` what it had when it was remembered.
    pub fn restore(&self, to: &mut impl Columns) {
        to.visit(&mut Restore {
            kept: &self.0,
            next: 0,
        });
    }
}

fn is_rolled_back(role: Role) -> bool {
    matches!(role, Role::Persistent(_) | Role::RolledBack)
}

struct Remember<'a> {
    kept: &'a mut Arrays,
    next: usize,
}

impl Viewer for Remember<'_> {
    fn view<T: Entry>(&mut self, role: Role, column: &Vec<T>) {
        if !is_rolled_back(role) {
            return;
        }
        if self.next == self.kept.len() {
            self.kept.push((Box::new(Vec::<T>::new()), bytes::<T>));
        }
        let copy = self.kept[self.next].0.downcast_mut::<Vec<T>>();
        let copy = copy.expect("columns in the order of before");
        copy.clear();
        make_room(copy, column.len());
        copy.extend_from_slice(column);
        self.next += 1;
    }
}

struct Restore<'a> {
    kept: &'a Arrays,
    next: usize,
}

impl Visitor for Restore<'_> {
    fn visit<T: Entry>(&mut self, role: Role, column: &mut Vec<T>) {
        if !is_rolled_back(role) {
            return;
        }
        let copy = self.kept[self.next].0.downcast_ref::<Vec<T>>();
        column.clone_from(copy.expect("columns in the order of before"));
        self.next += 1;
    }
}

/// Writes persistent columns into a state.
pub struct Save<'a>(pub &'a mut State);

impl Viewer for Save<'_> {
    fn view<T: Entry>(&mut self, role: Role, column: &Vec<T>) {
        let Role::Persistent(name) = role else {
            return;
        };
        if column.is_empty() {
            return;
        }
        for (k, part) in T::PARTS.iter().enumerate() {
            let values = column.iter().map(|entry| entry.part(k)).collect();
            self.0.arrays.push((format!("{name}{part}"), values));
        }
    }
}

/// Reads persistent columns from a state; those that it lacks stay as they are.
pub struct Load<'a>(pub &'a State);

impl Visitor for Load<'_> {
    fn visit<T: Entry>(&mut self, role: Role, column: &mut Vec<T>) {
        let Role::Persistent(name) = role else {
            return;
        };
        for (k, part) in T::PARTS.iter().enumerate() {
            let whole = format!("{name}{part}");
            let found = self.0.arrays.iter().find(|array| array.0 == whole);
            let Some((_, values)) = found else {
                return;
            };
            column.resize(values.len(), T::default());
            let pairs = column.iter_mut().zip(values);
            pairs.for_each(|(entry, value)| entry.set_part(k, *value));
        }
    }
}

/// Counts the bytes held.
#[derive(Default)]
pub struct Memory {
    /// So far.
    pub bytes: usize,
}

impl Viewer for Memory {
    fn view<T: Entry>(&mut self, _: Role, column: &Vec<T>) {
        self.bytes += size_of::<T>() * column.capacity();
    }
}
