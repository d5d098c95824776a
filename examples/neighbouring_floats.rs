//! A picture over neighbouring floats: do rays whose coordinates differ by single units in the last place agree?
//!
//! `cargo run --release --example neighbouring_floats -- docs/neighbouring_floats.png`
//!
//! Each cell is one ray, parallel to the z axis, whose x and y are the floats next to those of the cells beside it; in
//! the middle runs the exact silhouette. Above a sphere, below a torus; left the textbook's formula, right this library.
//!
//! - dark: a miss; white: a hit whose t is the nearest float;
//! - blue and orange: a hit too near or too far, the stronger the more digits are lost;
//! - yellow: a hit that does not exist; pink: a hit that was lost. Both are told by exact integer arithmetic.

use rt_core::double::Double;
use rt_core::kernel::{self, Product, Task};
use rt_core::poly::{self, Method};
use rt_core::shape::{Sphere, Torus};
use rt_core::{Interval, Primitive, Ray, Shape};
use rt_shade::Picture;

/// Cells along a side of a panel, pixels along a side of a cell, pixels between panels.
const CELLS: i64 = 96;
const PIXELS: usize = 4;
const GAP: usize = 16;
/// The distance between neighbouring floats in [1, 2), where all coordinates below lie.
const STEP: f64 = f64::EPSILON;
/// Rays start here and run down the z axis.
const START: f64 = 5.0;

/// A silhouette in the plane z = 0: the circle about `center` of this radius; the torus' ring is wider by `major` and
/// turned so that its tube shows this circle on the right.
struct Scene {
    center: [f64; 2],
    major: f64,
    radius: f64,
    shape: Shape,
}

impl Scene {
    /// The exact squared distance of a ray inside the silhouette, in units of the squared step; negative: outside.
    fn inside(&self, x: f64, y: f64) -> i128 {
        let whole = |a: f64| (a / STEP) as i128;
        let (dx, dy) =
            (whole(x) - whole(self.center[0]) - whole(self.major), whole(y) - whole(self.center[1]));
        whole(self.radius) * whole(self.radius) - dx * dx - dy * dy
    }

    /// The textbook's answer.
    fn textbook(&self, ray: &Ray) -> Option<f64> {
        let (o, d) = (ray.origin, ray.direction);
        let (x, y, z) = (o.x - self.center[0], o.y - self.center[1], o.z);
        let origin_squared = x * x + y * y + z * z;
        if self.major == 0.0 {
            let (b, c) = (z * d.z, origin_squared - self.radius * self.radius);
            let discriminant = b * b - c;
            return (discriminant >= 0.0).then(|| -b - discriminant.sqrt());
        }
        // The torus about the y axis, expanded about the ray's origin, and Graphics Gems' quartic.
        let (k, od) = (origin_squared - self.major * self.major - self.radius * self.radius, z * d.z);
        let four = 4.0 * self.major * self.major;
        let c = [
            k * k - four * (self.radius * self.radius - y * y),
            4.0 * od * k,
            2.0 * k + 4.0 * od * od,
            4.0 * od,
            1.0,
        ];
        poly::roots(c, Interval::FORWARD, Method::GraphicsGems).iter().map(|r| r.x).min_by(f64::total_cmp)
    }

    /// This library's answer.
    fn ours(&self, ray: &Ray) -> Option<f64> {
        self.shape.hit(ray, Interval::FORWARD).map(|hit| self.shape.surface(ray, hit).t)
    }
}

/// The exact first parameter, from the silhouette's own geometry in double-double arithmetic.
struct Exact<'a>(&'a Scene, f64, f64);

