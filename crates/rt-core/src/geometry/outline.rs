//! What a shape looks like from a point: its silhouette on the faces of a cube, never too small.

use crate::Shape;
use crate::frame::frame;
use crate::math::{exp2i, sqrt};
use alloc::vec::Vec;
use core::f64::consts::{FRAC_PI_4, PI};
use glam::{DVec2, DVec3};

/// Something that hides all that a shape hides, relative to a point.
#[derive(Clone, Debug)]
pub(super) enum Outline {
    /// The shape is in the convex hull of these.
    Hull(Vec<DVec3>),
    /// A sphere about `center`; `sine` is that of the angle under which its radius is seen.
    Ball { center: DVec3, sine: f64 },
    /// A plane in front of the point: seen in all directions whose product with this unit vector is greater than zero.
    Plane(DVec3),
    /// Nothing better than its box is known.
    Unknown,
}

/// The corners of a polygon about a circle.
const CORNERS: usize = 16;

/// By how much all sizes are widened: far more than the roundings here, far less than the margin of the squares.
const WIDER: f64 = 1.0 + exp2i(-30);

impl Outline {
    /// The outline of a shape as seen from `point`.
    pub fn of(shape: &Shape, point: DVec3) -> Outline {
        match shape {
            Shape::Sphere(sphere) => {
                let center = sphere.center() - point;
                let sine = sphere.radius() / sqrt(center.dot(center)) * WIDER;
                if sine < 1.0 { Outline::Ball { center, sine } } else { Outline::Unknown }
            }
            Shape::Plane(plane) => {
                let height = plane.normal().dot(plane.point() - point);
                Outline::Plane(if height < 0.0 { -plane.normal() } else { plane.normal() })
            }
            Shape::Cuboid(cuboid) => {
                let [x, y, z] = cuboid.axes();
                let (corner, size) = (cuboid.corner() - point, cuboid.size());
                let at = |i: u32, axis: DVec3, size: f64| if i == 0 { DVec3::ZERO } else { axis * size };
                Outline::hull(
                    (0..8)
                        .map(|i| corner + at(i & 1, x, size.x) + at(i & 2, y, size.y) + at(i & 4, z, size.z)),
                )
            }
            Shape::Cylinder(c) => {
                Outline::frustum(c.base() - point, c.top() - point, [c.radius(); 2], c.top() - c.base())
            }
            Shape::Cone(c) => {
                let radii = [c.base_radius(), c.top_radius()];
                Outline::frustum(c.base() - point, c.top() - point, radii, c.top() - c.base())
            }
            Shape::Torus(torus) => {
                // An octagon about the circle of the tube, turned about the axis.
                let (center, axis) = (torus.center() - point, torus.axis());
                let minor = torus.minor() * WIDER;
                let half = minor * libm::tan(0.5 * FRAC_PI_4);
                let ring = |out: f64, up: f64| ring(center + axis * up, axis, torus.major() + out);
                Outline::hull(
                    ring(minor, half)
                        .chain(ring(minor, -half))
                        .chain(ring(half, minor))
                        .chain(ring(half, -minor)),
                )
            }
            Shape::Disk(disk) => Outline::hull(ring(disk.center() - point, disk.normal(), disk.radius())),
            Shape::Triangle(triangle) => Outline::hull(triangle.corners().into_iter().map(|c| c - point)),
            Shape::Custom(_) => Outline::Unknown,
        }
    }

    fn frustum(base: DVec3, top: DVec3, radii: [f64; 2], along: DVec3) -> Outline {
        // Below, the square loses digits.
        if !(along.dot(along) > exp2i(-900)) {
            return Outline::Unknown;
        }
        let axis = along.normalize();
        Outline::hull(ring(base, axis, radii[0]).chain(ring(top, axis, radii[1])))
    }

    fn hull(points: impl Iterator<Item = DVec3>) -> Outline {
        let points: Vec<DVec3> = points.collect();
        if points.iter().all(|p| p.is_finite()) { Outline::Hull(points) } else { Outline::Unknown }
    }

    /// The silhouette on a face, where all of the shape is in front of it and at least `least` away.
    pub fn on_face(&self, face: Face, least: f64) -> Silhouette {
        match self {
            Outline::Hull(points) => {
                let seen: Option<Vec<DVec2>> = points
                    .iter()
                    .map(|&p| {
                        let (p, depth) = face.split(p);
                        (depth > least).then(|| p / depth)
                    })
                    .collect();
                seen.map_or(Silhouette::Everything, |points| Silhouette::Polygon(convex_hull(points)))
            }
            Outline::Ball { center, sine } => {
                let (p, depth) = face.split(*center);
                let center = p.extend(depth) / sqrt(center.dot(*center));
                Silhouette::Disc { center, sine: *sine, cosine: sqrt(1.0 - sine * sine) }
            }
            Outline::Plane(towards) => {
                let (p, depth) = face.split(*towards);
                Silhouette::HalfPlane(p.extend(depth))
            }
            Outline::Unknown => Silhouette::Everything,
        }
    }
}

