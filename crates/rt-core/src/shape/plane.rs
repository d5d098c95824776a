//! An infinite plane: `normal . (p - point) = 0`.
//!
//! `hit` costs one division and a certificate: it compares `t` with both ends of the interval and goes to exact
//! arithmetic only when an end lies within the error of `t`, or when the ray is parallel to the plane as far as `f64`
//! can tell. Source of the error bound: Higham, Accuracy and Stability of Numerical Algorithms, section 3.1.

use super::flat::{self, Doubt, Facing, Relative, Rough, Verdict};
use super::meeting::{self, ExactPlane, Meeting, Piece};
use crate::expansion::Expansion;
use crate::kernel::{Dekker, Lanes, Product};
use crate::scaled::checked_point;
use crate::surface::Coordinates;
use crate::{Aabb, Departure, Error, Hit, Interval, Primitive, Ray, Similarity, Surface};
use glam::{DVec2, DVec3};

/// An infinite plane. It has one part, 0, and a line meets it once at most.
///
/// # Texture axes
/// `uv` are the lengths of `point - self.point()` along two unit vectors in the plane: take the two world axes in
/// which the normal is not largest (of equals, x before y before z counts as the largest), in the order x, y, z. The
/// first is projected onto the plane; the second is perpendicular to it, on the side of its world axis. For a normal
/// along y that makes u the world's x and v its z, exactly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// Its point, and its normal for [`Rough`].
    facing: Facing,
    /// As given, times a power of two: largest component in `[1, 2)`.
    scaled_normal: DVec3,
    normal: DVec3,
    axes: [DVec3; 2],
    /// The world axis that the normal lies along exactly.
    axis: Option<u8>,
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
        Ok(Plane {
            facing: Facing::new(point, normal),
            scaled_normal: normal,
            normal: flat::unit(flat::doubles(normal)),
            axes: [first, second],
            axis: flat::world_axis(normal),
        })
    }

    /// The point it was made from: the anchor of local and texture coordinates.
    pub fn point(&self) -> DVec3 {
        self.facing.anchor()
    }

    /// The unit normal.
    pub fn normal(&self) -> DVec3 {
        self.normal
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
        Plane::new(by.point(self.point()), by.direction(self.scaled_normal))
    }

    /// The hit, where a glance does not tell it.
    #[inline(never)]
    fn hit_closely(&self, ray: &Ray, within: Interval) -> Option<Hit> {
        match self.plainly(ray, within) {
            Ok(hit) => hit,
            Err(_) => self.hit_carefully(ray, within),
        }
    }

    /// The hit, when its parameter or its place leave a doubt. An interval that ends exactly at the parameter
    /// that `f64` gives was made from a hit, and does not contain it.
    #[cold]
    #[inline(never)]
    fn hit_carefully(&self, ray: &Ray, within: Interval) -> Option<Hit> {
        if !ray.is_valid() {
            return None;
        }
        let there = Relative::new(self.point(), ray, 0.0);
        let span = there.interval(within);
        match (Plane { facing: self.facing.at(DVec3::ZERO), ..*self }).plainly(&there.ray, span) {
            Ok(hit) => there.hit(hit?, within),
            Err(Doubt { ended: false }) => within.admit(meeting::meet(self, ray)?.t, 0, 0),
            Err(Doubt { ended: true }) => None,
        }
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
        let (at, sound) = meeting::four(self, lanes, rays);
        let point = at.place(self.point());
        let (t, error) = (at.t.to_array(), at.radius(point).to_array());
        let (point, local) = (point.to_array(), at.locally().to_array());
        // The lanes bring their own products.
        let [u, v] = at.lengths::<Dekker>(&self.axes, self.axis);
        let (u, v) = (u.to_array(), v.to_array());
        for (i, surface) in surfaces.into_iter().enumerate() {
            if sound >> i & 1 == 0 {
                *surface = self.surface(rays[i], hits[i]);
                continue;
            }
            let uv = DVec2::new(u[i], v[i]);
            let (place, coordinates) = (uv.extend(0.0), Coordinates::Known(uv));
            surface.set(t[i], point[i], local[i], place, self.normal, coordinates, error[i]);
        }
    }

    #[inline(always)]
    fn plainly(&self, ray: &Ray, within: Interval) -> Verdict {
        Rough::new(&self.facing, ray).hit(within)
    }
}

