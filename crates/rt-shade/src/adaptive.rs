//! Adaptive anti-aliasing: pixels are split into quadrants while their corners differ.
//!
//! The cells of level 0 are the pixels; a cell that splits has four children of half its edge. A cell wants to split
//! when two of its corners differ by more than the threshold. At levels 0 and 1 it splits when it or any of its eight neighbours
//! of the same level wants to: corners alone stall where they happen to be equal, at a horizon or on a fine pattern. From level
//! 2 on it splits when it wants to itself, in pixels crossed by a plain edge: there each level halves the error, while a
//! pattern finer than the pixel is averaged only as fast as by any other samples. A leaf counts as the mean of its corners,
//! weighted by its area. Corners are shared. (Whitted 1980, doi:10.1145/358876.358882, with the neighbours and the
//! edges added.)
//!
//! Measured against 4 x 4 samples with threshold 0.05: depth 2 has 1.24 times its error on the family; depth 3 for all
//! pixels takes 1.2 to 1.4 times its rays on patterns and balls; without neighbours at level 1 the checker plane has 1.18 times
//! its error; as it is, 0.84 to 0.94 times its error on four scenes.
//!
//! All of this is a function of the colours at the corners alone, so that a pixel has the same bits in whatever tile it is
//! drawn. A tile looks at most two pixels beyond its border, and only where a cell there decides one inside: a cell of level
//! `l` asks its neighbours, whose existence is asked of their parents' neighbours, and `1 + 1/2 + 1/4 + .. < 2`.

use crate::sample::in_squares;
use crate::whitted::Tracer;
use crate::{Camera, Color, Region, Settings};
use rt_core::{Found, Interval, Ray};

/// How far a tile looks beyond its border, in pixels.
const HALO: u32 = 2;

/// Below this level cells split with their neighbours; from it on alone, and only in pixels with an edge.
const COARSE: u32 = 2;

/// The most of the 16 cells of level 2 that want to split in a pixel that has an edge and no pattern.
///
/// A straight line crosses 7 of them at most; 6 leaves out the fewest of the edges and most of the patterns.
const EDGE_CELLS: u32 = 6;

/// Rays that are cast in one piece. Only time and memory depend on it.
const BATCH: usize = 1024;

/// The tile's edge: a large one shares more corners, but the finest raster must stay small (a few MB).
pub(crate) fn tile_edge(depth: u32) -> u32 {
    (512 >> depth).clamp(16, 64)
}