/// The corners of a regular polygon about the circle.
fn ring(center: DVec3, axis: DVec3, radius: f64) -> impl Iterator<Item = DVec3> {
    let (first, second) = frame(axis);
    let radius = radius / libm::cos(PI / CORNERS as f64) * WIDER;
    (0..CORNERS).map(move |i| {
        let angle = i as f64 * (2.0 * PI / CORNERS as f64);
        center + first * (radius * libm::cos(angle)) + second * (radius * libm::sin(angle))
    })
}

/// The corners of the convex hull in order (Andrew's monotone chain, doi:10.1016/0020-0190(79)90072-3).
fn convex_hull(mut points: Vec<DVec2>) -> Vec<DVec2> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let mut hull: Vec<DVec2> = Vec::with_capacity(points.len() + 1);
    let mut half = |points: &mut dyn Iterator<Item = DVec2>| {
        let start = hull.len();
        for p in points {
            while let [.., a, b] = hull[start..]
                && !((b - a).perp_dot(p - b) > 0.0)
            {
                hull.pop();
            }
            hull.push(p);
        }
        hull.pop();
    };
    half(&mut points.iter().copied());
    half(&mut points.iter().rev().copied());
    if hull.is_empty() { points } else { hull }
}

/// A face of the cube about the point: 0 to 5 are +x, -x, +y, -y, +z, -z.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face(pub usize);

impl Face {
    /// The coordinates along the face, and the depth before it.
    fn split(self, p: DVec3) -> (DVec2, f64) {
        let axis = self.0 / 2;
        let depth = if self.0.is_multiple_of(2) { p[axis] } else { -p[axis] };
        (DVec2::new(p[(axis + 1) % 3], p[(axis + 2) % 3]), depth)
    }
}

/// Part of a face, in coordinates from -1 to 1.
#[derive(Clone, Debug)]
pub(super) enum Silhouette {
    /// The whole.
    Everything,
    /// A convex polygon.
    Polygon(Vec<DVec2>),
    /// The directions that make an angle of at most this sine and cosine with a unit vector.
    Disc { center: DVec3, sine: f64, cosine: f64 },
    /// The directions whose product with this vector is greater than zero.
    HalfPlane(DVec3),
}

impl Silhouette {
    /// Whether it may meet a square; `edge` is the number of squares along a face, `margin` what errs. A polygon is
    /// asked by its [`span`](Silhouette::span).
    pub fn meets(&self, row: usize, column: usize, edge: usize, margin: f64) -> bool {
        let center = self.center(row, column, edge);
        let half = 1.0 / edge as f64 + margin;
        match self {
            Silhouette::Everything | Silhouette::Polygon(_) => true,
            Silhouette::Disc { center: axis, sine, cosine } => {
                // All of the square lies within this angle of its centre: at a depth of at least 1 a distance is
                // greater than the sine of the angle under which it is seen.
                let spread = half * core::f64::consts::SQRT_2;
                let within = cosine * sqrt(1.0 - spread * spread) - sine * spread;
                let direction = center.extend(1.0);
                let along = direction.dot(*axis);
                let least = within - margin;
                along >= least * sqrt(direction.dot(direction))
            }
            Silhouette::HalfPlane(normal) => {
                normal.x * center.x
                    + normal.y * center.y
                    + normal.z
                    + (normal.x.abs() + normal.y.abs()) * half
                    + margin
                    > 0.0
            }
        }
    }

    fn center(&self, row: usize, column: usize, edge: usize) -> DVec2 {
        let place = |i: usize| (2 * i + 1) as f64 / edge as f64 - 1.0;
        DVec2::new(place(column), place(row))
    }

