//! Lists of indices in groups of eight, of neighbours that lie together in memory: 20 bytes for a
//! group, the least index and what the eight are beyond it, in place of 32. Few groups are wider;
//! those are kept as they are.
//! Tests: tests/engine/space_eights.rs.

use super::lane::WIDTH;
use super::room::make_room;
use std::ops::Range;

/// [`Packed::base`] of a group that is among the wide ones.
const WIDE: u32 = u32::MAX;

/// A group: index k is `base + beyond[k]`. Of a wide one, `beyond` begins with the halves of its
/// place among those.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Packed {
    base: u32,
    beyond: [u16; WIDTH],
}

/// What a group is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Group<'a> {
    /// What all indices are beyond, and by how much.
    Near(u32, &'a [u16; WIDTH]),
    /// The indices.
    Wide(&'a [u32; WIDTH]),
}

/// See the [module](self).
#[derive(Clone, Debug, Default)]
pub struct Eights {
    packed: Vec<Packed>,
    wide: Vec<[u32; WIDTH]>,
}

/// Some groups of [`Eights`].
#[derive(Clone, Copy, Debug)]
pub struct Groups<'a> {
    /// See [`Groups::open`].
    pub packed: &'a [Packed],
    wide: &'a [[u32; WIDTH]],
}

impl Eights {
    /// Removes all groups, and keeps the memory.
    pub fn clear(&mut self) {
        self.packed.clear();
        self.wide.clear();
    }

    /// Number of groups.
    pub fn len(&self) -> usize {
        self.packed.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.packed.is_empty()
    }

    /// Bytes held.
    pub fn memory(&self) -> usize {
        self.packed.capacity() * size_of::<Packed>() + self.wide.capacity() * 4 * WIDTH
    }

    /// Appends whole groups.
    #[inline(always)]
    pub fn extend(&mut self, indices: &[u32]) {
        let groups = indices.as_chunks::<WIDTH>().0;
        make_room(&mut self.packed, groups.len());
        for group in groups {
            let (mut low, mut high) = (u32::MAX, 0);
            for &index in group {
                (low, high) = (low.min(index), high.max(index));
            }
            let packed = match high - low <= u16::MAX as u32 {
                true => Packed {
                    base: low,
                    beyond: group.map(|index| (index - low) as u16),
                },
                false => self.widen(*group),
            };
            self.packed.push(packed);
        }
    }

    #[cold]
    fn widen(&mut self, group: [u32; WIDTH]) -> Packed {
        let place = self.wide.len() as u32;
        self.wide.push(group);
        let mut beyond = [0; WIDTH];
        (beyond[0], beyond[1]) = (place as u16, (place >> 16) as u16);
        Packed { base: WIDE, beyond }
    }

    /// Those of a range.
    #[inline(always)]
    pub fn groups(&self, range: Range<usize>) -> Groups<'_> {
        Groups {
            packed: &self.packed[range],
            wide: &self.wide,
        }
    }
}

impl<'a> Groups<'a> {
    /// Number of groups.
    pub fn len(&self) -> usize {
        self.packed.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.packed.is_empty()
    }

    /// What one of the groups is made of.
    #[inline(always)]
    pub fn open(&self, packed: &'a Packed) -> Group<'a> {
        let Packed { base, beyond } = packed;
        match *base {
            WIDE => Group::Wide(&self.wide[beyond[0] as usize | (beyond[1] as usize) << 16]),
            base => Group::Near(base, beyond),
        }
    }

    /// The groups, so many at a time.
    #[inline(always)]
    pub fn chunks(self, count: usize) -> impl Iterator<Item = Groups<'a>> {
        let wide = self.wide;
        let chunks = self.packed.chunks(count);
        chunks.map(move |packed| Groups { packed, wide })
    }

    /// The indices of one of the groups.
    #[inline(always)]
    pub fn eight(&self, packed: &'a Packed) -> [u32; WIDTH] {
        match self.open(packed) {
            Group::Near(base, beyond) => beyond.map(|beyond| base + u32::from(beyond)),
            Group::Wide(indices) => *indices,
        }
    }

    /// All indices.
    pub fn indices(self) -> impl Iterator<Item = usize> {
        let eight = move |packed| self.eight(packed).map(|index| index as usize);
        self.packed.iter().flat_map(eight)
    }
}
