//! Crossings judged by an oracle: the signed distance from the surface along the line, in double-double.
//!
//! The distance grows by at most one length a length, so two values of one sign prove that no crossing lies between
//! them when they add up to more than the way from one to the other. Where they do not, the way is halved, and the
//! last piece is searched for its extreme. No formula is shared with the solvers: nothing is solved.

use super::oracle::{Distance, Kind};
use crate::double::Double;
use crate::double_vector::DoubleVector;
use crate::kernel::{Product, Task, run};
use crate::math::{exp2i, exponent, sqrt};
use crate::scaled::{ScaledRay, largest};
use crate::shape::{Cone, Cylinder, Triangle, flat};
use crate::{Interval, Primitive, Ray, Shape, Surface};
use alloc::boxed::Box;
use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;
use glam::DVec3;

/// Half the spacing of floats just below 1.
const U: f64 = f64::EPSILON / 2.0;

/// Compares the crossings of a whole line with the oracle's: how many there are, and where.
///
/// Counts are compared wherever moving the surface by 8 u of the shape's size (u = 2^-53) cannot change them; each
/// place must lie within 4 u of the size from the surface and from the ray (8 u of its distance for a plane). Planes,
/// disks and triangles are judged by their equation in double-double instead. A [`Shape::Custom`] has no oracle.
///
/// # Errors
/// What is wrong, in words.
pub fn check_crossings(shape: &Shape, ray: &Ray) -> Result<(), String> {
    let mut found = Vec::new();
    shape.crossings(ray, Interval::LINE, &mut |hit| found.push((hit.part(), shape.surface(ray, hit))));
    let Some(model) = Model::new(shape) else { return Ok(()) };
    let Some(line) = Line::new(ray, &model) else { return Ok(()) };
    let fail = |what: &str| Err(format!("{what}: {shape:?}, {ray:?}: {found:?}"));
    let places: Vec<DVec3> = found.iter().map(|(_, s)| s.local * exp2i(-model.unit)).collect();
    let limit = 4.0 * U * model.size;
    for (place, (part, _)) in places.iter().zip(&found) {
        let scale = if model.size > 0.0 { limit } else { 8.0 * U * largest(*place) };
        if line.distance(*place) > scale + line.doubt {
            return fail("a crossing off the ray");
        }
        if !((model.wall)(DoubleVector::from(*place), *part).abs() <= scale) {
            return fail("a crossing off the surface");
        }
    }
    match &model.body {
        Body::Flat(flat) => match flat.is_crossed(&line, &model) {
            Some(crossed) if found.len() != usize::from(crossed) => fail("a wrong count"),
            _ => Ok(()),
        },
        Body::Solid(distance) => {
            let at: Vec<f64> = places.iter().map(|p| line.parameter(*p)).collect();
            let cosines: Vec<f64> = found.iter().map(|(_, s)| s.normal.dot(line.direction).abs()).collect();
            line.judge(&model, distance, &at, &cosines).or_else(fail)
        }
        Body::Open(closed) => {
            check_crossings(closed, ray)?;
            let mut all: Vec<(u32, Surface)> = Vec::new();
            closed
                .crossings(ray, Interval::LINE, &mut |hit| all.push((hit.part(), closed.surface(ray, hit))));
            all.retain(|(part, _)| *part == 0);
            if all.iter().map(|(_, s)| s.t).eq(found.iter().map(|(_, s)| s.t)) {
                Ok(())
            } else {
                fail("other crossings than those of the closed shape's side")
            }
        }
    }
}

/// The signed distance of a point from a part of the surface, or from the whole of it.
type Wall = Box<dyn Fn(DoubleVector, u32) -> f64>;
type Solid = Box<dyn Fn(DoubleVector) -> f64>;

enum Body {
    Solid(Solid),
    /// A side without caps: judged with them.
    Open(Box<Shape>),
    Flat(Flat),
}

/// A shape about its anchor, in units of a power of two.
struct Model {
    anchor: DVec3,
    unit: i32,
    /// The largest extent; zero for a plane.
    size: f64,
    wall: Wall,
    body: Body,
}

fn distance(local: DoubleVector, axis: DoubleVector, kind: Kind) -> f64 {
    run(Distance { local, axis, kind })
}

