//! Whitted's shading (doi:10.1145/358876.358882): the light of lamps that a surface sees, and what its mirror and its
//! glass see.
//!
//! ```text
//! colour = local + R mirror + (1 - R) transmit refracted,   R = reflect + (1 - reflect) F
//! local  = ambient diffuse paint + sum over lamps of
//!          share attenuation visibility lamp (diffuse paint cos + specular cos_mirror^shininess)
//! ```
//!
//! Light is only added, never taken away: two shadows that overlap are as dark as one. The sum is taken in the order of
//! the lamps.

use crate::lighting::{LightMany, Paths, ShadowQueue, Struck};
use crate::medium::{Around, Media};
use crate::onward::{Onward, Path, Rays};
use crate::{Color, Scene, Settings, Stats};
use core::mem::take;
use rt_core::glam::DVec3;
use rt_core::kernel::vectorize;
use rt_core::{Found, Interval, Ray, Surface};

/// Traces rays through a scene, one thread's worth.
pub(crate) struct Tracer<'s> {
    pub scene: &'s Scene,
    pub shadows: bool,
    max_depth: u32,
    pub cutoff: f64,
    pub media: Media,
    around_eye: Around,
    /// What a shadow ray crossed: kept to be multiplied in an order that does not depend on the search.
    pub filters: Vec<Color>,
    /// By lamp.
    queues: Vec<ShadowQueue>,
    /// Room that is used again: the records of hits, the hits, what rays bring, and the rays that go on.
    surfaces: Vec<Surface>,
    hits: Vec<Struck>,
    brought: Vec<Color>,
    onward: Vec<Onward>,
    pub stats: Stats,
}

/// As many records of hits as stay in the first cache until they are used.
const NEAR: usize = 64;

/// The most rays that are followed together, unless their shadow rays are cast together: those that wait, two a ray at most and
/// some 260 bytes each, then take less than 70 kB for each depth. Only time depends on it: with 1024, which do not stay in the
/// cache over eight depths, the family takes 1.02 to 1.05 times as long.
const TOGETHER: usize = 128;

impl<'s> Tracer<'s> {
    pub fn new(scene: &'s Scene, settings: &Settings) -> Self {
        let mut media = Media::default();
        let around_eye = media.add(&scene.around_eye);
        Tracer {
            scene,
            max_depth: settings.max_depth,
            shadows: settings.shadows,
            cutoff: settings.cutoff,
            media,
            around_eye,
            filters: Vec::new(),
            queues: scene.lights.iter().map(|_| ShadowQueue::default()).collect(),
            surfaces: Vec::new(),
            hits: Vec::new(),
            brought: Vec::new(),
            onward: Vec::new(),
            stats: Stats::default(),
        }
    }

    /// The nearest hits of rays from the eye.
    pub fn nearest_many(&self, rays: &[Ray], within: &[Interval], found: &mut [Option<Found>]) {
        let scene = self.scene;
        match &scene.seen_by_eye {
            Some(cube) => scene.geometry.nearest_from_many(cube, rays, within, found),
            None => scene.geometry.nearest_many(rays, within, found),
        }
    }

    /// The colours that rays from the eye see, whose nearest hits are known. They are those that each sees alone.
    pub fn seen_by_eye(&mut self, rays: &[Ray], found: &[Option<Found>], colors: &mut Vec<Color>) {
        colors.clear();
        colors.resize(rays.len(), Color::BLACK);
        self.stats.eye_rays += rays.len() as u64;
        self.stats.eye_hits += found.iter().flatten().count() as u64;
        let path = Path { parent: 0, share: Color::WHITE, weight: 1.0, around: self.around_eye };
        let count = if self.casts_together() { rays.len().max(1) } else { TOGETHER };
        let parts = rays.chunks(count).zip(found.chunks(count)).zip(colors.chunks_mut(count));
        for ((rays, found), colors) in parts {
            self.see(rays, found, Paths::Alike(path), 1, colors);
        }
    }

    /// Whether shadow rays wait to be cast together. Lamps that hold what they see ask for no search, and what is behind glass
    /// is searched otherwise.
    fn casts_together(&self) -> bool {
        self.shadows && self.scene.all_opaque && self.scene.seen_by_lamp.iter().any(Option::is_none)
    }

    /// The colours that rays of a depth see.
    fn see(&mut self, rays: &[Ray], found: &[Option<Found>], paths: Paths, depth: u32, colors: &mut [Color]) {
        let (mut surfaces, mut hits, mut queues) =
            (take(&mut self.surfaces), take(&mut self.hits), take(&mut self.queues));
        let mut onward = self.onward.pop().unwrap_or_default();
        let known = self.media.mark();
        let scene = self.scene;
        let cast_together = self.casts_together();
        let goes_on = depth < self.max_depth;
        surfaces.resize(NEAR, Surface::new(0.0, DVec3::ZERO, DVec3::ZERO, DVec3::Y, 0.0));
        let parts = rays.chunks(NEAR).zip(found.chunks(NEAR)).zip(colors.chunks_mut(NEAR));
        for (part, ((rays, found), colors)) in parts.enumerate() {
            scene.geometry.surface_many(rays, found, &mut surfaces);
            hits.clear();
            for (number, (found, color)) in found.iter().zip(&mut *colors).enumerate() {
                match *found {
                    Some(found) => hits.push(Struck { number, found }),
                    None => *color = scene.background,
                }
            }
            vectorize(LightMany {
                tracer: self,
                start: part * NEAR,
                rays,
                surfaces: &surfaces,
                hits: &hits,
                colors,
                queues: cast_together.then_some(&mut queues[..]),
                paths: paths.part(part * NEAR, rays.len()),
                onward: goes_on.then_some(&mut onward),
            });
        }
        for queue in &mut queues {
            queue.cast(&scene.geometry, &mut self.stats, colors);
        }
        (self.surfaces, self.hits, self.queues) = (surfaces, hits, queues);
        self.follow(onward.all(), depth + 1, colors);
        onward.clear();
        self.onward.push(onward);
        self.media.forget(known);
    }

    /// Adds what rays bring to the colours of those that they come from.
    fn follow(&mut self, onward: &mut Rays, depth: u32, colors: &mut [Color]) {
        let Rays { rays, within, from, paths, found, colors: seen } = onward;
        if rays.is_empty() {
            return;
        }
        found.clear();
        found.resize(rays.len(), None);
        self.scene.geometry.nearest_leaving_many(rays, within, from, found);
        self.stats.secondary_hits += found.iter().flatten().count() as u64;
        seen.clear();
        seen.resize(rays.len(), Color::BLACK);
        let parts = rays.chunks(TOGETHER).zip(found.chunks(TOGETHER)).zip(paths.chunks(TOGETHER));
        for (((rays, found), paths), colors) in parts.zip(seen.chunks_mut(TOGETHER)) {
            self.see(rays, found, Paths::Each(paths), depth, colors);
        }
        // First what all rays bring to a colour, then the colour itself: local + (R mirror + T refracted).
        self.brought.clear();
        self.brought.resize(colors.len(), Color::BLACK);
        for (path, seen) in paths.iter().zip(seen) {
            self.brought[path.parent as usize] += path.share * *seen;
        }
        for (color, brought) in colors.iter_mut().zip(&self.brought) {
            *color += *brought;
        }
    }
}
