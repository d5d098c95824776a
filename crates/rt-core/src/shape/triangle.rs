//! A triangle: the convex hull of three points.
//!
//! With the corners taken from the origin of the ray, `A = a - o` and so on, the ray passes inside when the three edge
//! functions `d . (B x C)`, `d . (C x A)`, `d . (A x B)` have one sign (Woop, Benthin, Wald 2013, Watertight
//! Ray/Triangle Intersection, JCGT 2(1)). `hit` computes them in `f64` with one bound on their errors, and exactly
//! when one of them is within that bound of zero: two triangles with a common edge see the same exact number, so no
//! ray slips between them, and none is lost at a common corner.

use super::flat::{self, Doubt, Facing, Relative, Rough, U, Verdict};
use super::meeting::{self, ExactPlane, Meeting, Piece};
use crate::double::{Double, fast_two_sum, two_difference};
use crate::expansion::Expansion;
use crate::kernel::{Pair, Pairs, Product, Task, run};
use crate::math::{exp2i, greater, lesser};
use crate::scaled::{checked_point, range_guard, times_power};
use crate::{Aabb, Departure, Error, Hit, Interval, Primitive, Ray, Similarity, Surface};
use alloc::sync::Arc;
use glam::{DVec2, DVec3};

/// A triangle, its edges included. It has one part, 0, and a line meets it once at most; a ray in its plane does not.
///
/// The normal is that of `(b - a) x (c - a)`: seen from the side it points to, the corners run counter-clockwise. The
/// anchor of local coordinates is the first corner; `uv` are the barycentric weights of the second and the third.
#[derive(Clone, Debug, PartialEq)]
pub struct Triangle {
    sides: Sides,
    b: DVec3,
    c: DVec3,
    /// `(b - a) x (c - a)` times a power of two, largest component in `[1, 2)`.
    scaled_normal: DVec3,
    /// What rounding to `normal` left, so that both together are within 2^-104.
    normal_rest: DVec3,
    normal: DVec3,
    /// The world axis that the normal lies along exactly.
    axis: Option<u8>,
    /// The exponent between `scaled_normal` and the product of the edges when `reach` is in `[1, 2)`.
    normal_power: i32,
    smooth: Option<Arc<[DVec3; 3]>>,
}

impl Triangle {
    /// The triangle with the corners `a`, `b`, `c`.
    ///
    /// # Errors
    /// [`Error::NotFinite`], [`Error::OutOfRange`] for coordinates beyond 1e150, [`Error::Degenerate`] when the corners
    /// lie exactly on a line.
    pub fn new(a: impl Into<DVec3>, b: impl Into<DVec3>, c: impl Into<DVec3>) -> Result<Self, Error> {
        let a = checked_point("triangle corner", a.into())?;
        let b = checked_point("triangle corner", b.into())?;
        let c = checked_point("triangle corner", c.into())?;
        let reach = (b - a).abs().max((c - a).abs()).max_element();
        let (exact, edge_power, normal_power) = exact_normal(a, b, c);
        let normal = exact.map(|n| n.rounded());
        if normal.iter().all(|n| n.high == 0.0) {
            return Err(Error::Degenerate { vertices: [a, b, c] });
        }
        let scaled_normal = DVec3::from_array(normal.map(|n| n.high));
        Ok(Triangle {
            sides: Sides::new(
                Facing::new(a, scaled_normal),
                [b - a, c - a],
                reach,
                2 * edge_power + normal_power,
            ),
            b,
            c,
            scaled_normal,
            normal_rest: DVec3::from_array(normal.map(|n| n.low)),
            normal: flat::unit(normal),
            axis: flat::world_axis(scaled_normal),
            normal_power,
            smooth: None,
        })
    }

    /// The same triangle shaded with normals interpolated between those of its corners, each of any length but zero.
    ///
    /// # Errors
    /// [`Error::NotFinite`], [`Error::ZeroLength`].
    pub fn with_normals(
        mut self,
        na: impl Into<DVec3>,
        nb: impl Into<DVec3>,
        nc: impl Into<DVec3>,
    ) -> Result<Self, Error> {
        let checked = |n: DVec3| -> Result<DVec3, Error> {
            let n = flat::checked_direction("normal of a triangle's corner", n)?;
            Ok(flat::unit(flat::doubles(flat::prescaled(n).0)))
        };
        self.smooth = Some(Arc::new([checked(na.into())?, checked(nb.into())?, checked(nc.into())?]));
        Ok(self)
    }

