//! Speed against error of the anti-aliasing: for each scene the root mean square error against a grid of 16 x 16 samples,
//! over the channels clipped to 0 and 1, and the rays from the eye a pixel.
//!
//! `cargo run --release --example antialias -- 160 scenes/checker.toml scenes/family.toml`
//!
//! Ways to sample may be added, as `rt render --aa` names them. Left to itself it draws the checker floor at 96.

use rt::rt_shade::text::{PictureLoader, load};
use rt::rt_shade::{Antialias, Picture, Settings, render};
use std::path::{Path, PathBuf};

struct Beside(PathBuf);

impl PictureLoader for Beside {
    fn load(&self, path: &str) -> Result<Vec<u8>, String> {
        std::fs::read(self.0.join(path)).map_err(|e| e.to_string())
    }
}

fn error(a: &Picture, b: &Picture) -> f64 {
    let clip = |v: &f32| f64::from(v.clamp(0.0, 1.0));
    let squares = a.pixels().iter().flatten().zip(b.pixels().iter().flatten()).map(|(a, b)| {
        let d = clip(a) - clip(b);
        d * d
    });
    (squares.sum::<f64>() / (3 * a.pixels().len()) as f64).sqrt()
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let size: u32 = arguments.next().map_or(Ok(96), |size| size.parse())?;
    let mut ways = vec![Antialias::None, Antialias::Grid(2), Antialias::Grid(4), Antialias::Grid(8)];
    let mut files = Vec::new();
    for argument in arguments {
        match argument.parse() {
            Ok(way) => ways.push(way),
            Err(_) => files.push(argument),
        }
    }
    if ways.len() == 4 {
        ways.push(Antialias::ADAPTIVE);
    }
    if files.is_empty() {
        files.push(concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/checker.toml").to_owned());
    }
    for file in files {
        let folder = Path::new(&file).parent().unwrap_or(Path::new(".")).to_owned();
        let loaded = load(&file, &std::fs::read(&file)?, &Beside(folder))?;
        let settings = Settings { width: size, height: size, ..loaded.settings };
        let draw = |antialias| render(&loaded.scene, &Settings { antialias, ..settings }, &());
        let reference = draw(Antialias::Grid(16))?.picture;
        println!("{file}");
        let mut four = (0.0, 0.0);
        for &way in &ways {
            let drawn = draw(way)?;
            let error = error(&drawn.picture, &reference);
            let rays = drawn.stats.eye_rays as f64 / f64::from(size * size);
            if way == Antialias::Grid(4) {
                four = (error, rays);
            }
            let relative = match four {
                (e, r) if e > 0.0 => {
                    format!("{:6.3} of the error, {:6.3} of the rays of 4x4", error / e, rays / r)
                }
                _ => String::new(),
            };
            println!("  {:18} {error:.5} {rays:7.2} rays/pixel  {relative}", way.to_string());
        }
    }
    Ok(())
}
