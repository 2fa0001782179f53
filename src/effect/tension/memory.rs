//! What the tension holds.

use super::{Tension, Wetting};

impl Tension {
    /// Bytes held.
    pub fn memory(&self) -> usize {
        let lines = [&self.lines, &self.feet];
        let indices = [&self.near, &self.reached];
        let indices = indices.iter().chain(&lines);
        4 * indices.map(|list| list.capacity()).sum::<usize>()
            + std::mem::size_of::<super::level::Bend>() * self.bends.capacity()
            + 24 * self.stressed.stress[0].capacity()
            + 12 * self.force.capacity()
            + 24 * self.normals.capacity()
            + 12 * self.payload[0].capacity()
            + 24 * self.stressed.u[0].capacity()
            + 4 * (self.stressed.index.capacity()
                + self.scalars.capacity()
                + self.stressed.start.capacity())
            + self.stressed.images.memory()
            + self.counted.memory()
            + self.energy.memory()
            + self.kept.memory()
            + 8 * self.typed.as_ref().map_or(0, |typed| typed.here.capacity())
            + self.band.memory()
            + self.wetting.as_ref().map_or(0, Wetting::memory)
    }
}
