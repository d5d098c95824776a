//! The quick ways of cylinders and cones against the line in double-double, ray by ray.

use super::*;
use crate::testing::Random;
use alloc::format;
use alloc::string::String;

/// A frustum and whether its radii differ.
fn frustum(random: &mut Random, case: usize) -> (Frustum, bool) {
    let axis = random.direction() * random.magnitude(-1.0, 1.0);
    let r = random.uniform(0.3, 1.0);
    let top = match case % 4 {
        // Cylinders; cones of moderate slope, with an apex, and flat or steep as the axis is long or short.
        0 | 1 => r,
        2 => r * random.uniform(0.0, 2.0),
        _ => 0.0,
    };
    let base = random.in_cube();
    let radii = if case % 8 < 4 { [r, top] } else { [top, r] };
    (Frustum::new(base, radii, base + axis, ["a", "b"], true).unwrap(), top != r)
}

/// A place on the side, endless, and the outward normal there; the generator through it.
fn place(f: &Frustum, v: f64, turn: f64) -> (DVec3, DVec3, DVec3) {
    let (sin, cos) = (libm::sin(turn), libm::cos(turn));
    let out = f.first * cos + f.second * sin;
    let height = f.numbers.height;
    let radius = f.base_radius + f.slope.high * v * height;
    let axis = f.axis.high();
    let normal = out * f.radial.high + axis * f.axial.high;
    (f.base + axis * (v * height) + out * radius, normal, (out * f.slope.high + axis).normalize())
}

/// A ray that is hard in one of several ways, and how nearly it grazes, in sizes of the frustum; infinite if not at all.
fn hard(random: &mut Random, f: &Frustum, case: usize, depths: [f64; 2]) -> (Ray, f64) {
    let size = f.numbers.height + f.numbers.reach;
    let turn = random.uniform(0.0, core::f64::consts::TAU);
    let (p, n, g) = place(f, random.uniform(-0.1, 1.1), turn);
    let depth = size * random.magnitude(depths[0], depths[1]) * random.sign();
    let tangent = |random: &mut Random, share: f64| {
        (n.cross(g) * random.sign() + g * share * random.uniform(-1.0, 1.0)).normalize()
    };
    let (target, along, graze) = match case % 6 {
        // Past the side, in any direction and more nearly along it.
        0 => (p + n * depth, tangent(random, 1.0), depth),
        1 => (p + n * depth, tangent(random, 30.0), depth),
        // At a rim.
        2 => {
            let (p, ..) = place(f, [0.0, 1.0][case / 6 % 2], turn);
            (p + random.direction() * depth, random.direction(), depth)
        }
        // Nearly along the axis, the side or a cap.
        3 => (p + n * depth, f.axis.high() + random.in_cube() * random.magnitude(-6.0, 0.0), depth),
        4 => {
            let cap = f.base + f.axis.high() * (f.numbers.height * [0.0, 1.0][case / 6 % 2] + depth);
            let along = f.first * libm::cos(turn) + f.second * libm::sin(turn);
            (
                cap + f.second * (0.5 * f.base_radius),
                along + f.axis.high() * random.magnitude(-9.0, 0.0),
                depth,
            )
        }
        _ => (p + random.in_cube() * size, random.direction(), f64::INFINITY),
    };
    let back = along * (size * random.magnitude(-1.0, 2.0) / along.length());
    (Ray::new(target - back, along * random.magnitude(-2.0, 2.0)), graze)
}

fn quickly(f: &Frustum, sloped: bool, ray: &Ray) -> Option<Span> {
    if sloped { f.rough::<true>(ray) } else { f.rough::<false>(ray) }
}

/// For a line nearly parallel to the side, one of whose crossings is far away: its distance from the base and the size
/// together, as a parameter.
fn along_side(f: &Frustum, ray: &Ray) -> Option<f64> {
    let (w, d) = (ray.origin - f.base, ray.direction);
    let (across, along) = (f.numbers.axis.cross(d).length_squared(), f.numbers.axis.dot(d) * f.slope.high);
    let parallel = (across - along * along).abs() <= 0.26 * (across + along * along);
    parallel.then(|| (w.abs().element_sum() + f.numbers.size) / d.abs().element_sum())
}