impl Piece for Plane {
    #[inline(always)]
    fn plane(&self) -> ExactPlane {
        ExactPlane {
            anchor: self.point(),
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
        let point = at.point(self.point());
        let uv = at.along::<P>(&self.axes, self.axis);
        Surface::new(at.t, point, at.local(), self.normal, at.error_radius(point))
            .with_object_point(uv.extend(0.0))
            .with_uv(uv)
    }

    fn parallel(&self, ray: &Ray, hit: Hit) -> Surface {
        Surface::new(hit.t(), ray.at(hit.t()), ray.at(hit.t()) - self.point(), self.normal, 0.0)
    }
}

impl Primitive for Plane {
    #[inline]
    fn hit(&self, ray: &Ray, within: Interval) -> Option<Hit> {
        let rough = Rough::new(&self.facing, ray);
        if rough.is_sound()
            && let Some(hit) = rough.glance(within)
        {
            return hit;
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
        None
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
    fn a_floor_counts_in_world_axes_exactly() {
        let floor = Plane::new([0.1, 0.0, -0.3], [0.0, 5.0, 0.0]).unwrap();
        assert_eq!(floor.texture_axes(), [DVec3::X, DVec3::Z]);
        let ray = Ray::new([1e6 + 0.7, 2.0, -0.25], [0.0, -3.0, 0.0]);
        let hit = floor.hit(&ray, Interval::FORWARD).unwrap();
        let surface = floor.surface(&ray, hit);
        assert_eq!((surface.t, surface.normal), (2.0 / 3.0, DVec3::Y));
        assert_eq!(surface.object_point, DVec3::new(1e6 + 0.7 - 0.1, -0.25 + 0.3, 0.0));
        assert_eq!(surface.local.y, 0.0);
        assert_eq!(surface.point, DVec3::new(1e6 + 0.7, 0.0, -0.25));
    }

    #[test]
    fn the_length_of_the_normal_does_not_matter() {
        for length in [1e-150, 1e-20, 7.0, 1e150] {
            let plane = Plane::new([0.0, 1.0, 0.0], DVec3::new(0.0, 0.6, 0.8) * length).unwrap();
            let ray = Ray::new([0.0, 5.0, 0.0], [0.0, -1e-150, 0.0]);
            let hit = plane.hit(&ray, Interval::FORWARD).unwrap();
            assert!((plane.surface(&ray, hit).t / 4e150 - 1.0).abs() < 1e-15);
            assert!((plane.normal() - DVec3::new(0.0, 0.6, 0.8)).length() < 4e-16);
        }
    }

    #[test]
    fn rays_in_the_plane_or_beside_it_miss() {
        let plane = Plane::new([0.0; 3], [1.0, 2.0, -3.0]).unwrap();
        for origin in [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]] {
            assert_eq!(plane.hit(&Ray::new(origin, [1.0, 1.0, 1.0]), Interval::LINE), None);
        }
    }

    #[test]
    fn an_interval_made_from_a_hit_does_not_contain_it() {
        let plane = Plane::new([0.3, 0.2, 0.1], [1.0, 2.0, -3.1]).unwrap();
        let mut random = 1_u32;
        for _ in 0..1000 {
            let mut number = || {
                random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                f64::from(random) / f64::from(u32::MAX) - 0.5
            };
            let ray = Ray::new([number(), number(), number()], [number(), number(), number()]);
            let Some(hit) = plane.hit(&ray, Interval::LINE) else { continue };
            assert_eq!(plane.hit(&ray, Interval::LINE.until(hit.t())), None);
            assert_eq!(plane.hit(&ray, Interval::LINE.after(hit.t())), None);
        }
    }

    /// A sum that is infinite is not seen to cancel: a ray with an infinite coordinate hits nothing all the same, in any interval.
    #[test]
    fn infinite_rays_hit_nothing() {
        let plane = Plane::new([0.5, 0.25, 0.0], [0.3, 1.0, -0.2]).unwrap();
        let ends = [f64::NEG_INFINITY, -1e300, -1e-100, -0.0, 0.0, 1e-100, 1e300, f64::INFINITY];
        for coordinate in 0..6 {
            for infinite in [f64::INFINITY, f64::NEG_INFINITY] {
                let mut ray = Ray::new([-1.7e28, 2.2, -1.6e-3], [-5.4e2, -2.7, 0.3]);
                let of = if coordinate < 3 { &mut ray.origin } else { &mut ray.direction };
                of[coordinate % 3] = infinite;
                for within in ends.iter().flat_map(|&min| ends.map(|max| Interval::new(min, max))) {
                    assert_eq!(plane.hit(&ray, within), None, "{ray:?} {within:?}");
                }
            }
        }
    }

    /// What a glance tells of a parameter and an interval is what the careful way says, and it tells all but ends beside the
    /// parameter and intervals that begin behind the origin.
    #[test]
    fn a_glance_is_right() {
        let mut random = crate::testing::Random::new(5);
        let mut told = [0; 4];
        for case in 0..40_000 {
            let size = if case % 5 == 0 { random.magnitude(-150.0, 150.0) } else { 1.0 };
            let plane = Plane::new(random.in_cube() * size, random.direction()).unwrap();
            let speed = if case % 7 == 0 { random.magnitude(-150.0, 150.0) } else { 1.0 };
            let ray = Ray::new(random.in_cube() * (3.0 * size), random.direction() * speed);
            let rough = Rough::new(&plane.facing, &ray);
            if !rough.is_sound() {
                continue;
            }
            let mut end = |other: f64| match random.below(8) {
                0 => f64::NAN,
                1 => -f64::NAN,
                2 => rough.t,
                3 => rough.t * (1.0 + random.sign() * random.magnitude(-16.0, -1.0)),
                4 => 1.0 - 2.0 * rough.t,
                _ => other,
            };
            let within = Interval::new(end(0.0), end(f64::INFINITY));
            let careful = plane.hit_closely(&ray, within);
            match rough.glance(within) {
                Some(hit) => {
                    assert_eq!(hit, careful, "{plane:?} {ray:?} {within:?}");
                    told[usize::from(hit.is_some())] += 1;
                }
                None if within.min == 0.0 && within.max == f64::INFINITY => told[2] += 1,
                None => told[3] += 1,
            }
            assert_eq!(plane.hit(&ray, within), careful, "{plane:?} {ray:?} {within:?}");
        }
        assert!(told[0] > 2000 && told[1] > 2000 && told[2] == 0 && told[3] > 2000, "{told:?}");
    }

    #[test]
    fn constructor_errors() {
        assert!(matches!(Plane::new([0.0; 3], [0.0; 3]), Err(Error::ZeroLength { .. })));
        assert!(matches!(Plane::new([f64::NAN, 0.0, 0.0], [0.0, 1.0, 0.0]), Err(Error::NotFinite { .. })));
        assert!(matches!(Plane::new([0.0; 3], [0.0, f64::INFINITY, 0.0]), Err(Error::NotFinite { .. })));
    }

    /// The smallest components of a normal count, of those too that a sixteenth of them would be nothing of.
    #[test]
    fn the_smallest_components_of_a_normal_count() {
        for slope in [f64::from_bits(1), f64::from_bits(7), 1e-310, 1e-290, 1e-260] {
            let plane = Plane::new([0.0; 3], [slope, 0.0, 1.0]).unwrap();
            let height = exp2i(-600);
            let ray = Ray::new([height / slope, 0.0, height], [0.0, 0.0, -1.0]);
            let found = plane.hit(&ray, Interval::FORWARD).map(|hit| hit.t() / height);
            assert!(found.is_some_and(|t| (t - 2.0).abs() < 1e-9), "{slope:e}: {found:?}");
        }
    }
}
