//! How much work the acceleration structure saves: counted in questions put to shapes, so the figures are the same on
//! every machine. A change that makes an answer no worse but slower shows here.
#![cfg(feature = "testing")]

use rt_core::shape::Sphere;
use rt_core::testing::Random;
use rt_core::{Aabb, Geometry, Hit, Interval, Primitive, Ray, Shape, Surface};
use std::cell::Cell;
use std::sync::Arc;

thread_local! {
    static ASKED: Cell<u32> = const { Cell::new(0) };
}

/// A sphere that counts how often it is asked.
#[derive(Debug)]
struct Counting(Sphere);

impl Primitive for Counting {
    fn hit(&self, ray: &Ray, within: Interval) -> Option<Hit> {
        ASKED.set(ASKED.get() + 1);
        self.0.hit(ray, within)
    }
    fn crossings(&self, ray: &Ray, within: Interval, each: &mut dyn FnMut(Hit)) {
        self.0.crossings(ray, within, each);
    }
    fn surface(&self, ray: &Ray, hit: Hit) -> Surface {
        self.0.surface(ray, hit)
    }
    fn bounds(&self) -> Option<Aabb> {
        self.0.bounds()
    }
}

/// How often shapes are asked, for each of so many rays.
fn asked(rays: usize, work: impl FnOnce()) -> f64 {
    ASKED.set(0);
    work();
    f64::from(ASKED.get()) / rays as f64
}

/// Spheres in a cube, of sizes from 1 to 30, the last far from the others; some in front of others.
fn cloud(random: &mut Random, count: usize, size: f64) -> Geometry {
    let mut builder = Geometry::builder();
    for i in 0..count {
        let far = if i + 1 == count { 20.0 } else { 1.0 };
        let sphere = Sphere::new(random.in_cube() * far, size * random.magnitude(-1.5, 0.0)).unwrap();
        builder.push(Shape::from(Arc::new(Counting(sphere)) as Arc<dyn Primitive>));
    }
    builder.build()
}

#[test]
fn questions_a_ray() {
    let mut random = Random::new(1);
    let (mut found, mut by_cube, mut back) = (Vec::new(), f64::INFINITY, f64::INFINITY);
    for (count, size) in [(30, 0.6), (1000, 0.2), (20_000, 0.08)] {
        let geometry = cloud(&mut random, count, size);
        // As of a camera: 40 x 40 pixels, in tiles of 4 x 4.
        let rays: Vec<Ray> = (0..1600)
            .map(|i| {
                let (tile, place) = (i / 16, i % 16);
                let (x, y) = (tile % 10 * 4 + place % 4, tile / 10 * 4 + place / 4);
                Ray::new([0.1, 0.2, 4.0], [f64::from(x) * 0.01 - 0.2, f64::from(y) * 0.01 - 0.2, -1.0])
            })
            .collect();
        let scattered: Vec<Ray> =
            (0..1600).map(|_| Ray::new(random.in_cube() * 1.5, random.direction())).collect();
        for rays in [&rays, &scattered] {
            let within = vec![Interval::FORWARD; rays.len()];
            let (mut nearest, mut blocked) = (vec![None; rays.len()], vec![false; rays.len()]);
            found.extend([
                asked(rays.len(), || {
                    rays.iter().for_each(|ray| _ = geometry.nearest(ray, Interval::FORWARD))
                }),
                asked(rays.len(), || geometry.nearest_many(rays, &within, &mut nearest)),
                asked(rays.len(), || {
                    rays.iter().for_each(|ray| _ = geometry.occluded(ray, Interval::FORWARD))
                }),
                asked(rays.len(), || geometry.occluded_many(rays, &within, &mut blocked)),
            ]);
        }
        if let Some(cube) = geometry.cube_about(rays[0].origin) {
            by_cube = asked(rays.len(), || {
                rays.iter().for_each(|ray| _ = geometry.nearest_from(&cube, ray, Interval::FORWARD));
            });
            // Back to the camera, from what its rays meet on either side.
            let starts: Vec<_> = scattered
                .iter()
                .filter_map(|ray| {
                    let found = geometry.nearest(ray, Interval::FORWARD)?;
                    let surface = geometry.surface(ray, found);
                    Some(surface.departure(found.object, found.hit, rt_core::Side::Outside))
                })
                .collect();
            back = asked(starts.len(), || {
                starts.iter().for_each(|from| _ = geometry.blocked_towards(&cube, from, &[], &mut |_| ()));
            });
        }
    }
    // As measured, and no more than a twentieth above: camera's rays and scattered ones for each scene, nearest hits one by
    // one and together, whether there is any one by one and together; in the small scene by the cube, too.
    let measured = [
        [0.742, 0.748, 0.713, 0.721],
        [0.305, 0.305, 0.294, 0.294],
        [1.694, 1.739, 1.441, 1.490],
        [0.885, 0.885, 0.736, 0.736],
        [1.906, 2.012, 1.478, 1.549],
        [1.124, 1.124, 0.862, 0.862],
    ];
    let within = |found: &f64, measured: &f64| *found <= measured * 1.05 && *found >= measured * 0.5;
    assert!(found.iter().zip(measured.iter().flatten()).all(|(a, b)| within(a, b)), "{found:?}");
    assert!(by_cube <= 0.943 * 1.05, "{by_cube}");
    assert!(back <= 1.185 * 1.05, "{back}");
}
