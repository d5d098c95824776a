use super::*;
use crate::{Side, Surface};
use alloc::vec::Vec;
use proptest::prelude::*;

fn all(torus: &Torus, ray: &Ray) -> Vec<Hit> {
    let mut hits = Vec::new();
    torus.crossings(ray, Interval::LINE, &mut |hit| hits.push(hit));
    hits
}

fn direction() -> impl Strategy<Value = DVec3> {
    [-1.0..1.0_f64, -1.0..1.0, -1.0..1.0]
        .prop_map(DVec3::from)
        .prop_filter("not too short", |v| v.length_squared() > 1e-4)
        .prop_map(|v| v.normalize())
}

/// Rings down to a millionth, nearly horns, spindles.
fn radii() -> impl Strategy<Value = (f64, f64)> {
    (0.5..2.0_f64, prop_oneof![0.05..0.95_f64, (-6.0..-1.0_f64).prop_map(libm::exp10), 0.95..1.05, 1.0..4.0])
        .prop_map(|(major, ratio)| (major, major * ratio))
}

fn torus() -> impl Strategy<Value = Torus> {
    let axis = prop_oneof![direction(), Just(DVec3::X), Just(DVec3::Y), Just(-3.0 * DVec3::Z)];
    let center =
        prop_oneof![Just(DVec3::ZERO), direction().prop_map(|v| 3.0 * v), direction().prop_map(|v| 1e6 * v)];
    (center, axis, radii()).prop_map(|(c, a, (major, minor))| Torus::new(c, a, major, minor).unwrap())
}

/// Rays at a point on or near the surface, some along a tangent, off it by 1e-15 to 1e-1 of the tube.
fn aimed() -> impl Strategy<Value = (Torus, Ray)> {
    let graze = prop_oneof![Just(None), (-15.0..-1.0_f64, any::<bool>()).prop_map(Some)];
    (torus(), 0.0..1.0_f64, 0.0..1.0_f64, direction(), graze, -3.0..4.0_f64).prop_map(
        |(torus, u, v, direction, graze, distance)| {
            let (p, n) = place(&torus, u, v);
            let distance = libm::exp10(distance) * torus.major;
            let (target, direction) = match graze {
                None => (p, direction),
                Some((depth, within)) => {
                    let along = direction - n * direction.dot(n);
                    let depth = libm::exp10(depth) * torus.minor * if within { -1.0 } else { 1.0 };
                    (p + n * depth, along)
                }
            };
            (torus, Ray::new(torus.center + (target - direction * distance), direction))
        },
    )
}

/// The point, relative to the centre, and the normal at these angles in turns.
fn place(torus: &Torus, u: f64, v: f64) -> (DVec3, DVec3) {
    let turn = core::f64::consts::TAU;
    let [x, y, z] = torus.frame.map(|axis| axis.high());
    let radial = x * libm::cos(u * turn) + y * libm::sin(u * turn);
    let normal = radial * libm::cos(v * turn) + z * libm::sin(v * turn);
    (radial * torus.major + normal * torus.minor, normal)
}

/// The distance of a point from the nearer sheet, in `f64`.
fn off(torus: &Torus, local: DVec3) -> f64 {
    let z = local.dot(torus.axis);
    let rho = (local - torus.axis * z).length();
    let near = libm::hypot(rho - torus.major, z) - torus.minor;
    let far = libm::hypot(rho + torus.major, z) - torus.minor;
    near.abs().min(far.abs())
}

#[test]
fn four_crossings_along_x() {
    let torus = Torus::new([0.0, 0.0, 0.0], [0.0, 0.0, 7.0], 2.0, 0.5).unwrap();
    let ray = Ray::new([-10.0, 0.0, 0.0], [2.0, 0.0, 0.0]);
    let hits = all(&torus, &ray);
    assert_eq!(hits.iter().map(|h| h.t()).collect::<Vec<_>>(), [3.75, 4.25, 5.75, 6.25]);
    assert_eq!(hits.iter().map(|h| h.root()).collect::<Vec<_>>(), [0, 1, 2, 3]);
    let normals: Vec<f64> = hits.iter().map(|&h| torus.surface(&ray, h).normal.x).collect();
    assert_eq!(normals, [-1.0, 1.0, -1.0, 1.0]);
    assert_eq!(torus.hit(&ray, Interval::new(4.25, 9.0)).map(|h| h.t()), Some(5.75));
    assert_eq!(torus.hit(&ray, Interval::new(4.25, 5.75)), None);
}

