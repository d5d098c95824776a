//! What every shape owes its callers, checked with hard rays.

use super::HardRays;
use crate::{Departure, Hit, Interval, Primitive, Ray, Side, Surface};
use alloc::format;
use alloc::string::{String, ToString};
use alloc::vec::Vec;
use core::fmt;
use glam::DVec3;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// The unit roundoff.
const U: f64 = f64::EPSILON / 2.0;

/// How much [`check_primitive`] does, and what it may assume.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Effort {
    /// Where the sequence of rays starts.
    pub seed: u64,
    /// How many rays of each kind.
    pub rays: u32,
    /// Whether the shape encloses a volume: then every line crosses it an even number of times.
    pub closed: bool,
}

impl Effort {
    /// This many rays of each kind from this seed, at a shape that need not be closed.
    pub fn new(seed: u64, rays: u32) -> Self {
        Effort { seed, rays, closed: false }
    }

    /// The same for a shape that encloses a volume.
    pub fn closed(mut self) -> Self {
        self.closed = true;
        self
    }
}

impl Default for Effort {
    /// A thousand rays of each kind.
    fn default() -> Self {
        Effort::new(1, 1000)
    }
}

/// The first broken promise that [`check_primitive`] found.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Failure {
    /// What was promised.
    pub promise: &'static str,
    /// The ray.
    pub ray: Ray,
    /// The interval.
    pub within: Interval,
    /// What was found instead.
    pub found: String,
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Failure { promise, ray, within, found } = self;
        write!(
            f,
            "broken: {promise}: {found}, for a ray from {:?} along {:?} within {:?} and {:?}",
            ray.origin.to_array(),
            ray.direction.to_array(),
            within.min,
            within.max
        )
    }
}

impl core::error::Error for Failure {}

/// Casts hard rays at a shape and checks its contract:
///
/// - no argument makes a method panic, and a ray that is not [valid](Ray::is_valid) hits nothing;
/// - every hit lies inside the interval; ending the interval at a hit or before it removes it, so does starting there
///   or after it; splitting it anywhere does not change the first hit;
/// - the crossings ascend and begin with the first hit; a closed shape has an even number on a line;
/// - the same question has the same answer, bit for bit; a direction twice as long gives half the parameter exactly;
/// - the point is on the ray to within the error radius, inside the [bounds](Primitive::bounds), and as far from
///   `local` as every other point is; the normals have unit length to within 4 u (u = 2^-53);
/// - a ray that leaves a hit back to where the first ray came from meets nothing on its way.
///
/// Whether the shape is where it should be only its own tests can tell.
///
/// # Errors
/// The first [`Failure`].
pub fn check_primitive(shape: &dyn Primitive, effort: &Effort) -> Result<(), Failure> {
    let mut rays = HardRays::new(effort.seed, shape.bounds());
    let check = Check { shape, closed: effort.closed };
    let mut known: Option<(DVec3, DVec3)> = None;
    for _ in 0..effort.rays {
        let (ray, within) = rays.anything();
        check.never_panics(&ray, within)?;
        let mut aims = [Some(rays.aimed()), Some(rays.at_feature()), None, None];
        if let Some((point, normal)) = known {
            aims[2] = Some(rays.grazing(point, normal));
            aims[3] = Some(rays.starting_at(point));
        }
        for ray in aims.into_iter().flatten() {
            let share = rays.random().uniform(0.0, 1.5);
            if let Some(surface) = check.ray(&ray, share)? {
                known = Some((surface.point, surface.normal));
            }
        }
    }
    Ok(())
}

struct Check<'a> {
    shape: &'a dyn Primitive,
    closed: bool,
}

