//! The tori that the rays of a packet may meet: they wait until there are enough of them to be asked about eight at a time.

use super::frame::PACKET;
use super::query::Query;
use super::store::Store;
use super::tile::Tile;
use crate::kernel::{Lanes, Vectorized, vectorize};
use crate::shape::Torus;
use crate::shape::torus::together::{Found, PAIRS, Pair, Told, Waiting, alone, with_one};
use crate::{Hit, Interval, Ray};
use core::ops::ControlFlow;

/// A query that takes hits from elsewhere.
pub(super) trait Together: Query {
    /// Whether it matters where a hit is.
    const PLACES: bool;
    /// The interval in which hits with an object count, if any do.
    fn asks(&self, object: u32) -> Option<Interval>;
    /// Takes a hit into account; breaks when nothing more needs to be seen.
    fn meet(&mut self, object: u32, hit: Hit) -> ControlFlow<()>;
}

/// How many pairs wait until they are asked about. Only time depends on it.
const MANY: usize = 8;

/// Pairs of a ray and a torus that it may meet.
pub(super) struct Rings {
    /// Index of the torus in the store, place of the ray in its packet.
    pairs: [u64; MANY + PACKET],
    count: usize,
    waiting: Waiting,
}

impl Rings {
    pub const NONE: Rings = Rings { pairs: [0; MANY + PACKET], count: 0, waiting: Waiting::NONE };

    /// Forgets all.
    #[inline(always)]
    pub fn clear(&mut self) {
        self.count = 0;
        self.waiting.clear();
    }

    /// Whether so many more pairs can wait.
    #[inline(always)]
    pub fn has_room_for(&self, more: usize) -> bool {
        self.count + more <= self.pairs.len()
    }

    /// The rays of `mask` may meet the torus; before, there were not [many](Rings::are_many).
    #[inline(always)]
    pub fn add(&mut self, index: usize, mut mask: u32) {
        let name = (index * PACKET) as u64;
        while mask != 0 {
            let place = u64::from(mask.trailing_zeros());
            mask &= mask - 1;
            if let Some(pair) = self.pairs.get_mut(self.count) {
                *pair = name | place;
                self.count += 1;
            }
        }
    }

    /// Whether they are enough to be asked about.
    #[inline(always)]
    pub fn are_many(&self) -> bool {
        self.count >= MANY
    }
}

/// Asks of four rays, of which `members` are meant, one bit each, whether they meet one torus, and where if `PLACES`.
pub(super) struct AskFour<'a, const PLACES: bool> {
    pub torus: &'a Torus,
    pub rays: [&'a Ray; 4],
    pub within: [Interval; 4],
    pub members: u32,
}

impl<const PLACES: bool> Vectorized for AskFour<'_, PLACES> {
    type Output = Told;

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) -> Told {
        with_one(lanes, self.torus, self.rays, self.within, self.members, PLACES)
    }
}

/// Asks about pairs by eight, or about all. Returns the rays that meet something and those that need not see more.
pub(super) struct Settle<'a, Q> {
    pub rings: &'a mut Rings,
    pub store: &'a Store,
    pub rays: &'a [Ray],
    pub tile: Tile,
    pub queries: &'a mut [Q; PACKET],
    pub all: bool,
}

/// Not in place: it is called from several, and long.
#[inline(never)]
pub(super) fn settle<Q: Together>(settle: Settle<'_, Q>) -> (u32, u32) {
    vectorize(settle)
}

impl<Q: Together> Vectorized for Settle<'_, Q> {
    type Output = (u32, u32);

    #[inline(always)]
    fn run<L: Lanes>(mut self, lanes: L) -> (u32, u32) {
        let mut told = (0, 0);
        let mut first = 0;
        while first + PAIRS <= self.rings.count || (self.all && first < self.rings.count) {
            let last = self.rings.count - 1;
            let mut names = [0; PAIRS];
            for (lane, name) in names.iter_mut().enumerate() {
                *name = self.rings.pairs[(first + lane).min(last)];
            }
            let mut members = (1 << (last + 1 - first).min(PAIRS)) - 1;
            first += PAIRS;
            let Some((pair, asked)) = self.pair(names[0]) else { continue };
            members &= !u32::from(!asked);
            let mut pairs = [pair; PAIRS];
            for (lane, &name) in names.iter().enumerate().skip(1) {
                match self.pair(name) {
                    Some((pair, true)) => pairs[lane] = pair,
                    _ => members &= !(1 << lane),
                }
            }
            if members == 0 {
                continue;
            }
            let doubt = self.rings.waiting.add(lanes, &pairs, &names, members);
            if doubt != 0 {
                self.tell(&Found::doubt(names, doubt), &mut told);
            }
            if self.rings.waiting.count() >= PAIRS {
                let found = self.rings.waiting.take(lanes, Q::PLACES);
                self.tell(&found, &mut told);
            }
        }
        // Less than eight are left.
        let left = self.rings.count.saturating_sub(first);
        for k in 0..left {
            self.rings.pairs[k] = self.rings.pairs[first + k];
        }
        self.rings.count = left;
        if self.all && self.rings.waiting.count() > 0 {
            let found = self.rings.waiting.take(lanes, Q::PLACES);
            self.tell(&found, &mut told);
        }
        told
    }
}

impl<'a, Q: Together> Settle<'a, Q> {
    /// A pair, and whether it is asked about.
    #[inline(always)]
    fn pair(&self, name: u64) -> Option<(Pair<'a>, bool)> {
        let (torus, object) = self.store.torus(name as usize / PACKET)?;
        let ray = self.rays.get(self.tile.place(name as usize % PACKET))?;
        let within = self.queries[name as usize % PACKET].asks(object);
        Some((Pair { torus, ray, within: within.unwrap_or(Interval::new(0.0, 0.0)) }, within.is_some()))
    }

    /// Tells the queries what was found.
    #[inline(always)]
    fn tell(&mut self, found: &Found, (met, over): &mut (u32, u32)) {
        let mut left = found.meet | found.doubt;
        while left != 0 {
            let lane = left.trailing_zeros() as usize & (PAIRS - 1);
            left &= left - 1;
            let name = found.names[lane];
            let place = name as usize % PACKET;
            let Some((torus, object)) = self.store.torus(name as usize / PACKET) else { continue };
            let hit = if found.meet >> lane & 1 == 1 {
                found.hit(lane)
            } else {
                let (Some(within), Some(ray)) =
                    (self.queries[place].asks(object), self.rays.get(self.tile.place(place)))
                else {
                    continue;
                };
                match alone(Pair { torus, ray, within }) {
                    Some(hit) => hit,
                    None => continue,
                }
            };
            *met |= 1 << place;
            if self.queries[place].meet(object, hit).is_break() {
                *over |= 1 << place;
            }
        }
    }
}
