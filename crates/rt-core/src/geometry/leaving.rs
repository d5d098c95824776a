//! The nearest hits of many rays that leave surfaces.

use super::batch::IN_FLIGHT;
use super::frame::PACKET;
use super::query::{Nearest, Query};
use super::rings::{Rings, Settle, settle};
use super::store::{Run, Store};
use super::stream::interleave;
use super::tile::Tile;
use super::{CACHE, FindNearest, Found, Geometry, is_legal};
use crate::kernel::{Lanes, Vectorized, vectorize};
use crate::{Departure, Interval, Primitive, Ray};
use core::ops::ControlFlow;

struct LeaveMany<'a> {
    geometry: &'a Geometry,
    rays: &'a [Ray],
    within: &'a [Interval],
    from: &'a [Departure],
    found: &'a mut [Option<Found>],
}

impl Vectorized for LeaveMany<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let LeaveMany { geometry, rays, within, from, found } = self;
        let all = rays.iter().zip(within).zip(from).zip(found.iter_mut());
        let flat = geometry.tree.roots != 1;
        if flat && !geometry.plain && geometry.store.count(Store::RING) > 0 {
            for (number, rays) in rays.chunks(PACKET).enumerate() {
                let start = number * PACKET;
                let end = start + rays.len();
                let (within, from, found) = (&within[start..end], &from[start..end], &mut found[start..end]);
                defer_tori(lanes, geometry, rays, within, from, found);
            }
            return;
        }
        if geometry.plain || flat || geometry.tree.bytes() <= CACHE {
            for (((ray, within), from), found) in all {
                *found = FindNearest { geometry, ray, within: *within, from: Some(from) }.run(lanes);
            }
            return;
        }
        for (.., found) in all {
            *found = None;
        }
        let mut numbers = 0..rays.len();
        // The next legal ray; those before it hit nothing.
        let next = || {
            for number in numbers.by_ref() {
                let (ray, within, from) = (&rays[number], within[number], &from[number]);
                if !is_legal(ray, within) {
                    continue;
                }
                let mut nearest = Nearest::new(within, Some(from.object));
                if let Some((from, shape)) = geometry.departed(Some(from))
                    && let Some(hit) = shape.hit_leaving(ray, within, from)
                {
                    nearest.offer(from.object, hit);
                }
                let _ = geometry.ask_apart(ray, &mut nearest);
                return Some((number, ray, within, nearest));
            }
            None
        };
        interleave::<IN_FLIGHT, L, Nearest>(lanes, geometry, next, |number, nearest| {
            found[number] = decided(geometry, &rays[number], &nearest, &from[number]);
        });
    }
}

/// Rays among few shapes: the tori that they may meet wait until they are asked about four at a time.
#[inline(always)]
fn defer_tori<L: Lanes>(
    lanes: L,
    geometry: &Geometry,
    rays: &[Ray],
    within: &[Interval],
    from: &[Departure],
    found: &mut [Option<Found>],
) {
    let mut queries = [Nearest::new(Interval::new(0.0, 0.0), None); PACKET];
    let mut rings = Rings::NONE;
    let (store, tile) = (&geometry.store, Tile::line(0, rays.len()));
    let ask_about = |rings: &mut Rings, queries: &mut [Nearest; PACKET], all| {
        settle(Settle { rings, store, rays, tile, queries, all });
    };
    for (place, ((ray, within), from)) in rays.iter().zip(within).zip(from).enumerate() {
        let Some(legal) = geometry.frame.legal(lanes, ray, *within) else { continue };
        let mut nearest = Nearest::new(*within, Some(from.object));
        if let Some((from, shape)) = geometry.departed(Some(from))
            && let Some(hit) = shape.hit_leaving(ray, *within, from)
        {
            nearest.offer(from.object, hit);
        }
        let mut query = Deferring { nearest, rings: &mut rings, place };
        let _ = geometry.ask(lanes, ray, *within, legal, &mut query);
        queries[place] = query.nearest;
        if rings.are_many() {
            ask_about(&mut rings, &mut queries, false);
        }
    }
    ask_about(&mut rings, &mut queries, true);
    for (((ray, from), nearest), found) in rays.iter().zip(from).zip(&queries).zip(found) {
        *found = decided(geometry, ray, nearest, from);
    }
}

/// The nearest hit but for the tori, which wait.
struct Deferring<'a> {
    nearest: Nearest,
    rings: &'a mut Rings,
    /// Of the ray among those that wait together.
    place: usize,
}

