//! A flat round disk: `normal . (p - center) = 0` and `|p - center| <= radius`.

use super::flat::{self, Doubt, Facing, Glance, Relative, Rough, U, Verdict};
use super::meeting::{self, ExactPlane, Meeting, Piece};
use crate::double::Double;
use crate::expansion::Expansion;
use crate::kernel::{Product, Task, run};
use crate::math::sqrt;
use crate::scaled::{checked_length, checked_point, range_guard, times_power};
use crate::{Aabb, Departure, Error, Hit, Interval, Primitive, Ray, Similarity, Surface};
use glam::DVec3;

/// A flat disk, its rim included. It has one part, 0, and a line meets it once at most; a ray in its plane does not.
///
/// # Texture axes
/// As for the [`Plane`](super::Plane): `uv` are the lengths of `point - center` along
/// [`texture_axes`](Disk::texture_axes), for a normal along a world axis the two others, exactly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disk {
    /// Its centre, and its normal for [`Rough`].
    facing: Facing,
    /// As given, times a power of two: largest component in `[1, 2)`.
    scaled_normal: DVec3,
    radius: f64,
    rim: Rim,
    normal: DVec3,
    axes: [DVec3; 2],
    /// The world axis that the normal lies along exactly.
    axis: Option<u8>,
    /// How far it reaches from its centre along each axis, rounded up.
    reach: DVec3,
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
        let unit = flat::unit(flat::doubles(normal));
        // The reach is radius sqrt(1 - n_i^2); sqrt(n_j^2 + n_k^2) errs by 4 u, the product by u; local coordinates
        // round once more.
        let reach = |a: f64, b: f64| radius * sqrt(a * a + b * b) * (1.0 + 16.0 * U);
        Ok(Disk {
            facing: Facing::new(center, normal),
            scaled_normal: normal,
            radius,
            rim: Rim::new(radius),
            normal: unit,
            axes: [first, second],
            axis: flat::world_axis(normal),
            reach: DVec3::new(reach(unit.y, unit.z), reach(unit.z, unit.x), reach(unit.x, unit.y)),
        })
    }

    /// The centre: the anchor of local and texture coordinates.
    pub fn center(&self) -> DVec3 {
        self.facing.anchor()
    }

    /// The unit normal.
    pub fn normal(&self) -> DVec3 {
        self.normal
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
        Disk::new(by.point(self.center()), by.direction(self.scaled_normal), self.radius * by.scale())
    }

    /// The hit, when its parameter or its place leave a doubt. An interval that ends exactly at the parameter
    /// that `f64` gives was made from a hit, and does not contain it.
    #[cold]
    #[inline(never)]
    fn hit_carefully(&self, ray: &Ray, within: Interval) -> Option<Hit> {
        if !ray.is_valid() {
            return None;
        }
        let there = Relative::new(self.center(), ray, self.radius);
        let span = there.interval(within);
        let (facing, radius) = (self.facing.at(DVec3::ZERO), self.radius * there.unit);
        let disk = Disk { facing, radius, rim: Rim::new(radius), ..*self };
        match disk.plainly(&there.ray, span) {
            Ok(hit) => return there.hit(hit?, within),
            Err(Doubt { ended: false }) => {}
            Err(Doubt { ended: true }) => return None,
        }
        let at = meeting::meet(self, ray)?;
        if run(InDisk { at: &at, radius: self.radius }) { within.admit(at.t, 0, 0) } else { None }
    }

    /// The hit, where `f64` can tell with the sharpest bounds.
    fn plainly(&self, ray: &Ray, within: Interval) -> Verdict {
        let (rough, d) = (Rough::new(&self.facing, ray), ray.direction);
        let slack = rough.slack() * (d.x.abs() + d.y.abs() + d.z.abs());
        // The place errs by the slack along the ray, and by two roundings of `t d`, less than a fifth of that, and of itself. Those
        // and the square's, 3 u, are less than 7 u r, and that of the radius' square u r (rho beyond 2 r errs by less than a small
        // part of rho - r). So |rho - r| > e decides, and with it |rho^2 - r^2| > e (e + 2 r), both ways. The radius is more
        // than 2^-200: no square here is lost to underflow.
        let error = 1.25 * slack + (8.0 * U) * self.radius;
        let (depth, doubt) = (self.rim.depth(&rough), error * (error + 2.0 * self.radius));
        let clear = rough.is_clear(within);
        if rough.is_sound() & ((depth < -doubt) | (clear & ((depth > doubt) | !within.contains(rough.t)))) {
            Ok(rough.admit(within, depth > 0.0))
        } else {
            Err(Doubt { ended: (depth > doubt) & rough.ends(within) })
        }
    }

    #[inline(never)]
    fn hit_closely(&self, ray: &Ray, within: Interval) -> Option<Hit> {
        match self.plainly(ray, within) {
            Ok(hit) => hit,
            Err(_) => self.hit_carefully(ray, within),
        }
    }
}

