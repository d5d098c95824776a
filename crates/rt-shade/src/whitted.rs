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

use crate::highlight::power;
use crate::material::{Optics, Paint};
use crate::medium::{Media, Medium};
use crate::optics::{Refraction, mirror, refract};
use crate::{Color, Light, Material, Scene, Settings, Stats};
use rt_core::glam::DVec3;
use rt_core::kernel::{Product, Task, run};
use rt_core::{Departure, DirectionCube, Found, Interval, Ray, Side, Surface};

/// Traces rays through a scene, one thread's worth.
pub(crate) struct Tracer<'s> {
    scene: &'s Scene,
    max_depth: u32,
    shadows: bool,
    cutoff: f64,
    media: Media,
    /// What a shadow ray crossed: kept to be multiplied in an order that does not depend on the search.
    filters: Vec<Color>,
    /// By lamp.
    queues: Vec<ShadowQueue>,
    pub stats: Stats,
}

/// How many hits ahead of its record the memory of an object is asked for. Only time depends on it: the records of four take
/// longer than a fetch from memory, some 100 ns.
const AHEAD: usize = 4;

/// Shadow rays of many points to one lamp, to be cast together.
#[derive(Default)]
struct ShadowQueue {
    rays: Vec<Ray>,
    within: Vec<Interval>,
    from: Vec<Departure>,
    blocked: Vec<bool>,
    /// The number of the point that each ray leaves, and what the lamp adds to its colour.
    gifts: Vec<(usize, Gift)>,
}

impl ShadowQueue {
    fn clear(&mut self) {
        self.rays.clear();
        self.within.clear();
        self.from.clear();
        self.blocked.clear();
        self.gifts.clear();
    }
}

/// The light of one lamp at a point, before it is known whether anything is in the way.
struct Arriving {
    to_light: DVec3,
    cosine: f64,
    color: Color,
}

/// What a lamp adds to the colour of a point: by its body, and by its gloss where it has one.
#[derive(Clone, Copy)]
struct Gift {
    body: Color,
    gloss: Option<Color>,
}

impl Gift {
    fn add_to(&self, sum: &mut Color) {
        *sum += self.body;
        if let Some(gloss) = self.gloss {
            *sum += gloss;
        }
    }
}

/// A point that a ray hit, with all that spawned rays need.
struct Vertex<'s> {
    found: Found,
    surface: Surface,
    /// The unit direction of the ray that arrived.
    direction: DVec3,
    /// The shading normal, on the side of arrival.
    normal: DVec3,
    /// The side of arrival.
    side: Side,
    material: &'s Material,
}

/// The colour of a hit: a task, so that all that is inlined into it is compiled for the instruction set in use.
struct Shade<'a, 's> {
    tracer: &'a mut Tracer<'s>,
    ray: &'a Ray,
    found: Found,
    depth: u32,
    weight: f64,
}

impl Task for Shade<'_, '_> {
    type Output = Color;
    #[inline(always)]
    fn run<P: Product>(self) -> Color {
        self.tracer.shade_here(self.ray, self.found, self.depth, self.weight)
    }
}

/// The first half of a colour: all but the light of the lamps and what rays bring that go on.
struct Enqueue<'a, 's> {
    tracer: &'a Tracer<'s>,
    ray: &'a Ray,
    found: Found,
    number: usize,
    queues: &'a mut [ShadowQueue],
}

impl<'s> Task for Enqueue<'_, 's> {
    type Output = (Color, Vertex<'s>);
    #[inline(always)]
    fn run<P: Product>(self) -> Self::Output {
        let vertex = self.tracer.vertex(self.ray, self.found);
        (self.tracer.enqueue(&vertex, self.number, self.queues), vertex)
    }
}

/// The second: what rays bring that go on.
struct Spawn<'a, 's> {
    tracer: &'a mut Tracer<'s>,
    local: Color,
    vertex: &'a Vertex<'s>,
}

impl Task for Spawn<'_, '_> {
    type Output = Color;
    #[inline(always)]
    fn run<P: Product>(self) -> Color {
        self.tracer.with_spawned(self.local, self.vertex, 1, 1.0)
    }
}

/// The ray from a surface to a lamp, at which it ends.
#[inline(always)]
fn shadow_ray(from: &Departure, lamp: DVec3) -> (Ray, Interval) {
    let start = from.ray(DVec3::ZERO).0.origin;
    (Ray::new(start, lamp - start), Interval::new(0.0, 1.0))
}

