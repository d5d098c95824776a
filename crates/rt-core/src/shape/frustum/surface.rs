//! The full record of a hit, refined in double-double.

use super::line::{FindLine, quotient};
use super::{BASE, Frustum, TOP};
use crate::double::Double;
use crate::double_vector::DoubleVector;
use crate::kernel::{self, Dekker, Four, Lanes, Product, Real, Task, Vector};
use crate::math::{exp2i, sqrt};
use crate::scaled::{ScaledFour, ScaledRay, largest, radius_about, times_power, uncertainty};
use crate::surface::Coordinates;
use crate::{Hit, Ray, Surface};
use glam::{DVec2, DVec3};

impl Frustum {
    /// See [`Primitive::surface`](crate::Primitive::surface).
    pub fn surface(&self, ray: &Ray, hit: Hit) -> Surface {
        let Some(scaled) = ScaledRay::new(ray, self.base, self.unit) else {
            return Surface::new(hit.t(), self.base, DVec3::ZERO, self.axis.high(), 0.0);
        };
        kernel::run(Record(FindSurface { frustum: self, ray: &scaled, hit }))
    }

    /// The records of four hits: [`surface`](Frustum::surface) for each.
    #[inline(always)]
    pub fn surface_four<L: Lanes>(
        &self,
        lanes: L,
        rays: [&Ray; 4],
        hits: [Hit; 4],
        surfaces: [&mut Surface; 4],
    ) {
        if hits.iter().any(|hit| hit.part() == BASE || hit.part() == TOP) {
            for (i, surface) in surfaces.into_iter().enumerate() {
                *surface = self.surface(rays[i], hits[i]);
            }
            return;
        }
        let ScaledFour { relative, direction, power, sound } =
            ScaledFour::new(lanes, rays, self.base, self.unit);
        let [a, b, c, d] = hits;
        let t = Four::new(lanes, [a.t(), b.t(), c.t(), d.t()]) / power;
        let side = |hit: Hit| if hit.root() & 1 == 0 { -1.0 } else { 1.0 };
        let side = Four::new(lanes, [side(a), side(b), side(c), side(d)]);
        // The lanes bring their own products.
        let line = SideLine::new(self, &relative, direction, side);
        let step = line.step::<Dekker>(self, Double { high: t, low: t.all(0.0) });
        let sound = sound & line.sound(self, t) & step.sound & step.small;
        let Finished { point, local, error, across, object_point } = Finished::new(self, &step.found);
        let v = (step.found.z / t.all(self.height.high)).to_array();
        let (t, error) = ((step.found.t.high * power).to_array(), error.to_array());
        let (point, local, object_point) = (point.to_array(), local.to_array(), object_point.to_array());
        let normal = step.found.normal.to_array();
        let (x, y) = (across[0].to_array(), across[1].to_array());
        for (i, surface) in surfaces.into_iter().enumerate() {
            if sound >> i & 1 == 0 {
                *surface = self.surface(rays[i], hits[i]);
                continue;
            }
            let coordinates = Coordinates::Side(DVec2::new(x[i], y[i]), v[i].clamp(0.0, 1.0));
            surface.set(t[i], point[i], local[i], object_point[i], normal[i], coordinates, error[i]);
        }
    }
}

/// The whole record in one piece: what travels between two goes through memory.
struct Record<'a>(FindSurface<'a>);

impl Task for Record<'_> {
    type Output = Surface;
    #[inline(always)]
    fn run<P: Product>(self) -> Surface {
        let FindSurface { frustum: f, ray, hit } = self.0;
        let found = match self.0.newton::<P>() {
            Some(found) => found,
            None => carefully(self.0),
        };
        let Finished { point, local, error, across: [x, y], object_point } = Finished::new(f, &found);
        let v = match hit.part() {
            BASE => 0.0,
            TOP => 1.0,
            _ => (found.z / f.height.high).clamp(0.0, 1.0),
        };
        Surface::new(ray.unscale(found.t).high, point.into(), local.into(), found.normal.into(), error)
            .with_coordinates(Coordinates::Side(DVec2::new(x, y), v))
            .with_object_point(object_point.into())
    }
}

/// What a record says of a place, in the units of the world.
struct Finished<R> {
    point: Vector<R>,
    local: Vector<R>,
    error: R,
    /// The place across the axis, in units of the frustum's size.
    across: [R; 2],
    object_point: Vector<R>,
}