/// What tells a place inside the rim from one outside.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Rim {
    /// The square of the radius, or NaN where that would leave the range of the exponents.
    square: f64,
    /// [`Glance::CLEAR`] of it.
    least: f64,
}

impl Rim {
    fn new(radius: f64) -> Rim {
        let square = radius * radius + range_guard(radius);
        Rim { square, least: Glance::CLEAR * square }
    }

    /// How much more the square of the radius is than that of the distance of the place.
    #[inline(always)]
    fn depth(&self, rough: &Rough) -> f64 {
        self.square - rough.distance_squared()
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
        // In units of the radius, so that no square that matters over- or underflows; from farther away than squares reach it
        // is infinite or NaN, and the comparison false.
        let power = crate::math::exponent(self.radius);
        let radius = times_power(self.radius, -power);
        let shift = self.at.power - power;
        let part = |x: Double| Double { high: times_power(x.high, shift), low: times_power(x.low, shift) };
        let [x, y, z] = self.at.local.map(part);
        let square = x.square::<P>() + y.square::<P>() + z.square::<P>();
        square <= Double::product::<P>(radius, radius)
    }
}

impl Piece for Disk {
    #[inline(always)]
    fn plane(&self) -> ExactPlane {
        ExactPlane {
            anchor: self.center(),
            normal: flat::doubles(self.scaled_normal),
            axis: self.axis,
            offset: 0.0,
        }
    }

    fn exact_normal(&self) -> [Expansion; 3] {
        flat::expansions(self.scaled_normal)
    }

    #[inline(always)]
    fn record<P: Product>(&self, at: &Meeting) -> Surface {
        // The hit is inside; what double-double leaves beside the rim is noise.
        let center = self.center();
        let point = flat::clamped(at.point(center), center - self.reach, center + self.reach);
        let uv = at.along::<P>(&self.axes, self.axis);
        Surface::new(at.t, point, at.local(), self.normal, at.error_radius(point))
            .with_object_point(uv.extend(0.0))
            .with_uv(uv)
    }

    fn parallel(&self, _: &Ray, hit: Hit) -> Surface {
        Surface::new(hit.t(), self.center(), DVec3::ZERO, self.normal, self.radius)
    }
}

impl Primitive for Disk {
    #[inline]
    fn hit(&self, ray: &Ray, within: Interval) -> Option<Hit> {
        let glance = Glance::new(&self.facing, ray);
        if glance.is_close()
            && let Some(mut meets) = glance.is_within(within)
        {
            if meets {
                let excess = glance.excess(self.rim.square);
                if !(excess.abs() > glance.doubt() + self.rim.least) {
                    return self.hit_closely(ray, within);
                }
                meets = excess.is_sign_negative();
            }
            // No branch between hit and miss, since neighbouring rays may differ.
            return Hit::only(glance.t, meets);
        }
        self.hit_closely(ray, within)
    }

    fn crossings(&self, ray: &Ray, within: Interval, each: &mut dyn FnMut(Hit)) {
        if let Some(hit) = self.hit(ray, within) {
            each(hit);
        }
    }

    fn surface(&self, ray: &Ray, hit: Hit) -> Surface {
        meeting::surface(self, ray, hit)
    }

    fn bounds(&self) -> Option<Aabb> {
        let half = self.reach;
        Some(flat::outward(self.center(), -half, half))
    }

    fn hit_leaving(&self, _: &Ray, _: Interval, _: &Departure) -> Option<Hit> {
        None
    }

    fn crossings_leaving(&self, _: &Ray, _: Interval, _: &Departure, _: &mut dyn FnMut(Hit)) {}
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::exp2i;

    #[test]
    fn the_rim_belongs_to_it() {
        let disk = Disk::new([0.0; 3], [0.0, 0.0, 2.0], 5.0).unwrap();
        let down = |x: f64, y: f64| disk.hit(&Ray::new([x, y, 7.0], [0.0, 0.0, -2.0]), Interval::FORWARD);
        assert_eq!(down(3.0, 4.0).map(|h| h.t()), Some(3.5));
        assert_eq!(down(3.0, 4.0_f64.next_up()), None);
        assert!(down(3.0, 4.0_f64.next_down()).is_some());
    }