    /// The corners.
    pub fn corners(&self) -> [DVec3; 3] {
        [self.a(), self.b, self.c]
    }

    #[inline(always)]
    fn a(&self) -> DVec3 {
        self.sides.facing.anchor()
    }

    /// The geometric unit normal.
    pub fn normal(&self) -> DVec3 {
        self.normal
    }

    /// The unit normals of the corners that shading interpolates, if there are any.
    pub fn corner_normals(&self) -> Option<[DVec3; 3]> {
        self.smooth.as_deref().copied()
    }

    /// Scaled, turned and moved.
    ///
    /// # Errors
    /// As [`Triangle::new`].
    pub fn transformed(&self, by: &Similarity) -> Result<Self, Error> {
        let moved = Triangle::new(by.point(self.a()), by.point(self.b), by.point(self.c))?;
        match self.corner_normals() {
            Some([a, b, c]) => moved.with_normals(by.direction(a), by.direction(b), by.direction(c)),
            None => Ok(moved),
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
        let there = Relative::new(self.a(), ray, self.sides.reach);
        let span = there.interval(within);
        let [x, y, z] = self.sides.edges.0.map(|[first, second]| (first * there.unit, -second * there.unit));
        let edges = [DVec3::new(x.0, y.0, z.0), DVec3::new(x.1, y.1, z.1)];
        let reach = self.sides.reach * there.unit;
        let power = 2 * crate::math::exponent(reach) + self.normal_power;
        match Sides::new(self.sides.facing.at(DVec3::ZERO), edges, reach, power).plainly(&there.ray, span) {
            Ok(hit) => return there.hit(hit?, within),
            Err(Doubt { ended: false }) => {}
            Err(Doubt { ended: true }) => return None,
        }
        let signs = run(EdgeSigns { corners: self.corners(), ray });
        let (least, most) = (signs[0].min(signs[1]).min(signs[2]), signs[0].max(signs[1]).max(signs[2]));
        if least < 0 && most > 0 {
            return None;
        }
        let at = meeting::meet(self, ray)?;
        // From more than 2^500 sizes away the signs are those of underflow; then the place tells.
        let beside = at
            .local
            .iter()
            .any(|x| x.high.abs() > 2.0 * at.error + 2.0 * times_power(self.sides.reach, -at.power));
        if beside { None } else { within.admit(at.t, 0, 0) }
    }
}

/// What decides in `f64` whether and where a ray meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Sides {
    facing: Facing,
    /// The edge to the second corner, and that to the third turned round: x, y, z.
    edges: Pairs<3>,
    /// The largest coordinate of the edges, in size.
    reach: f64,
    /// 128 u of it, or NaN where products may leave the range of the exponents.
    slack: f64,
    /// 16 times the power of two between the normal and the product of the edges; NaN where that is too large.
    area_scale: f64,
}

impl Sides {
    fn new(facing: Facing, [e, f]: [DVec3; 2], reach: f64, area_power: i32) -> Sides {
        Sides {
            facing,
            edges: Pairs([[e.x, -f.x], [e.y, -f.y], [e.z, -f.z]]),
            reach,
            slack: (128.0 * U) * reach + range_guard(reach),
            area_scale: if area_power < 1000 { times_power(16.0, area_power) } else { f64::NAN },
        }
    }

