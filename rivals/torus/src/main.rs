//! First hits of a torus: ours beside kurbo's `solve_quartic` (Algorithm 1010) on the naively expanded coefficients.
//!
//! `cargo run --release -p rivals-torus`: for each family of rays the least time of a ray over interleaved passes,
//! the ratio, and in how many rays the other way misses or invents a hit, or is off by more than 1e-9 of the size.

use rt_core::glam::DVec3;
use rt_core::shape::Torus;
use rt_core::{Hit, Interval, Primitive, Ray, Side};
use std::hint::black_box;
use std::time::Instant;

const MAJOR: f64 = 1.3;
const MINOR: f64 = 0.4;
const RAYS: usize = 4096;
const PASSES: usize = 25;

/// Numbers in `[0, 1)`, the same on every run (xorshift64, Marsaglia 2003).
struct Random(u64);

impl Random {
    fn number(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn direction(&mut self) -> DVec3 {
        loop {
            let v = DVec3::new(self.number(), self.number(), self.number()) * 2.0 - 1.0;
            if (0.01..1.0).contains(&v.length_squared()) {
                return v.normalize();
            }
        }
    }

    /// A ray of the family, all but the misses aimed at the surface.
    fn ray(&mut self, family: &str) -> Ray {
        let (u, v) = (self.direction(), self.direction());
        let radial = DVec3::new(u.x, u.y, 0.0).normalize();
        let normal = (radial * v.x + DVec3::Z * v.y).normalize();
        let (point, direction) = (radial * MAJOR + normal * MINOR, self.direction());
        let tangent = (direction - normal * direction.dot(normal)).normalize();
        match family {
            "far 1e4" => Ray::new(point - direction * 1e4, direction),
            "grazing 1e-3" => Ray::new(point - normal * 1e-3 - tangent * 5.0, tangent),
            "grazing 1e-8" => Ray::new(point - normal * 1e-8 - tangent * 5.0, tangent),
            "grazing 1e-14" => Ray::new(point - normal * 1e-14 - tangent * 5.0, tangent),
            "equatorial" => {
                let direction = DVec3::new(direction.x, direction.y, 0.0).normalize();
                let across = DVec3::new(-direction.y, direction.x, 0.0);
                let offset = (self.number() * 2.0 - 1.0) * (MAJOR + MINOR);
                Ray::new(across * offset - direction * 5.0, direction)
            }
            "from inside" => Ray::new(radial * MAJOR + normal * (0.5 * MINOR), direction),
            "miss" => {
                let closest = self.direction() * 3.0;
                let across = closest.cross(direction).normalize();
                Ray::new(closest - across * 5.0, across)
            }
            _ => Ray::new(point - direction * 5.0, direction),
        }
    }
}

/// The least positive root of the naive quartic.
fn theirs(ray: &Ray) -> Option<f64> {
    let (o, d) = (ray.origin, ray.direction);
    let (a, b, four) = (d.dot(d), o.dot(d), 4.0 * MAJOR * MAJOR);
    let k = o.dot(o) + MAJOR * MAJOR - MINOR * MINOR;
    let c0 = k * k - four * (o.x * o.x + o.y * o.y);
    let c1 = 4.0 * b * k - 2.0 * four * (o.x * d.x + o.y * d.y);
    let c2 = 2.0 * a * k + 4.0 * b * b - four * (d.x * d.x + d.y * d.y);
    let roots = kurbo::common::solve_quartic(c0, c1, c2, 4.0 * a * b, a * a);
    roots.into_iter().filter(|&t| t > 0.0).min_by(f64::total_cmp)
}

/// The time of one pass in nanoseconds a ray.
fn time<T>(items: &[T], mut each: impl FnMut(&T)) -> f64 {
    let start = Instant::now();
    for item in items {
        each(black_box(item));
    }
    start.elapsed().as_secs_f64() * 1e9 / items.len().max(1) as f64
}

fn main() {
    let torus = Torus::new([0.0, 0.0, 0.0], [0.0, 0.0, 1.0], MAJOR, MINOR).expect("a legal torus");
    let mut random = Random(88_172_645_463_325_252);
    println!("family          ours ns  kurbo ns  ratio  surface ns  leaving ns  kurbo wrong");
    for family in [
        "random",
        "far 1e4",
        "grazing 1e-3",
        "grazing 1e-8",
        "grazing 1e-14",
        "equatorial",
        "from inside",
        "miss",
    ] {
        let rays: Vec<Ray> = (0..RAYS).map(|_| random.ray(family)).collect();
        let hits: Vec<Option<Hit>> = rays.iter().map(|ray| torus.hit(ray, Interval::FORWARD)).collect();
        let found: Vec<(Ray, Hit)> = rays.iter().zip(&hits).filter_map(|(&r, h)| Some((r, (*h)?))).collect();
        let wrong = rays.iter().zip(&hits).filter(|(ray, hit)| match (theirs(ray), hit) {
            (None, None) => false,
            (Some(t), Some(hit)) => (t - torus.surface(ray, *hit).t).abs() > 1e-9,
            _ => true,
        });
        let wrong = wrong.count();
        let leaving: Vec<_> = found
            .iter()
            .map(|(ray, hit)| {
                let surface = torus.surface(ray, *hit);
                let side = Side::of_arrival(ray.direction, surface.normal);
                let mirrored = ray.direction - surface.normal * (2.0 * ray.direction.dot(surface.normal));
                (surface.departure(0, *hit, side), mirrored)
            })
            .collect();
        let mut best = [f64::INFINITY; 4];
        for _ in 0..PASSES {
            let pass = [
                time(&rays, |ray| {
                    black_box(torus.hit(ray, Interval::FORWARD));
                }),
                time(&rays, |ray| {
                    black_box(theirs(ray));
                }),
                time(&found, |(ray, hit)| {
                    black_box(torus.surface(ray, *hit));
                }),
                time(&leaving, |(from, direction)| {
                    let (ray, within) = from.ray(*direction);
                    black_box(torus.hit_leaving(&ray, within, from));
                }),
            ];
            for (best, time) in best.iter_mut().zip(pass) {
                *best = best.min(time);
            }
        }
        let [ours, kurbo, surface, leaving] = best;
        let ratio = ours / kurbo;
        println!("{family:14} {ours:8.0} {kurbo:9.0} {ratio:6.2} {surface:11.0} {leaving:11.0} {wrong:12}");
    }
}
