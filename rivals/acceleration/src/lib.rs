//! The scenes and rays that all programs of this comparison use, bit for bit: plain IEEE-754 arithmetic from
//! SplitMix64 (Steele, Lea, Flood 2014, doi:10.1145/2660193.2660195).

use rt_core::glam::DVec3;
use rt_core::shape::{Sphere, Torus};
use rt_core::{Geometry, Ray};

/// The seconds that this thread has spent on a processor: unlike the time of day, not disturbed by other programs that
/// wait for the same processor.
pub fn cpu_seconds() -> f64 {
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: the pointer is that of a `timespec` of ours.
    unsafe { libc::clock_gettime(libc::CLOCK_THREAD_CPUTIME_ID, &mut time) };
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

struct SplitMix(u64);

impl SplitMix {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// In [0, 1), exact in `f32`.
    fn uniform(&mut self) -> f64 {
        (self.next() >> 40) as f64 / 16_777_216.0
    }

    fn unit(&mut self) -> DVec3 {
        loop {
            let d = [2.0 * self.uniform() - 1.0, 2.0 * self.uniform() - 1.0, 2.0 * self.uniform() - 1.0];
            let q = (d[0] * d[0] + d[1] * d[1]) + d[2] * d[2];
            if q > 0.01 && q <= 1.0 {
                let l = q.sqrt();
                return DVec3::new(d[0] / l, d[1] / l, d[2] / l);
            }
        }
    }

    fn point(&mut self) -> DVec3 {
        let (x, y, z) = (self.uniform(), self.uniform(), self.uniform());
        DVec3::new(x, y, z)
    }
}

fn f32_of(v: DVec3) -> DVec3 {
    v.as_vec3().as_dvec3()
}

/// The mean radius with which a ray crosses about one of `n` spheres on a unit of length.
fn base_radius(n: usize) -> f64 {
    (1.0 / (3.4033920413889427 * n as f64)).sqrt()
}

/// Spheres in the unit cube: centre and radius.
pub fn spheres(n: usize) -> Vec<(DVec3, f64)> {
    let (mut random, base) = (SplitMix(1), base_radius(n));
    (0..n)
        .map(|_| {
            let center = random.point();
            (center, f64::from((base * (0.5 + random.uniform())) as f32))
        })
        .collect()
}

/// Tori in the unit cube: centre, unit axis, major and minor radius.
pub fn tori(n: usize) -> Vec<(DVec3, DVec3, f64, f64)> {
    let (mut random, base) = (SplitMix(3), base_radius(n));
    (0..n)
        .map(|_| {
            let (center, axis) = (random.point(), random.unit());
            let major = base * (0.5 + random.uniform());
            (center, axis, major, major * (0.15 + 0.35 * random.uniform()))
        })
        .collect()
}

/// Rays of a pinhole camera, row by row.
pub fn primary(resolution: usize) -> Vec<Ray> {
    let mut rays = Vec::with_capacity(resolution * resolution);
    for j in 0..resolution {
        for i in 0..resolution {
            let x = (i as f64 + 0.5) / resolution as f64 - 0.5;
            let y = (j as f64 + 0.5) / resolution as f64 - 0.5;
            let z = 1.5;
            let l = ((x * x + y * y) + z * z).sqrt();
            rays.push(Ray::new(DVec3::new(0.5, 0.5, -1.5), f32_of(DVec3::new(x / l, y / l, z / l))));
        }
    }
    rays
}

/// Rays from anywhere in the unit cube in any direction.
pub fn random(n: usize) -> Vec<Ray> {
    let mut random = SplitMix(2);
    (0..n)
        .map(|_| {
            let origin = random.point();
            Ray::new(origin, f32_of(random.unit()))
        })
        .collect()
}

/// The spheres as a geometry.
pub fn sphere_geometry(n: usize) -> rt_core::GeometryBuilder {
    let mut builder = Geometry::builder();
    for (center, radius) in spheres(n) {
        builder.push(Sphere::new(center, radius).expect("a sphere"));
    }
    builder
}

/// The tori as a geometry.
pub fn torus_geometry(n: usize) -> rt_core::GeometryBuilder {
    let mut builder = Geometry::builder();
    for (center, axis, major, minor) in tori(n) {
        builder.push(Torus::new(center, axis, major, minor).expect("a torus"));
    }
    builder
}

/// Spheres or tori, by name.
pub fn scene(kind: &str, n: usize) -> rt_core::GeometryBuilder {
    if kind == "torus" { torus_geometry(n) } else { sphere_geometry(n) }
}

/// Prints the best rate of some passes, and how many rays hit.
pub fn measure(name: &str, passes: usize, rays: usize, mut work: impl FnMut() -> usize) {
    let mut best = f64::INFINITY;
    let mut hits = 0;
    for _ in 0..passes {
        let start = cpu_seconds();
        hits = work();
        best = best.min(cpu_seconds() - start);
    }
    println!("{name:31} {:8.3} Mrays/s  hits={hits}", rays as f64 / best * 1e-6);
}

/// Prints hits, the sum of the parameters, and how far they are from the truth, in units of 2^-53 of the distance to the hit
/// (of 1 if that is less: coordinates are of that size). NaN stands for no hit. True is what the library's exact
/// records say.
pub fn judge(name: &str, geometry: &Geometry, rays: &[Ray], answers: &[f64]) {
    let (mut hits, mut sum, mut wrong, mut worst) = (0, 0.0, 0, 0.0_f64);
    for (ray, &t) in rays.iter().zip(answers) {
        if !t.is_nan() {
            hits += 1;
            sum += t;
        }
        match geometry.nearest(ray, rt_core::Interval::FORWARD) {
            None if t.is_nan() => {}
            Some(found) if !t.is_nan() => {
                let exact = geometry.surface(ray, found).t;
                let error = (t - exact).abs() / exact.max(1.0);
                if error > 1e-5 { wrong += 1 } else { worst = worst.max(error) }
            }
            _ => wrong += 1,
        }
    }
    let worst = worst * 9_007_199_254_740_992.0;
    println!(
        "{name:11} answers: hits={hits} sum of t={sum:.6}  wrong hits {wrong}, worst error {worst:.3e} u"
    );
}