/// Whether the quick answer, if there is one, is that of the line in double-double: none or both crossings, on the same
/// parts, within the margins, which are small.
fn agrees(f: &Frustum, quick: &Option<Span>, ray: &Ray) -> Result<bool, String> {
    let Some(quick) = quick else { return Ok(false) };
    let (scaled, line) = f.line(ray).unwrap();
    let exact = line.span(true);
    match (quick, exact) {
        (Span::Miss, [None, None]) => Ok(true),
        (Span::Crossings(found), [Some(first), Some(last)]) => {
            for (found, exact) in found.iter().zip([first, last]) {
                let t = scaled.unscale(line.shift + exact.at);
                if (found.part, found.root) != (exact.part, exact.root) {
                    return Err(format!("part {} for {}", found.part, exact.part));
                }
                if (t - found.t).high.abs() > found.margin {
                    return Err(format!("{} for {t:?}, margin {:e}", found.t, found.margin));
                }
                let half = 0.5 * (line.side[1] - line.side[0]).high.abs() + line.shift.high.abs() * 1e-3;
                let mut most = half.min(1e30) * exp2i(-7) * exp2i(scaled.power);
                if let Some(reach) = along_side(f, ray) {
                    most = most.max(exp2i(-6) * (reach + t.high.abs()));
                }
                if !(found.margin <= most + 1e-6 * t.high.abs()) && found.part == SIDE {
                    return Err(format!("margin {:e}, most {most:e}", found.margin));
                }
            }
            Ok(true)
        }
        (Span::Miss, _) => Err("a miss that is none".into()),
        _ => Err("crossings that are none".into()),
    }
}

/// Whatever plain numbers decide is right, next to where they cannot decide.
#[test]
fn what_is_decided_quickly_is_true() {
    let mut random = Random::new(1);
    let mut count = [[0; 2]; 6];
    for case in 0..60_000 {
        let (f, sloped) = frustum(&mut random, case / 6);
        let (ray, _) = hard(&mut random, &f, case, [-17.5, -9.0]);
        let quick = quickly(&f, sloped, &ray);
        match agrees(&f, &quick, &ray) {
            Ok(decided) => count[case % 6][usize::from(decided)] += 1,
            Err(what) => panic!("{what}: {f:?} {ray:?}"),
        }
    }
    assert!(count.iter().all(|[_, decided]| *decided > 250), "{count:?}");
}

/// What must not become slow unseen: plain numbers decide wherever the ray passes side, rims and caps by more than this.
#[test]
fn what_is_clear_is_decided_quickly() {
    let mut random = Random::new(2);
    let mut left = [[0; 2]; 12];
    for case in 0..24_000 {
        let (f, sloped) = frustum(&mut random, case / 6);
        let (ray, _) = hard(&mut random, &f, case, [-3.0, -0.5]);
        let quick = quickly(&f, sloped, &ray);
        let kind = case % 6 + if sloped { 6 } else { 0 };
        if let Err(what) = agrees(&f, &quick, &ray) {
            panic!("{what}: {f:?} {ray:?}");
        }
        left[kind][1] += 1;
        left[kind][0] += u32::from(quick.is_none());
        // In another unit of length, beyond the squares of which plain numbers end, the same is decided.
        let unit = exp2i([-300, 300][case / 12 % 2]);
        let names = ["a", "b"];
        let radii = [f.base_radius * unit, f.top_radius * unit];
        let far = Frustum::new(f.base * unit, radii, f.top * unit, names, true).unwrap();
        let far_ray = Ray::new(ray.origin * unit, ray.direction);
        assert!(quickly(&far, sloped, &far_ray).is_none());
        let again = if sloped { far.rescaled::<true>(&far_ray) } else { far.rescaled::<false>(&far_ray) };
        match (quick, again) {
            (None, None) | (Some(Span::Miss), Some(Span::Miss)) => {}
            (Some(Span::Crossings(a)), Some(Span::Crossings(b))) => {
                for (a, b) in a.iter().zip(b) {
                    assert!((a.part, a.root) == (b.part, b.root));
                    assert!((a.t - b.t / unit).abs() <= a.margin && b.margin / unit <= 1.5 * a.margin);
                }
            }
            // The base of the one is not exactly that of the other in all that is derived from it.
            (None, Some(_)) | (Some(_), None) => left[kind][0] += 1,
            _ => panic!("{f:?} {ray:?}"),
        }
        assert!(f.rescaled::<true>(&ray).is_none());
    }
    // Past the side, more nearly along it, at a rim, nearly along the axis or a cap, anyhow: of cylinders, then of cones.
    // At a rim some of those nearly parallel to the side of a cone, whose crossings have wide margins, are left.
    let most = [0, 0, 3, 270, 0, 0, 0, 95, 15, 1110, 0, 0];
    assert!(left.iter().zip(most).all(|([left, _], most)| *left <= most), "{left:?}");
}