/// The buffers of one thread.
#[derive(Debug, Default)]
pub(crate) struct Buffers {
    /// Colours at the points of the finest raster; NaN where none was traced.
    samples: Vec<[f32; 3]>,
    /// By level: what is known of each cell.
    cells: Vec<Vec<Known>>,
    /// By pixel: whether it has an edge.
    edges: Vec<Known>,
    /// Rays to be traced together, the indices of their samples, and what is known of them.
    waiting: Vec<usize>,
    rays: Vec<Ray>,
    within: Vec<Interval>,
    found: Vec<Option<Found>>,
    colors: Vec<Color>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Known {
    Nothing,
    Splits,
    IsLeaf,
}

struct Pixels<'a, 's> {
    tracer: &'a mut Tracer<'s>,
    buffers: &'a mut Buffers,
    camera: &'a Camera,
    width: u32,
    height: u32,
    threshold: f32,
    depth: u32,
    /// The pixels that may be looked at: the tile and its halo, within the picture.
    view: Region,
    /// Points of the finest raster in a row.
    stride: usize,
}

/// The colours of the pixels of `tile`, row by row.
pub(crate) fn tile(
    tracer: &mut Tracer,
    buffers: &mut Buffers,
    camera: &Camera,
    settings: &Settings,
    (threshold, depth): (f64, u32),
    tile: Region,
    out: &mut Vec<[f32; 3]>,
) {
    let (width, height) = (settings.width, settings.height);
    let (left, top) = (tile.x.saturating_sub(HALO), tile.y.saturating_sub(HALO));
    let right = (tile.x + tile.width + HALO).min(width);
    let bottom = (tile.y + tile.height + HALO).min(height);
    let view = Region { x: left, y: top, width: right - left, height: bottom - top };
    let (columns, rows) = ((view.width as usize) << depth, (view.height as usize) << depth);
    buffers.samples.clear();
    buffers.samples.resize((columns + 1) * (rows + 1), [f32::NAN; 3]);
    buffers.cells.resize_with(depth as usize, Vec::new);
    for (level, cells) in buffers.cells.iter_mut().enumerate() {
        cells.clear();
        cells.resize(((view.width as usize) << level) * ((view.height as usize) << level), Known::Nothing);
    }
    buffers.edges.clear();
    buffers.edges.resize(view.width as usize * view.height as usize, Known::Nothing);
    let threshold = threshold as f32;
    let stride = columns + 1;
    let mut pixels = Pixels { tracer, buffers, camera, width, height, threshold, depth, view, stride };
    pixels.prepare(tile);
    out.clear();
    for y in tile.y - view.y..tile.y - view.y + tile.height {
        for x in tile.x - view.x..tile.x - view.x + tile.width {
            out.push(pixels.value(Cell { level: 0, x, y }).to_f32());
        }
    }
}

/// A cell: `x` and `y` count cells of its level from the corner of the view.
#[derive(Clone, Copy, Debug)]
struct Cell {
    level: u32,
    x: u32,
    y: u32,
}

impl Cell {
    fn quadrants(self) -> [Cell; 4] {
        [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(i, j)| Cell {
            level: self.level + 1,
            x: 2 * self.x + i,
            y: 2 * self.y + j,
        })
    }
}

impl Pixels<'_, '_> {
    /// Traces what the pixels of the tile need, level by level: many rays together, neighbours side by side.
    fn prepare(&mut self, tile: Region) {
        let (left, top) = (tile.x - self.view.x, tile.y - self.view.y);
        let mut cells = Vec::with_capacity(tile.width as usize * tile.height as usize);
        in_squares(tile.width, 0..tile.height, |x, y| {
            cells.push(Cell { level: 0, x: left + x, y: top + y });
        });
        self.trace(cells.iter().flat_map(|cell| self.points(*cell, 1)).collect::<Vec<_>>());
        let mut parts = Vec::new();
        for _ in 0..self.depth {
            parts.clear();
            let mut points = Vec::new();
            for &cell in &cells {
                if self.splits(cell) {
                    points.extend(self.points(cell, 2));
                    parts.extend(cell.quadrants());
                }
            }
            self.trace(points);
            core::mem::swap(&mut cells, &mut parts);
        }
    }

    /// The corners of the `n` x `n` parts of a cell.
    fn points(&self, cell: Cell, n: u32) -> impl Iterator<Item = (u32, u32)> + use<> {
        let shift = self.depth - cell.level - (n - 1);
        (0..(n + 1) * (n + 1))
            .map(move |i| ((n * cell.x + i % (n + 1)) << shift, (n * cell.y + i / (n + 1)) << shift))
    }

    /// The mean colour of a cell.
    fn value(&mut self, cell: Cell) -> Color {
        let mut sum = Color::BLACK;
        if self.splits(cell) {
            for part in cell.quadrants() {
                sum += self.value(part);
            }
        } else {
            for corner in self.corners(cell) {
                sum += corner.into();
            }
        }
        sum * 0.25
    }

    /// Whether a cell that exists is split.
    fn splits(&mut self, cell: Cell) -> bool {
        if cell.level == self.depth {
            return false;
        }
        let index = self.index(cell);
        match self.buffers.cells[cell.level as usize][index] {
            Known::Splits => return true,
            Known::IsLeaf => return false,
            Known::Nothing => {}
        }
        let splits = if cell.level < COARSE {
            self.wants(cell) || self.has_neighbour_that_wants(cell)
        } else {
            self.wants(cell) && self.pixel_has_an_edge(cell)
        };
        self.buffers.cells[cell.level as usize][index] = if splits { Known::Splits } else { Known::IsLeaf };
        splits
    }

    fn has_neighbour_that_wants(&mut self, cell: Cell) -> bool {
        let (columns, rows) = (self.view.width << cell.level, self.view.height << cell.level);
        for y in cell.y.saturating_sub(1)..(cell.y + 2).min(rows) {
            for x in cell.x.saturating_sub(1)..(cell.x + 2).min(columns) {
                let neighbour = Cell { level: cell.level, x, y };
                if (x, y) != (cell.x, cell.y) && self.exists(neighbour) && self.wants(neighbour) {
                    return true;
                }
            }
        }
        false
    }

