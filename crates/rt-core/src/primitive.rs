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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::Torus;
    use crate::{Shape, Side};
    use alloc::vec::Vec;

    /// A shape behind a pointer is the shape.
    #[test]
    fn an_arc_is_what_it_points_to() {
        let torus = Torus::new([0.5, 0.0, 0.0], [0.0, 1.0, 1.0], 1.0, 0.3).unwrap();
        let (plain, shared) = (Shape::from(torus), Arc::new(torus));
        assert_eq!(Primitive::bounds(&shared), plain.bounds());
        let mut count = 0;
        for i in 0..50 {
            let ray = Ray::new([0.5, 0.0, 4.0], [0.03 * f64::from(i) - 0.75, 0.3, -4.0]);
            let hit = shared.hit(&ray, Interval::FORWARD);
            assert_eq!(hit, plain.hit(&ray, Interval::FORWARD));
            let all = |shape: &dyn Primitive| {
                let mut all = Vec::new();
                shape.crossings(&ray, Interval::FORWARD, &mut |hit| all.push(hit));
                all
            };
            assert_eq!(all(&shared), all(&plain));
            let Some(hit) = hit else { continue };
            count += all(&shared).len();
            let surface = shared.surface(&ray, hit);
            assert_eq!(surface.point, plain.surface(&ray, hit).point);
            let from = surface.departure(0, hit, Side::Inside);
            let (onward, within) = from.ray(ray.direction);
            let next = shared.hit_leaving(&onward, within, &from);
            assert!(next.is_some() && next == plain.hit_leaving(&onward, within, &from));
            let rest = |shape: &dyn Primitive| {
                let mut rest = Vec::new();
                shape.crossings_leaving(&onward, within, &from, &mut |hit| rest.push(hit));
                rest
            };
            assert_eq!(rest(&shared), rest(&plain));
            count += rest(&shared).len();
        }
        assert!(count > 60, "{count}");
    }
}
