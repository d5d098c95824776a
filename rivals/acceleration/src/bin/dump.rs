//! Writes the scene and the rays for programs in other languages: `dump N FOLDER`, arrays of `f32` in native order.

use rivals_acceleration::{primary, random, spheres};
use rt_core::Ray;
use std::path::Path;

fn main() -> std::io::Result<()> {
    let mut arguments = std::env::args().skip(1);
    let n: usize = arguments.next().and_then(|word| word.parse().ok()).unwrap_or(10_000);
    let folder = arguments.next().unwrap_or(".".into());
    let write = |name: &str, numbers: Vec<f64>| {
        // Every number is an f32 to begin with.
        let bytes: Vec<u8> = numbers.iter().flat_map(|&x| (x as f32).to_ne_bytes()).collect();
        std::fs::write(Path::new(&folder).join(name), bytes)
    };
    write("spheres", spheres(n).iter().flat_map(|(c, r)| [c.x, c.y, c.z, *r]).collect())?;
    let numbers = |rays: Vec<Ray>| -> Vec<f64> {
        rays.iter().flat_map(|ray| [ray.origin.to_array(), ray.direction.to_array()]).flatten().collect()
    };
    write("primary", numbers(primary(1024)))?;
    write("random", numbers(random(1 << 20)))
}