impl Task for Exact<'_> {
    type Output = f64;
    #[inline(always)]
    fn run<P: Product>(self) -> f64 {
        let Exact(scene, x, y) = self;
        let (x, y) = (x - scene.center[0], y - scene.center[1]);
        let radius = Double::product::<P>(scene.radius, scene.radius) - Double::product::<P>(y, y);
        // Sphere: the chord is r^2 - y^2 - x^2. Torus: (R + sqrt(r^2 - y^2))^2 - x^2.
        let outer =
            if scene.major == 0.0 { radius } else { (radius.sqrt::<P>() + scene.major).square::<P>() };
        let half_chord = (outer - Double::product::<P>(x, x)).sqrt::<P>();
        (Double::from(START) - half_chord).to_f64()
    }
}

/// What a cell looks like: linear light.
fn colour(exact: Option<f64>, answer: Option<f64>) -> [f32; 3] {
    let (t, a) = match (exact, answer) {
        (None, None) => return [0.010, 0.013, 0.022],
        (None, Some(_)) => return [1.0, 0.75, 0.02],
        (Some(_), None) => return [0.80, 0.10, 0.45],
        (Some(t), Some(a)) => (t, a),
    };
    let units = (a - t) / (t.abs() * STEP);
    // One unit shows faintly; 2^26 units, half of all digits, in full.
    let strength = (libm::log2(1.0 + units.abs()) / 27.0).min(1.0).sqrt() as f32;
    let full: [f32; 3] = if units < 0.0 { [0.0, 0.17, 0.45] } else { [0.66, 0.11, 0.0] };
    full.map(|c| 0.93 + (c - 0.93) * strength)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).unwrap_or_else(|| "neighbouring_floats.png".into());
    let scenes = [
        Scene {
            center: [0.5, 0.75],
            major: 0.0,
            radius: 1.0,
            shape: Sphere::new([0.5, 0.75, 0.0], 1.0)?.into(),
        },
        Scene {
            center: [0.5, 1.25],
            major: 0.75,
            radius: 0.25,
            shape: Torus::new([0.5, 1.25, 0.0], [0.0, 1.0, 0.0], 0.75, 0.25)?.into(),
        },
    ];
    let panel = CELLS as usize * PIXELS;
    let side = 2 * panel + GAP;
    let mut picture = Picture::new(side as u32, side as u32);
    picture.pixels_mut().fill([1.0; 3]);
    for (row, scene) in scenes.iter().enumerate() {
        let (mut wrong, mut digits) = ([0, 0], [0.0f64, 0.0]);
        for j in 0..CELLS {
            for i in 0..CELLS {
                // The silhouette at 35 degrees, and the floats around it.
                let (sin, cos) = libm::sincos(35.0f64.to_radians());
                let x = scene.center[0] + scene.major + scene.radius * cos + (i - CELLS / 2) as f64 * STEP;
                let y = scene.center[1] + scene.radius * sin + (CELLS / 2 - j) as f64 * STEP;
                let ray = Ray::new([x, y, START], [0.0, 0.0, -1.0]);
                let exact = (scene.inside(x, y) > 0).then(|| kernel::run(Exact(scene, x, y)));
                for (column, answer) in [scene.textbook(&ray), scene.ours(&ray)].into_iter().enumerate() {
                    wrong[column] += usize::from(exact.is_some() != answer.is_some());
                    if let (Some(t), Some(a)) = (exact, answer) {
                        digits[column] = digits[column].max((a - t).abs() / (t * STEP));
                    }
                    let (left, top) = (
                        column * (panel + GAP) + i as usize * PIXELS,
                        row * (panel + GAP) + j as usize * PIXELS,
                    );
                    for line in top..top + PIXELS {
                        picture.pixels_mut()[line * side + left..][..PIXELS].fill(colour(exact, answer));
                    }
                }
            }
        }
        let name = ["sphere", "torus"][row];
        println!(
            "{name}: textbook {} wrong of {}, error up to {:.1e} ulp",
            wrong[0],
            CELLS * CELLS,
            digits[0]
        );
        println!(
            "{name}: ours     {} wrong of {}, error up to {:.1e} ulp",
            wrong[1],
            CELLS * CELLS,
            digits[1]
        );
    }
    std::fs::write(&path, picture.to_png()?)?;
    println!("wrote {path}");
    Ok(())
}
