//! Images of points behind mirror planes, so that sums over a part are those over the whole.
//!
//! A point within reach of a plane has an image behind it; one that is near two planes has one
//! behind each and one behind both. Images are sorted along cells, as points are. A reflection in
//! fixed point is exact, so both halves of a pair across a plane are equally long.
//! Records: points of two kinds (liquid, then wall), then the images of each kind.
//! Tests: tests/engine/method_mirror.rs, tests/engine/pack_mirror.rs.

use super::grid::Grid;
use super::lane::Record;
use super::parallel::each_mut;
use super::row::Source;
use super::sort::Cells;
use super::sweep::Records;

/// In which planes an image is reflected: two bits an axis, 1 in its low plane, 2 in its high one.
pub type Code = u8;

/// Axes of the components of a symmetric tensor: xx, yy, zz, yz, xz, xy.
pub const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)];

/// Most images of one point, and itself.
const MOST: usize = 27;

/// What becomes of a component along `axis`: 1, or -1 if it is turned.
#[inline(always)]
pub fn sign(code: Code, axis: usize) -> f32 {
    if code >> (2 * axis) & 3 == 0 {
        1.0
    } else {
        -1.0
    }
}

/// Mirror planes.
#[derive(Clone, Debug)]
pub struct Planes {
    /// `place[axis] = [low, high]`, m.
    place: [[Option<f64>; 2]; 3],
    /// Twice the same in fixed point.
    turn: [[i32; 2]; 3],
}

impl Planes {
    /// `place[axis] = [low, high]`, m; `None` if there is no plane at all.
    pub fn new(place: [[Option<f64>; 2]; 3], grid: &Grid) -> Option<Self> {
        let twice = |a: usize, side: usize| match place[a][side] {
            Some(x) => (2.0 * (x - grid.low[a]) / grid.unit[a]).round() as i64 as i32,
            None => 0,
        };
        let any = place.iter().flatten().any(Option::is_some);
        any.then(|| Planes {
            place,
            turn: [0, 1, 2].map(|a| [twice(a, 0), twice(a, 1)]),
        })
    }

    /// The reflection of `x` m if it is beyond a plane of the axis.
    #[inline(always)]
    pub fn back(&self, axis: usize, x: f64) -> Option<f64> {
        let [low, high] = self.place[axis];
        low.filter(|p| x < *p)
            .or(high.filter(|p| x > *p))
            .map(|p| 2.0 * p - x)
    }

    #[inline(always)]
    fn reflect(&self, axis: usize, at: i32, code: Code) -> i32 {
        match code >> (2 * axis) & 3 {
            0 => at,
            side => self.turn[axis][side as usize - 1].wrapping_sub(at),
        }
    }
}

/// Where points are, m.
#[derive(Clone, Copy)]
pub struct Points<'a> {
    /// x, y, z.
    pub position: &'a [Vec<f64>; 3],
    /// The record of each; none if they are the first ones.
    pub index: &'a [u32],
}

impl<'a> Points<'a> {
    /// The first records.
    pub fn of(position: &'a [Vec<f64>; 3]) -> Self {
        Points {
            position,
            index: &[],
        }
    }
}

/// Images of one kind of points, along cells.
#[derive(Clone, Debug, Default)]
pub struct Images {
    /// The cells that they are in.
    pub cells: Cells,
    /// Their points.
    pub source: Vec<u32>,
    /// How they are reflected.
    pub code: Vec<Code>,
    position: [Vec<f64>; 3],
    indices: Vec<u32>,
    codes: Vec<Code>,
}

impl Images {
    /// Finds the images of `points` that are within `reach` m of a plane.
    fn find(&mut self, planes: &Planes, grid: &Grid, points: Points, reach: f64) {
        let position = points.position;
        self.source.clear();
        self.code.clear();
        self.position.iter_mut().for_each(Vec::clear);
        for i in 0..position[0].len() {
            let x = [position[0][i], position[1][i], position[2][i]];
            let (mut codes, mut count) = ([0; MOST], 1);
            for a in 0..3 {
                let known = count;
                for side in 0..2 {
                    let near = planes.place[a][side].is_some_and(|p| (x[a] - p).abs() < reach);
                    for k in 0..if near { known } else { 0 } {
                        codes[count] = codes[k] | (side as Code + 1) << (2 * a);
                        count += 1;
                    }
                }
            }
            for &code in &codes[1..count] {
                self.source
                    .push(points.index.get(i).map_or(i as u32, |&index| index));
                self.code.push(code);
                for a in 0..3 {
                    let image = match code >> (2 * a) & 3 {
                        0 => x[a],
                        side => 2.0 * planes.place[a][side as usize - 1].unwrap_or(0.0) - x[a],
                    };
                    self.position[a].push(image);
                }
            }
        }
        self.cells.sort(grid, &self.position);
        self.cells.permute(&mut self.source, &mut self.indices);
        self.cells.permute(&mut self.code, &mut self.codes);
    }