impl<R: Real> Finished<R> {
    #[inline(always)]
    fn new(f: &Frustum, found: &Refined<R>) -> Self {
        let scale = found.z.all(exp2i(f.unit));
        let local = found.local.scale_exact(scale);
        let point = local.plus(Vector::all(scale, f.base));
        let at = found.local.leading();
        let (x, y) = (at.dot(Vector::all(scale, f.first)), at.dot(Vector::all(scale, f.second)));
        Finished {
            point,
            local: local.leading(),
            error: radius_about(point, scale * found.error),
            across: [x, y],
            object_point: Vector { x, y, z: found.z } * scale,
        }
    }
}

#[cold]
#[inline(never)]
fn carefully(find: FindSurface<'_>) -> Refined {
    kernel::run(find)
}

#[derive(Clone, Copy)]
struct FindSurface<'a> {
    frustum: &'a Frustum,
    ray: &'a ScaledRay,
    hit: Hit,
}

struct Refined<R = f64> {
    t: Double<R>,
    local: DoubleVector<R>,
    normal: Vector<R>,
    z: R,
    /// How far the true crossing can be from `local`.
    error: R,
}

impl Task for FindSurface<'_> {
    type Output = Refined;
    #[inline(always)]
    fn run<P: Product>(self) -> Refined {
        let FindSurface { frustum: f, ray, hit } = self;
        let line = FindLine { frustum: f, ray }.run::<P>();
        let at = match hit.part() {
            BASE => quotient::<P>(-line.z, line.z_growth),
            TOP => quotient::<P>(line.height - line.z, line.z_growth),
            _ => line.side[(hit.root() & 1) as usize],
        };
        // A hit of another ray, or one that rounding invented: the closest approach is the nearest to it.
        let at = if at.high.is_finite() { at } else { Double::ZERO };
        let mut local = line.start + DoubleVector::from(ray.direction).mul::<P>(at);
        let t = line.shift + at;
        if hit.part() == BASE || hit.part() == TOP {
            let axis = f.axis.high();
            let (normal, z) = if hit.part() == BASE { (-axis, 0.0) } else { (axis, f.height.high) };
            let error = uncertainty(line.z_growth.high.abs());
            return Refined { t, local, normal: normal.into(), z, error };
        }
        let z = f.axis.dot::<P>(local);
        let along = f.axis.mul::<P>(z);
        let away = local - along;
        // Near the axis what the difference left along it, 2^-104 of the size, would lengthen the normal: once more.
        let away = away - f.axis.mul::<P>(f.axis.dot::<P>(away));
        let distance = away.length_squared::<P>().sqrt::<P>();
        // `away` is known to 2^-104 of the size: nearer than this it says nothing of a direction that the place, rounded
        // to 2^-53, could not say otherwise.
        let apart = distance.high > exp2i(-90);
        let half = if line.depth.high > 0.0 { sqrt(line.depth.high) } else { 0.0 };
        let error = uncertainty(half);
        let outward = if apart {
            away.mul::<P>(Double::ONE.div::<P>(distance))
        } else {
            // On the axis, at the apex: there is no direction away from it.
            DoubleVector::default()
        };
        if line.depth.high <= 0.0 && line.a.high >= 0.0 {
            // The rounded ray misses: take the place on the surface beside it.
            let radius = f.slope.mul::<P>(z) + f.base_radius * exp2i(-f.unit);
            local = along + outward.mul::<P>(radius);
        }
        let slanted = |outward: DoubleVector| (outward.mul::<P>(f.radial) + f.axis.mul::<P>(f.axial)).high();
        let axis = f.axis.high();
        let mut normal = match apart {
            true => slanted(outward),
            false if f.axial.high < 0.0 => -axis,
            false => axis,
        };
        // At the tip, nearer to the axis than the place is known, one direction away from it is as good as another: where
        // the normal contradicts the hit, the one that the ray comes from or goes to.
        let across = ray.direction - axis * axis.dot(ray.direction);
        let sense = if hit.root() & 1 == 0 { -1.0 } else { 1.0 };
        if distance.high <= error && sense * normal.dot(ray.direction) < 0.0 && across != DVec3::ZERO {
            normal = slanted(DoubleVector::from(across.normalize() * sense));
        }
        Refined { t, local, normal: normal.into(), z: z.high, error }
    }
}

