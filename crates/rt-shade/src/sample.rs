//! Where in a pixel the rays go: one, a grid, or the corners of the raster.

use crate::whitted::Tracer;
use crate::{Antialias, Camera, Color, Region, Settings};
use rt_core::{Interval, Ray};

/// The colours of the pixels of `tile`, row by row. The eye rays of a row are cast together.
pub(crate) fn tile(
    tracer: &mut Tracer,
    camera: &Camera,
    settings: &Settings,
    tile: Region,
    out: &mut Vec<[f32; 3]>,
) {
    let (width, height) = (settings.width, settings.height);
    let n = match settings.antialias {
        Antialias::Grid(n) => n,
        _ => 1,
    };
    let samples = (n * n) as usize;
    let share = 1.0 / f64::from(n * n);
    // Centres of n x n equal squares; the corner itself when corners are asked for.
    let step = 1.0 / f64::from(n);
    let first = if settings.corners { 0.0 } else { 0.5 * step };
    let count = tile.width as usize * samples;
    let mut rays: Vec<Ray> = Vec::with_capacity(count);
    let within = vec![Interval::FORWARD; count];
    let mut found = vec![None; count];
    out.clear();
    for y in tile.y..tile.y + tile.height {
        rays.clear();
        for x in tile.x..tile.x + tile.width {
            for j in 0..n {
                for i in 0..n {
                    let u = f64::from(x) + (first + f64::from(i) * step);
                    let v = f64::from(y) + (first + f64::from(j) * step);
                    rays.push(camera.ray(u, v, width, height));
                }
            }
        }
        tracer.nearest_many(&rays, &within, &mut found);
        for (rays, found) in rays.chunks_exact(samples).zip(found.chunks_exact(samples)) {
            let mut sum = Color::BLACK;
            for (ray, found) in rays.iter().zip(found) {
                sum += tracer.seen_by_eye(ray, *found);
            }
            out.push((sum * share).to_f32());
        }
    }
}
