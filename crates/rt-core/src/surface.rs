//! The full record of a hit, and how a ray leaves a surface.

use crate::frame::turns;
use crate::math::sqrt;
use crate::{Hit, Interval, Ray};
use glam::{DVec2, DVec3};

/// Texture coordinates, their angles not measured yet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Coordinates {
    /// The coordinates themselves.
    Known(DVec2),
    /// A vector whose angle is `u`, and `v`.
    Side(DVec2, f64),
    /// Longitude and latitude of the normal, about the y axis.
    Globe,
    /// The vectors whose angles are `u` and `v`.
    Ring(DVec2, DVec2),
}

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
    /// What the texture coordinates are made of.
    coordinates: Coordinates,
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
            coordinates: Coordinates::Known(DVec2::ZERO),
            error,
        }
    }

    /// Puts another record in its place, each number by itself: a record that is made first and copied in wider pieces is
    /// read before it is written.
    #[inline(always)]
    #[allow(clippy::too_many_arguments)]
    pub(crate) fn set(
        &mut self,
        t: f64,
        point: DVec3,
        local: DVec3,
        object_point: DVec3,
        normal: DVec3,
        coordinates: Coordinates,
        error: f64,
    ) {
        self.t = t;
        self.point = point;
        self.local = local;
        self.object_point = object_point;
        self.normal = normal;
        self.shading_normal = normal;
        self.coordinates = coordinates;
        self.error = error;
    }

    /// The same record with these texture coordinates.
    #[inline]
    pub fn with_uv(mut self, uv: DVec2) -> Self {
        self.coordinates = Coordinates::Known(uv);
        self
    }

    /// The same record with these texture coordinates, to be measured when asked for.
    #[inline(always)]
    pub(crate) fn with_coordinates(mut self, coordinates: Coordinates) -> Self {
        self.coordinates = coordinates;
        self
    }

    /// Texture coordinates as the shape's own documentation says: angles in turns, in `[0, 1)`; plane and disk:
    /// lengths.
    ///
    /// Computed at each call: an angle costs more than a hit, and few textures need one.
    pub fn uv(&self) -> DVec2 {
        match self.coordinates {
            Coordinates::Known(uv) => uv,
            Coordinates::Side(across, v) => DVec2::new(turns(across.x, across.y), v),
            Coordinates::Globe => {
                let n = self.normal;
                let latitude = libm::atan2(n.y, sqrt(n.x * n.x + n.z * n.z));
                DVec2::new(turns(n.x, -n.z), 0.5 + latitude * core::f64::consts::FRAC_1_PI)
            }
            Coordinates::Ring(around, tube) => DVec2::new(turns(around.x, around.y), turns(tube.x, tube.y)),
        }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Primitive;
    use crate::shape::Sphere;

    /// On a globe the first coordinate runs around, the second from the south pole to the north pole.
    #[test]
    fn coordinates_of_a_globe() {
        let sphere = Sphere::new([1.0, 2.0, 3.0], 2.0).unwrap();
        for (x, y, z, v) in [
            (0.0, -1.0, 0.0, 0.0),
            (0.0, 1.0, 0.0, 1.0),
            (1.0, 0.0, 0.0, 0.5),
            (0.6, 0.8, 0.0, 0.795_167_235_3),
            (0.0, -0.6, 0.8, 0.295_167_235_3),
        ] {
            let way = DVec3::new(x, y, z);
            let ray = crate::Ray::new(sphere.center() + way * 5.0, -way);
            let hit = sphere.hit(&ray, crate::Interval::FORWARD).unwrap();
            let uv = sphere.surface(&ray, hit).uv();
            assert!((uv.y - v).abs() < 1e-9 && (0.0..1.0).contains(&uv.x), "{way}: {uv}");
        }
    }
}
