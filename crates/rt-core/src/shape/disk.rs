//! A flat round disk: `normal . (p - center) = 0` and `|p - center| <= radius`.

use super::flat::{self, ExactPlane, LEAST_CERTAIN, Meeting, U};
use crate::double::Double;
use crate::kernel::{Product, Task, run};
use crate::math::sqrt;
use crate::scaled::{checked_length, checked_point, times_power};
use crate::{Aabb, Departure, Error, Hit, Interval, Primitive, Ray, Similarity, Surface};
use glam::DVec3;

/// A flat disk, its rim included. It has one part, 0, and a line meets it once at most; a ray in its plane does not.
///
/// # Texture axes
/// As for the [`Plane`](super::Plane): `uv` are the lengths of `point - center` along
/// [`texture_axes`](Disk::texture_axes), for a normal along a world axis the two others, exactly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disk {
    center: DVec3,
    /// As given, times a power of two: largest component in `[1, 2)`.
    normal: DVec3,
    radius: f64,
    unit_normal: DVec3,
    axes: [DVec3; 2],
}

impl Disk {
    /// The disk of `radius` about `center` across `normal`, of any length but zero; the surface normal is
    /// `normal / |normal|`.
    ///
    /// # Errors
    /// [`Error::NotFinite`], [`Error::ZeroLength`] for the normal, [`Error::NotPositive`] for the radius,
    /// [`Error::OutOfRange`] for lengths beyond 1e150 and a radius below 1e-150.
    pub fn new(center: impl Into<DVec3>, normal: impl Into<DVec3>, radius: f64) -> Result<Self, Error> {
        let center = checked_point("disk center", center.into())?;
        let (normal, _) = flat::prescaled(flat::checked_direction("disk normal", normal.into())?);
        let radius = checked_length("disk radius", radius)?;
        let (first, second) = flat::plane_axes(normal);
        let unit_normal = flat::unit(flat::doubles(normal));
        Ok(Disk { center, normal, radius, unit_normal, axes: [first, second] })
    }

    /// The centre: the anchor of local and texture coordinates.
    pub fn center(&self) -> DVec3 {
        self.center
    }

    /// The unit normal.
    pub fn normal(&self) -> DVec3 {
        self.unit_normal
    }

    /// The radius.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// The two unit vectors along which texture coordinates count.
    pub fn texture_axes(&self) -> [DVec3; 2] {
        self.axes
    }

    /// Scaled, turned and moved.
    ///
    /// # Errors
    /// As [`Disk::new`].
    pub fn transformed(&self, by: &Similarity) -> Result<Self, Error> {
        Disk::new(by.point(self.center), by.direction(self.normal), self.radius * by.scale())
    }

    /// How far it reaches from its centre along each axis, rounded up: `radius sqrt(1 - n_i^2)`.
    fn reach(&self) -> DVec3 {
        let n = self.unit_normal;
        // sqrt(n_j^2 + n_k^2) errs by 4 u, the product by u; local coordinates round once more.
        let reach = |a: f64, b: f64| self.radius * sqrt(a * a + b * b) * (1.0 + 16.0 * U);
        DVec3::new(reach(n.y, n.z), reach(n.z, n.x), reach(n.x, n.y))
    }

    fn meet(&self, ray: &Ray) -> Option<Meeting> {
        let plane = ExactPlane { anchor: self.center, normal: flat::doubles(self.normal), offset: 0.0 };
        let mut at = flat::meet(&plane, ray, || flat::expansions(self.normal))?;
        flat::settle(&mut at, self.normal);
        Some(at)
    }

    /// The hit, when its parameter `rough` or its place leave a doubt. An interval that ends exactly at the parameter
    /// that `f64` gives was made from a hit, and does not contain it.
    #[cold]
    #[inline(never)]
    fn hit_exactly(&self, ray: &Ray, within: Interval, rough: f64) -> Option<Hit> {
        if !ray.is_valid() || rough == within.min || rough == within.max {
            return None;
        }
        let at = self.meet(ray)?;
        if run(InDisk { at: &at, radius: self.radius }) { within.admit(at.t, 0, 0) } else { None }
    }
}

