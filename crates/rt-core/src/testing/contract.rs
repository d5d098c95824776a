//! What every shape owes its callers, checked with hard rays.

use super::HardRays;
use crate::{Hit, Interval, Primitive, Ray, Side, Surface};
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

    /// Whether what was met on the way back is an edge that the ray passed so closely on its way there that rounding
    /// decides: then a ray along the same line meets it when moved by some error radii. It begins as far beyond the edge
    /// as the start is on this side: where the ray itself began, such a move may be nothing. The start's own
    /// surroundings are no edge.
    fn at_an_edge(&self, start: &Surface, met: &Surface) -> bool {
        let way = start.point - met.point;
        let radius = start.error + met.error + 2.0 * U * way.abs().element_sum();
        let apart = |a: DVec3, b: DVec3| (a - b).length() > 1024.0 * radius;
        apart(start.point, met.point)
            && [DVec3::X, DVec3::Y, DVec3::Z].into_iter().flat_map(|axis| [axis, -axis]).any(|aside| {
                let moved = Ray::new(met.point - way + aside * (8.0 * radius), way);
                let first = self.shape.hit(&moved, Interval::FORWARD);
                first.is_some_and(|hit| !apart(self.shape.surface(&moved, hit).point, met.point))
            })
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
        let grazed = |met: Hit| self.shape.surface(&shadow, met).normal.dot(direction).abs() < 1e-3;
        let shadow_length = |met: Hit| (self.shape.surface(&shadow, met).point - surface.point).length();
        match self.shape.hit_leaving(&shadow, within, &from) {
            // Another part begins where the ray left: it left an edge, and rounding says on which side of it.
            Some(met)
                if met.part() != hit.part()
                    && shadow_length(met)
                        <= 8.0 * (surface.error + self.shape.surface(&shadow, met).error) =>
            {
                Ok(())
            }
            Some(met) if grazed(met) || self.at_an_edge(surface, &self.shape.surface(&shadow, met)) => Ok(()),
            Some(met) => Err(Failure {
                promise: "nothing lies on the way back from the first hit",
                ray: shadow,
                within,
                found: format!("{met:?} after {hit:?}"),
            }),
            None => Ok(()),
        }
    }
}