    /// Whether a plain edge crosses the pixel of this cell: few of its cells of level 2 want to split.
    fn pixel_has_an_edge(&mut self, cell: Cell) -> bool {
        let (x, y) = (cell.x >> cell.level, cell.y >> cell.level);
        let index = (y * self.view.width + x) as usize;
        match self.buffers.edges[index] {
            Known::Splits => return true,
            Known::IsLeaf => return false,
            Known::Nothing => {}
        }
        let mut wanting = 0;
        for i in 0..1 << COARSE {
            for j in 0..1 << COARSE {
                let part = Cell { level: COARSE, x: (x << COARSE) + j, y: (y << COARSE) + i };
                wanting += u32::from(self.exists(part) && self.wants(part));
            }
        }
        let edge = wanting <= EDGE_CELLS;
        self.buffers.edges[index] = if edge { Known::Splits } else { Known::IsLeaf };
        edge
    }

    fn exists(&mut self, cell: Cell) -> bool {
        cell.level == 0 || self.splits(Cell { level: cell.level - 1, x: cell.x / 2, y: cell.y / 2 })
    }

    /// Whether the corners differ by more than the threshold in a channel.
    fn wants(&mut self, cell: Cell) -> bool {
        let corners = self.corners(cell);
        (0..3).any(|channel| {
            let (mut least, mut most) = (f32::INFINITY, f32::NEG_INFINITY);
            for corner in &corners {
                let v = tone(corner[channel]);
                least = least.min(v);
                most = most.max(v);
            }
            most - least > self.threshold
        })
    }

    fn corners(&mut self, cell: Cell) -> [[f32; 3]; 4] {
        let shift = self.depth - cell.level;
        let places = [(0, 0), (1, 0), (0, 1), (1, 1)];
        let places = places.map(|(i, j)| ((cell.x + i) << shift, (cell.y + j) << shift));
        let corners = places.map(|place| self.buffers.samples[self.sample(place)]);
        if corners.iter().any(|corner| corner[0].is_nan()) {
            self.trace(places);
            return places.map(|place| self.buffers.samples[self.sample(place)]);
        }
        corners
    }

    /// Traces those of these points of the finest raster that were not asked for before.
    fn trace(&mut self, places: impl IntoIterator<Item = (u32, u32)>) {
        // Exact: a power of two.
        let step = 1.0 / f64::from(1u32 << self.depth);
        self.buffers.waiting.clear();
        self.buffers.rays.clear();
        for (x, y) in places {
            let index = self.sample((x, y));
            if self.buffers.samples[index][0].is_nan() {
                // Not to be asked for twice.
                self.buffers.samples[index] = [f32::INFINITY; 3];
                let u = f64::from(self.view.x) + f64::from(x) * step;
                let v = f64::from(self.view.y) + f64::from(y) * step;
                self.buffers.rays.push(self.camera.ray(u, v, self.width, self.height));
                self.buffers.waiting.push(index);
            }
        }
        let Buffers { samples, waiting, rays, within, found, colors, .. } = &mut *self.buffers;
        for (waiting, rays) in waiting.chunks(BATCH).zip(rays.chunks(BATCH)) {
            within.resize(rays.len(), Interval::FORWARD);
            found.clear();
            found.resize(rays.len(), None);
            self.tracer.nearest_many(rays, within, found);
            self.tracer.seen_by_eye(rays, found, colors);
            for (&index, color) in waiting.iter().zip(colors.iter()) {
                samples[index] = color.to_f32();
            }
        }
    }

    /// The index of a point of the finest raster.
    fn sample(&self, (x, y): (u32, u32)) -> usize {
        y as usize * self.stride + x as usize
    }

    fn index(&self, cell: Cell) -> usize {
        cell.y as usize * ((self.view.width as usize) << cell.level) + cell.x as usize
    }
}

/// What is compared: about what is seen, clipped as the picture will be, with a square root in place of the sRGB curve.
#[inline]
fn tone(v: f32) -> f32 {
    v.clamp(0.0, 1.0).sqrt()
}