impl FindSurface<'_> {
    /// One or two Newton steps from the hit's parameter; `None` where they may not be enough.
    ///
    /// In units of the frustum's size, the place `p` is known to 2^-104 of the distance S >= 1 that the ray comes from, and
    /// lies within 3 of the base: its height to 2^-98 (`inner`), the radius to that times the slope k < 2^3, the residual
    /// of the side, with its factor of twice the radius < 2, to 2^-93 and, for the rest of it, 2^-96 S. That moves the
    /// crossing by 2^-93.8 S over half the derivative, q: by less than 2^-71 for `q > 2^-22 S`. A
    /// step s leaves `s^2 A / (2 q)`, and what the rounding of q, below 2^-47, does to it, `2^-47 s / q`: for
    /// `s A < 2^-36 q` and `s < 2^-36 q` less than 2^-73 q and 2^-83. A cap is the same without curvature.
    #[inline(always)]
    fn newton<P: Product>(&self) -> Option<Refined> {
        let FindSurface { frustum: f, ray, hit } = self;
        let d = ray.direction;
        let far = largest(ray.relative.high()) + 1.0;
        let axis = f.axis.high();
        let z_growth = axis.dot(d);
        let error = exp2i(-70);
        let mut t = Double::from(times_power(hit.t(), -ray.power));
        if hit.part() == BASE || hit.part() == TOP {
            let (normal, height) = if hit.part() == BASE { (-axis, Double::ZERO) } else { (axis, f.height) };
            if !(z_growth.abs() > exp2i(-20) * far) {
                return None;
            }
            let p = ray.relative.advanced::<P>(d, t);
            let change = (height - f.axis.inner::<P>(&p)).high / z_growth;
            if !(change.abs() < exp2i(-42) * z_growth.abs()) {
                return None;
            }
            t = Double::sum(t.high, change);
            let (local, normal) = (p.nudged(d, change), normal.into());
            return Some(Refined { t, local, normal, z: height.high, error });
        }
        let side = if hit.root() & 1 == 0 { -1.0 } else { 1.0 };
        let line = SideLine::new(f, &ray.relative, d.into(), side);
        if line.sound(f, t.high) == 0 {
            return None;
        }
        for _ in 0..2 {
            let step = line.step::<P>(f, t);
            if step.sound == 0 {
                return None;
            }
            if step.small != 0 {
                return Some(step.found);
            }
            t = step.found.t;
        }
        None
    }
}

/// A line, and which of its crossings with the side is looked for.
struct SideLine<'a, R> {
    relative: &'a DoubleVector<R>,
    d: Vector<R>,
    far: R,
    /// Minus one where it enters, plus one where it leaves.
    side: R,
    z_growth: R,
    across: Vector<R>,
    e1: R,
    curvature: R,
}

/// A step of Newton's method: see [`FindSurface::newton`].
struct Step<R> {
    found: Refined<R>,
    /// In which lanes the derivative is large enough.
    sound: u32,
    /// In which lanes no more steps are needed.
    small: u32,
}

impl<'a, R: Real> SideLine<'a, R> {
    #[inline(always)]
    fn new(f: &Frustum, relative: &'a DoubleVector<R>, d: Vector<R>, side: R) -> Self {
        let axis = Vector::all(side, f.axis.high());
        let z_growth = axis.dot(d);
        let across = d - axis * z_growth;
        let e1 = side.all(f.slope.high) * z_growth;
        let curvature = (across.dot(across) - e1 * e1).abs();
        let far = relative.leading().largest() + side.all(1.0);
        SideLine { relative, d, far, side, z_growth, across, e1, curvature }
    }

    /// In which lanes steps from this parameter may do: one far below the size asks for more digits of the place than the
    /// size does.
    #[inline(always)]
    fn sound(&self, f: &Frustum, t: R) -> u32 {
        t.all(f.slope.high.abs()).less(t.all(8.0)) & t.all(exp2i(-8)).less(t.abs())
    }

