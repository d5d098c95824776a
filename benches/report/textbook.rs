//! The formulas of the textbooks, in `f64` and in `f32`: what a careful programmer writes on the first day.
//!
//! The first hit inside the interval, and nothing else. Shapes are prepared once (unit axes, radii), as a renderer
//! would. Sources: Glassner (ed.), An Introduction to Ray Tracing, 1989, chapter 2 (sphere, plane, box, quadrics);
//! Moller and Trumbore 1997, doi:10.1080/10867651.1997.10487468 (triangle); Williams et al. 2005,
//! doi:10.1080/2151237X.2005.10129188 (box); Schwarze, Graphics Gems, 1990 (quartic, in `rt_core::poly`).

macro_rules! textbook {
    ($(#[$about:meta])* $module:ident, $real:ident) => {
        $(#[$about])*
        pub mod $module {
            use serde_json::Value;

            /// A number of this precision.
            pub type Real = $real;
            /// A vector.
            pub type Vector = [Real; 3];

            fn dot(a: Vector, b: Vector) -> Real {
                a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
            }
            fn sub(a: Vector, b: Vector) -> Vector {
                [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
            }
            fn add_scaled(a: Vector, b: Vector, s: Real) -> Vector {
                [a[0] + b[0] * s, a[1] + b[1] * s, a[2] + b[2] * s]
            }
            fn cross(a: Vector, b: Vector) -> Vector {
                [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
            }
            fn unit(a: Vector) -> Vector {
                let l = dot(a, a).sqrt();
                [a[0] / l, a[1] / l, a[2] / l]
            }

            /// A ray with the interval in which a hit counts.
            #[derive(Clone, Copy)]
            pub struct Ray {
                /// Origin.
                pub o: Vector,
                /// Direction.
                pub d: Vector,
                /// Lower end, excluded.
                pub min: Real,
                /// Upper end, excluded.
                pub max: Real,
            }

            impl Ray {
                fn admits(&self, t: Real) -> bool {
                    self.min < t && t < self.max
                }
                fn nearer(&self, best: Option<Real>, t: Real) -> Option<Real> {
                    if self.admits(t) && best.is_none_or(|b| t < b) { Some(t) } else { best }
                }
            }

            /// A prepared shape.
            pub enum Shape {
                /// Centre, radius squared.
                Sphere(Vector, Real),
                /// Point, unit normal.
                Plane(Vector, Vector),
                /// Corners.
                Cuboid(Vector, Vector),
                /// Base, unit axis, height, base radius, slope of the radius, closed: cylinders and cones.
                Frustum(Vector, Vector, Real, Real, Real, bool),
                /// Centre, unit axis, two unit vectors across it, major, minor.
                Torus(Vector, [Vector; 3], Real, Real),
                /// Centre, unit normal, radius squared.
                Disk(Vector, Vector, Real),
                /// A vertex and two edges.
                Triangle(Vector, Vector, Vector),
            }

            /// A vector from JSON.
            pub fn vector(v: &Value) -> Vector {
                [0, 1, 2].map(|i| v[i].as_f64().unwrap_or(f64::NAN) as Real)
            }

            impl Shape {
                /// From the numbers of a truth row.
                pub fn prepare(kind: &str, n: &Value) -> Shape {
                    let v = |key: &str| vector(&n[key]);
                    let f = |key: &str| n[key].as_f64().unwrap_or(f64::NAN) as Real;
                    let frustum = |r0: Real, r1: Real, closed| {
                        let along = sub(v("top"), v("base"));
                        let height = dot(along, along).sqrt();
                        Shape::Frustum(v("base"), unit(along), height, r0, (r1 - r0) / height, closed)
                    };
                    match kind {
                        "sphere" => Shape::Sphere(v("center"), f("radius") * f("radius")),
                        "plane" => Shape::Plane(v("point"), unit(v("normal"))),
                        "cuboid" => Shape::Cuboid(v("min"), v("max")),
                        "cylinder" => frustum(f("radius"), f("radius"), true),
                        "open_cylinder" => frustum(f("radius"), f("radius"), false),
                        "cone" => frustum(f("base_radius"), f("top_radius"), true),
                        "open_cone" => frustum(f("base_radius"), f("top_radius"), false),
                        "torus" => {
                            let z = unit(v("axis"));
                            let other = if z[0].abs() < 0.5 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
                            let x = unit(cross(other, z));
                            Shape::Torus(v("center"), [x, cross(z, x), z], f("major"), f("minor"))
                        }
                        "disk" => Shape::Disk(v("center"), unit(v("normal")), f("radius") * f("radius")),
                        _ => Shape::Triangle(v("a"), sub(v("b"), v("a")), sub(v("c"), v("a"))),
                    }
                }

                /// The first hit; `quartic` solves `c0 + c1 x + .. + c4 x^4` and gives its real roots.
                pub fn hit(&self, r: &Ray, quartic: impl Fn([Real; 5], &mut [Real; 4]) -> usize) -> Option<Real> {
                    match *self {
                        Shape::Sphere(center, rr) => {
                            let w = sub(r.o, center);
                            let (a, b, c) = (dot(r.d, r.d), dot(w, r.d), dot(w, w) - rr);
                            let disc = b * b - a * c;
                            if disc < 0.0 {
                                return None;
                            }
                            let root = disc.sqrt();
                            [(-b - root) / a, (-b + root) / a].into_iter().find(|t| r.admits(*t))
                        }
                        Shape::Plane(point, n) => {
                            let t = dot(sub(point, r.o), n) / dot(r.d, n);
                            r.admits(t).then_some(t)
                        }
                        Shape::Cuboid(min, max) => {
                            let (mut enter, mut leave) = (Real::NEG_INFINITY, Real::INFINITY);
                            for k in 0..3 {
                                let inverse = 1.0 / r.d[k];
                                let (a, b) = ((min[k] - r.o[k]) * inverse, (max[k] - r.o[k]) * inverse);
                                enter = enter.max(a.min(b));
                                leave = leave.min(a.max(b));
                            }
                            if enter > leave {
                                return None;
                            }
                            [enter, leave].into_iter().find(|t| r.admits(*t))
                        }
                        Shape::Frustum(base, axis, height, r0, slope, closed) => {
                            let w = sub(r.o, base);
                            let (wa, da) = (dot(w, axis), dot(r.d, axis));
                            let (wp, dp) = (add_scaled(w, axis, -wa), add_scaled(r.d, axis, -da));
                            let (e0, e1) = (r0 + slope * wa, slope * da);
                            let (a, b, c) = (dot(dp, dp) - e1 * e1, dot(wp, dp) - e0 * e1, dot(wp, wp) - e0 * e0);
                            let mut best = None;
                            let disc = b * b - a * c;
                            if disc >= 0.0 {
                                let root = disc.sqrt();
                                for t in [(-b - root) / a, (-b + root) / a] {
                                    let h = wa + t * da;
                                    if h >= 0.0 && h <= height {
                                        best = r.nearer(best, t);
                                    }
                                }
                            }
                            if closed {
                                for (h, radius) in [(0.0, r0), (height, r0 + slope * height)] {
                                    let t = (h - wa) / da;
                                    let p = add_scaled(wp, dp, t);
                                    if dot(p, p) <= radius * radius {
                                        best = r.nearer(best, t);
                                    }
                                }
                            }
                            best
                        }
                        Shape::Torus(center, [x, y, z], major, minor) => {
                            let w = sub(r.o, center);
                            let (ox, oy, oz) = (dot(w, x), dot(w, y), dot(w, z));
                            let (dx, dy, dz) = (dot(r.d, x), dot(r.d, y), dot(r.d, z));
                            // The expansion of (|p|^2 + R^2 - r^2)^2 = 4 R^2 (x^2 + y^2) as it is usually printed.
                            let dd = dx * dx + dy * dy + dz * dz;
                            let od = ox * dx + oy * dy + oz * dz;
                            let e = ox * ox + oy * oy + oz * oz - major * major - minor * minor;
                            let four = 4.0 * major * major;
                            let mut roots = [0.0; 4];
                            let n = quartic(
                                [
                                    e * e - four * (minor * minor - oz * oz),
                                    4.0 * od * e + 2.0 * four * oz * dz,
                                    2.0 * dd * e + 4.0 * od * od + four * dz * dz,
                                    4.0 * dd * od,
                                    dd * dd,
                                ],
                                &mut roots,
                            );
                            roots[..n].iter().fold(None, |best, t| r.nearer(best, *t))
                        }
                        Shape::Disk(center, n, rr) => {
                            let t = dot(sub(center, r.o), n) / dot(r.d, n);
                            let p = sub(add_scaled(r.o, r.d, t), center);
                            (dot(p, p) <= rr && r.admits(t)).then_some(t)
                        }
                        Shape::Triangle(a, ab, ac) => {
                            let p = cross(r.d, ac);
                            let det = dot(ab, p);
                            let s = sub(r.o, a);
                            let u = dot(s, p) / det;
                            let q = cross(s, ab);
                            let v = dot(r.d, q) / det;
                            let t = dot(ac, q) / det;
                            (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && r.admits(t)).then_some(t)
                        }
                    }
                }
            }

            /// Ferrari's method with Cardano's resolvent, as printed.
            pub fn ferrari(c: [Real; 5], roots: &mut [Real; 4]) -> usize {
                let [e, d, c, b, a] = c;
                let (b, c, d, e) = (b / a, c / a, d / a, e / a);
                let (p, q) = (c - 3.0 * b * b / 8.0, b * b * b / 8.0 - b * c / 2.0 + d);
                let r = -3.0 * b * b * b * b / 256.0 + b * b * c / 16.0 - b * d / 4.0 + e;
                // 8 m^3 + 8 p m^2 + (2 p^2 - 8 r) m - q^2 = 0, its largest root.
                let (rb, rc, rd) = (p, p * p / 4.0 - r, -q * q / 8.0);
                let (cp, cq) = (rc - rb * rb / 3.0, 2.0 * rb * rb * rb / 27.0 - rb * rc / 3.0 + rd);
                let disc = cq * cq / 4.0 + cp * cp * cp / 27.0;
                let m = if disc >= 0.0 {
                    let s = disc.sqrt();
                    (-cq / 2.0 + s).cbrt() + (-cq / 2.0 - s).cbrt()
                } else {
                    let k = 2.0 * (-cp / 3.0).sqrt();
                    let angle = ((3.0 * cq) / (cp * k)).clamp(-1.0, 1.0).acos();
                    k * (angle / 3.0).cos()
                } - rb / 3.0;
                let mut n = 0;
                let s = (2.0 * m).max(0.0).sqrt();
                for sign in [-1.0, 1.0] {
                    let inner = -(2.0 * p + 2.0 * m + sign * 2.0 * q / s);
                    if inner >= 0.0 {
                        let w = inner.sqrt();
                        for half in [-w, w] {
                            roots[n] = (sign * s + half) / 2.0 - b / 4.0;
                            n += 1;
                        }
                    }
                }
                n
            }
        }
    };
}

textbook!(
    /// In double precision.
    double,
    f64
);
textbook!(
    /// In single precision: the input is rounded too.
    single,
    f32
);
