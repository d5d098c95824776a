//! The full record of a hit, and how a ray leaves a surface.

use crate::{Hit, Interval, Ray};
use glam::{DVec2, DVec3};

/// Everything about the point that a ray hit, made once, for the winning [`Hit`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Surface {
    /// The refined parameter: correctly rounded wherever `f64` input determines it.
    pub t: f64,
    /// The point in the world, within one unit in the last place of its largest coordinate.
    pub point: DVec3,
    /// The point minus the shape's own anchor (its centre, base or corner, world axes): within one unit in the last
    /// place of the shape's size, however far from the world's origin the shape is.
    pub local: DVec3,
    /// `local` in the shape's own axes: what solid textures are functions of. Plane and disk: the lengths along their
    /// two documented axes, then exactly zero.
    pub object_point: DVec3,
    /// The geometric unit normal: outward for closed shapes, else as the shape's own documentation says.
    pub normal: DVec3,
    /// The unit normal that shading uses: differs from `normal` on a smooth triangle only.
    pub shading_normal: DVec3,
    /// Texture coordinates as the shape's own documentation says: angles in turns, in `[0, 1)`; plane and disk:
    /// lengths.
    pub uv: DVec2,
    /// The error radius: the true point lies within this distance of `point`.
    pub error: f64,
}

impl Surface {
    /// A surface record whose shading normal is the geometric one, whose own axes are the world's and whose texture
    /// coordinates are zero.
    ///
    /// `t`, `point`, `local`, `normal`, `error`: see the fields.
    #[inline]
    pub fn new(t: f64, point: DVec3, local: DVec3, normal: DVec3, error: f64) -> Self {
        Surface {
            t,
            point,
            local,
            object_point: local,
            normal,
            shading_normal: normal,
            uv: DVec2::ZERO,
            error,
        }
    }

    /// The same record with these texture coordinates.
    #[inline]
    pub fn with_uv(mut self, uv: DVec2) -> Self {
        self.uv = uv;
        self
    }

    /// The same record with this point in the shape's own axes.
    #[inline]
    pub fn with_object_point(mut self, object_point: DVec3) -> Self {
        self.object_point = object_point;
        self
    }

    /// The same record with this unit normal for shading.
    #[inline]
    pub fn with_shading_normal(mut self, normal: DVec3) -> Self {
        self.shading_normal = normal;
        self
    }

    /// The place that rays leave from when they start at this hit of `object`, on `side` of the surface.
    ///
    /// The side follows from the role of the new ray (mirror and shadow rays keep the side of arrival, a
    /// transmitted ray takes the other), never from a sign computed anew.
    #[inline]
    pub fn departure(&self, object: u32, hit: Hit, side: Side) -> Departure {
        Departure {
            object,
            part: hit.part(),
            side,
            local: self.local,
            point: self.point,
            normal: self.normal,
            error: self.error,
        }
    }
}

/// The two sides of a surface, told by its geometric normal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Side {
    /// The side that the normal points to.
    Outside,
    /// The side that the normal points away from.
    Inside,
}

impl Side {
    /// The side from which a ray with this `direction` arrives at a surface with this `normal`.
    #[inline]
    pub fn of_arrival(direction: DVec3, normal: DVec3) -> Side {
        if direction.dot(normal) < 0.0 { Side::Outside } else { Side::Inside }
    }

    /// The other side.
    #[inline]
    pub fn other(self) -> Side {
        match self {
            Side::Outside => Side::Inside,
            Side::Inside => Side::Outside,
        }
    }

    /// +1 outside, -1 inside.
    #[inline]
    pub fn sign(self) -> f64 {
        match self {
            Side::Outside => 1.0,
            Side::Inside => -1.0,
        }
    }
}

/// Where a spawned ray starts: on which object, on which part, on which side.
///
/// The ray's own shape is handled by identity, without any offset
/// ([`Primitive::hit_leaving`](crate::Primitive::hit_leaving)); against other shapes the ray starts moved to its
/// side by the error radius ([`Departure::ray`]).
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Departure {
    /// The index of the object in its [`Geometry`](crate::Geometry).
    pub object: u32,
    /// The part of the shape, as in the hit.
    pub part: u32,
    /// The side on which the new ray runs at its start.
    pub side: Side,
    /// The start, relative to the shape's own anchor: see [`Surface::local`].
    pub local: DVec3,
    /// The start in the world: see [`Surface::point`].
    pub point: DVec3,
    /// The geometric normal there.
    pub normal: DVec3,
    /// The error radius there.
    pub error: f64,
}

impl Departure {
    /// The ray for a mirror or a shadow: it starts on the departure's side, moved along the normal by the error
    /// radius, so that no shape on the other side of this point can be taken for a hit; the interval is
    /// `0 < t`.
    #[inline]
    pub fn ray(&self, direction: DVec3) -> (Ray, Interval) {
        (Ray::new(self.point + self.normal * (self.side.sign() * self.error), direction), Interval::FORWARD)
    }

    /// The ray that goes on through the surface: it starts at the point itself and admits other shapes from
    /// `t > -error / |direction . normal|`, so that a face that coincides with this one is not lost.
    #[inline]
    pub fn through(&self, direction: DVec3) -> (Ray, Interval) {
        let slack = self.error / direction.dot(self.normal).abs();
        let min = if slack.is_finite() { -slack } else { 0.0 };
        (Ray::new(self.point, direction), Interval::new(min, f64::INFINITY))
    }
}