    #[inline(always)]
    fn step<P: Product>(&self, f: &Frustum, t: Double<R>) -> Step<R> {
        let SideLine { relative, d, far, side, z_growth, across, e1, curvature } = *self;
        let axis = DoubleVector::all(side, &f.axis);
        let p = relative.advanced::<P>(d, t);
        let z = axis.inner::<P>(&p);
        let away = p.less::<P>(&axis, z);
        let radius = Double::all(side, f.slope).mul::<P>(z) + side.all(f.base_radius * exp2i(-f.unit));
        let q = side * (away.leading().dot(across) - radius.high * e1);
        let sound = (side.all(exp2i(-22)) * far).less(q) & side.all(exp2i(-16)).less(radius.high);
        // Divisions before the long sum that they need not wait for.
        let per_excess = side.all(-0.5) * side / q;
        let inverse = side.all(1.0) / radius.high;
        let change = away.excess_over::<P>(radius) * per_excess;
        let t = Double::sum(t.high, t.low + change);
        let (size, most) = (change.abs(), side.all(exp2i(-36)) * q);
        let small = (size * curvature).less(most) & size.less(most);
        let away = away.nudged(across, change);
        // What the step does to the radius is below 2^-17 of it: its square vanishes.
        let mut part = Double::all(side, f.radial).div_with::<P>(radius, inverse);
        part.low = part.low - part.high * (e1 * change * inverse);
        let normal = away.blend::<P>(part, &axis, Double::all(side, f.axial));
        let z = (z + z_growth * change).high;
        let found = Refined { t, local: p.nudged(d, change), normal, z, error: side.all(exp2i(-70)) };
        Step { found, sound, small }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Interval;

    struct First<'a>(FindSurface<'a>);

