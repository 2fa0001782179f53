//! Numbers that a restart needs beside the columns, declared once.

use super::State;

/// A number of a state, by name.
pub trait Scalar {
    /// `None`: there is none, and none is written.
    fn get(&self) -> Option<f64>;
    /// Takes the value of a state.
    fn set(&mut self, value: f64);
}

macro_rules! scalars {
    ($($number:ty)*) => { $(
        impl Scalar for $number {
            fn get(&self) -> Option<f64> {
                Some(*self as f64)
            }
            fn set(&mut self, value: f64) {
                *self = value as $number;
            }
        }
    )* };
}
scalars!(f64 u64 u32 usize);

impl Scalar for Option<f64> {
    fn get(&self) -> Option<f64> {
        *self
    }
    fn set(&mut self, value: f64) {
        *self = Some(value);
    }
}

/// Numbers that a restart needs, declared once.
pub trait Scalars: Clone {
    /// Shows each with its name in checkpoints.
    fn scalars(&mut self, see: &mut dyn FnMut(&'static str, &mut dyn Scalar));

    /// Writes them into a state.
    fn save(&self, state: &mut State) {
        self.clone().scalars(&mut |name, scalar| {
            let value = scalar.get().map(|value| (name.to_string(), value));
            state.scalars.extend(value);
        });
    }

    /// Reads them from a state; those that it lacks stay as they are.
    fn load(&mut self, state: &State) {
        self.scalars(&mut |name, scalar| {
            if let Some((_, value)) = state.scalars.iter().find(|each| each.0 == name) {
                scalar.set(*value);
            }
        });
    }
}
