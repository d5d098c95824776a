//! Where in a pixel the rays go: one, a grid, or the corners of the raster.

use crate::whitted::Tracer;
use crate::{Antialias, Camera, Color, Region, Settings};
use core::ops::Range;
use rt_core::{Found, Interval, Ray};

/// The edge of a square of pixels whose rays are neighbours in a batch.
const BLOCK: usize = 4;

/// The rows whose rays are cast together, with one sample a pixel: as many rays as [`Geometry::nearest_many`] looks at in
/// one piece, for tiles of the usual width.
///
/// [`Geometry::nearest_many`]: rt_core::Geometry::nearest_many
const ROWS: usize = 32;

/// What is known of the rays that are cast together.
#[derive(Default)]
pub(crate) struct Buffers {
    rays: Vec<Ray>,
    within: Vec<Interval>,
    found: Vec<Option<Found>>,
    colors: Vec<Color>,
}

/// Calls `each` with the places of some rows of pixels, in squares of [`BLOCK`]: neighbours in that order go side by side.
#[inline(always)]
pub(crate) fn in_squares(width: u32, rows: Range<u32>, mut each: impl FnMut(u32, u32)) {
    for top in rows.clone().step_by(BLOCK) {
        let bottom = (top + BLOCK as u32).min(rows.end);
        for left in (0..width).step_by(BLOCK) {
            let right = (left + BLOCK as u32).min(width);
            for y in top..bottom {
                for x in left..right {
                    each(x, y);
                }
            }
        }
    }
}

/// The colours of the pixels of `tile`, row by row. The rays of a few rows are cast together.
pub(crate) fn tile(
    tracer: &mut Tracer,
    buffers: &mut Buffers,
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
    out.clear();
    out.resize(tile.width as usize * tile.height as usize, [0.0; 3]);
    let Buffers { rays, within, found, colors } = buffers;
    let rows = (ROWS / samples).max(1).next_multiple_of(BLOCK);
    for top in (0..tile.height).step_by(rows) {
        let rows = top..(top + rows as u32).min(tile.height);
        rays.clear();
        in_squares(tile.width, rows.clone(), |x, y| {
            for j in 0..n {
                for i in 0..n {
                    let u = f64::from(tile.x + x) + (first + f64::from(i) * step);
                    let v = f64::from(tile.y + y) + (first + f64::from(j) * step);
                    rays.push(camera.ray(u, v, width, height));
                }
            }
        });
        within.resize(rays.len(), Interval::FORWARD);
        found.clear();
        found.resize(rays.len(), None);
        tracer.nearest_many(rays, within, found);
        tracer.seen_by_eye(rays, found, colors);
        let mut colors = colors.chunks_exact(samples);
        in_squares(tile.width, rows, |x, y| {
            let Some(colors) = colors.next() else { return };
            let sum = colors.iter().fold(Color::BLACK, |sum, &color| sum + color);
            out[y as usize * tile.width as usize + x as usize] = (sum * share).to_f32();
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Attenuation, Light, Material, Scene};
    use rt_core::shape::{Plane, Sphere};

    /// Rays cast together, and their shadow rays, give the bits and the counts of rays cast one by one.
    #[test]
    fn together_is_one_by_one() {
        // More than direction cubes hold, and fewer.
        for (count, transmit) in [(100, 0.0), (30, 0.0), (30, 0.7)] {
            together(count, transmit);
        }
    }

    /// A floor and so many spheres on it, some of which let light through.
    fn together(count: u32, transmit: f64) {
        let mut scene = Scene::builder()
            .camera(Camera::new([0.0, 4.0, 9.0], [0.0, 0.5, 0.0], [0.0, 1.0, 0.0], 50.0).unwrap())
            .ambient([0.1; 3])
            .light(Light::point([4.0, 9.0, 5.0], [0.9; 3], Attenuation::NONE).unwrap())
            .light(Light::spot([-5.0, 8.0, 4.0], [0.0; 3], 9.0, 14.0, [0.5; 3], Attenuation::NONE).unwrap())
            .object("floor", Plane::new([0.0; 3], [0.0, 1.0, 0.0]).unwrap(), Material::default());
        for i in 0..count {
            let (x, z) = (f64::from(i % 10) - 4.5, f64::from(i / 10) - 4.5);
            let material = Material {
                specular: if i % 3 == 0 { 0.5 } else { 0.0 },
                reflect: if i % 4 == 0 { 0.3 } else { 0.0 },
                transmit: Color::gray(if i % 5 == 0 { transmit } else { 0.0 }),
                ..Material::default()
            };
            scene = scene.object(format!("{i}"), Sphere::new([x, 0.4, z], 0.4).unwrap(), material);
        }
        let scene = scene.build().unwrap();
        let settings =
            Settings { width: 41, height: 33, antialias: Antialias::Grid(2), ..Settings::default() };
        let all = Region { x: 0, y: 0, width: 41, height: 33 };
        let (mut together, mut single) = (Tracer::new(&scene, &settings), Tracer::new(&scene, &settings));
        let (mut pixels, mut colors) = (Vec::new(), Vec::new());
        tile(&mut together, &mut Buffers::default(), scene.camera(), &settings, all, &mut pixels);
        for (i, pixel) in pixels.iter().enumerate() {
            let mut sum = Color::BLACK;
            for (dx, dy) in [(0.25, 0.25), (0.75, 0.25), (0.25, 0.75), (0.75, 0.75)] {
                let (x, y) = ((i % 41) as f64 + dx, (i / 41) as f64 + dy);
                let (rays, mut found) = ([scene.camera().ray(x, y, 41, 33)], [None]);
                single.nearest_many(&rays, &[Interval::FORWARD], &mut found);
                single.seen_by_eye(&rays, &found, &mut colors);
                sum += colors[0];
            }
            assert_eq!((sum * 0.25).to_f32(), *pixel, "pixel {i} of {count} {transmit}");
        }
        assert_eq!(together.stats, single.stats);
        assert!(single.stats.shadow_hits > 30 && single.stats.reflected_rays > 30, "{:?}", single.stats);
    }
}