    #[test]
    fn rims_of_extreme_sizes() {
        for radius in [1e-150, 1e150] {
            let disk = Disk::new([0.0; 3], [0.0, 1.0, 0.0], radius).unwrap();
            let at = |x: f64| disk.hit(&Ray::new([x, radius, 0.0], [0.0, -1.0, 0.0]), Interval::FORWARD);
            assert!(at(radius).is_some() && at(radius.next_up()).is_none());
        }
    }

    #[test]
    fn bounds_of_a_tilted_disk() {
        let disk = Disk::new([10.0, 0.0, 0.0], [0.0, 0.6, 0.8], 2.0).unwrap();
        let bounds = disk.bounds().unwrap();
        assert!((bounds.max - DVec3::new(12.0, 1.6, 1.2)).abs().max_element() < 1e-14);
        assert!(bounds.contains(DVec3::new(12.0, 0.0, 0.0)));
    }

    /// Where plain `f64` leaves its range the same digits come out as where it does not.
    #[test]
    fn out_of_range_no_bit_changes() {
        let near = Disk::new([0.1, 0.2, 0.3], [0.3, -0.7, 0.9], 1.7).unwrap();
        let ray = Ray::new([3.1, 2.2, 5.7], [-2.4, -1.3, -5.5]);
        let t = near.hit(&ray, Interval::FORWARD).unwrap().t();
        for power in [-480, -300, 300, 500] {
            let far =
                Disk::new(near.center() * exp2i(power), near.scaled_normal, 1.7 * exp2i(power)).unwrap();
            for speed in [-481, -300, 300, 481] {
                let there = Ray::new(ray.origin * exp2i(power), ray.direction * exp2i(speed));
                let found = far.hit(&there, Interval::FORWARD).unwrap().t();
                assert_eq!(times_power(found, speed - power), t, "2^{power}, 2^{speed}");
            }
        }
    }

    #[test]
    fn constructor_errors() {
        assert!(matches!(Disk::new([0.0; 3], [0.0, 1.0, 0.0], 0.0), Err(Error::NotPositive { .. })));
        assert!(matches!(Disk::new([0.0; 3], [0.0, 1.0, 0.0], f64::NAN), Err(Error::NotPositive { .. })));
        assert!(matches!(Disk::new([0.0; 3], [0.0; 3], 1.0), Err(Error::ZeroLength { .. })));
    }

    /// Places beyond the reach of squares are outside, as is what is no number.
    #[test]
    fn far_outside() {
        for (x, power, inside) in [
            (0.5, 0, true),
            (1.0, 0, true),
            (1.5, 0, false),
            (1.0, 600, false),
            (1.0, 1000, false),
            (f64::INFINITY, 0, false),
            (f64::NAN, 0, false),
        ] {
            for k in 0..3 {
                let mut local = [crate::double::Double::ZERO; 3];
                local[k] = crate::double::Double::from(x);
                let at = Meeting { t: 1.0, local, power, error: 0.0 };
                assert_eq!(run(InDisk { at: &at, radius: 1.0 }), inside, "{x} {power} {k}");
            }
        }
    }

    /// What must not become slow unseen: `f64` tells all plain hits and misses, and the same as exact arithmetic.
    #[test]
    fn plainly_as_exactly() {
        let mut random = crate::testing::Random::new(1);
        let mut count = [0_u32; 3];
        for case in 0..8000 {
            let disk = Disk::new(random.in_cube(), random.direction(), random.uniform(0.1, 1.0)).unwrap();
            let ray = Ray::new(random.direction() * 4.0, random.direction());
            let mut target = disk.center() + random.in_cube() * disk.radius;
            if case >= 4000 {
                // Past the rim by nearly nothing.
                let out = disk.normal.cross(random.direction()).normalize();
                target = disk.center()
                    + out * (disk.radius * (1.0 + random.sign() * random.magnitude(-18.0, -8.0)));
            }
            let ray = Ray::new(ray.origin, target - ray.origin);
            let Ok(found) = disk.plainly(&ray, Interval::FORWARD) else {
                count[0] += u32::from(case < 4000);
                continue;
            };
            let at = meeting::meet(&disk, &ray).unwrap();
            let inside = run(InDisk { at: &at, radius: disk.radius });
            assert_eq!(found.is_some(), inside, "{disk:?} {ray:?}");
            if let Some(hit) = found {
                assert!((hit.t() - at.t).abs() <= exp2i(-30), "{disk:?} {ray:?}");
            }
            if case < 4000 {
                // An interval that ends before the disk, or begins after it, is told at once as well.
                for within in [Interval::FORWARD.until(0.99 * at.t), Interval::FORWARD.after(1.01 * at.t)] {
                    assert!(matches!(disk.plainly(&ray, within), Ok(None)), "{disk:?} {ray:?}");
                }
            }
            count[1 + usize::from(inside)] += 1;
        }
        assert!(count[0] < 10 && count[1] > 1000 && count[2] > 1000, "{count:?}");
    }

