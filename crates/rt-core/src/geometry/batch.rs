//! Many rays at once: packets of those that go side by side, the others interleaved. The answers are the same bits as
//! one by one: the ways differ only in which boxes they pass over.

use super::frame::{PACKET, Side};
use super::order::{Place, put_together};
use super::packet::Packet;
use super::query::{Any, Nearest, Query};
use super::returning::Returning;
use super::rings::{Rings, Together};
use super::stream::interleave;
use super::tile::{Tile, Tiles};
use super::{CACHE, FindNearest, Found, Geometry, is_legal};
use crate::kernel::{Lanes, Vectorized, vectorize};
use crate::scaled::largest;
use crate::{Departure, Interval, Ray};
use alloc::vec::Vec;

/// The rays that are looked at together: those without company are collected over a block.
const BLOCK: usize = 1024;

/// The rays in flight when interleaved.
pub(super) const IN_FLIGHT: usize = 12;

/// What is asked about each ray of a batch.
trait Request {
    type Query: Query + Together;
    type Answer;
    fn query(within: Interval, skip: Option<u32>) -> Self::Query;
    /// The answer when the ray cannot hit anything.
    fn nothing() -> Self::Answer;
    fn answer(geometry: &Geometry, ray: &Ray, query: &Self::Query) -> Self::Answer;
    /// The answer for a ray on its own.
    fn one<L: Lanes>(
        lanes: L,
        geometry: &Geometry,
        ray: &Ray,
        within: Interval,
        skip: Option<u32>,
    ) -> Self::Answer;
}

/// Nothing is skipped.
struct NearestRequest;

impl Request for NearestRequest {
    type Query = Nearest;
    type Answer = Option<Found>;
    #[inline(always)]
    fn query(within: Interval, skip: Option<u32>) -> Nearest {
        Nearest::new(within, skip)
    }
    #[inline(always)]
    fn nothing() -> Option<Found> {
        None
    }
    #[inline(always)]
    fn answer(geometry: &Geometry, ray: &Ray, query: &Nearest) -> Option<Found> {
        match query.contested(|| geometry.frame.window(ray)) {
            None => query.best(),
            Some(limit) => geometry.decide(ray, query.within(), limit, None),
        }
    }
    #[inline(always)]
    fn one<L: Lanes>(
        lanes: L,
        geometry: &Geometry,
        ray: &Ray,
        within: Interval,
        _: Option<u32>,
    ) -> Option<Found> {
        FindNearest { geometry, ray, within, from: None }.run(lanes)
    }
}

struct AnyRequest;

impl Request for AnyRequest {
    type Query = Any;
    type Answer = bool;
    #[inline(always)]
    fn query(within: Interval, skip: Option<u32>) -> Any {
        Any::new(within, skip)
    }
    #[inline(always)]
    fn nothing() -> bool {
        false
    }
    #[inline(always)]
    fn answer(_: &Geometry, _: &Ray, query: &Any) -> bool {
        query.found
    }
    #[inline(always)]
    fn one<L: Lanes>(lanes: L, geometry: &Geometry, ray: &Ray, within: Interval, skip: Option<u32>) -> bool {
        match geometry.frame.legal(lanes, ray, within) {
            Some(legal) => geometry.any(lanes, ray, within, legal, skip),
            None => false,
        }
    }
}

struct Batch<'a, R: Request> {
    geometry: &'a Geometry,
    rays: &'a [Ray],
    within: &'a [Interval],
    /// The object that each ray passes over; empty where none does.
    skip: &'a [u32],
    answers: &'a mut [R::Answer],
}

impl<R: Request> Vectorized for Batch<'_, R> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let Batch { geometry, rays, within, skip, answers } = self;
        let count = rays.len().min(within.len()).min(answers.len());
        let mut tiles = Tiles::new(&rays[..count]);
        while !tiles.are_done() {
            block::<R, L>(lanes, geometry, &mut tiles, rays, within, skip, answers);
        }
    }
}

