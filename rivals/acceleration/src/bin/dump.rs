//! Writes a scene and the rays for programs in other languages: `dump sphere|torus N FOLDER`, in native byte order.
//! Spheres (centre, radius) and rays (origin, direction) are arrays of `f32`, which hold them exactly; tori (centre,
//! axis, major and minor radius) of `f64`.

use rivals_acceleration::{primary, random, spheres, tori};
use rt_core::Ray;
use std::path::Path;

fn main() -> std::io::Result<()> {
    let mut arguments = std::env::args().skip(1);
    let kind = arguments.next().unwrap_or("sphere".into());
    let n: usize = arguments.next().and_then(|word| word.parse().ok()).unwrap_or(10_000);
    let folder = arguments.next().unwrap_or(".".into());
    let write = |name: &str, bytes: Vec<u8>| std::fs::write(Path::new(&folder).join(name), bytes);
    let singles = |numbers: Vec<f64>| numbers.iter().flat_map(|&x| (x as f32).to_ne_bytes()).collect();
    let shapes = if kind == "sphere" {
        singles(spheres(n).iter().flat_map(|(c, r)| [c.x, c.y, c.z, *r]).collect())
    } else {
        tori(n)
            .iter()
            .flat_map(|(c, a, major, minor)| [c.x, c.y, c.z, a.x, a.y, a.z, *major, *minor])
            .flat_map(f64::to_ne_bytes)
            .collect()
    };
    write("shapes", shapes)?;
    let numbers = |rays: Vec<Ray>| -> Vec<f64> {
        rays.iter().flat_map(|ray| [ray.origin.to_array(), ray.direction.to_array()]).flatten().collect()
    };
    write("primary", singles(numbers(primary(1024))))?;
    write("random", singles(numbers(random(1 << 20))))
}
