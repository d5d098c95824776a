//! The circular cylinder between two points, closed by two discs or open.
//!
//! The arithmetic is that of the cone with equal radii: see the private module `frustum`.

use super::frustum::Frustum;
use crate::kernel::Lanes;
use crate::{Aabb, Departure, Error, Hit, Interval, Primitive, Ray, Similarity, Surface};
use glam::DVec3;

/// A cylinder: the points at distance `radius` from the segment from `base` to `top`, between the planes through
/// its ends; closed by a disc at each end, or open.
///
/// Part 0 is the side, 1 the base cap, 2 the top cap. On the side, root 0 is where the line enters the endless
/// cylinder and root 1 where it leaves; on a cap the root is 0. The normal points outward, away from the axis on an
/// open one too.
///
/// Its own axes are two fixed ones perpendicular to the axis, and the axis. The first is the perpendicular part of
/// the world axis that makes the largest angle with the cylinder's (the earlier of x, y, z where two are equal), the
/// second is axis x first. `u` is the angle from the first towards the second axis, in turns in `[0, 1)`; `v` is the
/// height from 0 at the base to 1 at the top. `local` is the point minus the base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    frustum: Frustum,
}

impl Cylinder {
    /// The closed cylinder from `base` to `top` with `radius`, in world units.
    ///
    /// # Errors
    /// [`Error::NotFinite`], [`Error::NotPositive`] or [`Error::OutOfRange`] (beyond 1e150, below 1e-150) for a point,
    /// the radius or the height; [`Error::Coincident`] when base and top are the same.
    pub fn new(base: impl Into<DVec3>, top: impl Into<DVec3>, radius: f64) -> Result<Self, Error> {
        Self::checked(base.into(), top.into(), radius, true)
    }

    /// The cylinder without its caps.
    ///
    /// # Errors
    /// As [`Cylinder::new`].
    pub fn open(base: impl Into<DVec3>, top: impl Into<DVec3>, radius: f64) -> Result<Self, Error> {
        Self::checked(base.into(), top.into(), radius, false)
    }

    fn checked(base: DVec3, top: DVec3, radius: f64, closed: bool) -> Result<Self, Error> {
        if radius == 0.0 {
            return Err(Error::NotPositive { what: "radius", value: radius });
        }
        Ok(Cylinder { frustum: Frustum::new(base, [radius; 2], top, ["radius"; 2], closed)? })
    }

    /// The centre of the base.
    pub fn base(&self) -> DVec3 {
        self.frustum.base
    }

    /// The centre of the top.
    pub fn top(&self) -> DVec3 {
        self.frustum.top
    }

    /// The radius.
    pub fn radius(&self) -> f64 {
        self.frustum.base_radius
    }

    /// Whether the caps belong to it.
    pub fn is_closed(&self) -> bool {
        self.frustum.closed
    }

    /// The same cylinder scaled, turned and moved.
    ///
    /// # Errors
    /// As [`Cylinder::new`].
    pub fn transformed(&self, by: &Similarity) -> Result<Self, Error> {
        let f = &self.frustum;
        Self::checked(by.point(f.base), by.point(f.top), f.base_radius * by.scale(), f.closed)
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

impl Primitive for Cylinder {
    #[inline]
    fn hit(&self, ray: &Ray, within: Interval) -> Option<Hit> {
        self.frustum.hit::<false>(ray, within)
    }

    fn crossings(&self, ray: &Ray, within: Interval, each: &mut dyn FnMut(Hit)) {
        self.frustum.crossings::<false>(ray, within, each)
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