/// What leaves the pole of a spindle along the axis, where both sheets meet, meets neither on its way out.
#[test]
fn out_of_the_pole_of_a_spindle() {
    for k in 1..200 {
        let length = f64::from(k) / 7.0;
        for axis in [DVec3::X * length, DVec3::Y * length, DVec3::new(0.0, length, -0.5 * length)] {
            let torus = Torus::new(DVec3::ZERO, axis, 0.28125, 1.6 + f64::from(k)).unwrap();
            let ray = Ray::new(axis * (1000.0 / length), -axis);
            for hit in all(&torus, &ray).into_iter().take(1) {
                let surface = torus.surface(&ray, hit);
                let side = Side::of_arrival(ray.direction, surface.normal);
                let from = surface.departure(0, hit, side);
                let (start, within) = from.ray(ray.origin - surface.point);
                assert_eq!(torus.hit_leaving(&start, within, &from), None, "{torus:?} {surface:?}");
            }
        }
    }
}

#[test]
fn a_spindle_has_two_sheets() {
    // (rho - 3)^2 + z^2 = 25: along z = 0 the outer sheet is at rho = 8, the inner at rho = 2.
    let torus = Torus::new([0.0, 0.0, 0.0], [0.0, 1.0, 0.0], 3.0, 5.0).unwrap();
    let ray = Ray::new([-10.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
    let hits = all(&torus, &ray);
    assert_eq!(hits.iter().map(|&h| torus.surface(&ray, h).t).collect::<Vec<_>>(), [2.0, 8.0, 12.0, 18.0]);
    // The inner sheet's normal points away from the far side of the circle.
    let normals: Vec<f64> = hits.iter().map(|&h| torus.surface(&ray, h).normal.x).collect();
    assert_eq!(normals, [-1.0, -1.0, 1.0, 1.0]);
}

#[test]
fn tangents_are_no_hits() {
    let torus = Torus::new([0.0, 0.0, 0.0], [0.0, 0.0, 1.0], 2.0, 0.5).unwrap();
    for (origin, direction) in [
        ([-10.0, 0.0, 0.5], DVec3::X),
        ([-10.0, 2.5, 0.0], DVec3::X),
        ([2.5, 0.0, -10.0], DVec3::Z),
        ([1.5, 0.0, -10.0], DVec3::Z),
    ] {
        assert_eq!(all(&torus, &Ray::new(origin, direction)), []);
    }
    // Along the hole's edge: touches from within the hole's circle between two crossings.
    assert_eq!(all(&torus, &Ray::new([-10.0, 1.5, 0.0], DVec3::X)).len(), 2);
}

#[test]
fn coordinates_on_the_tube() {
    let torus = Torus::new([1.0, 0.0, 0.0], [0.0, 0.0, 1.0], 2.0, 0.5).unwrap();
    let at = |origin: [f64; 3], direction: [f64; 3]| {
        let ray = Ray::new(origin, direction);
        torus.surface(&ray, torus.hit(&ray, Interval::FORWARD).unwrap())
    };
    assert_eq!(at([9.0, 0.0, 0.0], [-1.0, 0.0, 0.0]).uv().to_array(), [0.0, 0.0]);
    assert_eq!(at([3.0, 0.0, 9.0], [0.0, 0.0, -1.0]).uv().to_array(), [0.0, 0.25]);
    assert_eq!(at([1.0, -9.0, 0.0], [0.0, 1.0, 0.0]).uv().to_array(), [0.75, 0.0]);
    assert_eq!(at([1.0, 2.0, -9.0], [0.0, 0.0, 1.0]).uv().to_array(), [0.25, 0.75]);
    assert_eq!(at([1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]).uv().to_array(), [0.5, 0.5]);
    let surface = at([3.0, 0.0, 9.0], [0.0, 0.0, -1.0]);
    assert_eq!(surface.local, DVec3::new(2.0, 0.0, 0.5));
    assert_eq!(surface.object_point, DVec3::new(2.0, 0.0, 0.5));
    assert_eq!(surface.point, DVec3::new(3.0, 0.0, 0.5));
}

#[test]
fn other_solvers() {
    use crate::poly::quartic;
    let torus = Torus::new([1.0, 2.0, 3.0], [1.0, 2.0, -1.0], 2.0, 0.5).unwrap();
    let ray = Ray::new([7.0, 8.0, 9.5], [-1.1, -1.0, -1.2]);
    let ours = torus.hit(&ray, Interval::FORWARD).unwrap();
    for solver in [quartic::quartic, quartic::ferrari, quartic::graphics_gems] {
        let theirs = torus.hit_with(&ray, Interval::FORWARD, solver).unwrap();
        assert_eq!(theirs.root(), ours.root());
        assert!((theirs.t() - ours.t()).abs() < 1e-9);
    }
}

/// What must not become slow unseen: the first ways, in `f64` and by Newton steps, answer nearly all rays at rings of plain
/// shape, and of the rays that leave for good nearly all are known to.
#[test]
fn first_ways_answer() {
    let mut count = [0_u32; 8];
    for i in 0..4000 {
        let x = f64::from(i);
        let way = |k: f64| DVec3::new(libm::sin(k * x), libm::cos(1.7 * k * x), libm::sin(2.3 * k * x + 1.0));
        // Of any size.
        let size = exp2i(i % 7 * 5 - 15);
        let minor = (0.15 + 0.1 * libm::fabs(libm::sin(x))) * size;
        let torus = Torus::new(way(0.1) * size, way(0.7), size, minor).unwrap();
        // At the tube, from a few sizes away.
        let [a, b] = [torus.frame[0].high(), torus.frame[1].high()];
        let target =
            torus.center + (a * libm::cos(x) + b * libm::sin(x)) * size + way(0.3) * (0.1 * torus.minor);
        let ray = Ray::new(target + way(1.3) * (4.0 * size), -way(1.3));
        let scaled = torus.scaled(&ray).unwrap();
        count[0] += 1;
        for all in [false, true] {
            let verdict = kernel::run(Filter { torus: &torus, ray: &scaled, within: Interval::LINE, all });
            count[1 + usize::from(all)] += u32::from(matches!(verdict, Verdict::Certain(_)));
        }
        let Some(hit) = torus.hit(&ray, Interval::FORWARD) else { continue };
        count[3] += 1;
        count[4] += u32::from(kernel::run(Near { torus: &torus, ray: &scaled, hit }).is_some());
        let surface = torus.surface(&ray, hit);
        let from = surface.departure(0, hit, Side::Outside);
        let out = if way(2.9).dot(surface.normal) < 0.0 { -way(2.9) } else { way(2.9) };
        let (onward, within) = from.ray(out);
        let onward = torus.scaled(&onward).unwrap();
        let mut again = 0;
        let each = |_| {
            again += 1;
            true
        };
        kernel::run(Leave { torus: &torus, ray: &onward, within, from: &from, first: false, each });
        if again == 0 {
            count[5] += 1;
            count[6] += u32::from(leaving::never_returns(&torus, &onward, &from));
        }
    }
    let share = |part: u32, whole: u32| f64::from(part) / f64::from(whole);
    let shares = [
        share(count[1], count[0]),
        share(count[2], count[0]),
        share(count[4], count[3]),
        share(count[6], count[5]),
    ];
    assert!(shares.iter().all(|&share| share > 0.97), "{shares:?} {count:?}");
}

#[test]
fn what_cannot_be_a_torus() {
    let zero = [0.0, 0.0, 0.0];
    assert!(matches!(Torus::new(zero, zero, 2.0, 1.0), Err(Error::ZeroLength { .. })));
    assert!(matches!(Torus::new(zero, [0.0, f64::NAN, 0.0], 2.0, 1.0), Err(Error::NotFinite { .. })));
    assert!(matches!(Torus::new([f64::INFINITY; 3], [1.0; 3], 2.0, 1.0), Err(Error::NotFinite { .. })));
    assert!(matches!(Torus::new(zero, [1.0; 3], 0.0, 1.0), Err(Error::NotPositive { .. })));
    assert!(matches!(Torus::new(zero, [1.0; 3], 2.0, -1.0), Err(Error::NotPositive { .. })));
    assert!(matches!(Torus::new(zero, [1.0; 3], 2.0, 1e-170), Err(Error::OutOfRange { .. })));
    assert!(Torus::new(zero, [0.0, 1e-310, 0.0], 2.0, 1.0).is_ok_and(|t| t.axis() == DVec3::Y));
}

#[test]
fn its_own_axes_turn_with_it() {
    let torus = Torus::new([1.0, 0.0, 0.0], [0.0, 0.0, 1.0], 2.0, 0.5).unwrap();
    let by = Similarity::IDENTITY.scaled(2.0).unwrap().rotated(DVec3::Z, 90.0).unwrap();
    let turned = torus.transformed(&by).unwrap();
    assert_eq!((turned.center(), turned.major(), turned.minor()), (DVec3::new(0.0, 2.0, 0.0), 4.0, 1.0));
    let ray = Ray::new([0.0, 99.0, 0.0], [0.0, -1.0, 0.0]);
    let surface = turned.surface(&ray, turned.hit(&ray, Interval::FORWARD).unwrap());
    assert_eq!(surface.object_point, DVec3::new(5.0, 0.0, 0.0));
    assert_eq!(surface.uv().to_array(), [0.0, 0.0]);
}

/// The one side is as far into the pair of neighbouring crossings as the other.
fn onward(torus: &Torus, ray: &Ray, hits: &[Hit], index: usize) -> Result<(), TestCaseError> {
    let surfaces: Vec<Surface> = hits.iter().map(|&h| torus.surface(ray, h)).collect();
    let here = surfaces[index];
    // An even crossing leads inside `f < 0`, which the normal tells unless on an inner sheet: ask the direction.
    let side = Side::of_arrival(ray.direction, here.normal).other();
    let from = here.departure(0, hits[index], side);
    let (ray_on, within) = from.through(ray.direction);
    let mut found = Vec::new();
    torus.crossings_leaving(&ray_on, within, &from, &mut |h| found.push(h));
    prop_assert_eq!(found.len(), hits.len() - index - 1, "onward from {} of {:?}", index, hits);
    let first = torus.hit_leaving(&ray_on, within, &from);
    prop_assert_eq!(first, found.first().copied());
    for (a, b) in found.iter().zip(&surfaces[index + 1..]) {
        // The start was rounded to a unit of the size: the crossing moves by that over the sine of the angle.
        let size = torus.major + torus.minor;
        let sine = ray.direction.dot(b.normal).abs();
        let moved = (8.0 * f64::EPSILON * size + 4.0 * here.error) / sine + 4.0 * f64::EPSILON * b.t.abs();
        prop_assert!((a.t() - (b.t - here.t)).abs() <= moved, "{} {} {}", a.t(), b.t - here.t, moved);
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, ..ProptestConfig::default() })]

    #[test]
    fn hits_lie_on_the_surface((torus, ray) in aimed()) {
        let bounds = torus.bounds().unwrap();
        let size = torus.major + torus.minor;
        let hits = all(&torus, &ray);
        prop_assert!(hits.len().is_multiple_of(2));
        for (i, &hit) in hits.iter().enumerate() {
            let s = torus.surface(&ray, hit);
            prop_assert_eq!(hit.root() as usize, i);
            prop_assert!(off(&torus, s.local) <= 8.0 * f64::EPSILON * size);
            prop_assert!((s.normal.length() - 1.0).abs() <= 2.0 * f64::EPSILON);
            prop_assert!(bounds.contains(s.point));
            prop_assert!((0.0..1.0).contains(&s.uv().x) && (0.0..1.0).contains(&s.uv().y));
            let (p, n) = place(&torus, s.uv().x, s.uv().y);
            prop_assert!((p - s.local).length() <= 32.0 * f64::EPSILON * size);
            // Near the axis the angle about it, and with it the normal, is only as good as the point.
            if torus.minor < torus.major {
                prop_assert!((n - s.normal).length() <= 32.0 * f64::EPSILON);
            }
            // The first after each of them is the next.
            let rest = Interval::LINE.after(hit.t());
            prop_assert_eq!(torus.hit(&ray, rest), hits.get(i + 1).copied());
        }
    }

    #[test]
    fn powers_of_two_change_no_digit((torus, ray) in aimed(), k in -400..400_i32, j in -400..400_i32) {
        let (scale, stretch) = (exp2i(k), exp2i(j));
        let scaled = Torus::new(torus.center * scale, torus.axis, torus.major * scale, torus.minor * scale).unwrap();
        let original = Torus::new(torus.center, torus.axis, torus.major, torus.minor).unwrap();
        let other = Ray::new(ray.origin * scale, ray.direction * stretch);
        let (a, b) = (all(&original, &ray), all(&scaled, &other));
        prop_assert_eq!(a.len(), b.len());
        for (&a, &b) in a.iter().zip(&b) {
            prop_assert_eq!(a.t() * exp2i(k - j), b.t());
            let (p, q) = (original.surface(&ray, a), scaled.surface(&other, b));
            prop_assert_eq!(p.t * exp2i(k - j), q.t);
            prop_assert_eq!(p.point * scale, q.point);
            prop_assert_eq!(p.local * scale, q.local);
            prop_assert_eq!((p.normal, p.uv()), (q.normal, q.uv()));
        }
    }

    #[test]
    fn moving_both_moves_the_hits((torus, ray) in aimed(), by in [-8..8_i32, -8..8_i32, -8..8_i32]) {
        // On a grid on which the sums are exact.
        let grid = exp2i(-20);
        let round = |v: DVec3| (v / grid).round() * grid;
        let by = DVec3::new(f64::from(by[0]), f64::from(by[1]), f64::from(by[2]));
        let (center, origin) = (round(torus.center), round(ray.origin));
        let here = Torus { center, ..torus };
        let there = Torus { center: center + by, ..torus };
        let (a, b) = (Ray::new(origin, ray.direction), Ray::new(origin + by, ray.direction));
        prop_assert_eq!(all(&here, &a), all(&there, &b));
    }

    #[test]
    fn backwards_the_same_crossings((torus, ray) in aimed()) {
        let back = Ray::new(ray.origin, -ray.direction);
        let (a, mut b) = (all(&torus, &ray), all(&torus, &back));
        b.reverse();
        prop_assert_eq!(a.len(), b.len());
        for (&a, &b) in a.iter().zip(&b) {
            let (a, b) = (torus.surface(&ray, a), torus.surface(&back, b));
            prop_assert_eq!(a.t, -b.t);
            prop_assert_eq!((a.point, a.local, a.normal), (b.point, b.local, b.normal));
        }
    }

    #[test]
    fn rays_go_on_from_each_crossing((torus, ray) in aimed()) {
        let hits = all(&torus, &ray);
        // The start is rounded to a unit of the size in the world: what passes another place by less may hit it.
        let far = torus.center.abs().max_element() + torus.major + torus.minor;
        let steady = |by: f64| {
            let other = Torus { minor: torus.minor + by * 16.0 * f64::EPSILON * far, ..torus };
            Torus::new(other.center, other.axis, other.major, other.minor)
                .is_ok_and(|other| all(&other, &ray).len() == hits.len())
        };
        if !(steady(1.0) && steady(-1.0)) {
            return Ok(());
        }
        for index in 0..hits.len() {
            let clear = |h: Hit| {
                let s = torus.surface(&ray, h);
                // Where the angle with the surface is within what the normal is rounded to, either side is right,
                // and so it is on the axis.
                ray.direction.dot(s.normal).abs() > 16.0 * f64::EPSILON * ray.direction.length()
                    * (1.0 + torus.major / torus.minor)
                    && s.object_point.truncate().length() > 1e-6 * torus.major
            };
            if hits.iter().all(|&h| clear(h)) {
                onward(&torus, &ray, &hits, index)?;
                let back = Ray::new(ray.origin, -ray.direction);
                onward(&torus, &back, &all(&torus, &back), index)?;
            }
        }
    }

    #[test]
    fn spawned_rays_do_not_return(torus in torus(), u in 0.0..1.0_f64, v in 0.0..1.0_f64, d in direction(), e in direction()) {
        let (p, n) = place(&torus, u, v);
        let ray = Ray::new(torus.center + p + e * torus.major, -e);
        for hit in all(&torus, &ray) {
            let s = torus.surface(&ray, hit);
            for side in [Side::Outside, Side::Inside] {
                let d = if d.dot(s.normal) * side.sign() < 0.0 { -d } else { d };
                let from = s.departure(0, hit, side);
                let (spawned, within) = from.ray(d);
                let again = torus.hit_leaving(&spawned, within, &from);
                if torus.minor < torus.major {
                    prop_assert!(side == Side::Outside || again.is_some(), "no way out");
                    // Outward from where the tube curves away in every direction nothing can be near.
                    let sine = d.dot(s.normal).abs();
                    if let Some(again) = again {
                        prop_assert!(again.t() > 0.5 * torus.minor * sine * (1.0 - torus.minor / torus.major).min(0.5), "{:?} {:?}", again, n);
                    }
                }
            }
        }
    }

    #[test]
    fn no_bits_make_it_panic(bits in [any::<u64>(); 17], side in any::<bool>()) {
        let x = bits.map(f64::from_bits);
        let vector = |i: usize| DVec3::new(x[i], x[i + 1], x[i + 2]);
        let ray = Ray::new(vector(0), vector(3));
        let within = Interval::new(x[15], x[16]);
        for torus in [
            Torus::new([0.0, 1.0, 2.0], [1.0, 2.0, 3.0], 2.0, 0.5),
            Torus::new(vector(6), vector(9), x[12].abs(), x[13].abs()),
            Torus::new(vector(6), vector(9), 1e150, 1e-150),
        ].into_iter().flatten() {
            for within in [within, Interval::LINE] {
                if let Some(hit) = torus.hit(&ray, within) {
                    torus.surface(&ray, hit);
                }
                torus.crossings(&ray, within, &mut |_| {});
                let hit = Interval::LINE.admit(x[14], 0, 3);
                if let Some(hit) = hit {
                    let side = if side { Side::Inside } else { Side::Outside };
                    let mut from = torus.surface(&ray, hit).departure(0, hit, side);
                    torus.hit_leaving(&ray, within, &from);
                    (from.local, from.normal) = (vector(6), vector(9));
                    torus.hit_leaving(&ray, within, &from);
                }
            }
        }
    }
}

