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
    levels: Vec<Level>,
    pub stats: Stats,
}

/// Rays of one depth that are being followed, some at a time.
struct Level {
    onward: Onward,
    /// What was known of media before.
    known: usize,
    /// The rays from `start` to `end` are those whose own rays are on their way; those before are done.
    start: usize,
    end: usize,
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
            levels: Vec::new(),
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
            self.see(rays, found, path, colors);
        }
    }

    /// Whether shadow rays wait to be cast together. Lamps that hold what they see ask for no search, and what is behind glass
    /// is searched otherwise.
    fn casts_together(&self) -> bool {
        self.shadows && self.scene.all_opaque && self.scene.seen_by_lamp.iter().any(Option::is_none)
    }

    /// The colours that some rays from the eye see.
    ///
    /// Depth first, some rays at a time, so that little waits; not by recursion, as a depth of a thousand is legal.
    fn see(&mut self, rays: &[Ray], found: &[Option<Found>], path: Path, colors: &mut [Color]) {
        let mut levels = take(&mut self.levels);
        levels.extend(self.light(rays, found, Paths::Alike(path), 1, colors));
        loop {
            let depth = levels.len() as u32 + 1;
            let Some(level) = levels.last_mut() else { break };
            let Rays { rays, found, paths, colors: seen, .. } = &mut level.onward.rays;
            if level.end < rays.len() {
                (level.start, level.end) = (level.end, (level.end + TOGETHER).min(rays.len()));
                let part = level.start..level.end;
                let (rays, found) = (&rays[part.clone()], &found[part.clone()]);
                let paths = Paths::Each(&paths[part.clone()]);
                let next = self.light(rays, found, paths, depth, &mut seen[part]);
                levels.extend(next);
                continue;
            }
            let Some(Level { onward, known, .. }) = levels.pop() else { break };
            let colors = match levels.last_mut() {
                Some(Level { onward, start, end, .. }) => &mut onward.rays.colors[*start..*end],
                None => &mut *colors,
            };
            self.bring(&onward.rays, colors);
            self.media.forget(known);
            self.onward.push(onward);
        }
        self.levels = levels;
    }

    /// Adds what rays bring to the colours of those that they come from: first what all bring to a colour, then that to the
    /// colour itself, local + (R mirror + T refracted).
    fn bring(&mut self, rays: &Rays, colors: &mut [Color]) {
        self.brought.clear();
        self.brought.resize(colors.len(), Color::BLACK);
        for (path, seen) in rays.paths.iter().zip(&rays.colors) {
            self.brought[path.parent as usize] += path.share * *seen;
        }
        for (color, brought) in colors.iter_mut().zip(&self.brought) {
            *color += *brought;
        }
    }

    /// The colours of what rays of a depth hit, but for what rays bring that go on: these, if there are any.
    fn light(
        &mut self,
        rays: &[Ray],
        found: &[Option<Found>],
        paths: Paths,
        depth: u32,
        colors: &mut [Color],
    ) -> Option<Level> {
        let (mut surfaces, mut hits, mut queues) =
            (take(&mut self.surfaces), take(&mut self.hits), take(&mut self.queues));
        let mut onward = self.onward.pop().unwrap_or_default();
        onward.clear();
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
        onward.merge();
        let Rays { rays, within, from, found, colors, .. } = &mut onward.rays;
        if rays.is_empty() {
            self.onward.push(onward);
            return None;
        }
        found.clear();
        found.resize(rays.len(), None);
        scene.geometry.nearest_leaving_many(rays, within, from, found);
        self.stats.secondary_hits += found.iter().flatten().count() as u64;
        colors.clear();
        colors.resize(rays.len(), Color::BLACK);
        Some(Level { onward, known, start: 0, end: 0 })
    }
}

#[cfg(test)]
mod tests {
    use crate::{Antialias, Attenuation, Camera, Light, Material, Scene, Settings, render};
    use rt_core::shape::Sphere;

    /// The greatest legal depth is reached, on a thread of the usual stack.
    #[test]
    fn a_thousand_reflections() {
        let mirror = Material { reflect: 0.999, ..Material::default() };
        let scene = Scene::builder()
            .camera(Camera::new([0.0; 3], [0.0, 0.1, 1.0], [0.0, 1.0, 0.0], 60.0).unwrap())
            .light(Light::point([0.0, 1.0, 0.0], [0.9; 3], Attenuation::NONE).unwrap())
            .object("inside", Sphere::new([0.0; 3], 3.0).unwrap(), mirror)
            .build()
            .unwrap();
        let settings = Settings {
            width: 8,
            height: 8,
            max_depth: Settings::MOST_DEPTH,
            antialias: Antialias::None,
            threads: 1,
            ..Settings::default()
        };
        let done = render(&scene, &settings, &()).unwrap();
        assert_eq!(done.stats.reflected_rays, 64 * u64::from(Settings::MOST_DEPTH - 1));
    }
}