/// Whether a point lies no farther from the anchor than the radius, in double-double.
struct InDisk<'a> {
    at: &'a Meeting,
    radius: f64,
}

impl Task for InDisk<'_> {
    type Output = bool;
    #[inline(always)]
    fn run<P: Product>(self) -> bool {
        // In units of the radius, so that no square over- or underflows; far outside is decided before.
        let power = crate::math::exponent(self.radius);
        let radius = times_power(self.radius, -power);
        let shift = self.at.power - power;
        let part = |x: Double| Double { high: times_power(x.high, shift), low: times_power(x.low, shift) };
        let [x, y, z] = self.at.local.map(part);
        let far = |x: Double| !(x.high.abs() <= 4.0);
        if far(x) || far(y) || far(z) {
            return false;
        }
        let square = x.square::<P>() + y.square::<P>() + z.square::<P>();
        square <= Double::product::<P>(radius, radius)
    }
}

impl Primitive for Disk {
    #[inline]
    fn hit(&self, ray: &Ray, within: Interval) -> Option<Hit> {
        let w = self.center - ray.origin;
        let n = self.normal * w;
        let d = self.normal * ray.direction;
        let denominator = d.x + d.y + d.z;
        let inverse = 1.0 / denominator;
        let t = (n.x + n.y + n.z) * inverse;
        // As for the plane, with one more rounding in the quotient: |dt| |denominator| <= slack.
        let (n, d) = (n.abs(), d.abs());
        let sizes = d.x + d.y + d.z;
        let slack = (6.0 * U) * ((n.x + n.y + n.z) + t.abs() * sizes);
        // The point t d - w errs in each coordinate by |dt| |d| and three roundings; `error` bounds the sum of all
        // three. |rho - r| > error decides, that is |rho^2 - r^2| > error (rho + r), rho being at most the sum of the
        // coordinates' sizes; the squares round by 4 u of themselves.
        let p = ray.direction * t - w;
        let (w, v, q) = (w.abs(), ray.direction.abs(), p.abs());
        let error =
            (v.x + v.y + v.z) * (slack * inverse.abs() + (3.0 * U) * t.abs()) + (3.0 * U) * (w.x + w.y + w.z);
        let (rho2, r2) = (p.length_squared(), self.radius * self.radius);
        let doubt = error * ((q.x + q.y + q.z) + self.radius) + (5.0 * U) * (rho2 + r2) + LEAST_CERTAIN;
        let from_min = (t - within.min).abs() * denominator.abs();
        let from_max = (t - within.max).abs() * denominator.abs();
        let certain = slack > LEAST_CERTAIN && flat::crosses(denominator, sizes);
        if certain && rho2 - r2 > doubt {
            None
        } else if certain && r2 - rho2 > doubt && from_min > slack && from_max > slack {
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
        let Some(at) = self.meet(ray) else {
            // Only for a ray that this disk gave no hit for.
            return Surface::new(hit.t(), self.center, DVec3::ZERO, self.unit_normal, self.radius);
        };
        // The hit is inside; what double-double leaves beside the rim is noise.
        let half = self.reach();
        let point = at.point(self.center).clamp(self.center - half, self.center + half);
        let uv = at.along(self.axes[0], self.axes[1]);
        Surface::new(at.t, point, at.local(), self.unit_normal, at.error_radius(point))
            .with_object_point(uv.extend(0.0))
            .with_uv(uv)
    }

    fn bounds(&self) -> Option<Aabb> {
        let half = self.reach();
        Some(flat::outward(self.center, -half, half))
    }

    fn hit_leaving(&self, _: &Ray, _: Interval, _: &Departure) -> Option<Hit> {
        None
    }

    fn crossings_leaving(&self, _: &Ray, _: Interval, _: &Departure, _: &mut dyn FnMut(Hit)) {}
}
