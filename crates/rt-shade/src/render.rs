//! Tiles over threads.

use crate::guard::{self, Fault};
use crate::whitted::Tracer;
use crate::{Antialias, Error, Picture, Region, Scene, Settings, Stats, adaptive, sample};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Hears how far a rendering is, and can end it. `&()` hears nothing; an [`AtomicBool`] ends it when set.
pub trait Progress: Sync {
    /// Called after each tile, from any thread: how many of how many steps are done, and the rays traced so far.
    fn tile(&self, done: u64, total: u64, rays: u64) {
        let _ = (done, total, rays);
    }

    /// Asked before each tile: whether to stop. Tiles in flight are finished.
    fn cancelled(&self) -> bool {
        false
    }
}

impl Progress for () {}

impl Progress for AtomicBool {
    fn cancelled(&self) -> bool {
        self.load(Ordering::Relaxed)
    }
}

/// What came out.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Rendering {
    /// The picture of the region; tiles that were not finished are black.
    pub picture: Picture,
    /// Where it lies in the whole picture.
    pub region: Region,
    /// The counters.
    pub stats: Stats,
    /// Whether every tile was finished.
    pub complete: bool,
}

/// Renders the scene.
///
/// # Errors
/// What [`Settings::check`] finds; [`Error::Object`] when a shape or texture of your own panics or returns NaN;
/// [`Error::Threads`]; [`Error::Memory`].
pub fn render(scene: &Scene, settings: &Settings, progress: &dyn Progress) -> Result<Rendering, Error> {
    settings.check()?;
    let region = settings.extent();
    // First, so that a picture too large ends here; the memory itself is used when the tiles are done.
    let room = Picture::reserve(region.width, region.height)?;
    let edge = match settings.antialias {
        Antialias::Adaptive { depth, .. } => adaptive::tile_edge(depth),
        _ => settings.tile,
    };
    let tiles = tiles(region, edge);
    let count = Count { done: AtomicU64::new(0), rays: AtomicU64::new(0), total: tiles.len() as u64 };
    let workers = Workers(Mutex::new(Vec::new()));
    let work = |tile: &Region| -> Option<Result<Tile, Fault>> {
        if progress.cancelled() {
            return None;
        }
        let done = workers.finish(scene, settings, *tile);
        let rays = done.as_ref().map_or(0, |tile| tile.stats.rays());
        let rays = count.rays.fetch_add(rays, Ordering::Relaxed) + rays;
        let done_now = count.done.fetch_add(1, Ordering::Relaxed) + 1;
        progress.tile(done_now, count.total, rays);
        Some(done)
    };
    let finished = on_threads(settings.threads, &tiles, work)?;
    let mut picture = Picture::within(room, region.width, region.height);
    let (mut stats, mut complete) = (Stats::default(), true);
    for (place, tile) in tiles.iter().zip(finished) {
        match tile {
            None => complete = false,
            Some(Err(fault)) => {
                let name = scene.objects.get(fault.object as usize).map(|o| o.name.clone());
                return Err(Error::Object { object: name.unwrap_or_default(), reason: fault.reason });
            }
            Some(Ok(tile)) => {
                stats += tile.stats;
                let rows = tile.pixels.chunks_exact(place.width as usize);
                for (y, row) in (place.y - region.y..).zip(rows) {
                    let start = y as usize * region.width as usize + (place.x - region.x) as usize;
                    picture.pixels_mut()[start..start + row.len()].copy_from_slice(row);
                }
            }
        }
    }
    Ok(Rendering { picture, region, stats, complete })
}

struct Count {
    done: AtomicU64,
    rays: AtomicU64,
    total: u64,
}

struct Tile {
    pixels: Vec<[f32; 3]>,
    stats: Stats,
}

/// The tiles of a region, row by row.
fn tiles(region: Region, edge: u32) -> Vec<Region> {
    let mut tiles = Vec::new();
    for y in (0..region.height).step_by(edge as usize) {
        for x in (0..region.width).step_by(edge as usize) {
            let (width, height) = (edge.min(region.width - x), edge.min(region.height - y));
            tiles.push(Region { x: region.x + x, y: region.y + y, width, height });
        }
    }
    tiles
}

/// What a thread works with, kept from tile to tile: memory that was used before is faster than new one.
struct Worker<'s> {
    tracer: Tracer<'s>,
    samples: sample::Buffers,
    corners: adaptive::Buffers,
}

/// The workers that have nothing to do.
struct Workers<'s>(Mutex<Vec<Worker<'s>>>);

impl<'s> Workers<'s> {
    fn idle(&self) -> MutexGuard<'_, Vec<Worker<'s>>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn finish(&self, scene: &'s Scene, settings: &Settings, tile: Region) -> Result<Tile, Fault> {
        let idle = self.idle().pop();
        let mut worker = idle.unwrap_or_else(|| Worker {
            tracer: Tracer::new(scene, settings),
            samples: sample::Buffers::default(),
            corners: adaptive::Buffers::default(),
        });
        let Worker { tracer, samples, corners } = &mut worker;
        let mut pixels = Vec::with_capacity(tile.width as usize * tile.height as usize);
        guard::take();
        match settings.antialias {
            Antialias::Adaptive { threshold, depth } => {
                let how = (threshold, depth);
                adaptive::tile(tracer, corners, &scene.camera, settings, how, tile, &mut pixels);
            }
            _ => sample::tile(tracer, samples, &scene.camera, settings, tile, &mut pixels),
        }
        if let Some(fault) = guard::take() {
            return Err(fault);
        }
        let stats = core::mem::take(&mut tracer.stats);
        self.idle().push(worker);
        Ok(Tile { pixels, stats })
    }
}

/// Does the work for every tile, in any order, and returns the results in the order of the tiles.
#[cfg(feature = "rayon")]
fn on_threads<T: Send>(
    threads: usize,
    tiles: &[Region],
    work: impl Fn(&Region) -> T + Sync,
) -> Result<Vec<T>, Error> {
    use rayon::prelude::*;
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|e| Error::Threads { threads, reason: e.to_string() })?;
    Ok(pool.install(|| tiles.par_iter().with_max_len(1).map(&work).collect()))
}

/// Does the work for every tile.
#[cfg(not(feature = "rayon"))]
fn on_threads<T: Send>(
    _threads: usize,
    tiles: &[Region],
    work: impl Fn(&Region) -> T + Sync,
) -> Result<Vec<T>, Error> {
    Ok(tiles.iter().map(work).collect())
}