impl<'s> Tracer<'s> {
    pub fn new(scene: &'s Scene, settings: &Settings) -> Self {
        let mut media = Media::default();
        media.reset(&scene.around_eye);
        Tracer {
            scene,
            max_depth: settings.max_depth,
            shadows: settings.shadows,
            cutoff: settings.cutoff,
            media,
            filters: Vec::new(),
            queues: scene.lights.iter().map(|_| ShadowQueue::default()).collect(),
            stats: Stats::default(),
        }
    }

    /// The colour that a ray from the eye sees.
    pub fn eye(&mut self, ray: &Ray) -> Color {
        let scene = self.scene;
        let found = match &scene.seen_by_eye {
            Some(cube) => scene.geometry.nearest_from(cube, ray, Interval::FORWARD),
            None => scene.geometry.nearest(ray, Interval::FORWARD),
        };
        self.seen_by_eye(ray, found)
    }

    /// The nearest hits of rays from the eye.
    pub fn nearest_many(&self, rays: &[Ray], within: &[Interval], found: &mut [Option<Found>]) {
        let scene = self.scene;
        match &scene.seen_by_eye {
            Some(cube) => scene.geometry.nearest_from_many(cube, rays, within, found),
            None => scene.geometry.nearest_many(rays, within, found),
        }
    }

    /// The same for a ray whose nearest hit is known.
    pub fn seen_by_eye(&mut self, ray: &Ray, found: Option<Found>) -> Color {
        self.stats.eye_rays += 1;
        match found {
            None => self.scene.background,
            Some(found) => {
                self.stats.eye_hits += 1;
                self.shade(ray, found, 1, 1.0)
            }
        }
    }

    /// The colour of a hit.
    fn shade(&mut self, ray: &Ray, found: Found, depth: u32, weight: f64) -> Color {
        run(Shade { tracer: self, ray, found, depth, weight })
    }

    #[inline(always)]
    fn shade_here(&mut self, ray: &Ray, found: Found, depth: u32, weight: f64) -> Color {
        let vertex = self.vertex(ray, found);
        let local = self.local(&vertex);
        self.with_spawned(local, &vertex, depth, weight)
    }

    /// The colours that rays from the eye see, whose nearest hits are known: the same as
    /// [`seen_by_eye`](Tracer::seen_by_eye) for each, with the shadow rays of the first hits cast together.
    pub fn all_seen_by_eye(&mut self, rays: &[Ray], all_found: &[Option<Found>], colors: &mut Vec<Color>) {
        colors.clear();
        // Lamps that hold what they see ask for no search, and what is behind glass is searched otherwise.
        let searched = self.scene.all_opaque && self.scene.seen_by_lamp.iter().any(Option::is_none);
        if !(searched && self.shadows) {
            colors.extend(rays.iter().zip(all_found).map(|(ray, found)| self.seen_by_eye(ray, *found)));
            return;
        }
        let mut queues = core::mem::take(&mut self.queues);
        let mut spawning = Vec::new();
        for (number, (ray, found)) in rays.iter().zip(all_found).enumerate() {
            self.stats.eye_rays += 1;
            if let Some(Some(soon)) = all_found.get(number + AHEAD) {
                self.scene.geometry.prefetch(*soon);
            }
            let Some(found) = *found else {
                colors.push(self.scene.background);
                continue;
            };
            self.stats.eye_hits += 1;
            let (color, vertex) = run(Enqueue { tracer: self, ray, found, number, queues: &mut queues });
            colors.push(color);
            if self.spawns(&vertex, 1) {
                spawning.push((number, vertex));
            }
        }
        for queue in &mut queues {
            self.stats.shadow_rays += queue.rays.len() as u64;
            queue.blocked.resize(queue.rays.len(), false);
            let ShadowQueue { rays, within, from, blocked, gifts } = queue;
            self.scene.geometry.occluded_leaving_many(rays, within, from, blocked);
            for ((number, gift), blocked) in gifts.iter().zip(blocked) {
                if *blocked {
                    self.stats.shadow_hits += 1;
                } else if let Some(color) = colors.get_mut(*number) {
                    gift.add_to(color);
                }
            }
            queue.clear();
        }
        self.queues = queues;
        for (number, vertex) in spawning {
            colors[number] = run(Spawn { tracer: self, local: colors[number], vertex: &vertex });
        }
    }