proptest! {
    #[test]
    fn those_that_never_return_do_not(torus in torus(), u in 0.0..1.0_f64, v in 0.0..1.0_f64, d in direction()) {
        let (p, n) = place(&torus, u, v);
        let ray = Ray::new(p + n * torus.minor, -n);
        let mut arrivals = all(&torus, &ray).into_iter();
        if let Some(hit) = arrivals.find(|hit| hit.root() % 2 == 0) {
            let surface = torus.surface(&ray, hit);
            let from = surface.departure(0, hit, Side::Outside);
            let (ray, within) = from.ray(if d.dot(surface.normal) < 0.0 { -d } else { d });
            let scaled = torus.scaled(&ray).unwrap();
            if leaving::never_returns(&torus, &scaled, &from) {
                let mut found = 0;
                let each = |_| { found += 1; true };
                kernel::run(Leave { torus: &torus, ray: &scaled, within, from: &from, first: false, each });
                prop_assert_eq!(found, 0);
            }
        }
    }
}

/// A line that runs through a thin tube lengthwise and leaves it beyond an inflection of `f`: the parabola at the extremum
/// says nothing of that crossing.
#[test]
fn a_crossing_beyond_an_inflection() {
    let torus = Torus::new([0.0; 3], [0.0, 0.0, -1.0], 0.5, 0.017768905136251786).unwrap();
    let ray = Ray::new(
        [0.6422513966388842, 0.18039910955834407, 0.08772137123195826],
        [-0.7612833144901687, 0.45035655594614227, -0.16838791491287675],
    );
    let hits = all(&torus, &ray);
    assert_eq!(hits.len(), 2);
    for hit in hits {
        let surface = torus.surface(&ray, hit);
        assert!((surface.t - hit.t()).abs() <= 1e-14);
        assert!(off(&torus, surface.local) <= 2.0 * f64::EPSILON);
    }
}

