//! Acceleration: time per ray, build time and memory over the number of shapes.

use crate::clock::{self, Pass};
use crate::plot::{Series, lines};
use crate::quantile::brief;
use crate::table::Table;
use crate::{Effort, Output};
use rt_core::glam::DVec3;
use rt_core::shape::{Sphere, Torus};
use rt_core::{Geometry, Interval, Primitive, Ray, Shape};
use std::time::Instant;

/// SplitMix64 with 24-bit uniform numbers, exact in `f32`.
struct Random(u64);

impl Random {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 40) as f64 / f64::from(1 << 24)
    }

    fn vector(&mut self) -> DVec3 {
        let (x, y, z) = (self.uniform(), self.uniform(), self.uniform());
        DVec3::new(x, y, z)
    }

    fn unit(&mut self) -> DVec3 {
        loop {
            let d = self.vector() * 2.0 - 1.0;
            let q = d.length_squared();
            if q > 0.01 && q <= 1.0 {
                return d / q.sqrt();
            }
        }
    }
}

/// Radii such that a ray crosses about one sphere per unit of length, however many there are.
fn radius(n: usize) -> f64 {
    (1.0 / (13.0 * std::f64::consts::PI / 12.0 * n as f64)).sqrt()
}

fn spheres(n: usize) -> Vec<Shape> {
    let (mut random, radius) = (Random(1), radius(n));
    let mut make = || {
        let center = random.vector();
        Sphere::new(center, radius * (0.5 + random.uniform())).ok().map(Shape::from)
    };
    (0..n).filter_map(|_| make()).collect()
}

fn tori(n: usize) -> Vec<Shape> {
    let (mut random, radius) = (Random(3), radius(n));
    let mut make = || {
        let (center, axis) = (random.vector(), random.unit());
        let major = radius * (0.5 + random.uniform());
        Torus::new(center, axis, major, major * (0.15 + 0.35 * random.uniform())).ok().map(Shape::from)
    };
    (0..n).filter_map(|_| make()).collect()
}

fn random_rays(count: usize) -> Vec<Ray> {
    let mut random = Random(2);
    (0..count)
        .map(|_| {
            let origin = random.vector();
            Ray::new(origin, random.unit())
        })
        .collect()
}

/// A pinhole camera before the unit cube: neighbouring rays agree.
fn primary_rays(width: usize) -> Vec<Ray> {
    let place = |k: usize| (k as f64 + 0.5) / width as f64 - 0.5;
    (0..width * width)
        .map(|k| {
            let direction = DVec3::new(place(k % width), place(k / width), 1.5);
            Ray::new(DVec3::new(0.5, 0.5, -1.5), direction / direction.length())
        })
        .collect()
}

/// The nearest hit by asking every shape.
fn brute_force(shapes: &[Shape], ray: &Ray) -> Option<f64> {
    shapes.iter().filter_map(|s| s.hit(ray, Interval::FORWARD)).map(|h| h.t()).min_by(f64::total_cmp)
}

/// Runs the section: table, CSV, plot.
pub fn run(effort: Effort, output: &mut Output) {
    let (sizes, width): (&[usize], usize) = match effort {
        Effort::Quick => (&[100, 10_000], 128),
        Effort::Full => (&[100, 1000, 10_000, 100_000, 1_000_000], 256),
    };
    let mut table = Table::new(
        "acceleration",
        "Acceleration: one thread, nearest hit",
        &[
            "shapes",
            "count",
            "build ms",
            "bytes per shape",
            "rays",
            "ns per ray",
            "spread",
            "hits",
            "differ from brute force",
        ],
    );
    let sets = [("camera", primary_rays(width)), ("random", random_rays(width * width))];
    let mut series: Vec<Series> = Vec::new();
    for (kind, make) in [("spheres", spheres as fn(usize) -> Vec<Shape>), ("tori", tori)] {
        for &count in sizes.iter().filter(|&&n| kind == "spheres" || n <= 100_000) {
            let shapes = make(count);
            let start = Instant::now();
            let mut builder = Geometry::builder();
            for shape in &shapes {
                builder.push(shape.clone());
            }
            let geometry = builder.build();
            let build = start.elapsed();
            for (set, rays) in &sets {
                // Brute force costs count * rays: check as many rays as 2 million tests allow, at least 20.
                let checked = rays.iter().step_by((rays.len() * count / 2_000_000).clamp(1, rays.len() / 20));
                let differ = checked
                    .filter(|ray| {
                        let found = geometry.nearest(ray, Interval::FORWARD);
                        found.map(|f| f.hit.t()) != brute_force(&shapes, ray)
                    })
                    .count();
                output.demand(differ == 0, || {
                    format!("{count} {kind}: {differ} {set} rays differ from brute force")
                });
                let hits = rays.iter().filter(|r| geometry.nearest(r, Interval::FORWARD).is_some()).count();
                let pass = || {
                    let nearest = |r| geometry.nearest(r, Interval::FORWARD);
                    rays.iter().filter_map(nearest).map(|f| f.hit.t()).sum()
                };
                let mut passes: Vec<Pass> = vec![Box::new(pass)];
                let timing = clock::compare(&mut passes, rays.len(), effort.rounds(), effort.round());
                let timing = match timing[0].clone() {
                    Ok(timing) => timing,
                    Err(refused) => {
                        output.refuse(format!("{count} {kind}, {set}: {refused:?}"));
                        continue;
                    }
                };
                table.row([
                    kind.into(),
                    count.to_string(),
                    brief(build.as_secs_f64() * 1e3),
                    brief(geometry.memory() as f64 / count as f64),
                    set.to_string(),
                    brief(timing.median),
                    format!("{}-{}", brief(timing.low), brief(timing.high)),
                    format!("{hits} of {}", rays.len()),
                    differ.to_string(),
                ]);
                let name = format!("{kind}, {set} rays");
                let point = (count as f64, timing.median, String::new());
                match series.iter_mut().find(|s| s.name == name) {
                    Some(s) => s.points.push(point),
                    None => series.push(Series { name, points: vec![point] }),
                }
            }
        }
    }
    output.table(table);
    output.plot("acceleration", |path| {
        lines(
            path,
            "Acceleration: cost against size",
            "number of shapes",
            "time per ray, nanoseconds",
            &series,
        )
    });
}
