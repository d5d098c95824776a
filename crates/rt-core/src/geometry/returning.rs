//! Rays that leave shapes: whether those shapes are in their way, four at a time where they are tori.

use super::{Geometry, is_legal};
use crate::kernel::{Lanes, Vectorized};
use crate::shape::torus::leaving::return_each;
use crate::{Departure, Interval, Ray};

/// Which rays the shapes block that they leave. As many as the shortest of the slices has.
pub(super) struct Returning<'a> {
    pub geometry: &'a Geometry,
    pub rays: &'a [Ray],
    pub within: &'a [Interval],
    pub from: &'a [Departure],
    pub occluded: &'a mut [bool],
}

impl Vectorized for Returning<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let Returning { geometry, rays, within, from, occluded } = self;
        let (store, shapes) = (&geometry.store, &geometry.shapes);
        let fours = rays.chunks(4).zip(within.chunks(4)).zip(from.chunks(4)).zip(occluded.chunks_mut(4));
        for (((rays, within), from), occluded) in fours {
            let mut left = 15;
            if let ([ra, rb, rc, rd], &[wa, wb, wc, wd], [a, b, c, d], [oa, ob, oc, od]) =
                (rays, within, from, &mut *occluded)
                && let Some(ta) = store.ring(shapes, a.object)
                && let Some(tb) = store.ring(shapes, b.object)
                && let Some(tc) = store.ring(shapes, c.object)
                && let Some(td) = store.ring(shapes, d.object)
                && is_legal(ra, wa)
                && is_legal(rb, wb)
                && is_legal(rc, wc)
                && is_legal(rd, wd)
            {
                let (rays, within) = ([ra, rb, rc, rd], [wa, wb, wc, wd]);
                let (back, doubt) = return_each(lanes, [ta, tb, tc, td], rays, within, [a, b, c, d]);
                [*oa, *ob, *oc, *od] =
                    [back & 1 == 1, back >> 1 & 1 == 1, back >> 2 & 1 == 1, back >> 3 & 1 == 1];
                left = doubt;
            }
            let all = rays.iter().zip(within).zip(from).zip(occluded);
            for (lane, (((ray, within), from), occluded)) in all.enumerate() {
                if left >> lane & 1 == 1 {
                    *occluded =
                        is_legal(ray, *within) && store.hit_leaving(shapes, ray, *within, from).is_some();
                }
            }
        }
    }
}