/// What must not become slow unseen: how many exact products the steps of a torus take, in the mean, as measured and no more
/// than a fiftieth above.
#[test]
fn products_a_torus() {
    use super::exact;
    use super::line::Line;
    use super::record::Thorough;
    use crate::kernel::counted::counted;
    use crate::kernel::{Product, Task};
    use crate::scaled::ScaledRay;
    struct Exactly<'a>(&'a Torus, &'a ScaledRay);
    impl Task for Exactly<'_> {
        type Output = usize;
        fn run<P: Product>(self) -> usize {
            let line = Line::of::<P>(self.0, self.1);
            exact::crossings::<P>(self.0, &line).as_slice().len()
        }
    }
    use crate::kernel::counted::steps;
    let mut random = crate::testing::Random::new(1);
    let mut sum = [[0.0; 2]; 20];
    let mut add = |place: usize, products: u64| {
        sum[place][0] += products as f64;
        sum[place][1] += 1.0;
    };
    for case in 0..4000 {
        let grazing = case % 2;
        let minor = if case % 8 < 6 { random.uniform(0.05, 0.5) } else { random.uniform(0.9, 1.5) };
        let torus = Torus::new(random.in_cube(), random.direction(), 1.0, minor).unwrap();
        let (point, normal) = place(&torus, random.uniform(0.0, 1.0), random.uniform(0.0, 1.0));
        let mut direction = random.direction();
        let mut target = torus.center + point;
        if grazing == 1 {
            direction = (direction - normal * direction.dot(normal)).normalize();
            target -= normal * random.magnitude(-9.0, -2.0);
        }
        let ray = Ray::new(target - direction * random.uniform(0.5, 4.0), direction);
        let scaled = torus.scaled(&ray).unwrap();
        for all in [false, true] {
            let filter = Filter { torus: &torus, ray: &scaled, within: Interval::FORWARD, all };
            let before = steps();
            add(5 * grazing + usize::from(all), counted(filter).1);
            add(10 + 5 * grazing + usize::from(all), steps() - before);
        }
        add(5 * grazing + 2, counted(Exactly(&torus, &scaled)).1);
        let Some(hit) = torus.hit(&ray, Interval::FORWARD) else { continue };
        add(5 * grazing + 3, counted(Near { torus: &torus, ray: &scaled, hit }).1);
        add(5 * grazing + 4, counted(Thorough(Near { torus: &torus, ray: &scaled, hit })).1);
        let surface = torus.surface(&ray, hit);
        let inward = surface.normal.dot(ray.direction) < 0.0;
        let from = surface.departure(0, hit, if inward { Side::Inside } else { Side::Outside });
        let (onward, within) = from.ray(ray.direction);
        let onward = torus.scaled(&onward).unwrap();
        let before = steps();
        let leave = Leave { torus: &torus, ray: &onward, within, from: &from, first: false, each: |_| true };
        add(10 + 5 * grazing + 2, counted(leave).1);
        add(10 + 5 * grazing + 3, steps() - before);
    }
    // One hit and all, by the filter; the exact crossings; the record, near and thorough. Then the same of grazing rays. Then
    // the steps in `f64` of one hit and of all, the products and the steps of leaving; and the same of grazing rays.
    let measured = [
        5.14, 5.14, 159.7, 52.8, 174.6, 35.1, 35.1, 140.9, 51.1, 155.8, 4.56, 9.7, 106.5, 8.13, 0.0, 3.53,
        7.75, 105.2, 10.4, 0.0,
    ];
    let found = sum.map(|[products, count]| products / f64::max(count, 1.0));
    assert!(found.iter().zip(measured).all(|(found, measured)| *found <= 1.004 * measured), "{found:?}");
}