    #[inline(always)]
    fn plainly(&self, ray: &Ray, within: Interval) -> Verdict {
        let rough = Rough::new(&self.facing, ray);
        let r = rough.moment();
        let edges = |k: usize, r: f64| self.edges.get(k) * Pair::new(r, r);
        let of_c_and_b = (edges(0, r.x) + edges(1, r.y)) + edges(2, r.z);
        let of_a = rough.slope() * self.area_scale - (of_c_and_b.low() + of_c_and_b.high());
        // With E, S, D the largest coordinates of edges, s and d: a component of r is at most 2 D S and errs by
        // 6 u D S (differences, products, difference); its product with an edge errs by 42 u E D S (three terms:
        // 18 u from r, 24 u from the edge, the product and two additions). The product of the areas is at most
        // 6 E E D and errs by 5 u of that with the rounded normal. The third function adds both others and 2 u of
        // its terms: (84 + 36) u E D S + (30 + 6) u E E D at most.
        let (far, speed) = rough.largest();
        let doubt = self.slack * (speed * (far + self.reach));
        // With E in 2^-200..2^200, neither r nor any product leaves the range of the exponents, and what those lose that
        // underflow is nothing against the bound.
        const LEAST: u64 = exp2i(-500).to_bits();
        if doubt.to_bits().wrapping_sub(LEAST) > exp2i(500).to_bits() - LEAST {
            return Err(Doubt { ended: false });
        }
        let (signs, positive) = (of_c_and_b.signs(), of_a > 0.0);
        if Pair::new(doubt, doubt).is_below(of_c_and_b.abs()) & (of_a.abs() > doubt) {
            if signs == if positive { 0 } else { 3 } { rough.hit(within) } else { Ok(None) }
        } else {
            let (b, c) = (of_c_and_b.high(), of_c_and_b.low());
            let least = lesser(of_a, lesser(b, c));
            let most = greater(of_a, greater(b, c));
            if (least < -doubt) & (most > doubt) { Ok(None) } else { Err(Doubt { ended: false }) }
        }
    }
}

/// `(b - a) x (c - a)` without rounding, its largest component in `[1, 2)`: in units of `4^p 2^q`, with `2^p` the unit
/// in which the largest coordinate of the edges is in `[1, 2)`; and `p`, `q`.
fn exact_normal(a: DVec3, b: DVec3, c: DVec3) -> ([Expansion; 3], i32, i32) {
    struct Cross([Double; 3], [Double; 3]);
    impl Task for Cross {
        type Output = [Expansion; 3];
        #[inline(always)]
        fn run<P: Product>(self) -> [Expansion; 3] {
            flat::cross::<P>(&self.0, &self.1)
        }
    }
    let power = flat::power_of((b - a).abs().max((c - a).abs()));
    let edge = |to: DVec3| {
        [Double::difference(to.x, a.x), Double::difference(to.y, a.y), Double::difference(to.z, a.z)]
            .map(|x| x.scale_exact(exp2i(-power)))
    };
    let mut normal = run(Cross(edge(b), edge(c)));
    let rough = DVec3::new(normal[0].rounded().high, normal[1].rounded().high, normal[2].rounded().high);
    let normal_power = flat::power_of(rough);
    normal.iter_mut().for_each(|n| n.scale_exact(exp2i(-normal_power)));
    (normal, power, normal_power)
}

/// The exact signs of the edge functions opposite the corners.
struct EdgeSigns<'a> {
    corners: [DVec3; 3],
    ray: &'a Ray,
}

impl Task for EdgeSigns<'_> {
    type Output = [i32; 3];
    #[inline(always)]
    fn run<P: Product>(self) -> [i32; 3] {
        let (d, _) = flat::prescaled(self.ray.direction);
        let o = self.ray.origin;
        let from_origin =
            self.corners.map(|p| [(p.x, o.x), (p.y, o.y), (p.z, o.z)].map(|(p, o)| Double::difference(p, o)));
        let largest = from_origin.iter().flatten().fold(0.0_f64, |m, x| m.max(x.high.abs()));
        let scale = exp2i(-flat::power_of(DVec3::splat(largest)));
        let [a, b, c] = from_origin.map(|p| p.map(|x| x.scale_exact(scale)));
        [(&b, &c), (&c, &a), (&a, &b)].map(|(p, q)| {
            let m = flat::cross::<P>(p, q);
            let mut sum = Expansion::ZERO;
            for (m, d) in m.iter().zip(d.to_array()) {
                sum.add_expansion_product::<P>(m, Double::from(d));
            }
            sum.sign()
        })
    }
}

impl Piece for Triangle {
    #[inline(always)]
    fn plane(&self) -> ExactPlane {
        ExactPlane { anchor: self.a(), normal: self.normal_sum(), axis: self.axis, offset: 0.0 }
    }

    fn exact_normal(&self) -> [Expansion; 3] {
        exact_normal(self.a(), self.b, self.c).0
    }

