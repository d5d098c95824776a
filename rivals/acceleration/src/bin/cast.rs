//! Casts the rays at our geometry: `cast sphere|torus N [passes]`.

use rivals_acceleration::*;
use rt_core::{Interval, Ray};

fn main() {
    let mut arguments = std::env::args().skip(1);
    let kind = arguments.next().unwrap_or("sphere".into());
    let n: usize = arguments.next().and_then(|s| s.parse().ok()).unwrap_or(10_000);
    let passes: usize = arguments.next().and_then(|s| s.parse().ok()).unwrap_or(3);
    let builder = if kind == "sphere" { sphere_geometry(n) } else { torus_geometry(n) };
    let start = cpu_seconds();
    let geometry = builder.build();
    println!(
        "ours {kind} N={n} build {:.1} ms  {:.1} bytes/primitive",
        (cpu_seconds() - start) * 1e3,
        geometry.memory() as f64 / n as f64
    );
    let only = arguments.next().unwrap_or_default();
    let method = arguments.next();
    for (name, rays) in [("primary", primary(1024)), ("random", random(1 << 20))] {
        if !name.starts_with(&only) {
            continue;
        }
        let measure = |way: &str, passes, rays: &[Ray], work: &mut dyn FnMut() -> (usize, f64)| {
            if method.as_ref().is_none_or(|method| method == way) {
                measure(&format!("{name} {way}"), passes, rays, work);
            }
        };
        measure("nearest", passes, &rays, &mut || {
            rays.iter().fold((0, 0.0), |(hits, sum), ray| match geometry.nearest(ray, Interval::FORWARD) {
                Some(found) => (hits + 1, sum + found.hit.t()),
                None => (hits, sum),
            })
        });
        let within = vec![Interval::FORWARD; rays.len()];
        let mut found = vec![None; rays.len()];
        measure("nearest_many", passes, &rays, &mut || {
            geometry.nearest_many(&rays, &within, &mut found);
            (found.iter().filter(|found| found.is_some()).count(), 0.0)
        });
        let mut occluded = vec![false; rays.len()];
        measure("occluded_many", passes, &rays, &mut || {
            geometry.occluded_many(&rays, &within, &mut occluded);
            (occluded.iter().filter(|&&yes| yes).count(), 0.0)
        });
        measure("occluded", passes, &rays, &mut || {
            (rays.iter().filter(|ray| geometry.occluded(ray, Interval::FORWARD)).count(), 0.0)
        });
    }
}

fn measure(name: &str, passes: usize, rays: &[Ray], work: &mut dyn FnMut() -> (usize, f64)) {
    let mut best = f64::INFINITY;
    let mut answer = (0, 0.0);
    for _ in 0..passes {
        let start = cpu_seconds();
        answer = work();
        best = best.min(cpu_seconds() - start);
    }
    println!(
        "  {name:24} {:7.2} Mrays/s  hits={} sum={:.6}",
        rays.len() as f64 / best * 1e-6,
        answer.0,
        answer.1
    );
}
