//! The contract of a shape.

use crate::{Aabb, Departure, Hit, Interval, Ray, Surface};
use alloc::sync::Arc;
use core::fmt;

/// A surface that rays can hit. Implement it to add a shape of your own ([`Shape::Custom`](crate::Shape)).
///
/// Shapes are surfaces: the first crossing inside the interval counts, from inside a closed shape too. A tangency
/// without a crossing is no hit. No method may panic, whatever the bits of its arguments: a ray that is not
/// [valid](Ray::is_valid) hits nothing.
pub trait Primitive: fmt::Debug + Send + Sync {
    /// The first crossing inside the interval.
    fn hit(&self, ray: &Ray, within: Interval) -> Option<Hit>;

    /// All crossings inside the interval, ascending in `t`.
    ///
    /// The default repeats [`hit`](Primitive::hit), each time after the crossing before.
    fn crossings(&self, ray: &Ray, within: Interval, each: &mut dyn FnMut(Hit)) {
        let mut rest = within;
        while let Some(hit) = self.hit(ray, rest) {
            each(hit);
            rest = rest.after(hit.t());
        }
    }

    /// The full record of a hit that this shape gave for this ray.
    fn surface(&self, ray: &Ray, hit: Hit) -> Surface;

    /// A box that contains every point that [`hit`](Primitive::hit) can return; `None` when unbounded.
    fn bounds(&self) -> Option<Aabb>;

    /// The first crossing of a ray that starts on this very surface, the start itself not counted.
    ///
    /// `ray` and `within` are as made by [`Departure::ray`] or [`Departure::through`]. The default trusts the offset
    /// by the error radius that [`Departure::ray`] applied; shapes that know where the ray starts do better.
    fn hit_leaving(&self, ray: &Ray, within: Interval, from: &Departure) -> Option<Hit> {
        let moved = Ray::new(from.point + from.normal * (from.side.sign() * from.error), ray.direction);
        self.hit(&moved, within.after(0.0))
    }

    /// All crossings of a ray that starts on this very surface, ascending, the start itself not counted.
    ///
    /// The default repeats [`hit_leaving`](Primitive::hit_leaving) once and [`hit`](Primitive::hit) from there on.
    fn crossings_leaving(&self, ray: &Ray, within: Interval, from: &Departure, each: &mut dyn FnMut(Hit)) {
        if let Some(first) = self.hit_leaving(ray, within, from) {
            each(first);
            self.crossings(ray, within.after(first.t()), each);
        }
    }
}

impl<P: Primitive + ?Sized> Primitive for Arc<P> {
    fn hit(&self, ray: &Ray, within: Interval) -> Option<Hit> {
        (**self).hit(ray, within)
    }
    fn crossings(&self, ray: &Ray, within: Interval, each: &mut dyn FnMut(Hit)) {
        (**self).crossings(ray, within, each)
    }
    fn surface(&self, ray: &Ray, hit: Hit) -> Surface {
        (**self).surface(ray, hit)
    }
    fn bounds(&self) -> Option<Aabb> {
        (**self).bounds()
    }
    fn hit_leaving(&self, ray: &Ray, within: Interval, from: &Departure) -> Option<Hit> {
        (**self).hit_leaving(ray, within, from)
    }
    fn crossings_leaving(&self, ray: &Ray, within: Interval, from: &Departure, each: &mut dyn FnMut(Hit)) {
        (**self).crossings_leaving(ray, within, from, each)
    }
}
