//! What lanes are filled from.

/// One neighbour record: fixed-point x, y, z, then five f32 payloads, as bits. 32 bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C, align(32))]
pub struct Record(pub [u32; 8]);

impl Record {
    /// Fixed-point coordinates and five payloads.
    #[inline(always)]
    pub fn new(at: [i32; 3], payload: [f32; 5]) -> Self {
        let ([x, y, z], [a, b, c, d, e]) = (at, carried_all(payload));
        Record([x as u32, y as u32, z as u32, a, b, c, d, e])
    }

    /// Changes the payloads.
    #[inline(always)]
    pub fn carry(&mut self, payload: [f32; 5]) {
        self.0[3..].copy_from_slice(&carried_all(payload));
    }

    /// Fixed-point coordinate of one axis.
    #[inline(always)]
    pub fn at(&self, axis: usize) -> i32 {
        self.0[axis] as i32
    }

    /// Payload `k` (0..5).
    #[inline(always)]
    pub fn payload(&self, k: usize) -> f32 {
        f32::from_bits(self.0[3 + k])
    }
}

/// Payloads below this are carried as zero, so that products of two are no subnormal numbers: where
/// a lattice at rest feels a far disturbance, velocities fall off to 1e-45 m/s, and processors take
/// some 150 cycles for each such product.
const FAINT: f32 = 1e-18;

/// The bits of a payload.
#[inline(always)]
fn carried(x: f32) -> u32 {
    if x.abs() < FAINT { 0 } else { x.to_bits() }
}

/// Written out: `map` of five is no longer inlined.
#[inline(always)]
fn carried_all([a, b, c, d, e]: [f32; 5]) -> [u32; 5] {
    [carried(a), carried(b), carried(c), carried(d), carried(e)]
}

/// A point and one word of it: fixed-point x, y, z, then an f32, as bits. 16 bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C, align(16))]
pub struct Half(pub [u32; 4]);
