//! Anti-aliasing: rays and time against the error of the picture.

use crate::plot::{Series, lines};
use crate::quantile::brief;
use crate::table::Table;
use crate::{Effort, Output};
use rt_shade::{Antialias, Picture, Scene, Settings, text};
use std::path::Path;
use std::time::Instant;

/// The scenes compared, from the repository.
const SCENES: [&str; 2] = ["family.toml", "checker.toml"];

fn methods() -> Vec<(String, Antialias)> {
    let grid = [1, 2, 4, 8]
        .map(|n| (if n == 1 { "none".into() } else { format!("grid {n}x{n}") }, Antialias::Grid(n)));
    let adaptive = [(0.1, 3), (0.03, 3), (0.01, 3)].map(|(threshold, depth)| {
        (format!("adaptive {threshold}"), Antialias::Adaptive { threshold, depth })
    });
    grid.into_iter().chain(adaptive).collect()
}

/// Root of the mean square difference of all channels, each clamped to what a screen shows.
fn rms(a: &Picture, b: &Picture) -> f64 {
    let shown = |x: &f32| f64::from(x.clamp(0.0, 1.0));
    let pairs = a.pixels().iter().flatten().zip(b.pixels().iter().flatten());
    let sum: f64 = pairs.map(|(x, y)| (shown(x) - shown(y)) * (shown(x) - shown(y))).sum();
    (sum / (3 * a.pixels().len()) as f64).sqrt()
}

fn load(name: &str) -> Result<(Scene, Settings), String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let bytes = std::fs::read(folder.join(name)).map_err(|e| e.to_string())?;
    let pictures = |path: &str| std::fs::read(folder.join(path)).map_err(|e| e.to_string());
    let loaded = text::load(name, &bytes, &pictures).map_err(|e| e.to_string())?;
    Ok((loaded.scene, loaded.settings))
}

/// Runs the section: table, CSV, plots.
pub fn run(effort: Effort, output: &mut Output) {
    let size = match effort {
        Effort::Quick => 120,
        Effort::Full => 400,
    };
    let mut table = Table::new(
        "antialias",
        "Anti-aliasing: error against a 16x16 grid",
        &["scene", "method", "rays per pixel", "seconds", "RMS error"],
    );
    let mut series: Vec<Series> = Vec::new();
    for name in SCENES {
        let (scene, settings) = match load(name) {
            Ok(loaded) => loaded,
            Err(error) => {
                output.demand(false, || format!("{name}: {error}"));
                continue;
            }
        };
        let draw = |antialias| {
            let mut settings = settings;
            (settings.width, settings.height, settings.antialias) = (size, size, antialias);
            let start = Instant::now();
            let rendering = rt_shade::render(&scene, &settings, &());
            rendering.map(|r| (r.picture, r.stats.eye_rays as f64, start.elapsed().as_secs_f64()))
        };
        let Ok((reference, _, _)) = draw(Antialias::Grid(16)) else {
            output.demand(false, || format!("{name}: the reference cannot be rendered"));
            continue;
        };
        let mut errors = Vec::new();
        for (method, antialias) in methods() {
            let Ok((picture, rays, seconds)) = draw(antialias) else { continue };
            let per_pixel = rays / f64::from(size * size);
            let error = rms(&picture, &reference);
            errors.push((method.clone(), error));
            table.row([name.into(), method.clone(), brief(per_pixel), brief(seconds), brief(error)]);
            let kind = if method.starts_with("adaptive") { "adaptive" } else { "grid" };
            let series_name = format!("{}, {kind}", name.trim_end_matches(".toml"));
            match series.iter_mut().find(|s| s.name == series_name) {
                Some(s) => s.points.push((per_pixel, error, method)),
                None => series.push(Series { name: series_name, points: vec![(per_pixel, error, method)] }),
            }
        }
        // More samples must not be worse: a picture that is wrong as a whole would break this order.
        let grids: Vec<f64> = errors.iter().filter(|e| !e.0.starts_with("adaptive")).map(|e| e.1).collect();
        output.demand(grids.windows(2).all(|w| w[1] < w[0]), || {
            format!("{name}: errors {grids:?} do not fall")
        });
    }
    output.table(table);
    output.plot("antialias", |path| {
        lines(
            path,
            "Anti-aliasing: rays against error",
            "rays per pixel",
            "RMS error against 16x16 samples, linear light",
            &series,
        )
    });
}
