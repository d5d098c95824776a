//! The circular cone between two discs, or a frustum of one, closed or open.
//!
//! The arithmetic is in the private module `frustum`.

use super::frustum::Frustum;
use crate::kernel::Lanes;
use crate::{Aabb, Departure, Error, Hit, Interval, Primitive, Ray, Similarity, Surface};
use glam::DVec3;

/// A cone or a frustum of one: its radius grows linearly from `base_radius` at `base` to `top_radius` at `top`;
/// closed by a disc at each end of positive radius, or open.
///
/// Either radius may be the larger or zero (then that end is the apex), but not both zero; with equal radii it is a
/// cylinder. Part 0 is the side, 1 the base cap, 2 the top cap. On the side, root 0 is where the line enters the
/// endless cone and root 1 where it leaves it; on a cap the root is 0. The normal points outward, away from the axis
/// on an open one too; at the very apex it is along the axis, or that of the wall that the line meets there first or last.
///
/// Its own axes are two fixed ones perpendicular to the axis, and the axis. The first is the perpendicular part of
/// the world axis that makes the largest angle with the cone's (the earlier of x, y, z where two are equal), the
/// second is axis x first. `u` is the angle from the first towards the second axis, in turns in `[0, 1)`; `v` is the
/// height from 0 at the base to 1 at the top. `local` is the point minus the base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    frustum: Frustum,
}

impl Cone {
    /// The closed frustum from `base` with `base_radius` to `top` with `top_radius`, in world units.
    ///
    /// # Errors
    /// [`Error::NotFinite`], [`Error::Negative`] or [`Error::OutOfRange`] (beyond 1e150; the larger radius or the height
    /// below 1e-150) for a point, a radius or the height; [`Error::NotPositive`] when both radii are zero; [`Error::Coincident`] when
    /// base and top are the same.
    pub fn new(
        base: impl Into<DVec3>,
        base_radius: f64,
        top: impl Into<DVec3>,
        top_radius: f64,
    ) -> Result<Self, Error> {
        Self::checked(base.into(), [base_radius, top_radius], top.into(), true)
    }

    /// The cone without its caps.
    ///
    /// # Errors
    /// As [`Cone::new`].
    pub fn open(
        base: impl Into<DVec3>,
        base_radius: f64,
        top: impl Into<DVec3>,
        top_radius: f64,
    ) -> Result<Self, Error> {
        Self::checked(base.into(), [base_radius, top_radius], top.into(), false)
    }

    fn checked(base: DVec3, radii: [f64; 2], top: DVec3, closed: bool) -> Result<Self, Error> {
        const NAMES: [&str; 2] = ["base_radius", "top_radius"];
        for (what, value) in NAMES.into_iter().zip(radii) {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(Error::Negative { what, value });
            }
        }
        if radii == [0.0; 2] {
            return Err(Error::NotPositive { what: "the larger of base_radius and top_radius", value: 0.0 });
        }
        Ok(Cone { frustum: Frustum::new(base, radii, top, NAMES, closed)? })
    }

    /// The centre of the base.
    pub fn base(&self) -> DVec3 {
        self.frustum.base
    }

    /// The radius at the base.
    pub fn base_radius(&self) -> f64 {
        self.frustum.base_radius
    }

    /// The centre of the top.
    pub fn top(&self) -> DVec3 {
        self.frustum.top
    }

    /// The radius at the top.
    pub fn top_radius(&self) -> f64 {
        self.frustum.top_radius
    }

    /// Whether the caps belong to it.
    pub fn is_closed(&self) -> bool {
        self.frustum.closed
    }

    /// The same cone scaled, turned and moved.
    ///
    /// # Errors
    /// As [`Cone::new`].
    pub fn transformed(&self, by: &Similarity) -> Result<Self, Error> {
        let f = &self.frustum;
        let radii = [f.base_radius * by.scale(), f.top_radius * by.scale()];
        Self::checked(by.point(f.base), radii, by.point(f.top), f.closed)
    }

    /// The records of four hits: [`Primitive::surface`] for each.
    #[inline(always)]
    pub(crate) fn surface_four<L: Lanes>(
        &self,
        lanes: L,
        rays: [&Ray; 4],
        hits: [Hit; 4],
        surfaces: [&mut Surface; 4],
    ) {
        self.frustum.surface_four(lanes, rays, hits, surfaces);
    }
}

impl Primitive for Cone {
    #[inline]
    fn hit(&self, ray: &Ray, within: Interval) -> Option<Hit> {
        self.frustum.hit::<true>(ray, within)
    }

    fn crossings(&self, ray: &Ray, within: Interval, each: &mut dyn FnMut(Hit)) {
        self.frustum.crossings::<true>(ray, within, each)
    }

    fn surface(&self, ray: &Ray, hit: Hit) -> Surface {
        self.frustum.surface(ray, hit)
    }

    fn bounds(&self) -> Option<Aabb> {
        Some(self.frustum.bounds())
    }

    fn hit_leaving(&self, ray: &Ray, within: Interval, from: &Departure) -> Option<Hit> {
        self.frustum.leaving(ray, within, from)
    }

    fn crossings_leaving(&self, ray: &Ray, within: Interval, from: &Departure, each: &mut dyn FnMut(Hit)) {
        if let Some(exit) = self.frustum.leaving(ray, within, from) {
            each(exit);
        }
    }
}