impl Model {
    fn new(shape: &Shape) -> Option<Model> {
        let none = DoubleVector::from(DVec3::X);
        Some(match shape {
            Shape::Sphere(s) => {
                let unit = exponent(s.radius());
                let radius = s.radius() * exp2i(-unit);
                let away = move |l| distance(l, none, Kind::Sphere { radius });
                Model {
                    anchor: s.center(),
                    unit,
                    size: radius,
                    wall: Box::new(move |l, _| away(l)),
                    body: Body::Solid(Box::new(away)),
                }
            }
            Shape::Torus(s) => {
                let unit = exponent(s.major() + s.minor());
                let (major, minor) = (s.major() * exp2i(-unit), s.minor() * exp2i(-unit));
                let axis = DoubleVector::from(s.axis());
                // The distance from the nearer of the two sheets, and on which side of how many of them.
                let away = move |l| {
                    let outer = distance(l, axis, Kind::Torus { major, minor });
                    let inner = distance(l, axis, Kind::Torus { major: -major, minor });
                    let nearest = inner.abs().min(outer.abs());
                    if (outer < 0.0) == (inner < 0.0) { nearest } else { -nearest }
                };
                Model {
                    anchor: s.center(),
                    unit,
                    size: major + minor,
                    wall: Box::new(move |l, _| away(l)),
                    body: Body::Solid(Box::new(away)),
                }
            }
            Shape::Cuboid(s) => {
                let unit = exponent(largest(s.size()));
                let (size, axes) = (s.size() * exp2i(-unit), s.axes());
                // A box without a volume has no inside to tell.
                if !(size.min_element() > 64.0 * U * largest(size)) {
                    return None;
                }
                let away = move |l: DoubleVector| {
                    let beyond = |i: usize| {
                        let q = distance(l, DoubleVector::from(axes[i]), Kind::Plane);
                        if -q > q - size[i] { -q } else { q - size[i] }
                    };
                    let (x, y, z) = (beyond(0), beyond(1), beyond(2));
                    largest_of([x, y, z])
                };
                Model {
                    anchor: s.corner(),
                    unit,
                    size: largest(size),
                    wall: Box::new(move |l, _| away(l)),
                    body: Body::Solid(Box::new(away)),
                }
            }
            Shape::Cylinder(s) => {
                let closed =
                    if s.is_closed() { None } else { Some(Cylinder::new(s.base(), s.top(), s.radius())) };
                let closed = closed.map(|c| c.map(Shape::from));
                Model::frustum(s.base(), s.radius(), s.top(), s.radius(), closed.transpose().ok()?)
            }
            Shape::Cone(s) => {
                let again = || Cone::new(s.base(), s.base_radius(), s.top(), s.top_radius());
                let closed = if s.is_closed() { None } else { Some(again().map(Shape::from)) };
                Model::frustum(s.base(), s.base_radius(), s.top(), s.top_radius(), closed.transpose().ok()?)
            }
            Shape::Plane(s) => {
                Flat { normal: DoubleVector::from(s.normal()), outline: Outline::None }.model(s.point(), 0.0)
            }
            Shape::Disk(s) => Flat { normal: DoubleVector::from(s.normal()), outline: Outline::Circle }
                .model(s.center(), s.radius()),
            Shape::Triangle(s) => Flat::triangle(s)?,
            Shape::Custom(_) => return None,
        })
    }

    fn frustum(base: DVec3, base_radius: f64, top: DVec3, top_radius: f64, closed: Option<Shape>) -> Model {
        let axis = DoubleVector::difference(top, base);
        let size = largest_of([largest(axis.high()), base_radius, top_radius]);
        let unit = exponent(size);
        let scale = exp2i(-unit);
        let axis = axis.scale_exact(scale);
        let (low, high) = (base_radius * scale, top_radius * scale);
        let side = move |l| distance(l, axis, Kind::Cone { base: low, top: high });
        let caps = move |l: DoubleVector| {
            let (a, b) = (distance(l, axis, Kind::Plane), distance(l - axis, axis, Kind::Plane));
            (-a, b)
        };
        let wall = move |l: DoubleVector, part: u32| match part {
            0 => side(l),
            1 => caps(l).0,
            _ => caps(l).1,
        };
        let solid = move |l: DoubleVector| {
            let (a, b) = caps(l);
            largest_of([side(l), a, b])
        };
        let body = closed.map_or(Body::Solid(Box::new(solid)), |shape| Body::Open(Box::new(shape)));
        Model { anchor: base, unit, size: size * scale, wall: Box::new(wall), body }
    }
}