/// The next rays, at most [`BLOCK`].
#[inline(always)]
fn block<R: Request, L: Lanes>(
    lanes: L,
    geometry: &Geometry,
    tiles: &mut Tiles,
    rays: &[Ray],
    within: &[Interval],
    skip: &[u32],
    answers: &mut [R::Answer],
) {
    let mut members = [Tile::line(0, 0); BLOCK / PACKET];
    // The rays without company, by tile and place in it.
    let mut alone = [0_u16; BLOCK];
    let mut alone_count = 0;
    let mut packet = Packet {
        rays,
        tile: Tile::line(0, 0),
        side: Side::EMPTY,
        queries: core::array::from_fn(|_| R::query(Interval::new(0.0, 0.0), None)),
        active: 0,
        rings: Rings::NONE,
    };
    for (slot, tile) in tiles.take(BLOCK / PACKET).enumerate() {
        members[slot] = tile;
        packet.tile = tile;
        packet.active = 0;
        if !go_together(rays, &tile) {
            for i in 0..tile.count {
                alone[alone_count] = (slot * PACKET + i) as u16;
                alone_count += 1;
            }
            continue;
        }
        enter::<R, L>(lanes, geometry, &mut packet, within, skip, answers);
        let active = packet.active;
        let done = packet.search(lanes, geometry);
        for i in (0..tile.count).filter(|i| active >> i & 1 == 1) {
            let number = tile.place(i);
            if done >> i & 1 == 1 {
                answers[number] = R::answer(geometry, &rays[number], &packet.queries[i]);
            } else {
                alone[alone_count] = (slot * PACKET + i) as u16;
                alone_count += 1;
            }
        }
    }
    let number = |&name: &u16| members[usize::from(name) / PACKET].place(usize::from(name) % PACKET);
    let mut numbers = alone[..alone_count].iter().map(number);
    if geometry.tree.roots != 1 || geometry.tree.bytes() <= CACHE {
        for number in numbers {
            answers[number] =
                R::one(lanes, geometry, &rays[number], within[number], skip.get(number).copied());
        }
        return;
    }
    // The next ray that may hit more; those before it are answered.
    let answers = core::cell::RefCell::new(answers);
    let next = || {
        for number in numbers.by_ref() {
            let (ray, within) = (&rays[number], within[number]);
            let mut nothing = R::nothing();
            if is_legal(ray, within) {
                let mut query = R::query(within, skip.get(number).copied());
                if geometry.ask_apart(ray, &mut query).is_continue() {
                    return Some((number, ray, within, query));
                }
                nothing = R::answer(geometry, ray, &query);
            }
            answers.borrow_mut()[number] = nothing;
        }
        None
    };
    interleave::<IN_FLIGHT, L, R::Query>(lanes, geometry, next, |number, query| {
        answers.borrow_mut()[number] = R::answer(geometry, &rays[number], &query);
    });
}

/// Makes the rays of a packet and their queries ready; answers those that cannot meet the tree.
#[inline(always)]
fn enter<R: Request, L: Lanes>(
    lanes: L,
    geometry: &Geometry,
    packet: &mut Packet<R::Query>,
    within: &[Interval],
    skip: &[u32],
    answers: &mut [R::Answer],
) {
    let (rays, tile) = (packet.rays, packet.tile);
    if geometry.frame.enter_together(lanes, rays, within, &tile, &mut packet.side) {
        packet.active = ((1_u64 << tile.count) - 1) as u32;
        for (i, query) in packet.queries.iter_mut().enumerate().take(tile.count) {
            let number = tile.place(i);
            *query = R::query(within[number], skip.get(number).copied());
        }
        if geometry.apart.is_empty() {
            return;
        }
        for (i, query) in packet.queries.iter_mut().enumerate().take(tile.count) {
            let number = tile.place(i);
            if geometry.ask_apart(&rays[number], query).is_break() {
                answers[number] = R::answer(geometry, &rays[number], query);
                packet.active &= !(1 << i);
            } else {
                packet.side.cut(i, query.end());
            }
        }
        return;
    }
    packet.side.error = 0.0;
    for i in 0..tile.count {
        let number = tile.place(i);
        let (ray, within, answer) = (&rays[number], &within[number], &mut answers[number]);
        *answer = R::nothing();
        if !is_legal(ray, *within) {
            continue;
        }
        let local = geometry.frame.enter(ray, *within);
        let query = &mut packet.queries[i];
        *query = R::query(*within, skip.get(number).copied());
        let seen = geometry.ask_apart(ray, query).is_break();
        match local {
            Some(local) if !seen => {
                packet.side.set(i, &local, query.end());
                packet.active |= 1 << i;
            }
            _ => *answer = R::answer(geometry, ray, query),
        }
    }
    let any = packet.active.trailing_zeros() as usize;
    for i in (0..PACKET).filter(|i| packet.active >> i & 1 == 0) {
        packet.side.repeat(i, any);
    }
}