/// Texture coordinates lead back to the place, on rings and on both sheets of spindles.
#[test]
fn coordinates_on_all_sheets() {
    let mut random = crate::testing::Random::new(2);
    let mut inner = 0;
    for case in 0..2000 {
        let minor = if case % 2 == 0 { random.uniform(1.1, 3.0) } else { random.uniform(0.05, 0.9) };
        let torus = Torus::new(random.in_cube(), random.direction(), 1.0, minor).unwrap();
        let along = random.direction();
        let ray = Ray::new(torus.center + random.in_cube() * 0.7 - along * 5.0, along);
        for hit in all(&torus, &ray) {
            let surface = torus.surface(&ray, hit);
            let uv = surface.uv();
            let (point, normal) = place(&torus, uv.x, uv.y);
            let rho = (surface.local - torus.axis * surface.local.dot(torus.axis)).length();
            assert!((point - surface.local).length() < 1e-14 + 1e-15 / rho, "{torus:?} {ray:?} {surface:?}");
            assert!(
                (normal - surface.normal).length() < 1e-14 + 1e-14 / rho,
                "{torus:?} {ray:?} {surface:?}"
            );
            // On the inner sheet the tube's outside is beyond the axis.
            inner += u32::from(1.0 + minor * libm::cos(core::f64::consts::TAU * uv.y) < 0.0);
            let own = torus.frame.map(|axis| axis.high().dot(surface.local));
            assert!((surface.object_point - DVec3::from_array(own)).length() < 1e-14);
        }
    }
    assert!(inner > 500, "{inner}");
}