fn largest_of(values: [f64; 3]) -> f64 {
    values.into_iter().fold(f64::NEG_INFINITY, f64::max)
}

/// A ray about a shape's anchor, moved to its closest approach.
struct Line {
    origin: DoubleVector,
    direction: DVec3,
    /// What the move may have lost.
    doubt: f64,
}

/// How far along the direction a line passes the anchor: minus the quotient of two scalar products.
struct Approach<'a>(&'a ScaledRay);

impl Task for Approach<'_> {
    type Output = (DoubleVector, f64);
    #[inline(always)]
    fn run<P: Product>(self) -> Self::Output {
        let ray = self.0;
        let d = DoubleVector::from(ray.direction);
        let along = (-ray.relative.dot::<P>(d)).div::<P>(d.dot::<P>(d));
        (ray.relative.advanced::<P>(ray.direction, along), along.high)
    }
}

impl Line {
    fn new(ray: &Ray, model: &Model) -> Option<Line> {
        if !ray.is_valid() {
            return None;
        }
        let scaled = ScaledRay::new(ray, model.anchor, model.unit)?;
        let (origin, along) = run(Approach(&scaled));
        // 2^-100 of the way: some roundings of double-double numbers.
        let doubt = exp2i(-100) * (largest(scaled.relative.high()) + along.abs() * 2.0);
        Some(Line { origin, direction: scaled.direction, doubt })
    }

    fn at(&self, t: f64) -> DoubleVector {
        run(Advance { origin: &self.origin, direction: self.direction, t })
    }

    /// Which parameter a place beside the line has.
    fn parameter(&self, place: DVec3) -> f64 {
        (place - self.origin.high()).dot(self.direction) / self.direction.length_squared()
    }

    fn distance(&self, place: DVec3) -> f64 {
        let off = DoubleVector::from(place) - self.at(self.parameter(place));
        let d = self.direction;
        let off = off.high();
        (off - d * (off.dot(d) / d.length_squared())).length()
    }

    /// Whether the crossings, with the cosines of their angles, are all sign changes of `distance`, and nothing else is.
    fn judge(
        &self,
        model: &Model,
        distance: &Solid,
        at: &[f64],
        cosines: &[f64],
    ) -> Result<(), &'static str> {
        let speed = self.direction.length();
        let doubt = 8.0 * U * model.size + self.doubt;
        let value = |t: f64| distance(self.at(t));
        let sign = |v: f64| if v.abs() <= doubt { 0.0 } else { v.signum() };
        // The anchor may be at an end of a shape, whose far corners are then up to four sizes away.
        let reach = (8.0 * model.size + largest(self.origin.high())) / speed;
        let mut ends = Vec::from([(-reach, value(-reach))]);
        for (i, (t, cosine)) in at.iter().zip(cosines).enumerate() {
            // Half a unit of the place, as a length along the ray.
            let step = 4.0 * doubt / (cosine * speed);
            let gap = |other: Option<&f64>| other.map_or(f64::INFINITY, |o| (o - t).abs());
            let room = gap(at.get(i + 1)).min(if i > 0 { gap(at.get(i - 1)) } else { f64::INFINITY });
            if !(step * 2.0 < room) {
                return Ok(());
            }
            let (before, after) = (value(t - step), value(t + step));
            if sign(before) == 0.0 || sign(after) == 0.0 {
                return Ok(());
            }
            if sign(before) == sign(after) {
                return Err("a crossing where the line does not cross");
            }
            ends.push((t - step, before));
            ends.push((t + step, after));
        }
        ends.push((reach, value(reach)));
        for pair in ends.chunks(2) {
            let [a, b] = pair else { continue };
            if sign(a.1) != sign(b.1) && sign(a.1) != 0.0 && sign(b.1) != 0.0 {
                return Err("an odd number of crossings is missing");
            }
            // Halvings, so that one ray cannot take long; a piece that they do not settle is not judged.
            let mut budget = 2000;
            if !keeps_sign(&value, *a, *b, speed, doubt, model.size / (32.0 * speed), &mut budget) {
                return Err("a pair of crossings is missing");
            }
        }
        Ok(())
    }
}