    /// The record of a hit.
    #[inline(always)]
    fn vertex(&self, ray: &Ray, found: Found) -> Vertex<'s> {
        let scene = self.scene;
        let surface = scene.geometry.surface(ray, found);
        let direction = ray.direction.normalize();
        let facing = if direction.dot(surface.shading_normal) > 0.0 {
            -surface.shading_normal
        } else {
            surface.shading_normal
        };
        Vertex {
            found,
            direction,
            normal: facing,
            side: Side::of_arrival(direction, surface.normal),
            material: &scene.materials[scene.material_of[found.object as usize] as usize],
            surface,
        }
    }

    /// Whether rays go on from a point.
    #[inline(always)]
    fn spawns(&self, v: &Vertex, depth: u32) -> bool {
        depth < self.max_depth && !v.material.is_matt()
    }

    /// The colour of a point whose own is known.
    #[inline(always)]
    fn with_spawned(&mut self, local: Color, v: &Vertex, depth: u32, weight: f64) -> Color {
        if self.spawns(v, depth) { local + self.spawned(v, depth, weight) } else { local }
    }

    /// The colour of the surface itself, before it is lit; `None` where it shows none.
    #[inline(always)]
    fn body(&self, v: &Vertex) -> Option<Color> {
        let scene = self.scene;
        let material = v.material;
        if material.diffuse == 0.0 && material.specular == 0.0 {
            return None;
        }
        let paint = match material.paint {
            Paint::Color(color) => color,
            Paint::Texture(texture) => {
                let object = v.found.object;
                let mapping = scene.mappings[object as usize];
                scene.textures[texture as usize].color(&v.surface, mapping, object)
            }
        };
        Some(paint * material.diffuse)
    }

    /// The light of a lamp at a point; `None` where it gives none, whatever is in the way.
    #[inline(always)]
    fn arriving(&self, v: &Vertex, light: &Light) -> Option<Arriving> {
        let to_light = light.position() - v.surface.point;
        let distance = to_light.length();
        let to_light = to_light / distance;
        let cosine = v.normal.dot(to_light);
        // Not `<=`: a lamp at the very point has no direction, NaN, and gives nothing.
        if !(cosine > 0.0) {
            return None;
        }
        let share = light.share(-to_light);
        if share == 0.0 {
            return None;
        }
        let color = light.color() * (share * light.attenuation().at(distance));
        Some(Arriving { to_light, cosine, color })
    }

    /// What the light adds.
    #[inline(always)]
    fn gift(&self, v: &Vertex, body: Color, arriving: &Arriving) -> Gift {
        let Arriving { to_light, cosine, color } = *arriving;
        let mut gift = Gift { body: color * body * cosine, gloss: None };
        if v.material.specular > 0.0 {
            let along = (v.normal * (2.0 * cosine) - to_light).dot(-v.direction);
            if along > 0.0 {
                gift.gloss = Some(color * (v.material.specular * power(along, v.material.shininess)));
            }
        }
        gift
    }

    /// Ambient light and the light of the lamps.
    #[inline(always)]
    fn local(&mut self, v: &Vertex) -> Color {
        let scene = self.scene;
        let Some(body) = self.body(v) else { return Color::BLACK };
        let mut sum = scene.ambient * body;
        let from = v.surface.departure(v.found.object, v.found.hit, v.side);
        for (light, cube) in scene.lights.iter().zip(&scene.seen_by_lamp) {
            let Some(mut arriving) = self.arriving(v, light) else { continue };
            if self.shadows {
                match self.visibility(&from, light.position(), cube.as_ref()) {
                    None => continue,
                    Some(visible) => arriving.color *= visible,
                }
            }
            self.gift(v, body, &arriving).add_to(&mut sum);
        }
        sum
    }

    /// The same with the light of the lamps still to come.
    #[inline(always)]
    fn enqueue(&self, v: &Vertex, number: usize, queues: &mut [ShadowQueue]) -> Color {
        let scene = self.scene;
        let Some(body) = self.body(v) else { return Color::BLACK };
        let from = v.surface.departure(v.found.object, v.found.hit, v.side);
        for (light, queue) in scene.lights.iter().zip(queues) {
            let Some(arriving) = self.arriving(v, light) else { continue };
            let (ray, within) = shadow_ray(&from, light.position());
            queue.rays.push(ray);
            queue.within.push(within);
            queue.from.push(from);
            queue.gifts.push((number, self.gift(v, body, &arriving)));
        }
        scene.ambient * body
    }

    /// What a straight ray to a lamp leaves of its light; `None` when something opaque is in the way.
    #[inline(always)]
    fn visibility(&mut self, from: &Departure, lamp: DVec3, cube: Option<&DirectionCube>) -> Option<Color> {
        self.stats.shadow_rays += 1;
        let scene = self.scene;
        let filters = &mut self.filters;
        filters.clear();
        let transmit = |object: u32| scene.materials[scene.material_of[object as usize] as usize].transmit;
        let mut each = |found: Found| filters.push(transmit(found.object));
        let blocked = match cube {
            Some(cube) => scene.geometry.blocked_towards(cube, from, &scene.screens, &mut each),
            None => {
                let (ray, within) = shadow_ray(from, lamp);
                match scene.all_opaque {
                    true => scene.geometry.occluded_leaving(&ray, within, from),
                    false => scene.geometry.blocked(&ray, within, Some(from), &scene.screens, &mut each),
                }
            }
        };
        if blocked {
            self.stats.shadow_hits += 1;
            return None;
        }
        if filters.len() > 2 {
            // A product of two is the same either way round; more are multiplied in an order of their own.
            filters.sort_unstable_by(|a, b| {
                a.r.total_cmp(&b.r).then(a.g.total_cmp(&b.g)).then(a.b.total_cmp(&b.b))
            });
        }
        Some(filters.iter().fold(Color::WHITE, |product, &left| product * left))
    }

    /// What the mirror ray and the transmitted ray bring.
    #[inline(always)]
    fn spawned(&mut self, v: &Vertex, depth: u32, weight: f64) -> Color {
        let material = v.material;
        let transmits = !material.transmit.is_black();
        let entering = v.side == Side::Outside;
        let key = self.scene.material_of[v.found.object as usize];
        let medium = material.ior.map(|ior| Medium { key, ior });
        // An opaque body with an index is never entered: its back is as good as its front.
        let refraction = match medium {
            None => Refraction::Through { direction: v.direction, reflectance: 0.0 },
            Some(medium) => {
                let boundary = self.media.boundary(medium, entering || !transmits);
                refract(v.direction, v.normal, boundary.from, boundary.to)
            }
        };
        let (reflect, through) = match (material.optics, refraction) {
            (Optics::Fresnel, Refraction::Through { direction, reflectance }) => {
                let reflect = material.reflect + (1.0 - material.reflect) * reflectance;
                (Color::gray(reflect), Some((direction, material.transmit * (1.0 - reflect))))
            }
            (Optics::Fresnel, Refraction::Total) => (Color::WHITE, None),
            (Optics::Plain, Refraction::Through { direction, .. }) => {
                (Color::gray(material.reflect), Some((direction, material.transmit)))
            }
            // The mirror takes the place of the refracted ray.
            (Optics::Plain, Refraction::Total) => (Color::gray(material.reflect) + material.transmit, None),
        };
        let mut sum = Color::BLACK;
        if self.counts(reflect, weight) {
            self.stats.reflected_rays += 1;
            let from = v.surface.departure(v.found.object, v.found.hit, v.side);
            let (ray, within) = from.ray(mirror(v.direction, v.normal));
            sum += reflect * self.follow(&ray, within, &from, depth + 1, weight * reflect.max_channel());
        }
        if let Some((direction, through)) = through
            && self.counts(through, weight)
        {
            self.stats.refracted_rays += 1;
            let change = medium.map(|medium| self.media.cross(medium, entering));
            let from = v.surface.departure(v.found.object, v.found.hit, v.side.other());
            let (ray, within) = from.through(direction);
            sum += through * self.follow(&ray, within, &from, depth + 1, weight * through.max_channel());
            if let Some(change) = change {
                self.media.undo(change);
            }
        }
        sum
    }

    /// Whether a ray of this share is worth tracing.
    fn counts(&self, share: Color, weight: f64) -> bool {
        !share.is_black() && weight * share.max_channel() >= self.cutoff
    }

    /// The colour that a spawned ray sees.
    #[inline(always)]
    fn follow(&mut self, ray: &Ray, within: Interval, from: &Departure, depth: u32, weight: f64) -> Color {
        match self.scene.geometry.nearest_leaving(ray, within, from) {
            None => self.scene.background,
            Some(found) => {
                self.stats.secondary_hits += 1;
                self.shade(ray, found, depth, weight)
            }
        }
    }
}
