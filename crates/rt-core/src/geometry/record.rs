//! The records of many hits, four at a time where rays that are neighbours hit the same object, or any spheres or tori.

use super::store::ByFour;
use super::{Found, Geometry};
use crate::kernel::{Lanes, Vectorized, vectorize};
use crate::shape::{Sphere, SurfaceEach, Torus};
use crate::{Hit, Primitive, Ray, Shape, Surface};

/// How many hits ahead of its record the memory of an object is asked for. Only time depends on it: the records of four take
/// longer than a fetch from memory, some 100 ns.
const AHEAD: usize = 4;

struct RecordMany<'a> {
    geometry: &'a Geometry,
    rays: &'a [Ray],
    found: &'a [Option<Found>],
    surfaces: &'a mut [Surface],
}

impl Vectorized for RecordMany<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let RecordMany { geometry, rays, found, surfaces } = self;
        let count = surfaces.len();
        let (mut spheres, mut tori) = (Waiting::new(), Waiting::new());
        let fours = found.chunks(4).zip(rays.chunks(4));
        for (number, (found, four)) in fours.enumerate() {
            for soon in self.found.iter().skip(4 * number + AHEAD).take(4).flatten() {
                geometry.prefetch(*soon);
            }
            if let ([Some(a), Some(b), Some(c), Some(d)], [ra, rb, rc, rd], [sa, sb, sc, sd]) =
                (found, four, &mut surfaces[4 * number..(4 * number + 4).min(count)])
                && a.object == b.object
                && a.object == c.object
                && a.object == d.object
                && geometry.store.may_go_by_four(a.object)
                && let Some(shape) = geometry.shapes.get(a.object as usize)
            {
                let (rays, hits) = ([ra, rb, rc, rd], [a.hit, b.hit, c.hit, d.hit]);
                match shape {
                    Shape::Plane(s) => s.surface_four(lanes, rays, hits, [sa, sb, sc, sd]),
                    Shape::Cylinder(s) => s.surface_four(lanes, rays, hits, [sa, sb, sc, sd]),
                    Shape::Cone(s) => s.surface_four(lanes, rays, hits, [sa, sb, sc, sd]),
                    Shape::Sphere(s) => Sphere::surface_each(lanes, [s; 4], rays, hits, [sa, sb, sc, sd]),
                    Shape::Torus(s) => Torus::surface_each(lanes, [s; 4], rays, hits, [sa, sb, sc, sd]),
                    _ => {
                        for ((surface, ray), hit) in [sa, sb, sc, sd].into_iter().zip(rays).zip(hits) {
                            *surface = shape.surface(ray, hit);
                        }
                    }
                }
                continue;
            }
            for (place, found) in (4 * number..).zip(found) {
                let Some(found) = *found else { continue };
                let (ray, hit) = (&rays[place], found.hit);
                match geometry.store.by_four(&geometry.shapes, found.object) {
                    Some(ByFour::Sphere(sphere)) => spheres.add(lanes, (sphere, hit, place), rays, surfaces),
                    Some(ByFour::Torus(torus)) => tori.add(lanes, (torus, hit, place), rays, surfaces),
                    None => surfaces[place] = geometry.surface(ray, found),
                }
            }
        }
        spheres.rest(rays, surfaces);
        tori.rest(rays, surfaces);
    }
}