struct Advance<'a> {
    origin: &'a DoubleVector,
    direction: DVec3,
    t: f64,
}

impl Task for Advance<'_> {
    type Output = DoubleVector;
    #[inline(always)]
    fn run<P: Product>(self) -> DoubleVector {
        self.origin.advanced::<P>(self.direction, Double::from(self.t))
    }
}

/// False if a value between the two ends has the other sign, by more than `doubt`.
fn keeps_sign(
    value: &dyn Fn(f64) -> f64,
    a: (f64, f64),
    b: (f64, f64),
    speed: f64,
    doubt: f64,
    least: f64,
    budget: &mut u32,
) -> bool {
    let side = if a.1.abs() > b.1.abs() { a.1.signum() } else { b.1.signum() };
    let proven = |a: (f64, f64), b: (f64, f64)| a.1.abs() + b.1.abs() > (b.0 - a.0) * speed;
    if proven(a, b) || *budget == 0 {
        return true;
    }
    *budget -= 1;
    if b.0 - a.0 > least {
        let middle = 0.5 * (a.0 + b.0);
        let m = (middle, value(middle));
        return m.1 * side > -doubt
            && keeps_sign(value, a, m, speed, doubt, least, budget)
            && keeps_sign(value, m, b, speed, doubt, least, budget);
    }
    // The least value of one valley by thirds: after 60 steps 3e-11 of the way, which errs by the square of that.
    let (mut low, mut high) = (a.0, b.0);
    for _ in 0..60 {
        let third = (high - low) / 3.0;
        let (s, t) = (low + third, high - third);
        let (f, g) = (value(s) * side, value(t) * side);
        if f < -doubt || g < -doubt {
            return false;
        }
        if f < g { high = t } else { low = s }
    }
    true
}

/// Where a flat shape ends, in its units.
enum Outline {
    None,
    /// The circle about the anchor as large as the shape.
    Circle,
    /// The second and third corner, the first being the anchor, and the edge between them, which is not the difference of
    /// their rounded coordinates where they are close together.
    Corners([DVec3; 2], DVec3),
}

struct Flat {
    /// Of any length.
    normal: DoubleVector,
    outline: Outline,
}

/// The cross product of two vectors, each coordinate summed without error and rounded to double-double: of a sliver's
/// edges the products cancel, and a normal from rounded ones would be none.
struct Cross(DoubleVector, DoubleVector);

impl Task for Cross {
    type Output = DoubleVector;
    #[inline(always)]
    fn run<P: Product>(self) -> DoubleVector {
        let [a, b] = [self.0, self.1].map(|v| [v.x, v.y, v.z]);
        let [x, y, z] = flat::cross::<P>(&a, &b).map(|sum| sum.rounded());
        DoubleVector { x, y, z }
    }
}

/// Where a line meets the plane through the anchor: the place, and the cosine between line and normal.
struct Meet<'a>(&'a Line, DoubleVector);

impl Task for Meet<'_> {
    type Output = (DoubleVector, f64);
    #[inline(always)]
    fn run<P: Product>(self) -> Self::Output {
        let (line, normal) = (self.0, self.1);
        let slope = normal.dot_f64::<P>(line.direction);
        let t = (-line.origin.dot::<P>(normal)).div::<P>(slope);
        let lengths = sqrt(normal.length_squared::<P>().high) * line.direction.length();
        (line.origin.advanced::<P>(line.direction, t), slope.high.abs() / lengths)
    }
}

impl Flat {
    fn model(self, anchor: DVec3, size: f64) -> Model {
        let normal = self.normal;
        let unit = if size > 0.0 { exponent(size) } else { 0 };
        let wall = move |l, _| distance(l, normal, Kind::Plane);
        Model { anchor, unit, size: size * exp2i(-unit), wall: Box::new(wall), body: Body::Flat(self) }
    }