/// Next to the pole of a spindle, where two sheets meet: what comes from outside meets the outer one first and sees the way it
/// came, what goes on meets the inner one, however small the angle between them.
#[test]
fn at_the_pole_of_a_spindle() {
    let mut random = crate::testing::Random::new(4);
    let mut count = 0;
    for case in 0..40_000 {
        let major = random.magnitude(-8.9, -1.5);
        let axis = if case % 2 == 0 { DVec3::X } else { random.direction() };
        let torus = Torus::new(random.in_cube() * 3.0, axis, major, 1.0).unwrap();
        let pole = torus.center() + axis * libm::sqrt(1.0 - major * major);
        let beside = random.in_cube() * random.magnitude(-17.0, -5.0).min(0.1 * major);
        let way = (axis * random.uniform(0.5, 1.0) + random.direction() * 0.3).normalize();
        let origin = pole + way * random.magnitude(-1.0, 7.0);
        let ray = Ray::new(origin, (pole + beside - origin) * random.magnitude(-7.0, 7.0));
        let hits = all(&torus, &ray);
        // A line that touches both sheets where they meet counts as passing: four crossings or two.
        if hits.len() < 4 {
            continue;
        }
        count += 1;
        let surfaces = [0, 1].map(|k| torus.surface(&ray, hits[k]));
        for (k, surface) in surfaces.iter().enumerate() {
            assert!(surface.normal.dot(ray.direction) < 0.0, "{torus:?} {ray:?} {hits:?}");
            // Away from the axis the normal of the outer sheet leans inward, that of the inner one outward.
            let across = surface.local - axis * axis.dot(surface.local);
            if across.length() > 1e-15 {
                let lean = (surface.normal - axis).dot(across);
                assert!(
                    (lean < 0.0) == (k == 0) || lean.abs() < 1e-15 * across.length(),
                    "{torus:?} {ray:?} {surfaces:?}"
                );
            }
        }
        let from = surfaces[0].departure(0, hits[0], Side::Outside);
        let (back, within) = from.ray(origin - surfaces[0].point);
        assert_eq!(torus.hit_leaving(&back, within, &from), None, "{torus:?} {ray:?} {surfaces:?}");
    }
    assert!(count > 10_000, "{count}");
}

/// However thin the tube, and from however far away it is met, a normal has unit length.
#[test]
fn normals_of_thin_tubes() {
    let mut random = crate::testing::Random::new(5);
    let mut count = 0;
    for case in 0..20_000 {
        let minor = random.magnitude(-24.0, -3.0);
        let axis = if case % 2 == 0 { DVec3::X } else { random.direction() };
        let torus = Torus::new(DVec3::ZERO, axis, 1.0, minor).unwrap();
        let (mut out, _) = place(&torus, random.uniform(0.0, 1.0), random.uniform(0.0, 1.0));
        let mut way = random.direction();
        if case % 2 == 0 {
            // In the plane of the ring, where every ray that passes the ring meets the thinnest tube.
            (out.x, way.x) = (0.0, 0.0);
        }
        let origin = out - way * random.magnitude(-1.0, 8.0);
        let ray = Ray::new(origin, out - origin);
        for hit in all(&torus, &ray) {
            let surface = torus.surface(&ray, hit);
            let square = surface.normal.length_squared();
            count += 1;
            assert!((square - 1.0).abs() < 1e-15, "{torus:?} {ray:?} {square}");
        }
    }
    assert!(count > 1000, "{count}");
}
