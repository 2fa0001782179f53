//! What points carry beside their place: numbers with names, so that a pass reads what was packed.

use crate::space::lane::Record;
use std::any::{TypeId, type_name};
use std::ops::Deref;

/// Most numbers of a payload; a record holds one less.
pub const WORDS: usize = 6;

/// Most numbers of the payload of a record.
pub(super) const IN_RECORD: usize = 5;

/// The named numbers that a point carries: a struct that [`payload!`](crate::payload) declares, or
/// `()` for none.
pub trait Payload: Fields<f32> + Default + Send + Sync + 'static {
    /// The same fields of other numbers, as those of eight lanes.
    type Of<F: Copy>: Fields<F>;
    /// The numbers one after the other, then zeros.
    fn to_words(self) -> [f32; WORDS];
}

/// Fields of numbers `F`.
pub trait Fields<F>: Copy {
    /// How many numbers each field has: 1, or 3 if it is a vector.
    const SIZES: &'static [usize];
    /// The fields from the numbers one after the other.
    fn from_words(words: [F; WORDS]) -> Self;
}

impl Payload for () {
    type Of<F: Copy> = ();
    #[inline(always)]
    fn to_words(self) -> [f32; WORDS] {
        [0.0; WORDS]
    }
}

impl<F> Fields<F> for () {
    const SIZES: &'static [usize] = &[];
    #[inline(always)]
    fn from_words(_: [F; WORDS]) {}
}

/// A field: a number or a vector.
pub trait PayloadField<F> {
    /// How many numbers it has.
    const SIZE: usize;
    /// The next field of `words`.
    fn take(words: &[F; WORDS], next: &mut usize) -> Self;
    /// Makes it the next field of `words`.
    fn put(self, words: &mut [F; WORDS], next: &mut usize);
}

impl<F: Copy> PayloadField<F> for F {
    const SIZE: usize = 1;
    #[inline(always)]
    fn take(words: &[F; WORDS], next: &mut usize) -> Self {
        *next += 1;
        words[*next - 1]
    }
    #[inline(always)]
    fn put(self, words: &mut [F; WORDS], next: &mut usize) {
        words[*next] = self;
        *next += 1;
    }
}

impl<F: Copy> PayloadField<F> for [F; 3] {
    const SIZE: usize = 3;
    #[inline(always)]
    fn take(words: &[F; WORDS], next: &mut usize) -> Self {
        *next += 3;
        [words[*next - 3], words[*next - 2], words[*next - 1]]
    }
    #[inline(always)]
    fn put(self, words: &mut [F; WORDS], next: &mut usize) {
        [words[*next], words[*next + 1], words[*next + 2]] = self;
        *next += 3;
    }
}

/// Declares a [`Payload`]: a struct whose fields, all public, are numbers `F` and vectors `[F; 3]`.
/// Mirror planes turn the vectors. Without `F` it is what is packed.
#[macro_export]
macro_rules! payload {
    ($(#[$about:meta])* $seen:vis struct $name:ident<$number:ident> {
        $($(#[$what:meta])* $field:ident: $kind:ty),+ $(,)?
    }) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        $seen struct $name<$number = f32> {
            $($(#[$what])* pub $field: $kind),+
        }
        impl<$number: Copy> $crate::space::sweep::Fields<$number> for $name<$number> {
            const SIZES: &'static [usize] =
                &[$(<$kind as $crate::space::sweep::PayloadField<$number>>::SIZE),+];
            #[inline(always)]
            fn from_words(words: [$number; $crate::space::sweep::WORDS]) -> Self {
                let next = &mut 0;
                $name { $($field: $crate::space::sweep::PayloadField::take(&words, next)),+ }
            }
        }
        impl $crate::space::sweep::Payload for $name {
            type Of<$number: Copy> = $name<$number>;
            #[inline(always)]
            fn to_words(self) -> [f32; $crate::space::sweep::WORDS] {
                let (mut words, next) = ([0.0; $crate::space::sweep::WORDS], &mut 0);
                $($crate::space::sweep::PayloadField::put(self.$field, &mut words, next);)+
                words
            }
        }
    };
}

/// How many numbers `P` has.
pub(super) const fn count<P: Payload>() -> usize {
    let (mut sum, mut k) = (0, 0);
    while k < P::SIZES.len() {
        sum += P::SIZES[k];
        k += 1;
    }
    sum
}

/// The axis of each word of a record that is a component of a vector.
const fn axes<P: Payload>() -> Axes {
    assert!(
        count::<P>() <= IN_RECORD,
        "a payload too large for a record"
    );
    let (mut axes, mut word, mut field) = ([None; IN_RECORD], 0, 0);
    while field < P::SIZES.len() {
        let mut axis = 0;
        while axis < P::SIZES[field] {
            if P::SIZES[field] == 3 {
                axes[word] = Some(axis);
            }
            (word, axis) = (word + 1, axis + 1);
        }
        field += 1;
    }
    axes
}

/// See [`Records::turning`].
pub(in crate::space) type Axes = [Option<usize>; IN_RECORD];

/// The words of a record that carries `payload`.
#[inline(always)]
pub fn words_of<P: Payload>(payload: P) -> [f32; IN_RECORD] {
    let [a, b, c, d, e, _] = payload.to_words();
    [a, b, c, d, e]
}

/// Records of points, and which payload they carry.
#[derive(Clone, Debug)]
pub struct Records {
    all: Vec<Record>,
    carried: TypeId,
    name: &'static str,
    axes: Axes,
}

impl Default for Records {
    fn default() -> Self {
        Records {
            all: Vec::new(),
            carried: TypeId::of::<()>(),
            name: type_name::<()>(),
            axes: axes::<()>(),
        }
    }
}

impl Deref for Records {
    type Target = [Record];
    fn deref(&self) -> &[Record] {
        &self.all
    }
}

impl Records {
    /// The records, for a caller that makes all of them carry `P`.
    pub fn carry<P: Payload>(&mut self) -> &mut Vec<Record> {
        self.carried = TypeId::of::<P>();
        self.name = type_name::<P>();
        self.axes = const { axes::<P>() };
        &mut self.all
    }

    /// The records, for a caller that takes some from where the same was packed.
    pub(in crate::space) fn all(&mut self) -> &mut [Record] {
        &mut self.all
    }

    /// The records, for a caller that moves them, or changes the payload of some.
    ///
    /// # Panics
    /// If they do not carry `P`.
    pub fn carrying<P: Payload>(&mut self) -> &mut [Record] {
        self.check::<P>();
        &mut self.all
    }

    /// Panics if a pass that reads `P` would read something else.
    pub(in crate::space) fn check<P: Payload>(&self) {
        let alike = P::SIZES.is_empty() || TypeId::of::<P>() == self.carried;
        let (wanted, name) = (type_name::<P>(), self.name);
        assert!(alike, "records carry {name}, not {wanted}");
    }

    /// The records, and what mirror planes do to their words: those with an axis are components of
    /// vectors.
    pub(in crate::space) fn turning(&mut self) -> (&mut [Record], Axes) {
        (&mut self.all, self.axes)
    }

    /// How many there is room for.
    pub fn capacity(&self) -> usize {
        self.all.capacity()
    }
}