    /// The least and greatest first coordinate between two values of the second, or `None` where there are none.
    pub fn span(&self, low: f64, high: f64) -> Option<(f64, f64)> {
        let Silhouette::Polygon(corners) = self else { return Some((f64::NEG_INFINITY, f64::INFINITY)) };
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        let mut meet = |x: f64| {
            least = if x < least { x } else { least };
            most = if x > most { x } else { most };
        };
        for (i, &a) in corners.iter().enumerate() {
            let b = corners[(i + 1) % corners.len()];
            if (low..=high).contains(&a.y) {
                meet(a.x);
            }
            for level in [low, high] {
                if (a.y < level) != (b.y < level) {
                    meet(a.x + (b.x - a.x) * ((level - a.y) / (b.y - a.y)));
                }
            }
        }
        (least <= most).then_some((least, most))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hull_turns_one_way_and_holds_all_points() {
        let points: Vec<DVec2> =
            (0..50).map(|i| DVec2::new(f64::from(i * 37 % 50), f64::from(i * 21 % 50) * 0.5)).collect();
        let hull = convex_hull(points.clone());
        for (i, &a) in hull.iter().enumerate() {
            let b = hull[(i + 1) % hull.len()];
            assert!(points.iter().all(|&p| (b - a).perp_dot(p - a) >= 0.0));
        }
        assert!(convex_hull(alloc::vec![DVec2::ONE; 3]).iter().all(|&p| p == DVec2::ONE));
    }

    #[test]
    fn a_span_is_that_of_the_polygon() {
        let square = Silhouette::Polygon(alloc::vec![
            DVec2::new(0.0, -1.0),
            DVec2::new(1.0, 0.0),
            DVec2::new(0.0, 1.0),
            DVec2::new(-1.0, 0.0)
        ]);
        assert_eq!(square.span(-0.25, 0.5), Some((-1.0, 1.0)));
        assert_eq!(square.span(0.25, 0.5), Some((-0.75, 0.75)));
        assert_eq!(square.span(0.75, 2.0), Some((-0.25, 0.25)));
        assert_eq!(square.span(1.5, 2.0), None);
    }

    /// The outline of a torus holds its surface and exceeds it by no more than a polygon of so many corners about each of
    /// its two circles does.
    #[test]
    fn the_outline_of_a_torus() {
        let (center, axis) = (DVec3::new(1.0, -2.0, 0.5), DVec3::new(0.6, 0.0, 0.8));
        for (major, minor) in [(1.0, 0.25), (3.0, 0.01), (1.0, 0.75)] {
            let torus = Shape::from(crate::shape::Torus::new(center, axis, major, minor).unwrap());
            let Outline::Hull(corners) = Outline::of(&torus, DVec3::ZERO) else { panic!("a hull") };
            let wider = 1.0 / libm::cos(PI / CORNERS as f64);
            let tube = minor / libm::cos(0.5 * FRAC_PI_4);
            for &corner in &corners {
                let local = corner - center;
                let height = local.dot(axis);
                let rho = (local - axis * height).length();
                assert!(height.abs() <= minor * 1.001 && rho <= (major + minor) * wider * 1.001, "{local}");
                assert!(
                    rho >= major - minor * 1.001 && libm::hypot(rho / wider - major, height) <= tube * 1.001
                );
            }
            // No point of the surface is farther out, in any direction, than the farthest corner.
            for i in 0..2000 {
                let x = f64::from(i);
                let way = DVec3::new(libm::sin(x), libm::cos(1.7 * x), libm::sin(2.3 * x + 1.0)).normalize();
                let up = way.dot(axis);
                let farthest = center.dot(way) + major * sqrt(1.0 - up * up) + minor;
                assert!(corners.iter().any(|corner| corner.dot(way) >= farthest), "{way}");
            }
        }
    }

    /// The outline of any shape holds its surface and exceeds it by no more than polygons do.
    #[test]
    fn outlines_hold_their_shapes() {
        use crate::shape::{Cone, Cuboid, Cylinder, Disk, Sphere, Triangle};
        use crate::{Interval, Primitive, Ray, Similarity};
        let mut random = crate::testing::Random::new(1);
        for _ in 0..20 {
            let (a, b, c) = (random.in_cube(), random.in_cube(), random.in_cube());
            let turn = Similarity::IDENTITY.rotated(b, 77.0).unwrap().translated(c).unwrap();
            let size = DVec3::new(0.3, 0.9, 0.5);
            let shapes: [Shape; 6] = [
                Cuboid::new(a, a + size).unwrap().into(),
                Cuboid::new(-size, size).unwrap().transformed(&turn).unwrap().into(),
                Cylinder::new(a, a + b.normalize(), 0.4).unwrap().into(),
                Cone::new(a, 0.2, a + b.normalize(), 0.7).unwrap().into(),
                Disk::new(a, b, 0.6).unwrap().into(),
                Triangle::new(a, b, c).unwrap().into(),
            ];
            let point = random.in_cube() * 3.0;
            for shape in shapes {
                let Outline::Hull(corners) = Outline::of(&shape, point) else { panic!("a hull") };
                let bounds = shape.bounds().unwrap();
                let mut places = Vec::new();
                for _ in 0..1500 {
                    let target = bounds.min + (random.in_cube() * 0.5 + 0.5) * (bounds.max - bounds.min);
                    let ray = Ray::new(target, random.direction());
                    shape.crossings(&ray, Interval::LINE, &mut |hit| {
                        places.push(shape.surface(&ray, hit).point)
                    });
                }
                assert!(places.len() > 50, "{shape:?}");
                for _ in 0..100 {
                    let way = random.direction();
                    let farthest =
                        |points: &[DVec3]| points.iter().fold(f64::NEG_INFINITY, |m, p| m.max(p.dot(way)));
                    let (hull, surface) = (farthest(&corners), farthest(&places) - point.dot(way));
                    assert!(
                        (surface - 1e-12..surface + 0.3).contains(&hull),
                        "{shape:?} {way}: {hull} {surface}"
                    );
                }
            }
            let sphere = Sphere::new(a, 0.25).unwrap();
            match Outline::of(&sphere.into(), point) {
                Outline::Ball { center, sine } => {
                    assert_eq!(center, a - point);
                    assert!(
                        (sine * center.length() / 0.25 - 1.0).abs() < 1e-8 && sine * center.length() > 0.25
                    );
                }
                _ => assert!((a - point).length() < 0.2501),
            }
        }
    }
}