impl Check<'_> {
    fn never_panics(&self, ray: &Ray, within: Interval) -> Result<(), Failure> {
        let cast = || {
            let mut count = 0_u32;
            self.shape.crossings(ray, within, &mut |_| count += 1);
            let hit = self.shape.hit(ray, within);
            if let Some(hit) = hit {
                let surface = self.shape.surface(ray, hit);
                for side in [Side::Outside, Side::Inside] {
                    let from = surface.departure(0, hit, side);
                    self.shape.hit_leaving(ray, within, &from);
                }
            }
            (hit, count)
        };
        let fail = |found: String| Failure {
            promise: "no panic, no hit of an invalid ray",
            ray: *ray,
            within,
            found,
        };
        let (hit, count) = catch_unwind(AssertUnwindSafe(cast)).map_err(|_| fail("a panic".to_string()))?;
        match hit {
            Some(hit) if !ray.is_valid() => Err(fail(format!("{hit:?}"))),
            Some(hit) if !within.contains(hit.t()) => Err(fail(format!("{hit:?}"))),
            None if count > 0 && !ray.is_valid() => Err(fail(format!("{count} crossings"))),
            _ => Ok(()),
        }
    }

    /// Everything about one valid ray; `share` places the split of the interval. The surface of the first hit.
    fn ray(&self, ray: &Ray, share: f64) -> Result<Option<Surface>, Failure> {
        if !ray.is_valid() {
            return Ok(None);
        }
        let shape = self.shape;
        let mut line: Vec<Hit> = Vec::new();
        shape.crossings(ray, Interval::LINE, &mut |hit| line.push(hit));
        let fail = |promise, within, found: String| Failure { promise, ray: *ray, within, found };
        if !line.is_sorted_by(|a, b| a.t() <= b.t()) {
            return Err(fail("crossings ascend", Interval::LINE, format!("{line:?}")));
        }
        if self.closed && line.len() % 2 == 1 {
            return Err(fail(
                "a closed shape is crossed an even number of times",
                Interval::LINE,
                format!("{line:?}"),
            ));
        }
        let within = Interval::FORWARD;
        let Some(hit) = shape.hit(ray, within) else {
            let beyond = line.iter().find(|h| h.t() > 0.0 && !self.near_start(ray, **h));
            return match beyond {
                Some(hit) => {
                    Err(fail("the first hit is the first crossing", within, format!("none, but {hit:?}")))
                }
                None => Ok(None),
            };
        };
        self.interval(ray, hit, share)?;
        let again = shape.hit(ray, within);
        if again != Some(hit) {
            return Err(fail(
                "the same question has the same answer",
                within,
                format!("{hit:?} and {again:?}"),
            ));
        }
        let longer = Ray::new(ray.origin, ray.direction * 2.0);
        let half = shape.hit(&longer, within).map(|h| h.t() * 2.0);
        // Subnormal parameters have lost the digits that the comparison needs.
        if half != Some(hit.t()) && hit.t() > 4.0 * f64::MIN_POSITIVE {
            return Err(fail(
                "twice the direction, half the parameter",
                within,
                format!("{hit:?} and 2 * {half:?} / 2"),
            ));
        }
        let surface = shape.surface(ray, hit);
        self.record(ray, hit, &surface)?;
        self.way_back(ray, hit, &surface)?;
        Ok(Some(surface))
    }

    /// Whether a crossing is at the start of the ray, or behind it, as far as its error radius can tell.
    fn near_start(&self, ray: &Ray, hit: Hit) -> bool {
        let surface = self.shape.surface(ray, hit);
        let cosine = ray.direction.normalize_or_zero().dot(surface.normal).abs();
        surface.t <= 0.0 || (surface.point - ray.origin).length() * cosine <= 8.0 * surface.error
    }

    fn interval(&self, ray: &Ray, hit: Hit, share: f64) -> Result<(), Failure> {
        let shape = self.shape;
        let t = hit.t();
        if t < 4.0 * f64::MIN_POSITIVE {
            return Ok(());
        }
        let fail = |promise, within, found| Err(Failure { promise, ray: *ray, within, found });
        // `Hit::t` may err by a few u of the distances involved (64 are allowed here), over the cosine of the angle of incidence; an end
        // of the interval nearer to the hit than that may be decided with more digits.
        let surface = shape.surface(ray, hit);
        let speed = ray.direction.dot(surface.normal).abs();
        // The size of the shape counts among the distances: its far end may be what the ray meets; so does the
        // distance of the place from its anchor.
        let size = shape.bounds().map_or(0.0, |b| (b.max - b.min).element_sum());
        let size = size + surface.local.abs().element_sum();
        let reach = ray.origin.abs().element_sum() + (ray.direction * t).abs().element_sum() + size;
        let doubt = (surface.error + 64.0 * U * reach) / speed;
        let before = Interval::new(0.0, t - doubt);
        if let Some(hit) = shape.hit(ray, before).filter(|hit| !self.near_start(ray, *hit)) {
            return fail("an interval that ends before the first hit has none", before, format!("{hit:?}"));
        }
        let after = Interval::new(t + doubt, f64::INFINITY);
        if let Some(next) = shape.hit(ray, after).filter(|next| next.t() <= t + doubt) {
            return fail("an interval that starts after a hit does not have it", after, format!("{next:?}"));
        }
        // The end itself is not in doubt: whatever the digits behind it, a reported hit is not reported again.
        let within = Interval::FORWARD;
        if let Some(again) = shape.hit(ray, within.until(t)) {
            return fail(
                "an interval that ends at the first hit has none",
                within.until(t),
                format!("{again:?}"),
            );
        }
        let is_same =
            |next: &Hit| (next.part(), next.root()) == (hit.part(), hit.root()) && next.t() <= t + doubt;
        if let Some(again) = shape.hit(ray, within.after(t)).filter(is_same) {
            let found = format!("{hit:?} and {again:?}");
            return fail("an interval that starts at a hit does not have it", within.after(t), found);
        }
        let middle = t * share;
        let parts = [Interval::new(0.0, middle), Interval::new(middle, f64::INFINITY)];
        let split = shape.hit(ray, parts[0]).or_else(|| shape.hit(ray, parts[1]));
        // A split next to the hit may be decided with more digits, and give another parameter of the same place.
        let same = |other: Hit| {
            let (a, b) = (shape.surface(ray, hit), shape.surface(ray, other));
            other.t() == t || (a.point - b.point).length() <= 4.0 * (a.error + b.error)
        };
        // So may a crossing at the very start of the ray.
        if middle != t && !split.is_some_and(|other| same(other) || self.near_start(ray, other)) {
            return fail(
                "a split interval has the same first hit",
                parts[1],
                format!("{hit:?} and {split:?}"),
            );
        }
        Ok(())
    }

    fn record(&self, ray: &Ray, hit: Hit, surface: &Surface) -> Result<(), Failure> {
        let fail = |promise, found| Err(Failure { promise, ray: *ray, within: Interval::FORWARD, found });
        let Surface { point, local, normal, shading_normal, error, t, .. } = *surface;
        // Sums of three coordinates leave the range of f64: a plane met that far away has no error radius.
        let far = f64::MAX / 4.0;
        if !(point.abs().max_element() < far && ray.at(t).abs().max_element() < far) {
            return Ok(());
        }
        let numbers = [point, local, normal, shading_normal, surface.object_point, surface.uv().extend(0.0)];
        if !numbers.iter().all(|v| v.is_finite()) || error < 0.0 || !error.is_finite() || !t.is_finite() {
            return fail("a surface record is finite", format!("{surface:?}"));
        }
        for n in [normal, shading_normal] {
            // |n|^2 - 1 is twice the error of the length; the test itself rounds by 3 u.
            if (n.length_squared() - 1.0).abs() > 12.0 * U {
                return fail(
                    "a normal has unit length",
                    format!("{n:?} with square {:e}", n.length_squared()),
                );
            }
        }
        // The point in plain arithmetic: two roundings of each coordinate of the product and the sum, and t's own.
        let (o, step) = (ray.origin.abs(), (ray.direction * t).abs());
        // And as many of the least steps, where all is subnormal, also those of t; and what is nothing beside the size
        // of the shape even for double-double numbers.
        let least = f64::from_bits(16) + f64::from_bits(1) * ray.direction.abs().element_sum();
        let size = self.shape.bounds().map_or(0.0, |b| (b.max - b.min).max_element());
        let own = 4.0 * U * (o.element_sum() + step.element_sum()) + least + U * U * size;
        // In units of the largest component, whose square may be out of range.
        let off = ray.at(t) - point;
        let unit = off.abs().max_element();
        let off = if unit > 0.0 { (off / unit).length() * unit } else { 0.0 };
        if off > error + own {
            return fail("the point is on the ray", format!("{off:e} off, radius {error:e}"));
        }
        if let Some(bounds) = self.shape.bounds()
            && !bounds.contains(point)
        {
            return fail("the bounds contain every hit", format!("{point:?} in {bounds:?}"));
        }
        let _ = hit;
        Ok(())
    }

    /// Whether rounding decides that something is met on the way back: what the first ray began at, a wall thinner than its
    /// places are known, an edge, or a bulge that the ray grazes.
    ///
    /// The first ray met nothing there. Its line and the way back are nowhere further apart than two error radii: the
    /// recorded point lies within one of its line, and the way back begins within one of that point, in the direction to the
    /// first ray's origin. What the way back meets and the first ray did not is hence nearer than that to either line,
    /// whatever the angle it is met at.
    ///
    /// Either the first ray began at it, then the origin lies so near to the tangent plane of the place. Or some rays
    /// beside the way back meet it and some do not: those moved by 4 radii along the axes, as one of the six is
    /// within an angle of cosine 1 / sqrt(3) of each direction. They are asked from half of the way to the place onward; where
    /// that is no higher above the tangent plane of the start than they were moved, they may meet the start's own
    /// surroundings, and tell nothing. Nor do they tell where two sheets meet at a point, through which the first ray passed both
    /// and counted neither, while all rays beside it cross the wall between them: the way back is out of it again sooner
    /// than they were moved.
    fn is_decided_by_rounding(
        &self,
        (ray, start): (&Ray, &Surface),
        (shadow, within, from): (&Ray, Interval, &Departure),
        (met, place): (Hit, &Surface),
    ) -> bool {
        let way = place.point - start.point;
        let radius = start.error + place.error + 2.0 * U * way.abs().element_sum();
        if (ray.origin - place.point).dot(place.normal).abs() <= 2.0 * radius {
            return true;
        }
        let mut next = None;
        let is_other = |hit: &Hit| (hit.part(), hit.root()) != (met.part(), met.root());
        self.shape.crossings_leaving(shadow, within, from, &mut |hit| {
            next = next.or(Some(hit).filter(is_other));
        });
        let moved = 4.0 * radius;
        if next.is_some_and(|next| (self.shape.surface(shadow, next).point - place.point).length() <= moved) {
            return true;
        }
        if 0.5 * way.dot(start.normal).abs() <= moved {
            return false;
        }
        let within = within.after(0.5 * met.t());
        let meets = |aside: &DVec3| {
            let beside = Ray::new(shadow.origin + *aside * moved, shadow.direction);
            self.shape.hit(&beside, within).is_some()
        };
        let sides = DVec3::AXES.into_iter().flat_map(|axis| [axis, -axis]);
        let count = sides.filter(meets).count();
        (1..6).contains(&count)
    }

    /// What the eye sees, the eye's lamp sees.
    fn way_back(&self, ray: &Ray, hit: Hit, surface: &Surface) -> Result<(), Failure> {
        let direction = ray.direction.normalize_or_zero();
        let back = ray.origin - surface.point;
        // Closer than the record can tell, or more grazing: nothing is promised. `local`, which the exit of a shape is
        // found from, is known to a unit in the last place of the shape's size.
        let size = self.shape.bounds().map(|b| (b.max - b.min).max_element());
        let known = surface.error + 2.0 * U * size.unwrap_or(0.0);
        if direction.dot(surface.normal).abs() < 1e-3 || back.length() < 1e6 * known {
            return Ok(());
        }
        // Nor of a shape that is not much larger than the error radius, where it is.
        if size.is_some_and(|size| size < 1e6 * surface.error) {
            return Ok(());
        }
        let side = Side::of_arrival(ray.direction, surface.normal);
        let from = surface.departure(0, hit, side);
        let (shadow, within) = from.ray(back);
        // The last part of the way belongs to what the first ray's origin itself may lie on.
        let within = within.until(1.0 - 1e-3);
        let Some(met) = self.shape.hit_leaving(&shadow, within, &from) else { return Ok(()) };
        let place = self.shape.surface(&shadow, met);
        // Another part begins where the ray left: it left an edge, and rounding says on which side of it.
        let is_at_start = (place.point - surface.point).length() <= 8.0 * (surface.error + place.error);
        let is_other_part = met.part() != hit.part() && is_at_start;
        if is_other_part
            || self.is_decided_by_rounding((ray, surface), (&shadow, within, &from), (met, &place))
        {
            return Ok(());
        }
        Err(Failure {
            promise: "nothing lies on the way back from the first hit",
            ray: shadow,
            within,
            found: format!("{met:?} after {hit:?}"),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Aabb;
    use crate::shape::{Sphere, Torus};

    fn check(shape: &dyn Primitive, ray: &Ray) -> Result<Option<Surface>, Failure> {
        Check { shape, closed: true }.ray(ray, 0.5)
    }

    /// The point that was hit, and what the way back from it meets, as `way_back` asks.
    fn returned(shape: &dyn Primitive, ray: &Ray) -> (Surface, Option<Surface>) {
        let hit = shape.hit(ray, Interval::FORWARD).unwrap();
        let surface = shape.surface(ray, hit);
        let from = surface.departure(0, hit, Side::of_arrival(ray.direction, surface.normal));
        let (shadow, within) = from.ray(ray.origin - surface.point);
        let met = shape.hit_leaving(&shadow, within.until(1.0 - 1e-3), &from);
        (surface, met.map(|met| shape.surface(&shadow, met)))
    }

    /// A hole of 1e-4 of the tube, passed inside the tube, so far from the world's origin that a point is known to
    /// 7e-8: the way back meets the hole, and not at a grazing angle.
    #[test]
    fn a_narrow_hole_passed_within_rounding() {
        let center = [-469762048.0, -268610903.9989902, -8388608.0];
        let axis = [-1161.4721440789365, 268435456.0, 15805.740879193474];
        let torus = Torus::new(center, axis, 32.0052586984425, 32.0000000221345).unwrap();
        let ray = Ray::new(
            [-469762049.2158912, -268610901.408413, -8388601.201758277],
            [0.16557638889419957, -0.3507541098681875, -0.9217136289956095],
        );
        let (surface, met) = returned(&torus, &ray);
        let met = met.unwrap();
        let direction = ray.direction.normalize();
        assert!(surface.normal.dot(direction) > 0.1 && (surface.point - met.point).length() > 30.0);
        assert!(met.normal.dot(direction).abs() > 1e-3 && met.error < 1e-7, "{met:?}");
        assert!(check(&torus, &ray).unwrap().is_some());
    }

    /// Where the two sheets of a spindle meet, a first ray passes both and counts neither; the way back crosses the wall
    /// between them, as do all rays beside it.
    #[test]
    fn a_pole_passed_within_rounding() {
        let center = [-1.9533475925234192e-103, -2.337040869691205e-103, -3.488120700941022e-105];
        let torus = Torus::new(center, DVec3::NEG_X, 1.330612450002561e-110, 4.77995646170444e-103).unwrap();
        let ray = Ray::new(
            [-9.377234153312557e-102, 1.8344985034600482e-102, 1.0358524637012893e-102],
            [8.70390374788977e-102, -2.0682025904291687e-102, -1.0393405844022303e-102],
        );
        let (surface, met) = returned(&torus, &ray);
        assert!((surface.point - met.unwrap().point).length() > 8e-103, "{surface:?} {met:?}");
        assert!(check(&torus, &ray).unwrap().is_some());
    }

    /// Two spheres, of which a first ray misses the nearer one when told so.
    #[derive(Debug)]
    struct Screened {
        near: Sphere,
        far: Sphere,
        /// Rays that start further away than this miss the near one,
        reach: f64,
        /// and so do those that meet it at a smaller cosine.
        cosine: f64,
    }

    impl Screened {
        fn is_missed(&self, ray: &Ray, hit: Hit) -> bool {
            let normal = self.near.surface(ray, hit).normal;
            let cosine = normal.dot(ray.direction.normalize()).abs();
            (ray.origin - self.near.center()).length() > self.reach || cosine < self.cosine
        }

        fn nearer(near: Option<Hit>, far: Option<Hit>) -> Option<Hit> {
            let near = near.and_then(|hit| Interval::LINE.admit(hit.t(), 1, hit.root()));
            near.filter(|near| far.is_none_or(|far| near.t() < far.t())).or(far)
        }
    }

    impl Primitive for Screened {
        fn hit(&self, ray: &Ray, within: Interval) -> Option<Hit> {
            let near = self.near.hit(ray, within).filter(|hit| !self.is_missed(ray, *hit));
            Screened::nearer(near, self.far.hit(ray, within))
        }

        fn surface(&self, ray: &Ray, hit: Hit) -> Surface {
            let sphere = if hit.part() == 1 { self.near } else { self.far };
            Interval::LINE.admit(hit.t(), 0, hit.root()).map(|hit| sphere.surface(ray, hit)).unwrap()
        }

        fn bounds(&self) -> Option<Aabb> {
            let (a, b) = (self.near.bounds()?, self.far.bounds()?);
            Some(Aabb::new(a.min.min(b.min), a.max.max(b.max)))
        }

        fn hit_leaving(&self, ray: &Ray, within: Interval, from: &Departure) -> Option<Hit> {
            let hit_or_leave = |sphere: &Sphere, part: u32| {
                if from.part == part {
                    sphere.hit_leaving(ray, within, from)
                } else {
                    sphere.hit(ray, within)
                }
            };
            Screened::nearer(hit_or_leave(&self.near, 1), hit_or_leave(&self.far, 0))
        }
    }

    /// What reaches into the way back deeper than the error radius is found, by however little the first ray should have
    /// met it, whether only rays from far away miss it or all rays that graze it, or all.
    #[test]
    fn what_lies_on_the_way_back_is_found() {
        let far = Sphere::new(DVec3::ZERO, 2.0).unwrap();
        let ray = Ray::new([0.5, 0.0, 100.0], DVec3::NEG_Z);
        for depth in [0.4, 1e-3, 1e-9, 1e-13] {
            let near = Sphere::new([depth - 0.5, 0.0, 4.0], 1.0).unwrap();
            let sound = Screened { near, far, reach: f64::INFINITY, cosine: 0.0 };
            let surface = check(&sound, &ray).unwrap().unwrap();
            assert!(surface.point.z > 3.5, "{surface:?}");
            for (reach, cosine) in [(50.0, 0.0), (f64::INFINITY, 0.9), (0.0, 0.0)] {
                let shape = Screened { reach, cosine, ..sound };
                let (surface, met) = returned(&shape, &ray);
                assert!(surface.point.z < 2.0 && met.unwrap().point.z > 2.9, "{surface:?} {met:?}");
                let failure = check(&shape, &ray).unwrap_err();
                assert!(failure.promise.starts_with("nothing lies on the way back"), "{failure}");
            }
            // Past it by as much.
            let near = Sphere::new([-depth - 0.5, 0.0, 4.0], 1.0).unwrap();
            let surface = check(&Screened { near, ..sound }, &ray).unwrap().unwrap();
            assert!(surface.point.z < 2.0, "{surface:?}");
        }
    }
}
