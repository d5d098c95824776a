//! An infinite plane: `normal . (p - point) = 0`.
//!
//! `hit` costs one division and a certificate: it compares `t` with both ends of the interval and goes to exact
//! arithmetic only when an end lies within the error of `t`, or when the ray is parallel to the plane as far as `f64`
//! can tell. Source of the error bound: Higham, Accuracy and Stability of Numerical Algorithms, section 3.1.

use super::flat::{self, ExactPlane, LEAST_CERTAIN, Meeting, U};
use crate::scaled::checked_point;
use crate::{Aabb, Departure, Error, Hit, Interval, Primitive, Ray, Similarity, Surface};
use glam::DVec3;

/// An infinite plane. It has one part, 0, and a line meets it once at most.
///
/// # Texture axes
/// `uv` are the lengths of `point - self.point()` along two unit vectors in the plane: take the two world axes in
/// which the normal is not largest (of equals, x before y before z counts as the largest), in the order x, y, z. The
/// first is projected onto the plane; the second is perpendicular to it, on the side of its world axis. For a normal
/// along y that makes u the world's x and v its z, exactly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    point: DVec3,
    /// As given, times a power of two: largest component in `[1, 2)`.
    normal: DVec3,
    unit_normal: DVec3,
    axes: [DVec3; 2],
}

impl Plane {
    /// The plane through `point` across `normal`, of any length but zero; the surface normal is `normal / |normal|`.
    ///
    /// # Errors
    /// [`Error::NotFinite`], [`Error::ZeroLength`] for the normal, [`Error::OutOfRange`] for a point beyond 1e150.
    pub fn new(point: impl Into<DVec3>, normal: impl Into<DVec3>) -> Result<Self, Error> {
        let point = checked_point("plane point", point.into())?;
        let (normal, _) = flat::prescaled(flat::checked_direction("plane normal", normal.into())?);
        let (first, second) = flat::plane_axes(normal);
        Ok(Plane { point, normal, unit_normal: flat::unit(flat::doubles(normal)), axes: [first, second] })
    }

    /// The point it was made from: the anchor of local and texture coordinates.
    pub fn point(&self) -> DVec3 {
        self.point
    }

    /// The unit normal.
    pub fn normal(&self) -> DVec3 {
        self.unit_normal
    }

    /// The two unit vectors along which texture coordinates count.
    pub fn texture_axes(&self) -> [DVec3; 2] {
        self.axes
    }

    /// Scaled, turned and moved.
    ///
    /// # Errors
    /// As [`Plane::new`].
    pub fn transformed(&self, by: &Similarity) -> Result<Self, Error> {
        Plane::new(by.point(self.point), by.direction(self.normal))
    }

    fn exact(&self) -> ExactPlane {
        ExactPlane { anchor: self.point, normal: flat::doubles(self.normal), offset: 0.0 }
    }

    fn meet(&self, ray: &Ray) -> Option<Meeting> {
        flat::meet(&self.exact(), ray, || flat::expansions(self.normal))
    }

    /// The hit, when its parameter `rough` or its place leave a doubt. An interval that ends exactly at the parameter
    /// that `f64` gives was made from a hit, and does not contain it.
    #[cold]
    #[inline(never)]
    fn hit_exactly(&self, ray: &Ray, within: Interval, rough: f64) -> Option<Hit> {
        if !ray.is_valid() || rough == within.min || rough == within.max {
            return None;
        }
        within.admit(self.meet(ray)?.t, 0, 0)
    }
}

impl Primitive for Plane {
    #[inline]
    fn hit(&self, ray: &Ray, within: Interval) -> Option<Hit> {
        let n = self.normal * (self.point - ray.origin);
        let d = self.normal * ray.direction;
        let denominator = d.x + d.y + d.z;
        let t = (n.x + n.y + n.z) / denominator;
        // The numerator errs by 4 u of the sum of its terms' sizes (difference, product, two additions), the
        // denominator by 3 u of its own, the quotient by u: |dt| |denominator| <= 4 u (sizes), the fifth pays for the
        // roundings of this bound and of the comparisons.
        let (n, d) = (n.abs(), d.abs());
        let sizes = d.x + d.y + d.z;
        let slack = (5.0 * U) * ((n.x + n.y + n.z) + t.abs() * sizes);
        let from_min = (t - within.min).abs() * denominator.abs();
        let from_max = (t - within.max).abs() * denominator.abs();
        if from_min > slack && from_max > slack && slack > LEAST_CERTAIN && flat::crosses(denominator, sizes)
        {
            within.admit(t, 0, 0)
        } else {
            self.hit_exactly(ray, within, t)
        }
    }

    fn crossings(&self, ray: &Ray, within: Interval, each: &mut dyn FnMut(Hit)) {
        if let Some(hit) = self.hit(ray, within) {
            each(hit);
        }
    }

    fn surface(&self, ray: &Ray, hit: Hit) -> Surface {
        let Some(mut at) = self.meet(ray) else {
            // Only for a ray that this plane gave no hit for.
            return Surface::new(
                hit.t(),
                ray.at(hit.t()),
                ray.at(hit.t()) - self.point,
                self.unit_normal,
                0.0,
            );
        };
        flat::settle(&mut at, self.normal);
        let point = at.point(self.point);
        let uv = at.along(self.axes[0], self.axes[1]);
        Surface::new(at.t, point, at.local(), self.unit_normal, at.error_radius(point))
            .with_object_point(uv.extend(0.0))
            .with_uv(uv)
    }

    fn bounds(&self) -> Option<Aabb> {
        None
    }

    fn hit_leaving(&self, _: &Ray, _: Interval, _: &Departure) -> Option<Hit> {
        None
    }

    fn crossings_leaving(&self, _: &Ray, _: Interval, _: &Departure, _: &mut dyn FnMut(Hit)) {}
}
