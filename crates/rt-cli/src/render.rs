//! `rt render`: a scene becomes a picture file.

use crate::failure::Failure;
use crate::interrupt;
use crate::output::Output;
use crate::picture_file::{self, Format};
use crate::place::{self, Part, Place};
use crate::progress::{self, Listener, Mode};
use crate::scene_file::{self, Loaded};
use rt_shade::{Antialias, Region, Rendering, Settings};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// The options of `rt render`.
#[derive(clap::Args)]
pub struct Options {
    /// The scene, .toml or .nff; `-` reads TOML from standard input
    scene: PathBuf,
    /// The picture: .png (8 bits, sRGB) or .pfm (32-bit floats, linear); `-` writes PNG to standard output
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
    /// Columns, instead of those of the scene
    #[arg(long, value_name = "PIXELS", allow_negative_numbers = true)]
    width: Option<u32>,
    /// Rows, instead of those of the scene
    #[arg(long, value_name = "PIXELS", allow_negative_numbers = true)]
    height: Option<u32>,
    /// Anti-aliasing: none, grid:N, adaptive or adaptive:THRESHOLD:DEPTH
    #[arg(long, value_name = "HOW")]
    aa: Option<Antialias>,
    /// How many threads; 0 takes as many as the machine has. The picture is the same bits for any number
    #[arg(long, value_name = "N", default_value_t = 0, allow_negative_numbers = true)]
    threads: usize,
    /// The depth of the deepest rays: the eye ray is depth 1, what would be deeper is black
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    max_depth: Option<u32>,
    /// Leave out all shadows
    #[arg(long)]
    no_shadows: bool,
    /// One ray through each corner of the raster: a picture of one column and one row more
    #[arg(long, conflicts_with = "aa")]
    corners: bool,
    /// Only these pixels, columns and rows counted from 0 at the top left; the picture has the region's size
    #[arg(long, value_name = "X,Y,W,H", value_parser = parse_region)]
    region: Option<Region>,
    /// Only part K of N, for `rt stitch`
    #[arg(long, value_name = "K/N")]
    tile: Option<Part>,
    /// Write counts and times to this file, as JSON
    #[arg(long, value_name = "FILE")]
    stats: Option<PathBuf>,
    /// How progress is shown on standard error
    #[arg(long, value_enum, value_name = "HOW", default_value = "auto")]
    progress: Mode,
    /// Say nothing but errors
    #[arg(short, long)]
    quiet: bool,
}

fn parse_region(text: &str) -> Result<Region, String> {
    let numbers: Result<Vec<u32>, _> = text.split(',').map(|number| number.trim().parse()).collect();
    match numbers.as_deref() {
        Ok(&[x, y, width, height]) => Ok(Region { x, y, width, height }),
        _ => Err("expected X,Y,WIDTH,HEIGHT in pixels, such as 0,0,100,50".into()),
    }
}

/// How long each stage took.
#[derive(Clone, Copy, Default)]
struct Times {
    load: Duration,
    build: Duration,
    trace: Duration,
    write: Duration,
}

/// Renders.
pub fn run(options: &Options) -> Result<(), Failure> {
    let format = Format::of(&options.output)?;
    interrupt::install()?;
    let output = Output::check(&options.output)?;
    let stats_output = options.stats.as_deref().map(Output::check).transpose()?;
    refuse_overlap(options, &output, stats_output.as_ref())?;

    let loaded = scene_file::load(&options.scene)?;
    let (settings, part) = settings(options, &loaded)?;

    let extent = settings.extent();
    picture_file::check_memory(extent.width, extent.height)?;

    let listener = Listener::new(options.progress, options.quiet);
    interrupt::rendering();
    let start = Instant::now();
    let rendering = rt_shade::render(&loaded.scene, &settings, &listener);
    let trace = start.elapsed();
    listener.finish();
    let rendering = rendering.map_err(|error| Failure::Work(error.to_string()))?;

    let start = Instant::now();
    let mut bytes = picture_file::encode(&rendering.picture, format)?;
    if let Some(part) = part {
        let whole = Settings { region: options.region, ..settings }.extent();
        let picture = fingerprint(options, &settings, &loaded);
        let finished = rendering.complete;
        Place { part, width: whole.width, height: whole.height, picture, finished }.attach(&mut bytes);
    }
    output.write(&bytes)?;
    let times = Times { load: loaded.load, build: loaded.build, trace, write: start.elapsed() };
    if let Some(target) = stats_output {
        target.write(stats(&loaded, &settings, &rendering, times).as_bytes())?;
    }
    if listener.talks() {
        let _ = writeln!(std::io::stderr(), "{}", summary(options, &rendering, times));
    }
    match interrupt::signal() {
        Some(signal) => Err(Failure::Interrupted(signal)),
        None => Ok(()),
    }
}

