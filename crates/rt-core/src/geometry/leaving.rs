//! The nearest hits of many rays that leave surfaces.

use super::batch::IN_FLIGHT;
use super::query::Nearest;
use super::stream::interleave;
use super::{CACHE, FindNearest, Found, Geometry, is_legal};
use crate::kernel::{Lanes, Vectorized, vectorize};
use crate::{Departure, Interval, Primitive, Ray};

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
        if geometry.plain || geometry.tree.roots != 1 || geometry.tree.bytes() <= CACHE {
            for (((ray, within), from), found) in all {
                *found = FindNearest { geometry, ray, within: *within, from: Some(from) }.run(lanes);
            }
            return;
        }
        for (.., found) in all {
            *found = None;
        }
        let found = core::cell::RefCell::new(found);
        let mut numbers = 0..rays.len();
        // The next ray that has to go down the tree; those before it are answered.
        let next = || {
            for number in numbers.by_ref() {
                let (ray, within, from) = (&rays[number], within[number], &from[number]);
                if !is_legal(ray, within) {
                    continue;
                }
                let (local, window) = geometry.frame.enter(ray, within);
                let mut nearest = Nearest::new(within, window, Some(from.object));
                if let Some((from, shape)) = geometry.departed(Some(from))
                    && let Some(hit) = shape.hit_leaving(ray, within, from)
                {
                    nearest.offer(from.object, hit);
                }
                let _ = geometry.ask_apart(ray, &mut nearest);
                match local {
                    Some(local) => return Some((number, ray, local, nearest)),
                    None => found.borrow_mut()[number] = decided(geometry, ray, &nearest, from),
                }
            }
            None
        };
        interleave::<IN_FLIGHT, L, Nearest>(lanes, geometry, next, |number, nearest| {
            found.borrow_mut()[number] = decided(geometry, &rays[number], &nearest, &from[number]);
        });
    }
}

#[inline(always)]
fn decided(geometry: &Geometry, ray: &Ray, nearest: &Nearest, from: &Departure) -> Option<Found> {
    match nearest.contested() {
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