    fn triangle(shape: &Triangle) -> Option<Model> {
        let [a, b, c] = shape.corners();
        let edges = [(b, a), (c, a), (c, b)].map(|(to, from)| DoubleVector::difference(to, from));
        let size = largest(edges[0].high()).max(largest(edges[1].high()));
        let unit = exponent(size);
        let [b, c, between] = edges.map(|edge| edge.scale_exact(exp2i(-unit)));
        let normal = run(Cross(b, c));
        // Only of edges whose least products leave the range of numbers.
        if largest(normal.high()) < exp2i(-400) {
            return None;
        }
        let normal = normal.scale_exact(exp2i(-exponent(largest(normal.high()))));
        let outline = Outline::Corners([b.high(), c.high()], between.high());
        Some(Flat { normal, outline }.model(a, size))
    }

    /// Whether the line crosses, if that is not in doubt.
    fn is_crossed(&self, line: &Line, model: &Model) -> Option<bool> {
        let (place, cosine) = run(Meet(line, self.normal));
        let place = place.high();
        // A unit of the line's place and of the normal, as seen along the plane.
        let doubt = (8.0 * U * (model.size + place.length()) + line.doubt) / cosine;
        if !(cosine > 16.0 * U) || !doubt.is_finite() {
            return None;
        }
        let inside = match self.outline {
            Outline::None => return Some(true),
            Outline::Circle => model.size - place.length(),
            Outline::Corners([b, c], between) => {
                let normal = self.normal.high();
                let normal = normal / largest(normal);
                // Seen along an axis, the edges keep their order; the height over each is at most the distance.
                let over = |from: DVec3, edge: DVec3| {
                    let edge = edge / largest(edge);
                    normal.dot(edge.cross(place - from)) / (normal.length() * edge.length())
                };
                let heights = [over(DVec3::ZERO, b), over(b, between), over(c, -c)];
                heights.into_iter().fold(f64::INFINITY, f64::min)
            }
        };
        if inside.abs() > doubt { Some(inside > 0.0) } else { None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::{Sphere, Torus};

    #[test]
    fn what_is_missing_is_found() {
        let torus = Torus::new(DVec3::ZERO, DVec3::Z, 2.0, 0.5).unwrap();
        let model = Model::new(&torus.into()).unwrap();
        let Body::Solid(distance) = &model.body else { panic!("no solid") };
        for (height, pairs) in [(0.0, 2), (0.5 - 1e-12, 2), (0.5 + 1e-12, 0)] {
            let ray = Ray::new([-9.0, 0.25, height], [3.0, 0.0, 0.0]);
            let line = Line::new(&ray, &model).unwrap();
            let none = line.judge(&model, distance, &[], &[]);
            assert_eq!(none.is_err(), pairs > 0, "{height}");
        }
    }

    #[test]
    fn what_is_not_there_is_refused() {
        let sphere = Sphere::new(DVec3::ZERO, 1.0).unwrap();
        let model = Model::new(&sphere.into()).unwrap();
        let Body::Solid(distance) = &model.body else { panic!("no solid") };
        let ray = Ray::new([-9.0, 0.5, 0.0], [3.0, 0.0, 0.0]);
        let line = Line::new(&ray, &model).unwrap();
        // The line here has a direction of length 1.5.
        let t = sqrt(0.75) / 1.5;
        let cosine = sqrt(0.75);
        assert_eq!(line.judge(&model, distance, &[-t, t], &[cosine; 2]), Ok(()));
        assert!(line.judge(&model, distance, &[-t, 1.1 * t], &[cosine; 2]).is_err());
        assert!(line.judge(&model, distance, &[-t], &[cosine]).is_err());
        assert!(line.judge(&model, distance, &[-t, 0.0, t], &[cosine; 3]).is_err());
    }

    /// However thin a sliver is, it has a normal, and rays that hit it are judged, as long as its products are numbers.
    #[test]
    fn slivers_are_judged() {
        let corners =
            |height: f64| [DVec3::ZERO, DVec3::new(3.0, 1.0, -1.0), DVec3::new(1.5, 0.5, height - 0.5)];
        for power in [-1, -20, -50, -52] {
            let [a, b, c] = corners(exp2i(power));
            let sliver = Shape::from(Triangle::new(a, b, c).unwrap());
            let normal = (b - a).cross(c - a);
            for (along, aside) in [(0.3, 0.0), (0.5, -0.25), (0.9, 2.0), (-0.5, 0.0)] {
                let to = b * along + (c - b * 0.5) * (aside + 0.1);
                let ray = Ray::new(to + normal / largest(normal), -normal);
                check_crossings(&sliver, &ray).unwrap();
            }
        }
        for (height, judged) in
            [(1e-20, true), (exp2i(-200), true), (exp2i(-390), true), (exp2i(-410), false)]
        {
            let sliver = Triangle::new([0.0; 3], [1.0, 0.0, 0.0], [0.5, height, 0.0]).unwrap();
            assert_eq!(Model::new(&sliver.into()).is_some(), judged, "{height:e}");
        }
    }

    /// Every kind of shape is judged, flat ones by whether they are crossed.
    #[test]
    fn every_kind_has_an_oracle() {
        use crate::shape::{Cone, Cuboid, Cylinder, Disk, Plane};
        let (zero, z) = (DVec3::ZERO, DVec3::Z);
        let flat: [(Shape, bool); 3] = [
            (Plane::new(zero, z).unwrap().into(), true),
            (Disk::new(zero, z, 1.0).unwrap().into(), false),
            (Triangle::new(zero, DVec3::X, DVec3::Y).unwrap().into(), false),
        ];
        for (shape, everywhere) in flat {
            let model = Model::new(&shape).unwrap();
            let Body::Flat(flat) = &model.body else { panic!("no flat shape") };
            for (x, y, inside) in
                [(0.25, 0.25, true), (0.75, 0.75, false), (-0.1, 0.3, false), (2.0, 0.1, false)]
            {
                let ray = Ray::new([x, y, 3.0], [0.0, 0.0, -2.0]);
                let line = Line::new(&ray, &model).unwrap();
                let inside = inside || everywhere || (x * x + y * y < 1.0 && matches!(shape, Shape::Disk(_)));
                let within = if x * x + y * y == 1.125 { None } else { Some(inside) };
                assert!(within.is_none() || flat.is_crossed(&line, &model) == within, "{shape:?} {x} {y}");
                assert_eq!(check_crossings(&shape, &ray), Ok(()));
            }
        }
        let solid: [Shape; 5] = [
            Sphere::new(zero, 1.0).unwrap().into(),
            Cuboid::new(-DVec3::ONE, DVec3::ONE).unwrap().into(),
            Cylinder::new(zero, z, 1.0).unwrap().into(),
            Cone::new(zero, 1.0, z, 0.5).unwrap().into(),
            Torus::new(zero, z, 2.0, 0.5).unwrap().into(),
        ];
        for shape in solid {
            assert!(Model::new(&shape).is_some(), "{shape:?}");
        }
    }

    /// A piece between two values of one sign is judged by what lies between: dips of any width that reach below zero are
    /// found, others are not.
    #[test]
    fn dips_are_found() {
        let mut random = crate::testing::Random::new(1);
        let mut count = [0; 2];
        for case in 0..4000 {
            let (speed, side) = (random.uniform(0.5, 2.0), random.sign());
            let (middle, least) = (random.uniform(-0.8, 0.8), random.magnitude(-6.0, -1.0) * random.sign());
            // As steep as a distance may be, or a smooth valley.
            let bend = random.magnitude(-1.0, 2.0);
            let value = |t: f64| {
                let way = (t - middle).abs();
                let rise = if case % 2 == 0 { way } else { (way * way * bend).min(way.max(0.5 * way)) };
                side * (least + rise * speed)
            };
            let doubt = 1e-7;
            let mut budget = 2000;
            let ends = [-1.0, 1.0].map(|t| (t, value(t)));
            if ends.iter().any(|end| end.1 * side <= least.abs()) {
                continue;
            }
            let kept = keeps_sign(&value, ends[0], ends[1], speed, doubt, 0.01, &mut budget);
            assert_eq!(kept, least > 0.0, "{middle} {least} {bend} {speed}");
            assert!(budget > 1700, "{budget}");
            // Without a budget nothing is judged.
            assert!(keeps_sign(&value, ends[0], ends[1], speed, doubt, 0.01, &mut 0));
            count[usize::from(kept)] += 1;
        }
        assert!(count[0] > 1000 && count[1] > 1000, "{count:?}");
    }

    fn solids(random: &mut crate::testing::Random) -> [Shape; 6] {
        use crate::shape::{Cone, Cuboid, Cylinder};
        let mut point = || random.in_cube();
        let (a, b) = (point(), point());
        let corner = DVec3::new(0.4, 0.3, 0.5);
        let axis = point().normalize();
        let by = crate::Similarity::IDENTITY.rotated(axis, 57.0).unwrap().translated(b).unwrap();
        [
            Sphere::new(a, 0.7).unwrap().into(),
            Torus::new(a, b, 1.0, 0.3).unwrap().into(),
            Cuboid::new(-corner, corner).unwrap().transformed(&by).unwrap().into(),
            Cylinder::new(a, a + axis, 0.4).unwrap().into(),
            Cone::new(a, 0.7, a + axis, 0.2).unwrap().into(),
            Cone::new(a, 0.0, a + axis * 0.8, 0.5).unwrap().into(),
        ]
    }

    /// Of the true crossings none may be left out, doubled, moved or added, whatever the shape.
    #[test]
    fn wrong_lists_are_refused() {
        let mut random = crate::testing::Random::new(2);
        let mut count = 0;
        for _ in 0..300 {
            for shape in solids(&mut random) {
                let model = Model::new(&shape).unwrap();
                let Body::Solid(distance) = &model.body else { panic!("no solid") };
                let along = random.direction() * random.magnitude(-1.0, 1.0);
                let target = shape.bounds().unwrap().center() + random.in_cube() * 0.4;
                let ray = Ray::new(target - along * random.uniform(0.0, 3.0), along);
                let line = Line::new(&ray, &model).unwrap();
                let (mut at, mut cosines) = (Vec::new(), Vec::new());
                let scale = exp2i(-model.unit);
                shape.crossings(&ray, Interval::LINE, &mut |hit| {
                    let surface = shape.surface(&ray, hit);
                    let place = surface.local * scale;
                    at.push(line.parameter(place));
                    cosines.push(surface.normal.dot(line.direction.normalize()).abs());
                    // The distance beside the surface, and from the line.
                    for off in [1e-3, -1e-3, 1e-9, -1e-9] {
                        let beside = place + surface.normal * off;
                        let away = (model.wall)(DoubleVector::from(beside), hit.part());
                        // Inside a box another face may be nearer.
                        let nearer =
                            matches!(shape, Shape::Cuboid(_)) && off < 0.0 && (off..1e-14).contains(&away);
                        assert!((away - off).abs() < 1e-14 || nearer, "{shape:?} {place} {off} {away}");
                    }
                    let across = line.direction.cross(random.direction());
                    let off = line.distance(place + across);
                    assert!((off - across.length()).abs() < 1e-14, "{off} {across}");
                });
                assert_eq!(line.judge(&model, distance, &at, &cosines), Ok(()), "{shape:?} {ray:?}");
                // Only where the line runs in and out clearly.
                let speed = line.direction.length();
                let clear = at.windows(2).all(|pair| (pair[1] - pair[0]) * speed > 0.01);
                if at.is_empty() || !clear || cosines.iter().any(|cosine| *cosine < 0.01) {
                    continue;
                }
                count += 1;
                let refused = |at: &[f64], cosines: &[f64], what: &str| {
                    assert!(line.judge(&model, distance, at, cosines).is_err(), "{what}: {shape:?} {ray:?}");
                };
                for i in 0..at.len() {
                    let (mut fewer, mut others) = (at.clone(), cosines.clone());
                    fewer.remove(i);
                    others.remove(i);
                    refused(&fewer, &others, "one is missing");
                    let mut moved = at.clone();
                    moved[i] += 2e-3 / speed;
                    refused(&moved, &cosines, "one is elsewhere");
                    if i + 1 < at.len() {
                        let (mut fewer, mut others) = (at.clone(), cosines.clone());
                        fewer.drain(i..i + 2);
                        others.drain(i..i + 2);
                        refused(&fewer, &others, "two are missing");
                        let (mut more, mut others) = (at.clone(), cosines.clone());
                        more.insert(i + 1, 0.5 * (at[i] + at[i + 1]));
                        others.insert(i + 1, 1.0);
                        refused(&more, &others, "one too many");
                    }
                }
            }
        }
        assert!(count > 1000, "{count}");
    }
}