    impl Task for First<'_> {
        type Output = Option<DoubleVector>;
        fn run<P: Product>(self) -> Self::Output {
            self.0.newton::<P>().map(|found| found.local)
        }
    }

    struct Careful<'a>(FindSurface<'a>);

    impl Task for Careful<'_> {
        type Output = DVec3;
        fn run<P: Product>(self) -> DVec3 {
            let FindSurface { frustum, ray, hit } = self.0;
            let line = FindLine { frustum, ray }.run::<P>();
            let at = line.side[(hit.root() & 1) as usize];
            (line.start + DoubleVector::from(ray.direction).mul::<P>(at)).high()
        }
    }

    /// What must not become slow unseen: Newton steps answer nearly all hits of plain frusta, and as the closed form does.
    #[test]
    fn first_way_answers() {
        let mut count = [0_u32; 4];
        for i in 0..4000 {
            let x = f64::from(i);
            let way =
                |k: f64| DVec3::new(libm::sin(k * x), libm::cos(1.7 * k * x), libm::sin(2.3 * k * x + 1.0));
            let names = ["a", "b"];
            let top = [0.5, 0.5 + 0.4 * libm::sin(x)][i as usize % 2];
            let frustum = Frustum::new(DVec3::ZERO, [0.5, top], way(0.7), names, true).unwrap();
            let ray = Ray::new(way(0.7) * 0.5 + way(0.3) * 0.1 + way(1.3) * 3.0, -way(1.3));
            let mut hits = [None; 2];
            let mut slots = hits.iter_mut();
            frustum.crossings::<true>(&ray, Interval::LINE, &mut |hit| {
                if let Some(slot) = slots.next() {
                    *slot = Some(hit);
                }
            });
            for hit in hits.into_iter().flatten() {
                let scaled = ScaledRay::new(&ray, frustum.base, frustum.unit).unwrap();
                let find = || FindSurface { frustum: &frustum, ray: &scaled, hit };
                let cap = usize::from(hit.part() != 0);
                count[2 * cap] += 1;
                let Some(found) = kernel::run(First(find())) else { continue };
                count[2 * cap + 1] += 1;
                if cap == 0 {
                    let closed = kernel::run(Careful(find()));
                    assert!((found.high() - closed).length() < 1e-15, "{frustum:?} {ray:?} {hit:?}");
                }
            }
        }
        let [side, side_found, cap, cap_found] = count.map(f64::from);
        assert!(
            side_found > 0.95 * side && cap_found > 0.95 * cap && side > 1000.0 && cap > 1000.0,
            "{count:?}"
        );
    }

    /// What must not become slow unseen: `f64` tells nearly all plain crossings with the side, in every direction, also next
    /// to the axis and along the side; and tells them as double-double does.
    #[test]
    fn chords_in_every_direction() {
        use crate::scaled::admit;
        use crate::testing::Random;
        let mut random = Random::new(1);
        let mut count = [[0_u32; 2]; 4];
        for case in 0..8000 {
            let kind = case % 4;
            let radii = [0.5, if kind == 0 { 0.5 } else { random.uniform(0.0, 0.45) }];
            let top = random.direction();
            let frustum = Frustum::new(DVec3::ZERO, radii, top, ["a", "b"], true).unwrap();
            let axis = frustum.axis.high();
            let target = top * random.uniform(0.1, 0.9) + random.in_cube() * 0.1;
            let direction = match kind {
                // Next to the axis, or along the side.
                2 => axis + random.in_cube() * 0.2,
                3 => {
                    let out = axis.cross(random.direction()).normalize();
                    axis + out * (radii[1] - radii[0]) + random.in_cube() * 0.05
                }
                _ => random.direction(),
            };
            let ray = Ray::new(target - direction * 3.0, direction);
            let rough = if kind == 0 { frustum.rough::<false>(&ray) } else { frustum.rough::<true>(&ray) };
            count[kind][usize::from(rough.is_some())] += 1;
            let found = frustum.both(rough, &ray, Interval::LINE);
            let (scaled, line) = frustum.line(&ray).unwrap();
            let exact = line.span(true).map(|found| {
                admit(Interval::LINE, scaled.unscale(line.shift + found?.at), found?.part, found?.root)
            });
            for (found, exact) in found.into_iter().zip(exact) {
                assert_eq!(found.is_some(), exact.is_some(), "{frustum:?} {ray:?}");
                if let (Some(found), Some(exact)) = (found, exact) {
                    assert!((found.t() - exact.t()).abs() < 1e-11, "{frustum:?} {ray:?}");
                    assert_eq!(found.part(), exact.part());
                }
            }
        }
        assert!(count.iter().all(|&[left, _]| left < 20), "{count:?}");
    }

    /// What `f64` says of lines that nearly touch the side is true, for steep and flat cones, from near and from afar.
    #[test]
    fn chords_of_grazing_lines() {
        use super::super::rough::Span;
        use crate::scaled::admit;
        use crate::testing::Random;
        let mut random = Random::new(2);
        let mut count = [0_u32; 3];
        for case in 0..20_000 {
            let height = random.magnitude(-3.0, 1.0);
            let radii = [1.0, if case % 4 == 0 { 1.0 } else { random.uniform(0.0, 0.9) }];
            let axis = random.direction();
            let frustum = Frustum::new(random.in_cube(), radii, axis * height, ["a", "b"], true);
            let Ok(frustum) = frustum else { continue };
            // A point of the side, and a line in its tangent plane, off by a little.
            let axis = (frustum.top - frustum.base).normalize();
            let out = axis.cross(random.direction()).normalize();
            let v = random.uniform(0.1, 0.9);
            let length = (frustum.top - frustum.base).length();
            let radius = radii[0] + (radii[1] - radii[0]) * v;
            let normal = (out * length + axis * (radii[0] - radii[1])).normalize();
            let tangent = normal.cross(random.direction()).normalize();
            let place = frustum.base + axis * (v * length) + out * radius;
            let place = place + normal * (random.sign() * random.magnitude(-17.0, -6.0) * length.min(1.0));
            let ray = Ray::new(place - tangent * random.magnitude(-1.0, 4.0), tangent);
            let rough =
                if case % 4 == 0 { frustum.rough::<false>(&ray) } else { frustum.rough::<true>(&ray) };
            let (scaled, line) = frustum.line(&ray).unwrap();
            let exact = line.span(true).map(|found| {
                admit(Interval::LINE, scaled.unscale(line.shift + found?.at), found?.part, found?.root)
            });
            match rough {
                None => count[0] += 1,
                Some(Span::Miss) => {
                    count[1] += 1;
                    assert_eq!(exact, [None; 2], "{frustum:?} {ray:?}");
                }
                Some(Span::Crossings(found)) => {
                    count[2] += 1;
                    for (found, exact) in found.into_iter().zip(exact) {
                        let off = exact.map_or(f64::INFINITY, |exact| (exact.t() - found.t).abs());
                        assert!(off <= found.margin, "{frustum:?} {ray:?} {found:?} {exact:?}");
                    }
                }
            }
        }
        assert!(count.iter().all(|&count| count > 2000), "{count:?}");
    }

    /// A hit that rounding invented, of a line that passes beside the side: the record is of the place on the surface next
    /// to the line.
    #[test]
    fn records_beside_the_line_are_on_the_surface() {
        let mut random = crate::testing::Random::new(3);
        let mut count = 0;
        for case in 0..2000 {
            let radii = [0.5, if case % 2 == 0 { 0.5 } else { random.uniform(0.2, 0.45) }];
            let frustum = Frustum::new(DVec3::ZERO, radii, random.direction(), ["a", "b"], true).unwrap();
            let axis = frustum.axis.high();
            let out = axis.cross(random.direction()).normalize();
            let normal = (out + axis * (radii[0] - radii[1])).normalize();
            let v = random.uniform(0.2, 0.8);
            let off = random.magnitude(-14.0, -4.0);
            let place = axis * v + out * (radii[0] + (radii[1] - radii[0]) * v);
            // Across the axis: then the line passes outside everywhere.
            let tangent = axis.cross(normal).normalize();
            let ray = Ray::new(place + normal * off - tangent * 2.0, tangent);
            let scaled = ScaledRay::new(&ray, frustum.base, frustum.unit).unwrap();
            let hit = crate::Hit::inside(2.0, super::super::SIDE, 0);
            let found = kernel::run(FindSurface { frustum: &frustum, ray: &scaled, hit });
            let local = found.local.high() * exp2i(frustum.unit);
            let z = local.dot(axis);
            let rho = (local - axis * z).length();
            assert!(
                (rho - (radii[0] + (radii[1] - radii[0]) * z)).abs() < 1e-14,
                "{frustum:?} {ray:?} {local}"
            );
            assert!((local - place).length() < 2.0 * off + 1e-7, "{frustum:?} {ray:?} {local} {place}");
            count += 1;
        }
        assert!(count == 2000);
    }

    struct BothWays<'a>(FindSurface<'a>);

    impl Task for BothWays<'_> {
        type Output = Option<[Refined; 2]>;
        fn run<P: Product>(self) -> Self::Output {
            Some([self.0.newton::<P>()?, self.0.run::<P>()])
        }
    }

    /// Newton's steps find what the closed form finds: place and parameter within what both may err, the normal to a few
    /// roundings, and the error they tell is far below a rounding.
    #[test]
    fn both_ways_agree() {
        let mut random = crate::testing::Random::new(4);
        let mut count = [[0_u32; 2]; 2];
        for case in 0..6000 {
            let radius = random.uniform(0.2, 2.0);
            let other = match case % 3 {
                0 => radius,
                1 => 0.0,
                _ => radius * random.uniform(0.0, 2.0),
            };
            let (base, axis) = (random.in_cube(), random.direction());
            let top = base + axis * random.uniform(0.3, 3.0);
            let frustum = Frustum::new(base, [radius, other], top, ["a", "b"], true).unwrap();
            let target = base.lerp(top, random.uniform(0.0, 1.0)) + random.in_cube() * (0.5 * radius);
            let direction = random.direction() * random.magnitude(-1.0, 1.0);
            let ray = Ray::new(target - direction.normalize() * random.magnitude(-0.5, 2.0), direction);
            let scaled = ScaledRay::new(&ray, frustum.base, frustum.unit).unwrap();
            for hit in frustum.exact(&ray, Interval::LINE).into_iter().flatten() {
                let cap = usize::from(hit.part() == BASE || hit.part() == TOP);
                count[cap][0] += 1;
                let Some([quick, closed]) =
                    kernel::run(BothWays(FindSurface { frustum: &frustum, ray: &scaled, hit }))
                else {
                    continue;
                };
                count[cap][1] += 1;
                let error = quick.error + closed.error;
                assert!(quick.error <= exp2i(-70), "{}", quick.error);
                let apart = (quick.local - closed.local).high().length();
                assert!(apart <= error, "{frustum:?} {ray:?} {hit:?}: {apart:e} {error:e}");
                let apart = (quick.t - closed.t).high.abs() * scaled.direction.length();
                assert!(apart <= error, "{frustum:?} {ray:?} {hit:?}: {apart:e} {error:e}");
                assert!((quick.normal - closed.normal).length() < 1e-15, "{frustum:?} {ray:?} {hit:?}");
                assert!((quick.z - closed.z).abs() <= 1e-16 + error, "{frustum:?} {ray:?} {hit:?}");
            }
        }
        let [[side, quick_side], [cap, quick_cap]] = count.map(|count| count.map(f64::from));
        assert!(quick_side > 0.9 * side && quick_cap > 0.9 * cap, "{count:?}");
        assert!(side > 3000.0 && cap > 3000.0, "{count:?}");
    }
}