    /// The number of images.
    pub fn len(&self) -> usize {
        self.source.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.source.is_empty()
    }

    fn memory(&self) -> usize {
        40 * self.source.capacity() + 4 * self.cells.start.capacity()
    }
}

/// The images of liquid and wall.
#[derive(Clone, Debug)]
pub struct Mirror {
    /// Where the planes are.
    pub planes: Planes,
    /// Of the liquid.
    pub liquid: Images,
    /// Of the wall.
    pub wall: Images,
    /// First image record.
    pub first: usize,
    /// Of every image record: the record of its point, and how it is reflected.
    pub source: Vec<u32>,
    /// See `source`.
    pub code: Vec<Code>,
}

impl Mirror {
    /// Without images yet.
    pub fn new(planes: Planes) -> Self {
        Mirror {
            planes,
            liquid: Images::default(),
            wall: Images::default(),
            first: 0,
            source: Vec::new(),
            code: Vec::new(),
        }
    }

    /// Finds all images of points within `reach` m of a plane, which come behind `first` records;
    /// `liquid`: those of the first kind, `n` of which are this rank's own, `wall`: positions, m.
    pub fn find(
        &mut self,
        grid: &Grid,
        (liquid, n): (Points, usize),
        wall: &[Vec<f64>; 3],
        first: usize,
        reach: f64,
    ) {
        self.liquid.find(&self.planes, grid, liquid, reach);
        self.wall.find(&self.planes, grid, Points::of(wall), reach);
        let n = n as u32;
        self.first = first;
        self.source.clear();
        self.source.extend_from_slice(&self.liquid.source);
        self.source.extend(self.wall.source.iter().map(|j| n + j));
        self.code.clear();
        self.code.extend_from_slice(&self.liquid.code);
        self.code.extend_from_slice(&self.wall.code);
    }

    /// Image records.
    pub fn len(&self) -> usize {
        self.source.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.source.is_empty()
    }

    /// Images of the liquid, then of the wall.
    pub fn sources(&self) -> [Source<'_>; 2] {
        let liquid = Source {
            start: &self.liquid.cells.start,
            offset: self.first,
        };
        let wall = Source {
            start: &self.wall.cells.start,
            offset: self.first + self.liquid.len(),
        };
        [liquid, wall]
    }

    /// Fixed-point coordinates of the images from those of the points; `at` holds all records.
    pub fn place(&self, at: &mut [Vec<i32>; 3]) {
        for (a, at) in at.iter_mut().enumerate() {
            let (points, images) = at.split_at_mut(self.first);
            each_mut(&mut images[..self.len()], |k, image| {
                let point = points[self.source[k] as usize];
                *image = self.planes.reflect(a, point, self.code[k]);
            });
        }
    }

    /// Image records from those of the points.
    pub fn copy(&self, records: &mut Records) {
        self.copy_from(records, 0);
    }

    /// The same for the images of the wall alone.
    pub fn copy_wall(&self, records: &mut Records) {
        self.copy_from(records, self.liquid.len());
    }

    fn copy_from(&self, records: &mut Records, from: usize) {
        let (records, axes) = records.turning();
        let (points, images) = records.split_at_mut(self.first);
        let images = &mut images[from..self.len()];
        each_mut(images, |k, image| {
            let (k, code) = (from + k, self.code[from + k]);
            let point = &points[self.source[k] as usize];
            let at = [0, 1, 2].map(|a| self.planes.reflect(a, point.at(a), code));
            let payload = [0, 1, 2, 3, 4].map(|c| match axes[c] {
                Some(axis) => sign(code, axis) * point.payload(c),
                None => point.payload(c),
            });
            *image = Record::new(at, payload);
        });
    }

    /// Words of the images from those of the points: the components of a vector.
    pub fn turn(&self, words: &mut [Vec<f32>; 3]) {
        for (a, words) in words.iter_mut().enumerate() {
            self.spread(words, |code| sign(code, a));
        }
    }

    /// The same for a scalar.
    pub fn share(&self, words: &mut [f32]) {
        self.spread(words, |_| 1.0);
    }

    fn spread(&self, words: &mut [f32], sign: impl Fn(Code) -> f32 + Sync) {
        let (points, images) = words.split_at_mut(self.first);
        each_mut(&mut images[..self.len()], |k, image| {
            let point = points[self.source[k] as usize];
            *image = sign(self.code[k]) * point;
        });
    }

    /// Bytes held.
    pub fn memory(&self) -> usize {
        self.liquid.memory() + self.wall.memory() + 5 * self.source.capacity()
    }
}

/// What becomes of component `c` (xx, yy, zz, yz, xz, xy) of a symmetric tensor.
#[inline(always)]
pub fn sign_of_tensor(code: Code, c: usize) -> f32 {
    let (a, b) = PAIRS[c];
    sign(code, a) * sign(code, b)
}