    #[inline(always)]
    fn record<P: Product>(&self, at: &Meeting) -> Surface {
        // The hit is inside; what double-double leaves beside the corners is noise.
        let [a, b, c] = self.corners();
        let point = flat::clamped(at.point(a), a.min(b).min(c), a.max(b).max(c));
        let uv = self.weights::<P>(at);
        let surface = Surface::new(at.t, point, at.local(), self.normal, at.error_radius(point)).with_uv(uv);
        match self.smooth.as_deref() {
            Some([a, b, c]) => {
                let normal = *a * (1.0 - uv.x - uv.y) + *b * uv.x + *c * uv.y;
                // Opposite corner normals may cancel: the geometric normal is all there is then.
                surface.with_shading_normal(normal.try_normalize().unwrap_or(self.normal))
            }
            None => surface,
        }
    }

    fn parallel(&self, _: &Ray, hit: Hit) -> Surface {
        Surface::new(hit.t(), self.a(), DVec3::ZERO, self.normal, self.sides.reach)
    }
}

impl Triangle {
    #[inline(always)]
    fn normal_sum(&self) -> [Double; 3] {
        let (high, low) = (self.scaled_normal.to_array(), self.normal_rest.to_array());
        [0, 1, 2].map(|i| Double { high: high[i], low: low[i] })
    }

    /// The weights of the second and third corner at a point of the plane.
    #[inline(always)]
    fn weights<P: Product>(&self, at: &Meeting) -> DVec2 {
        // In the two coordinates in which the triangle is largest: the plane point l = beta (b - a) + gamma (c - a)
        // gives beta = (l x e2)_k / n_k and gamma = (e1 x l)_k / n_k.
        let k = flat::dominant(self.scaled_normal);
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        let power = flat::power_of(DVec3::splat(self.sides.reach));
        let [a, b, c] = self.corners().map(|p| p.to_array());
        let unit = exp2i(-power);
        let edge = |to: [f64; 3]| [i, j].map(|i| Double::difference(to[i], a[i]).scale_exact(unit));
        // In two steps: the unit of a place met from afar may be more than 2^1023 times as large.
        let shift = (at.power - power).clamp(-2000, 2000);
        let (first, second) = (exp2i(shift / 2), exp2i(shift - shift / 2));
        let l = [i, j].map(|i| at.local[i].scale_exact(first).scale_exact(second));
        let area = self.normal_sum()[k].scale_exact(times_power(1.0, self.normal_power));
        let inverse = 1.0 / area.high;
        let weight = |p: [Double; 2], q: [Double; 2]| {
            let (x, y) = (p[0].mul::<P>(q[1]), p[1].mul::<P>(q[0]));
            let (s, e) = two_difference(x.high, y.high);
            let (high, low) = fast_two_sum(s, e + (x.low - y.low));
            Double { high, low }.div_with::<P>(area, inverse).high.clamp(0.0, 1.0)
        };
        DVec2::new(weight(l, edge(c)), weight(edge(b), l))
    }
}

impl Primitive for Triangle {
    #[inline]
    fn hit(&self, ray: &Ray, within: Interval) -> Option<Hit> {
        match self.sides.plainly(ray, within) {
            Ok(hit) => hit,
            Err(_) => self.hit_carefully(ray, within),
        }
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
        let [a, b, c] = self.corners();
        let least = a.min(b).min(c);
        let most = a.max(b).max(c);
        Some(flat::outward(DVec3::ZERO, least, most))
    }

    fn hit_leaving(&self, _: &Ray, _: Interval, _: &Departure) -> Option<Hit> {
        None
    }

