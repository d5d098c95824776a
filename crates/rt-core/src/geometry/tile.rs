//! Which rays of a slice make a packet: neighbours in the slice, or in four rows of a picture.

use super::frame::{GROUPS, PACKET};
use crate::Ray;
use crate::scaled::largest;

/// The places of a packet's rays in their slice: eight in a row, as many again a row further, and so on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Tile {
    first: usize,
    /// From one eight to the next.
    row: usize,
    /// The number of rays.
    pub count: usize,
}

impl Tile {
    /// So many neighbours, at most as many as a packet holds.
    pub fn line(first: usize, count: usize) -> Tile {
        Tile { first, row: 8, count: count.min(PACKET) }
    }

    /// The place of the ray `i` of the packet.
    #[inline(always)]
    pub fn place(&self, i: usize) -> usize {
        self.first + i / 8 * self.row + i % 8
    }
}

/// Divides a slice of rays among packets: every ray is in one at least.
pub(super) struct Tiles {
    /// The rays of a row, if they come in rows.
    width: Option<usize>,
    /// The next band of four rows begins here, or the next line of neighbours.
    first: usize,
    column: usize,
    count: usize,
}

impl Tiles {
    /// Among the packets of all these rays.
    pub fn new(rays: &[Ray]) -> Tiles {
        Tiles { width: width(rays), first: 0, column: 0, count: rays.len() }
    }

    /// Whether there is no packet left.
    pub fn are_done(&self) -> bool {
        self.first >= self.count
    }
}

impl Iterator for Tiles {
    type Item = Tile;

    fn next(&mut self) -> Option<Tile> {
        if let Some(width) = self.width
            && self.first + GROUPS * width <= self.count
        {
            // The last of a row whose width is no multiple of eight has some rays of the one before.
            let first = self.first + self.column.min(width - 8);
            self.column += 8;
            if self.column >= width {
                self.column = 0;
                self.first += GROUPS * width;
            }
            return Some(Tile { first, row: width, count: PACKET });
        }
        let tile = Tile::line(self.first, self.count - self.first);
        self.first += tile.count;
        (tile.count > 0).then_some(tile)
    }
}

/// How much one ray differs from another: in direction, and in origin.
#[inline(always)]
fn difference(a: &Ray, b: &Ray) -> [f64; 2] {
    [largest(a.direction - b.direction), largest(a.origin - b.origin)]
}

#[inline(always)]
fn greater(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [if b[0] > a[0] { b[0] } else { a[0] }, if b[1] > a[1] { b[1] } else { a[1] }]
}

/// Rows of fewer rays are left as they come: four of them are not much wider than they are high.
const LEAST_WIDTH: usize = 16;

/// A step so many times as large as all before it may lead to the next row: that step is at least 15 pixels long, and within
/// a row the greatest so far is at least one or, of places anywhere in their pixels, hardly less.
const JUMP: f64 = 8.0;

/// The length of the rows in which the rays come, if tiles of four rows hold rays that differ half as much as neighbours
/// do. Only time depends on it.
fn width(rays: &[Ray]) -> Option<usize> {
    let mut most = [0.0; 2];
    let mut width = 0;
    for (i, pair) in rays.windows(2).enumerate().take(rays.len() / GROUPS) {
        let step = difference(&pair[0], &pair[1]);
        if i > 0 && (step[0] > JUMP * most[0] || step[1] > JUMP * most[1]) {
            width = i + 1;
            break;
        }
        most = greater(most, step);
    }
    if width < LEAST_WIDTH {
        return None;
    }
    let spread = |tile: Tile| {
        (1..PACKET).map(|i| difference(&rays[tile.first], &rays[tile.place(i)])).fold([0.0; 2], greater)
    };
    let rows = Tile { first: 0, row: width, count: PACKET };
    if rows.place(PACKET - 1) >= rays.len() {
        return None;
    }
    let (square, line) = (spread(rows), spread(Tile::line(0, PACKET)));
    (2.0 * square[0] <= line[0] && 2.0 * square[1] <= line[1]).then_some(width)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;
    use alloc::vec::Vec;

    /// The rays of a camera, row by row, each jittered by so many steps.
    fn camera(random: &mut Random, width: usize, height: usize, jitter: f64, parallel: bool) -> Vec<Ray> {
        let mut rays = Vec::new();
        for y in 0..height {
            for x in 0..width {
                let at = [x, y].map(|k| (k as f64 + random.uniform(-jitter, jitter)) / 200.0);
                rays.push(if parallel {
                    Ray::new([at[0], at[1], -3.0], [0.0, 0.0, 1.0])
                } else {
                    Ray::new([0.5, 0.5, -3.0], [at[0] - 0.5, at[1] - 0.5, 1.0])
                });
            }
        }
        rays
    }

    #[test]
    fn rows_are_found() {
        let mut random = Random::new(1);
        for (width, height, jitter) in
            [(64, 64, 0.0), (100, 8, 0.4), (37, 4, 0.0), (16, 9, 0.3), (1000, 5, 0.1)]
        {
            for parallel in [false, true] {
                let rays = camera(&mut random, width, height, jitter, parallel);
                // Where there is no jitter, parallel rays have equal directions, others equal origins.
                assert_eq!(super::width(&rays), Some(width), "{width} {jitter} {parallel}");
                assert_eq!(super::width(&rays[..3 * width]), None);
            }
        }
    }

    #[test]
    fn no_rows_are_found_where_none_are() {
        let mut random = Random::new(2);
        // Any rays, equal rays, narrow rows, none, one.
        let any: Vec<Ray> = (0..1000).map(|_| Ray::new(random.in_cube(), random.direction())).collect();
        assert_eq!(width(&any), None);
        assert_eq!(width(&[Ray::new([0.0; 3], [1.0, 0.0, 0.0]); 400]), None);
        assert_eq!(width(&camera(&mut random, 8, 200, 0.1, false)), None);
        assert_eq!(width(&[]), None);
        assert_eq!(width(&any[..1]), None);
        // Squares of eight by four pixels, put side by side in rows.
        let rows = camera(&mut random, 64, 64, 0.0, false);
        let mut squares = Vec::new();
        for (top, left) in (0..64).step_by(4).flat_map(|y| (0..64).step_by(8).map(move |x| (y, x))) {
            squares.extend((0..PACKET).map(|i| rows[(top + i / 8) * 64 + left + i % 8]));
        }
        assert_eq!(width(&squares), None);
    }

    /// Every ray is in a packet, those of a picture in tiles of 8 by 4, the last ones in lines.
    #[test]
    fn every_ray_is_in_a_packet() {
        let mut random = Random::new(3);
        for (width, height) in [(64, 64), (100, 9), (37, 6), (19, 4), (5, 70), (1, 1), (0, 0)] {
            let rays = camera(&mut random, width, height, 0.2, false);
            let mut seen = alloc::vec![0; rays.len()];
            let mut tiles = Tiles::new(&rays);
            while !tiles.are_done() {
                let tile = tiles.next().unwrap();
                assert!((1..=PACKET).contains(&tile.count));
                (0..tile.count).for_each(|i| seen[tile.place(i)] += 1);
                if width >= 16 && tile.first < height / 4 * 4 * width {
                    assert_eq!((tile.row, tile.count), (width, PACKET));
                    assert!(tile.first % width <= width - 8);
                }
            }
            assert_eq!(tiles.next(), None);
            let most = if width % 8 == 0 { 1 } else { 2 };
            assert!(seen.iter().all(|&n| (1..=most).contains(&n)), "{width} {height}");
        }
    }
}