/// The scene must not be overwritten, nor one output by the other.
fn refuse_overlap(options: &Options, output: &Output, stats: Option<&Output>) -> Result<(), Failure> {
    let real = |path: &Path| std::fs::canonicalize(path).ok();
    let scene = real(&options.scene);
    for target in [Some(output), stats].into_iter().flatten() {
        if let Some(file) = target.file()
            && scene.is_some()
            && real(file) == scene
        {
            return Err(Failure::Usage(format!("{} is the scene itself: name another file", file.display())));
        }
    }
    let clash = match (output, stats) {
        (Output::Stdout, Some(Output::Stdout)) => true,
        (output, Some(stats)) => output.file().is_some() && output.file() == stats.file(),
        _ => false,
    };
    if clash {
        return Err(Failure::Usage("the picture and --stats need different outputs".into()));
    }
    Ok(())
}

/// The scene's settings with those of the command line over them, and the part to render.
fn settings(options: &Options, loaded: &Loaded) -> Result<(Settings, Option<Part>), Failure> {
    let mut settings = loaded.settings;
    settings.width = options.width.unwrap_or(settings.width);
    settings.height = options.height.unwrap_or(settings.height);
    settings.max_depth = options.max_depth.unwrap_or(settings.max_depth);
    settings.antialias = options.aa.unwrap_or(settings.antialias);
    if options.corners {
        settings.antialias = Antialias::None;
    }
    settings.threads = options.threads;
    settings.shadows = !options.no_shadows;
    settings.corners = options.corners;
    settings.region = options.region;
    // What the scene says has been checked: only the command line can be wrong here.
    let usage = |error: rt_shade::Error| Failure::Usage(error.to_string());
    settings.check().map_err(usage)?;
    if let Some(part) = options.tile {
        let whole = settings.extent();
        let region = part.region(whole).ok_or_else(|| {
            Failure::Usage(format!(
                "--tile {part}: a picture of {} rows has no {} parts",
                whole.height, part.of
            ))
        })?;
        settings.region = Some(region);
        settings.check().map_err(usage)?;
    }
    Ok((settings, options.tile))
}

/// What the parts of one picture have in common: the scene's text and every setting that pixels depend on.
fn fingerprint(options: &Options, settings: &Settings, loaded: &Loaded) -> u64 {
    let Settings { width, height, max_depth, antialias, shadows, corners, cutoff, .. } = *settings;
    let region = options.region;
    let words = format!("{width} {height} {max_depth} {antialias} {shadows} {corners} {cutoff} {region:?}");
    place::mix(loaded.hash, words.as_bytes())
}

/// What `--stats` writes.
#[derive(serde::Serialize)]
struct Report {
    eye_rays: u64,
    eye_hits: u64,
    shadow_rays: u64,
    shadow_hits: u64,
    reflected_rays: u64,
    refracted_rays: u64,
    secondary_hits: u64,
    primitives: usize,
    lights: usize,
    threads: usize,
    load_s: f64,
    build_s: f64,
    trace_s: f64,
    write_s: f64,
    width: u32,
    height: u32,
    complete: bool,
}

fn stats(loaded: &Loaded, settings: &Settings, rendering: &Rendering, times: Times) -> String {
    let counts = &rendering.stats;
    let threads = match settings.threads {
        0 => std::thread::available_parallelism().map_or(1, usize::from),
        n => n,
    };
    let seconds = |time: Duration| time.as_secs_f64();
    let report = Report {
        eye_rays: counts.eye_rays,
        eye_hits: counts.eye_hits,
        shadow_rays: counts.shadow_rays,
        shadow_hits: counts.shadow_hits,
        reflected_rays: counts.reflected_rays,
        refracted_rays: counts.refracted_rays,
        secondary_hits: counts.secondary_hits,
        primitives: loaded.scene.geometry().shapes().len(),
        lights: loaded.scene.lights().len(),
        threads,
        load_s: seconds(times.load),
        build_s: seconds(times.build),
        trace_s: seconds(times.trace),
        write_s: seconds(times.write),
        width: rendering.picture.width(),
        height: rendering.picture.height(),
        complete: rendering.complete,
    };
    // Numbers alone: nothing in it can fail to be written.
    serde_json::to_string_pretty(&report).map(|json| json + "\n").unwrap_or_default()
}

fn summary(options: &Options, rendering: &Rendering, times: Times) -> String {
    let (width, height) = (rendering.picture.width(), rendering.picture.height());
    let rays = rendering.stats.rays();
    let rate = progress::rate(rays, times.trace);
    let state = if rendering.complete { "" } else { " (interrupted: unfinished tiles are black)" };
    let total = (times.load + times.build + times.trace + times.write).as_secs_f64();
    let name = match options.output.to_str() {
        Some("-") => "standard output".into(),
        _ => options.output.display().to_string(),
    };
    format!("{name}: {width} x {height} pixels{state}, {rays} rays, {rate}, {total:.2} s in all")
}