    fn crossings_leaving(&self, _: &Ray, _: Interval, _: &Departure, _: &mut dyn FnMut(Hit)) {}
}
#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_and_corners_belong_to_it() {
        let triangle = Triangle::new([0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [0.0, 3.0, 0.0]).unwrap();
        let down = |x: f64, y: f64| triangle.hit(&Ray::new([x, y, 2.0], [0.0, 0.0, -1.0]), Interval::FORWARD);
        for (x, y) in [(0.0, 0.0), (3.0, 0.0), (0.0, 3.0), (1.0, 2.0), (2.0, 0.0)] {
            assert!(down(x, y).is_some(), "{x} {y}");
        }
        assert_eq!(down(1.0, 2.0_f64.next_up()), None);
        assert_eq!(down(2.0, -f64::MIN_POSITIVE), None);
    }

    #[test]
    fn weights_and_normals() {
        let triangle = Triangle::new([0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 4.0, 0.0]).unwrap();
        let smooth = triangle.with_normals([0.0, 0.0, 3.0], [0.0, 5.0, 0.0], [0.0, 0.0, 1.0]).unwrap();
        let ray = Ray::new([1.0, 1.0, 1.0], [0.0, 0.0, -1.0]);
        let surface = smooth.surface(&ray, smooth.hit(&ray, Interval::FORWARD).unwrap());
        assert_eq!(surface.uv(), DVec2::new(0.5, 0.25));
        assert_eq!(surface.normal, DVec3::Z);
        let half = 0.5_f64.sqrt();
        assert!((surface.shading_normal - DVec3::new(0.0, half, half)).length() < 1e-15);
    }

    #[test]
    fn the_normal_of_a_sliver_is_exact() {
        let (a, b) = (DVec3::new(0.1, 0.2, 0.3), DVec3::new(1.1, 1.2, 1.3));
        let triangle = Triangle::new(a, b, DVec3::new(0.6, 0.7, 0.8_f64.next_up())).unwrap();
        // The third corner lies a few roundings off the line: the normal is across it all the same.
        assert!(triangle.normal().dot((b - a).normalize()).abs() < 2e-16);
    }

    /// In `f64` this ray meets the plane at exactly 0, where the interval begins; truly it starts before the plane, and
    /// only exact edge functions can tell that it meets the corner.
    #[test]
    fn a_start_beside_a_far_corner() {
        let a = [-4160735616.0, 7650410496.001251, 0.0];
        let triangle = Triangle::new(a, [0.0; 3], [0.0, 256.0468752644956, 2097152.0]).unwrap();
        let d = [-0.5943017621161063, 0.5020127814839439, 0.6283220374715858];
        let ray = Ray::new([-1e-323, 3.3306690738754696e-16, 5e-324], d);
        let hit = triangle.hit(&ray, Interval::FORWARD).unwrap();
        assert_eq!(Some(hit), triangle.hit(&ray, Interval::LINE));
        assert!((hit.t() - 5.637e-16).abs() < 1e-18);
    }

    /// Where plain `f64` leaves its range the same digits come out as where it does not.
    #[test]
    fn out_of_range_no_bit_changes() {
        let near = Triangle::new([0.1, 0.2, 0.3], [1.7, 0.4, -0.2], [0.3, 1.9, 0.5]).unwrap();
        let ray = Ray::new([3.1, 2.2, 5.7], [-2.4, -1.3, -5.5]);
        let t = near.hit(&ray, Interval::FORWARD).unwrap().t();
        for power in [-480, -300, 300, 500] {
            let scale = exp2i(power);
            let far = Triangle::new(near.a() * scale, near.b * scale, near.c * scale).unwrap();
            for speed in [-480, -300, 300, 480] {
                let there = Ray::new(ray.origin * scale, ray.direction * exp2i(speed));
                let found = far.hit(&there, Interval::FORWARD).unwrap().t();
                assert_eq!(times_power(found, speed - power), t, "2^{power}, 2^{speed}");
            }
        }
    }

    #[test]
    fn constructor_errors() {
        let line = Triangle::new([0.0, 0.0, 0.0], [1.0, 1.0, 1.0], [3.0, 3.0, 3.0]);
        assert!(matches!(line, Err(Error::Degenerate { .. })));
        let fine = Triangle::new([0.0, 0.0, 0.0], [1e-150, 0.0, 0.0], [0.0, 1e-150, 0.0]).unwrap();
        assert_eq!(fine.normal(), DVec3::Z);
        assert!(matches!(fine.with_normals(DVec3::Z, DVec3::ZERO, DVec3::Z), Err(Error::ZeroLength { .. })));
    }

    /// What must not become slow unseen: `f64` tells all plain hits and misses, and the same as exact arithmetic.
    #[test]
    fn plainly_as_exactly() {
        let mut random = crate::testing::Random::new(1);
        let mut count = [0_u32; 3];
        for case in 0..8000 {
            let size = if case < 4000 { 1.0 } else { random.magnitude(-4.0, 4.0) };
            let corners = [(); 3].map(|()| random.in_cube() * size);
            let Ok(triangle) = Triangle::new(corners[0], corners[1], corners[2]) else { continue };
            let origin = random.direction() * 4.0;
            let mut target = (corners[0] + corners[1] + corners[2]) / 3.0 + random.in_cube() * 0.3;
            if case >= 4000 {
                // Past an edge by nearly nothing.
                target = corners[0] + (corners[1] - corners[0]) * random.uniform(-0.1, 1.1);
                target += random.in_cube() * (size * random.magnitude(-18.0, -8.0));
            }
            let ray = Ray::new(origin, target - origin);
            let Ok(found) = triangle.sides.plainly(&ray, Interval::FORWARD) else {
                count[0] += u32::from(case < 4000);
                continue;
            };
            let signs = run(EdgeSigns { corners: triangle.corners(), ray: &ray });
            let inside = !(signs.contains(&-1) && signs.contains(&1));
            assert_eq!(found.is_some(), inside, "{triangle:?} {ray:?}");
            if let Some(hit) = found {
                let t = meeting::meet(&triangle, &ray).unwrap().t;
                assert!((hit.t() - t).abs() <= exp2i(-30) * size.max(1.0), "{triangle:?} {ray:?}");
            }
            count[1 + usize::from(inside)] += 1;
        }
        assert!(count[0] < 40 && count[1] > 800 && count[2] > 800, "{count:?}");
    }

    /// Texture coordinates are right to a unit in the last place, however thin the triangle and far its corners.
    #[test]
    fn weights_keep_their_digits() {
        let mut random = crate::testing::Random::new(2);
        let whole = |random: &mut crate::testing::Random| f64::from(random.below(2000)) - 1000.0;
        let mut count = 0;
        for _ in 0..2000 {
            // Whole numbers: the weights are fractions whose numbers are exact.
            let [a, b, c] = [(); 3].map(|()| DVec3::new(whole(&mut random), whole(&mut random), 7.0));
            let (e, f) = (b - a, c - a);
            let area = e.x * f.y - e.y * f.x;
            if area == 0.0 {
                continue;
            }
            let triangle = Triangle::new(a, b, c).unwrap();
            let p = DVec3::new(whole(&mut random), whole(&mut random), 1000.0);
            let ray = Ray::new(p, [0.0, 0.0, -3.0]);
            let Some(hit) = triangle.hit(&ray, Interval::FORWARD) else { continue };
            count += 1;
            let l = p - a;
            let expected = DVec2::new((l.x * f.y - l.y * f.x) / area, (e.x * l.y - e.y * l.x) / area);
            let uv = triangle.surface(&ray, hit).uv();
            assert!((uv - expected).abs().cmple(expected.abs() * f64::EPSILON).all(), "{uv} {expected}");
        }
        assert!(count > 100, "{count}");
    }

    /// Seen from 2^1090 sizes away the edges are nothing beside the corners, and all edge functions zero: the place tells
    /// that the ray passes.
    #[test]
    fn passed_by_from_afar() {
        let tiny = Triangle::new([4.982064e-318, 0.0, 0.0], [0.0; 3], [0.0, 6.378214640626665e-306, 0.0]);
        let ray = Ray::new([-3.9e-156, 4.8e21, -9.6e-229], [-73.4453125, -40.3828125, 2.9e-322]);
        assert_eq!(tiny.unwrap().hit(&ray, Interval::LINE), None);
    }

    /// A ray that begins at one of two corners 10^-19 sizes apart meets the triangle there.
    #[test]
    fn a_start_at_the_corner_of_a_sliver() {
        let b = DVec3::splat(-1.0141204801825844e31);
        let c = DVec3::new(b.x, -1.0141204801824745e31, b.z);
        let a = [-5.974201560428325e37, 2.074884984312466e36, -2.1267647932558652e37];
        let sliver = Triangle::new(a, b, c).unwrap();
        for direction in
            [[-5.575186299632661e42, 1.817502137570498e39, -3.902630410391896e44], [0.0, 1.0, 7.0]]
        {
            let ray = Ray::new(b, direction);
            let hit = sliver.hit(&ray, Interval::LINE).unwrap();
            assert_eq!((hit.t(), sliver.surface(&ray, hit).point), (0.0, b));
            crate::testing::check_crossings(&sliver.clone().into(), &ray).unwrap();
        }
    }
}