    /// What is certain at a glance is so, however near to the rim, and how near that is.
    #[test]
    fn how_near_to_the_rim_a_place_is_told() {
        let mut random = crate::testing::Random::new(2);
        let mut count = [0_u32; 3];
        for _ in 0..8000 {
            let radius = random.magnitude(-2.0, 2.0);
            let disk = Disk::new(random.in_cube() * radius, random.direction(), radius).unwrap();
            let out = disk.normal.cross(random.direction()).normalize();
            let share = 1.0 + random.sign() * random.magnitude(-13.0, 0.0);
            let target = disk.center() + out * (radius * share);
            let origin = target + random.direction() * (radius * random.magnitude(-1.0, 3.0));
            let ray = Ray::new(origin, (target - origin) * random.magnitude(-1.0, 1.0));
            let glance = Glance::new(&disk.facing, &ray);
            if !glance.is_close() {
                continue;
            }
            assert_eq!(glance.t, Rough::new(&disk.facing, &ray).t);
            let (excess, doubt) = (glance.excess(disk.rim.square), glance.doubt() + disk.rim.least);
            let far = (ray.origin - disk.center()).length();
            assert!(doubt <= 1.001 * (exp2i(-39) * far * far + exp2i(-33) * radius * radius));
            if excess.abs() <= doubt {
                count[0] += 1;
                continue;
            }
            let at = meeting::meet(&disk, &ray).unwrap();
            let inside = run(InDisk { at: &at, radius });
            assert_eq!(excess < 0.0, inside, "{disk:?} {ray:?}");
            assert_eq!(disk.hit(&ray, Interval::LINE).is_some(), inside, "{disk:?} {ray:?}");
            count[1 + usize::from(inside)] += 1;
        }
        assert!(count.iter().all(|&count| count > 500), "{count:?}");
    }

    /// From so far away that squares overflow, a disk is still found, and missed.
    #[test]
    fn from_where_squares_overflow() {
        let disk = Disk::new([0.0; 3], [0.0, 1.0, 0.0], 1.0).unwrap();
        for power in [200, 440, 499, 500, 501, 505, 508, 511, 512, 600] {
            for speed in [-300, 0, 300, 508, 511, 512, 513] {
                let (away, along) = (exp2i(power), exp2i(speed));
                for (place, inside) in [(0.0, true), (0.5, true), (1.5, false)] {
                    let ray = Ray::new([place, away, 0.0], [0.0, -along, 0.0]);
                    assert_eq!(
                        disk.hit(&ray, Interval::LINE).is_some(),
                        inside,
                        "2^{power} 2^{speed} {place}"
                    );
                }
                let beside = Ray::new([away, away, 0.0], [-along * 0.75, -along, 0.0]);
                assert!(disk.hit(&beside, Interval::LINE).is_none(), "2^{power} 2^{speed}");
            }
        }
    }

    /// A parameter that underflows to zero is not inside an interval that begins at minus zero.
    #[test]
    fn parameters_that_underflow() {
        let disk = Disk::new(
            [-8.307674969787162e34, 0.0, 0.0],
            [0.0, 1.907348634588857e-6, 1.5576911988681483],
            7.339311609538979e36,
        );
        let disk = disk.unwrap();
        let ray = Ray::new(
            [-6.951677008358049e-209, -4.260078838878369e-119, -1.4678102010332136e-186],
            [-f64::MAX, f64::MAX, 1.1527554512648458e51],
        );
        for min in [-0.0, 0.0] {
            let within = Interval::new(min, f64::INFINITY);
            assert!(disk.hit(&ray, within).is_none_or(|hit| within.contains(hit.t())), "{min}");
        }
    }
}