/// A glance whether rays may make a beam: whether the first, the middle and the last have much the same direction.
/// Only time depends on it.
#[inline(always)]
fn go_together(rays: &[Ray], tile: &Tile) -> bool {
    let ray = |i: usize| rays.get(tile.place(i));
    let (Some(first), Some(last), Some(middle)) =
        (ray(0), ray(tile.count.saturating_sub(1)), ray(tile.count / 2))
    else {
        return false;
    };
    let most = largest(first.direction);
    // Directions of unlike lengths may be alike.
    let near = |ray: &Ray| {
        let size = largest(ray.direction);
        largest(ray.direction * most - first.direction * size) <= most * size * 0.25
    };
    near(last) && near(middle)
}

impl Geometry {
    /// The nearest hit of each ray inside its interval: the same as [`nearest`](Geometry::nearest) for each, faster.
    ///
    /// Rays that go side by side should be neighbours in the slice, as the pixels of a row or of a small tile; the rows of a
    /// picture, of sixteen pixels or more, are found and taken in tiles. Works on as many rays as the shortest of the three
    /// slices has.
    pub fn nearest_many(&self, rays: &[Ray], within: &[Interval], found: &mut [Option<Found>]) {
        if self.plain {
            for ((ray, within), found) in rays.iter().zip(within).zip(found) {
                *found = self.nearest(ray, *within);
            }
            return;
        }
        vectorize(Batch::<NearestRequest> { geometry: self, rays, within, skip: &[], answers: found });
    }

    /// Whether anything lies inside the interval of each ray: the same as [`occluded`](Geometry::occluded) for each,
    /// faster. See [`nearest_many`](Geometry::nearest_many).
    pub fn occluded_many(&self, rays: &[Ray], within: &[Interval], occluded: &mut [bool]) {
        if self.plain {
            for ((ray, within), occluded) in rays.iter().zip(within).zip(occluded) {
                *occluded = self.occluded(ray, *within);
            }
            return;
        }
        vectorize(Batch::<AnyRequest> { geometry: self, rays, within, skip: &[], answers: occluded });
    }

    /// Whether anything lies inside the interval of each ray, for rays that leave surfaces: the same as
    /// [`occluded_leaving`](Geometry::occluded_leaving) for each, faster. See [`nearest_many`](Geometry::nearest_many).
    pub fn occluded_leaving_many(
        &self,
        rays: &[Ray],
        within: &[Interval],
        from: &[Departure],
        occluded: &mut [bool],
    ) {
        // The shapes that are left, first: what they block needs no search.
        vectorize(Returning { geometry: self, rays, within, from, occluded: &mut *occluded });
        let mut searched = Vec::with_capacity(rays.len());
        let all = rays.iter().zip(within).zip(from).zip(occluded.iter());
        for (number, (((ray, _), _), occluded)) in all.enumerate() {
            if !*occluded {
                searched.push(Place::new(ray, number));
            }
        }
        put_together(&mut searched);
        let room = searched.len().min(BLOCK);
        let (mut free, mut free_within) = (Vec::with_capacity(room), Vec::with_capacity(room));
        let (mut skip, mut answers) = (Vec::with_capacity(room), alloc::vec![false; room]);
        for block in searched.chunks(BLOCK) {
            let numbers = || block.iter().map(|place| place.number as usize);
            free.clear();
            free.extend(numbers().map(|number| rays[number]));
            free_within.clear();
            free_within.extend(numbers().map(|number| within[number]));
            skip.clear();
            skip.extend(numbers().map(|number| from[number].object));
            vectorize(Batch::<AnyRequest> {
                geometry: self,
                rays: &free,
                within: &free_within,
                skip: &skip,
                answers: &mut answers,
            });
            for (number, answer) in numbers().zip(&answers) {
                occluded[number] = *answer;
            }
        }
    }
}