impl Query for Deferring<'_> {
    #[inline(always)]
    fn end(&self) -> f64 {
        self.nearest.end()
    }
    #[inline(always)]
    fn defer(&mut self, tori: Run) -> bool {
        let fits = self.rings.has_room_for(tori.count);
        if fits {
            for index in tori.first..tori.first + tori.count {
                self.rings.add(index, 1 << self.place);
            }
        }
        fits
    }
    #[inline(always)]
    fn visit<P: Primitive>(&mut self, ray: &Ray, object: u32, shape: &P) -> ControlFlow<()> {
        self.nearest.visit(ray, object, shape)
    }
}

#[inline(always)]
fn decided(geometry: &Geometry, ray: &Ray, nearest: &Nearest, from: &Departure) -> Option<Found> {
    match nearest.contested(|| geometry.frame.window(ray)) {
        None => nearest.best(),
        Some(limit) => geometry.decide(ray, nearest.within(), limit, Some(from)),
    }
}

impl Geometry {
    /// The nearest hit of each ray inside its interval, for rays that leave surfaces: the same as
    /// [`nearest_leaving`](Geometry::nearest_leaving) for each, faster. Works on as many rays as the shortest of the four
    /// slices has.
    pub fn nearest_leaving_many(
        &self,
        rays: &[Ray],
        within: &[Interval],
        from: &[Departure],
        found: &mut [Option<Found>],
    ) {
        let count = rays.len().min(within.len()).min(from.len()).min(found.len());
        let (rays, within, from, found) =
            (&rays[..count], &within[..count], &from[..count], &mut found[..count]);
        vectorize(LeaveMany { geometry: self, rays, within, from, found });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Side;
    use crate::kernel::PortableLanes;
    use crate::shape::{Cuboid, Plane, Sphere, Torus};
    use crate::testing::Random;
    use alloc::vec::Vec;
    use glam::DVec3;

    /// So many shapes of some kinds.
    fn scene(random: &mut Random, count: usize, tori: bool) -> Geometry {
        let mut builder = Geometry::builder().add(Plane::new([0.0, -1.0, 0.0], [0.0, 1.0, 0.0]).unwrap());
        for i in 0..count {
            let (at, axis) = (random.in_cube() * 4.0, random.direction());
            builder = match i % 3 {
                0 if tori => builder.add(Torus::new(at, axis, 0.9, 0.3).unwrap()),
                1 => builder.add(Cuboid::new(at, at + DVec3::splat(0.8)).unwrap()),
                _ => builder.add(Sphere::new(at, 0.5).unwrap()),
            };
        }
        builder.build()
    }

    /// Many find what they find one by one, in all lanes: without a tree, with a small one and with one beyond the cache.
    #[test]
    fn many_are_each() {
        let mut random = Random::new(1);
        for (count, tori, rays) in [(25, true, 900), (25, false, 300), (200, true, 300), (40_000, true, 200)]
        {
            let geometry = scene(&mut random, count, tori);
            assert_eq!(geometry.tree.bytes() > CACHE, count > 1000);
            let (mut all, mut within, mut from) = (Vec::new(), Vec::new(), Vec::new());
            while all.len() < rays {
                let origin = random.in_cube() * 9.0;
                let ray = Ray::new(origin, random.in_cube() * 4.0 - origin);
                let Some(found) = geometry.nearest(&ray, Interval::FORWARD) else { continue };
                let surface = geometry.surface(&ray, found);
                let side = Side::of_arrival(ray.direction, surface.normal);
                let onward = match all.len() % 3 {
                    0 => surface.departure(found.object, found.hit, side),
                    _ => surface.departure(found.object, found.hit, side.other()),
                };
                let (mut ray, interval) = match all.len() % 3 {
                    0 => onward.ray(surface.normal * side.sign() + random.direction() * 0.9),
                    1 => onward.through(ray.direction),
                    _ => onward.through(ray.direction - surface.normal * side.sign()),
                };
                if all.len() % 50 == 7 {
                    ray.direction.x = [f64::NAN, f64::INFINITY, 0.0][all.len() / 50 % 3];
                }
                all.push(ray);
                within.push(if all.len() % 9 == 0 { interval.until(1.5) } else { interval });
                from.push(onward);
            }
            let (mut found, mut portable) = (alloc::vec![None; rays], alloc::vec![None; rays]);
            geometry.nearest_leaving_many(&all, &within, &from, &mut found);
            let (all_, within_, from_) = (&all, &within, &from);
            LeaveMany { geometry: &geometry, rays: all_, within: within_, from: from_, found: &mut portable }
                .run(PortableLanes);
            let mut hits = 0;
            for i in 0..rays {
                let expected = geometry.nearest_leaving(&all[i], within[i], &from[i]);
                assert_eq!((found[i], portable[i]), (expected, expected), "{:?}", all[i]);
                hits += usize::from(expected.is_some());
            }
            assert!(hits > rays / 8, "{hits} of {rays}");
        }
    }
}
