//! Casts the rays at our geometry: `cast sphere|torus N [passes] [primary|random] [way]`.

use rivals_acceleration::*;
use rt_core::Interval;

fn main() {
    let mut arguments = std::env::args().skip(1);
    let kind = arguments.next().unwrap_or("sphere".into());
    let n: usize = arguments.next().and_then(|s| s.parse().ok()).unwrap_or(10_000);
    let passes: usize = arguments.next().and_then(|s| s.parse().ok()).unwrap_or(3);
    let only = arguments.next().unwrap_or_default();
    let way = arguments.next();
    let builders = vec![scene(&kind, n); passes.max(1)];
    let mut least = f64::INFINITY;
    let mut built = None;
    for builder in builders {
        drop(built.take());
        let start = cpu_seconds();
        built = Some(builder.build());
        least = least.min(cpu_seconds() - start);
    }
    let geometry = built.expect("one pass at least");
    println!("ours build {:29.1} ms  {:.1} bytes/shape", least * 1e3, geometry.memory() as f64 / n as f64);
    for (name, rays) in [("primary", primary(1024)), ("random", random(1 << 20))] {
        if !name.starts_with(&only) {
            continue;
        }
        let wanted = |other: &str| way.as_ref().is_none_or(|way| way == other);
        let within = vec![Interval::FORWARD; rays.len()];
        let mut found = vec![None; rays.len()];
        let mut occluded = vec![false; rays.len()];
        if wanted("nearest") {
            measure("ours single", passes, rays.len(), || {
                for (ray, found) in rays.iter().zip(&mut found) {
                    *found = geometry.nearest(ray, Interval::FORWARD);
                }
                found.iter().filter(|found| found.is_some()).count()
            });
        }
        if wanted("nearest_many") {
            let singles = found.clone();
            measure("ours batch", passes, rays.len(), || {
                geometry.nearest_many(&rays, &within, &mut found);
                found.iter().filter(|found| found.is_some()).count()
            });
            assert!(way.is_some() || singles == found, "batches and singles differ");
        }
        if wanted("occluded") {
            measure("ours any hit, single", passes, rays.len(), || {
                rays.iter().filter(|ray| geometry.occluded(ray, Interval::FORWARD)).count()
            });
        }
        if wanted("occluded_many") {
            measure("ours any hit, batch", passes, rays.len(), || {
                geometry.occluded_many(&rays, &within, &mut occluded);
                occluded.iter().filter(|&&yes| yes).count()
            });
        }
        let answers: Vec<f64> =
            found.iter().map(|found| found.as_ref().map_or(f64::NAN, |found| found.hit.t())).collect();
        judge("ours", &geometry, &rays, &answers);
    }
}