/// Hits that wait until they are four, and the places of their rays and records.
struct Waiting<'a, S> {
    hits: [Option<(&'a S, Hit, usize)>; 4],
    count: usize,
}

impl<'a, S: SurfaceEach> Waiting<'a, S> {
    #[inline(always)]
    fn new() -> Self {
        Waiting { hits: [None; 4], count: 0 }
    }

    #[inline(always)]
    fn add<L: Lanes>(&mut self, lanes: L, hit: (&'a S, Hit, usize), rays: &[Ray], surfaces: &mut [Surface]) {
        self.hits[self.count & 3] = Some(hit);
        self.count += 1;
        if self.count < 4 {
            return;
        }
        self.count = 0;
        if let [Some((sa, a, pa)), Some((sb, b, pb)), Some((sc, c, pc)), Some((sd, d, pd))] = self.hits
            && let Ok(surfaces) = surfaces.get_disjoint_mut([pa, pb, pc, pd])
        {
            let rays = [&rays[pa], &rays[pb], &rays[pc], &rays[pd]];
            S::surface_each(lanes, [sa, sb, sc, sd], rays, [a, b, c, d], surfaces);
        }
    }

    /// The records of those that still wait.
    #[inline(always)]
    fn rest(self, rays: &[Ray], surfaces: &mut [Surface]) {
        for (shape, hit, place) in self.hits.into_iter().take(self.count).flatten() {
            surfaces[place] = shape.surface(&rays[place], hit);
        }
    }
}

impl Geometry {
    /// The full records of many hits found with these rays, each in its place: the same as
    /// [`surface`](Geometry::surface) for each, faster. Places without a hit are left as they are. Works on as many rays as
    /// the shortest of the three slices has.
    pub fn surface_many(&self, rays: &[Ray], found: &[Option<Found>], surfaces: &mut [Surface]) {
        let count = rays.len().min(found.len()).min(surfaces.len());
        let (rays, found, surfaces) = (&rays[..count], &found[..count], &mut surfaces[..count]);
        vectorize(RecordMany { geometry: self, rays, found, surfaces });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Interval;
    use crate::kernel::PortableLanes;
    use crate::math::exp2i;
    use crate::shape::{Cone, Cylinder, Plane};
    use crate::testing::Random;
    use alloc::vec::Vec;
    use glam::DVec3;

    /// So are those of many objects, whose copies are found by their places in the tree; hits that are left over, and any order.
    #[test]
    fn records_of_many_objects() {
        let mut random = Random::new(2);
        let mut builder = Geometry::builder();
        for _ in 0..6000 {
            builder = builder.add(Sphere::new(random.in_cube(), random.uniform(0.01, 0.04)).unwrap());
        }
        builder = builder.add(Plane::new([0.0, -1.5, 0.0], [0.1, 1.0, 0.0]).unwrap());
        let geometry = builder.build();
        let rays: Vec<Ray> = (0..4001)
            .map(|_| {
                let (origin, target) = (random.in_cube() * 3.0, random.in_cube() * 1.5);
                Ray::new(origin, (target - origin) * random.magnitude(-3.0, 3.0))
            })
            .collect();
        let found: Vec<_> = rays.iter().map(|ray| geometry.nearest(ray, Interval::FORWARD)).collect();
        let nowhere = Surface::new(7.0, DVec3::ZERO, DVec3::ZERO, DVec3::Y, 0.0);
        let mut surfaces = alloc::vec![nowhere; rays.len()];
        geometry.surface_many(&rays, &found, &mut surfaces);
        let mut count = [0; 2];
        for ((ray, found), surface) in rays.iter().zip(&found).zip(&surfaces) {
            let expected = found.map_or(nowhere, |found| geometry.surface(ray, found));
            assert_eq!(alloc::format!("{surface:?}"), alloc::format!("{expected:?}"), "{ray:?}");
            if let Some(found) = found {
                count[usize::from(found.object == 6000)] += 1;
            }
        }
        assert!(count[0] > 1000 && count[1] > 50, "{count:?}");
    }

    /// Records by four are those one by one, in all lanes, also where some are in doubt.
    #[test]
    fn many_are_each() {
        let mut random = Random::new(1);
        let floor = Plane::new([0.3, -1.0, 0.1], [0.0, 1.0, 0.0]).unwrap();
        let slope = Plane::new([0.1, 0.2, 5.0], [0.3, 1.0, -2.0]).unwrap();
        let geometry = Geometry::builder()
            .add(floor)
            .add(slope)
            .add(Sphere::new([0.0, 0.0, 1.0], 0.5).unwrap())
            .add(Cylinder::new([1.0, -0.9, 0.0], [1.5, 1.0, 1.0], 0.4).unwrap())
            .add(Cone::new([-1.0, -0.9, 0.3], 0.8, [-1.0, 1.0, 0.0], 0.1).unwrap())
            .add(Sphere::new([0.6, 0.2, 1.1], 0.3).unwrap())
            .add(Sphere::new([-0.5, 0.4, 0.9], 0.2).unwrap())
            .build();
        let (tube, cone, balls) =
            (DVec3::new(1.25, 0.0, 0.5), DVec3::new(-1.0, 0.0, 0.2), DVec3::new(0.0, 0.2, 1.0));
        let targets = [floor.point(), slope.point(), tube, cone, balls];
        let (mut fours, mut spheres, mut in_doubt) = ([0; 7], 0, 0);
        for case in 0..2500 {
            let size = if case % 8 == 0 { random.magnitude(-140.0, 140.0) } else { 1.0 };
            let origin = random.in_cube() * 4.0 * size;
            let mut target = targets[case % 5];
            if case % 16 == 1 || case % 16 == 4 {
                // At the anchor to within this, where a place may have too few digits.
                target += random.in_cube() * random.magnitude(-40.0, -5.0);
            } else {
                target += random.in_cube() * if case % 5 < 2 { 9.0 } else { 0.9 };
            }
            let rays: Vec<Ray> = (0..9)
                .map(|i| {
                    let apart = random.in_cube() * if i == 3 { 1e-3 } else { exp2i(-(case as i32 % 40)) };
                    Ray::new(origin + apart * 1e-2, (target - origin + apart) * random.magnitude(-2.0, 2.0))
                })
                .collect();
            let mut found: Vec<_> = rays.iter().map(|ray| geometry.nearest(ray, Interval::FORWARD)).collect();
            if case % 3 == 0 {
                found[5] = None;
            }
            let nowhere = Surface::new(7.0, DVec3::ZERO, DVec3::ZERO, DVec3::Y, 0.0);
            let (mut surfaces, mut portable) = ([nowhere; 9], [nowhere; 9]);
            geometry.surface_many(&rays, &found, &mut surfaces);
            RecordMany { geometry: &geometry, rays: &rays, found: &found, surfaces: &mut portable }
                .run(PortableLanes);
            for (i, (ray, found)) in rays.iter().zip(&found).enumerate() {
                let expected = found.map_or(nowhere, |found| geometry.surface(ray, found));
                // All bits, those of zeros too.
                let bits = |s: &Surface| alloc::format!("{s:?}");
                assert_eq!(bits(&surfaces[i]), bits(&expected), "{ray:?}");
                assert_eq!(bits(&portable[i]), bits(&expected), "{ray:?}");
            }
            let objects: Vec<_> = found[..4].iter().map(|found| found.map(|found| found.object)).collect();
            if let Some(object) = objects[0]
                && objects.iter().all(|&o| o == objects[0])
            {
                fours[object as usize] += 1;
            }
            let is_sphere =
                |found: &Option<Found>| found.is_some_and(|found| [2, 5, 6].contains(&found.object));
            spheres += found.iter().filter(|found| is_sphere(found)).count();
            in_doubt += u32::from(case % 8 == 0 || case % 16 == 1 || case % 16 == 4);
        }
        assert!([0, 1, 3, 4].iter().all(|&o| fours[o] > 100), "{fours:?}");
        assert!(spheres > 1000 && in_doubt > 100, "{spheres} {in_doubt}");
    }
}