/// However thin, a closed one is left where it is entered: aimed at the axis, from anywhere.
#[test]
fn needles_are_crossed_twice() {
    let mut random = Random::new(4);
    for case in 0..4000 {
        let axis = random.direction();
        let height = random.magnitude(-3.0, 3.0);
        let thin = height * random.magnitude(-13.0, -3.0);
        let radii = [[thin; 2], [thin, 0.0], [0.0, thin]][case % 3];
        let base = random.in_cube() * height;
        let f = Frustum::new(base, radii, base + axis * height, ["a", "b"], true).unwrap();
        let target = base + axis * (height * random.uniform(0.3, 0.7));
        let along = axis.cross(random.direction()).normalize() + axis * random.uniform(-1.0, 1.0);
        let ray = Ray::new(target - along * (height * random.uniform(0.5, 4.0)), along);
        let (_, line) = f.line(&ray).unwrap();
        let crosses = line.span(true).iter().all(Option::is_some);
        let found = f.exact(&ray, Interval::LINE).map(|hit| hit.is_some());
        assert_eq!(found, [crosses; 2], "{f:?} {ray:?}");
        let quickly = if radii[0] == radii[1] { f.rough::<false>(&ray) } else { f.rough::<true>(&ray) };
        let found = f.both(quickly, &ray, Interval::LINE).map(|hit| hit.is_some());
        assert_eq!(found, [crosses; 2], "{f:?} {ray:?}");
    }
}

/// A line next to the apex enters and leaves through the side, whatever rounding makes of the order of the side and the
/// plane across the apex: an entrance is never lost, so the first hit faces the ray, and nothing lies on the way back.
#[test]
fn next_to_the_apex() {
    let mut random = Random::new(8);
    let mut count = 0;
    for case in 0..40_000 {
        let slope = random.magnitude(-8.0, 0.5);
        let height = random.uniform(0.5, 2.0);
        let axis = [DVec3::X, DVec3::NEG_Z, random.direction()][case % 3];
        let radii = if case % 2 == 0 { [slope * height, 0.0] } else { [0.0, slope * height] };
        let (base, top) =
            if case % 2 == 0 { (axis * height, DVec3::ZERO) } else { (DVec3::ZERO, axis * height) };
        let frustum = Frustum::new(base, radii, top, ["a", "b"], case % 5 == 0).unwrap();
        let origin = random.in_cube() * random.magnitude(0.0, 9.0);
        let beside = random.in_cube() * random.magnitude(-18.0, -13.0);
        let ray = Ray::new(origin, beside - origin);
        let mut hits = alloc::vec::Vec::new();
        frustum.crossings::<true>(&ray, Interval::LINE, &mut |hit| hits.push(hit));
        let Some(&first) = hits.first() else { continue };
        count += 1;
        let apex = if radii[1] == 0.0 { TOP } else { BASE };
        assert!(hits.iter().all(|hit| hit.part() != apex), "{frustum:?} {ray:?} {hits:?}");
        if first.part() == SIDE && hits.len() == 2 {
            assert_eq!(first.root(), 0, "{frustum:?} {ray:?}");
        }
        if hits.len() == 1 {
            // The other end of what line and cone share is the open base.
            assert!(
                !frustum.closed && (first.root() == 1) == (ray.direction.dot(axis) < 0.0),
                "{frustum:?} {ray:?} {hits:?}"
            );
        }
    }
    assert!(count > 3000, "{count}");
}

/// A line in the very plane of a cap is moved next to the axis before its crossings are taken, from however far it comes.
#[test]
fn in_the_plane_of_a_cap() {
    let mut random = Random::new(11);
    let mut exactly = 0;
    for case in 0..2000 {
        let radius = random.uniform(0.1, 1.0);
        let base = DVec3::new(0.0, random.uniform(0.5, 2.0), random.uniform(-1.0, 1.0) * 0.01);
        let [base, top] = if case % 2 == 0 { [base, DVec3::ZERO] } else { [DVec3::ZERO, base] };
        let radii = [radius, if case % 4 < 2 { radius } else { 0.5 * radius }];
        let f = Frustum::new(base, radii, top, ["a", "b"], case % 8 < 4).unwrap();
        let radius = if case % 2 == 0 { radii[1] } else { radii[0] };
        let ray = Ray::new([random.magnitude(8.0, 50.0) * random.sign(), 0.0, 0.0], [0.25, 0.0, 0.0]);
        let axis = f.axis.high();
        exactly += u32::from(axis.dot(ray.origin - base) == f.numbers.height);
        for (root, side) in [(0, -1.0), (1, 1.0)] {
            let t = 4.0 * (side * radius - ray.origin.x);
            let surface = f.surface(&ray, Hit::inside(t, SIDE, root));
            assert_eq!(surface.t, t, "{base} {top} {radii:?} {ray:?}");
            let off = (surface.point.x - side * radius).abs();
            assert!(off <= exp2i(-53) * radius, "{base} {top} {radii:?} {ray:?}: {off:e}");
        }
    }
    assert!(exactly > 200, "{exactly}");
}
