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
use rt_core::kernel::{Four, Lanes, Product, Real, Task, Vector, Vectorized, run, vectorize};
use rt_core::{Departure, DirectionCube, Found, Geometry, Interval, Ray, Side, Surface};

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
    /// The records of first hits: room that is used again.
    surfaces: Vec<Surface>,
    pub stats: Stats,
}

/// As many records of hits as stay in the first cache until they are used.
const NEAR: usize = 64;

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
    #[inline(always)]
    fn push(&mut self, number: usize, from: &Departure, lamp: DVec3, gift: Gift) {
        let (ray, within) = shadow_ray(from, lamp);
        self.rays.push(ray);
        self.within.push(within);
        self.from.push(*from);
        self.gifts.push((number, gift));
    }

    fn clear(&mut self) {
        self.rays.clear();
        self.within.clear();
        self.from.clear();
        self.blocked.clear();
        self.gifts.clear();
    }
}

/// Where light falls on a surface.
#[derive(Clone, Copy)]
struct Place<R> {
    point: Vector<R>,
    /// The shading normal, on the side of arrival.
    normal: Vector<R>,
    /// The unit direction of the ray that arrived.
    direction: Vector<R>,
}

/// The light of one lamp at a point, before it is known whether anything is in the way.
struct Arriving<R> {
    /// The cosine of its angle with the normal.
    cosine: R,
    /// The share of its light that the lamp sends this way.
    share: R,
    /// That times what the distance leaves of it.
    strength: R,
    /// The cosine of the angle between its mirror image and the ray that arrived.
    along: R,
}

impl<R: Real> Arriving<R> {
    #[inline(always)]
    fn new(light: &Light, at: &Place<R>) -> Self {
        let to_light = Vector::all(at.point.x, light.position()) - at.point;
        let distance = to_light.length();
        let to_light = to_light / distance;
        let cosine = at.normal.dot(to_light);
        let share = light.share_into(-to_light);
        let mirrored = at.normal * (cosine.all(2.0) * cosine) - to_light;
        Arriving {
            cosine,
            share,
            strength: share * light.attenuation().factor(distance),
            along: mirrored.dot(-at.direction),
        }
    }
}

impl Arriving<f64> {
    /// Whether there is any light.
    #[inline(always)]
    fn is_some(&self) -> bool {
        // A lamp at the very point has no direction, NaN, and gives nothing.
        self.cosine > 0.0 && self.share != 0.0
    }
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
    found: &'s Found,
    surface: &'s Surface,
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
    found: &'a Found,
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

/// A hit of a ray from the eye.
#[derive(Clone, Copy)]
struct First {
    /// The number of the ray.
    number: usize,
    found: Found,
}

/// The light of the surfaces that rays from the eye hit: their colours, but for what rays bring that go on.
struct LightMany<'a, 's> {
    tracer: &'a mut Tracer<'s>,
    /// What is added to the numbers of rays where shadow rays wait.
    start: usize,
    rays: &'a [Ray],
    surfaces: &'a [Surface],
    hits: &'a [First],
    colors: &'a mut [Color],
    /// Where shadow rays wait, by lamp, if they are to be cast together.
    queues: Option<&'a mut [ShadowQueue]>,
}

impl Vectorized for LightMany<'_, '_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(mut self, lanes: L) {
        for hits in self.hits.chunks(4) {
            self.four(lanes, hits);
        }
    }
}

impl LightMany<'_, '_> {
    /// Up to four hits.
    #[inline(always)]
    fn four<L: Lanes>(&mut self, lanes: L, hits: &[First]) {
        let LightMany { tracer, start: first, rays, surfaces, colors, queues, .. } = self;
        let scene = tracer.scene;
        let Some(last) = hits.last() else { return };
        // Places without a hit repeat the last.
        let four = [0, 1, 2, 3].map(|i| hits.get(i).unwrap_or(last));
        let surface = four.map(|hit| &surfaces[hit.number]);
        let direction = Vector::new(lanes, four.map(|hit| &rays[hit.number].direction));
        let zero = direction.x.all(0.0);
        let direction = direction * (zero.all(1.0) / direction.length());
        let shading = Vector::new(lanes, surface.map(|surface| &surface.shading_normal));
        let away = direction.dot(shading);
        let at = Place {
            point: Vector::new(lanes, surface.map(|surface| &surface.point)),
            normal: Vector {
                x: Four::if_less(zero, away, -shading.x, shading.x),
                y: Four::if_less(zero, away, -shading.y, shading.y),
                z: Four::if_less(zero, away, -shading.z, shading.z),
            },
            direction,
        };
        let geometric = Vector::new(lanes, surface.map(|surface| &surface.normal));
        let against = direction.dot(geometric);
        let outside = against.less(zero);
        // As `Departure::ray` begins.
        let error = Four::new(lanes, surface.map(|surface| surface.error));
        let start = at.point + geometric * Four::if_less(against, zero, error, -error);
        let materials = four.map(|hit| tracer.material(&hit.found));
        let mut bodies = [Color::BLACK; 4];
        let mut shows = 0;
        for (i, hit) in hits.iter().enumerate() {
            if let Some(body) = tracer.body(&hit.found, surface[i]) {
                bodies[i] = body;
                shows |= 1 << i;
                colors[hit.number] = scene.ambient * body;
            } else {
                colors[hit.number] = Color::BLACK;
            }
        }
        for (lamp, (light, cube)) in scene.lights.iter().zip(&scene.seen_by_lamp).enumerate() {
            let Arriving { cosine, share, strength, along } = Arriving::new(light, &at);
            let mut lit = zero.less(cosine) & zero.less(share) & shows;
            let (cosine, share) = (cosine.to_array(), share.to_array());
            let (strength, along) = (strength.to_array(), along.to_array());
            if lit == 0 {
                continue;
            }
            let ways = match cube {
                Some(cube) if tracer.shadows => Some((cube, Geometry::four_towards(cube, start))),
                _ => None,
            };
            while lit != 0 {
                let i = lit.trailing_zeros() as usize & 3;
                lit &= lit - 1;
                let (cosine, share, strength, along) = (cosine[i], share[i], strength[i], along[i]);
                let arriving = Arriving { cosine, share, strength, along };
                let (hit, material) = (four[i], materials[i]);
                let from = || {
                    let side = if outside >> i & 1 == 1 { Side::Outside } else { Side::Inside };
                    surface[i].departure(hit.found.object, hit.found.hit, side)
                };
                let mut color = light.color() * strength;
                if let Some(queues) = queues {
                    let gift = tracer.gift(material, bodies[i], color, &arriving);
                    queues[lamp].push(*first + hit.number, &from(), light.position(), gift);
                    continue;
                }
                if tracer.shadows {
                    let visible = match &ways {
                        Some((cube, ways)) => tracer.visible(|each| {
                            let object = hit.found.object;
                            scene.geometry.blocked_on(cube, &ways[i], object, from, &scene.screens, each)
                        }),
                        None => tracer.visibility(&from(), light.position(), None),
                    };
                    match visible {
                        None => continue,
                        Some(visible) => color *= visible,
                    }
                }
                tracer.gift(material, bodies[i], color, &arriving).add_to(&mut colors[hit.number]);
            }
        }
    }
}

/// The second: what rays bring that go on.
struct Spawn<'a, 's> {
    tracer: &'a mut Tracer<'s>,
    local: Color,
    ray: &'a Ray,
    found: &'a Found,
    surface: &'a Surface,
}

impl Task for Spawn<'_, '_> {
    type Output = Color;
    #[inline(always)]
    fn run<P: Product>(self) -> Color {
        let vertex = self.tracer.vertex(self.ray, self.found, self.surface);
        self.local + self.tracer.spawned(&vertex, 1, 1.0)
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
            surfaces: Vec::new(),
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
                self.shade(ray, &found, 1, 1.0)
            }
        }
    }

    /// The colour of a hit.
    fn shade(&mut self, ray: &Ray, found: &Found, depth: u32, weight: f64) -> Color {
        run(Shade { tracer: self, ray, found, depth, weight })
    }

    #[inline(always)]
    fn shade_here(&mut self, ray: &Ray, found: &Found, depth: u32, weight: f64) -> Color {
        let surface = self.scene.geometry.surface(ray, *found);
        let vertex = self.vertex(ray, found, &surface);
        let local = self.local(&vertex);
        self.with_spawned(local, &vertex, depth, weight)
    }

    /// The colours that rays from the eye see, whose nearest hits are known: the same as
    /// [`seen_by_eye`](Tracer::seen_by_eye) for each, with the shadow rays of the first hits cast together.
    pub fn all_seen_by_eye(&mut self, rays: &[Ray], all_found: &[Option<Found>], colors: &mut Vec<Color>) {
        colors.clear();
        colors.resize(rays.len(), self.scene.background);
        // Lamps that hold what they see ask for no search, and what is behind glass is searched otherwise.
        let searched = self.scene.all_opaque && self.scene.seen_by_lamp.iter().any(Option::is_none);
        let together = searched && self.shadows;
        let count = if together { rays.len().max(1) } else { NEAR };
        let parts = rays.chunks(count).zip(all_found.chunks(count)).zip(colors.chunks_mut(count));
        for ((rays, found), colors) in parts {
            self.together(rays, found, colors, together);
        }
    }

    /// Some of them, in one piece.
    fn together(
        &mut self,
        rays: &[Ray],
        all_found: &[Option<Found>],
        colors: &mut [Color],
        cast_together: bool,
    ) {
        let mut surfaces = core::mem::take(&mut self.surfaces);
        let nowhere = Surface::new(0.0, DVec3::ZERO, DVec3::ZERO, DVec3::Y, 0.0);
        surfaces.resize(NEAR, nowhere);
        let mut queues = core::mem::take(&mut self.queues);
        let (mut hits, mut spawning) = (Vec::with_capacity(NEAR), Vec::new());
        let parts = rays.chunks(NEAR).zip(all_found.chunks(NEAR)).zip(colors.chunks_mut(NEAR));
        for (part, ((rays, all_found), colors)) in parts.enumerate() {
            self.scene.geometry.surface_many(rays, all_found, &mut surfaces);
            hits.clear();
            let first = |(number, found): (usize, &Option<Found>)| Some(First { number, found: (*found)? });
            hits.extend(all_found.iter().enumerate().filter_map(first));
            self.stats.eye_rays += rays.len() as u64;
            self.stats.eye_hits += hits.len() as u64;
            vectorize(LightMany {
                queues: cast_together.then_some(&mut queues[..]),
                tracer: self,
                start: part * NEAR,
                rays,
                surfaces: &surfaces,
                hits: &hits,
                colors,
            });
            for hit in &hits {
                if self.spawns(self.material(&hit.found), 1) {
                    let first = First { number: part * NEAR + hit.number, found: hit.found };
                    spawning.push((first, surfaces[hit.number]));
                }
            }
        }
        for queue in queues.iter_mut().filter(|queue| !queue.rays.is_empty()) {
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
        for (First { number, found }, surface) in &spawning {
            let (local, ray) = (colors[*number], &rays[*number]);
            colors[*number] = run(Spawn { tracer: self, local, ray, found, surface });
        }
        self.surfaces = surfaces;
    }

    /// The material of what was hit.
    #[inline(always)]
    fn material(&self, found: &Found) -> &'s Material {
        &self.scene.materials[self.scene.material_of[found.object as usize] as usize]
    }

    /// A hit and all that spawned rays need.
    #[inline(always)]
    fn vertex<'a>(&self, ray: &Ray, found: &'a Found, surface: &'a Surface) -> Vertex<'a>
    where
        's: 'a,
    {
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
            material: self.material(found),
            surface,
        }
    }

    /// Whether rays go on from a point.
    #[inline(always)]
    fn spawns(&self, material: &Material, depth: u32) -> bool {
        depth < self.max_depth && !material.is_matt()
    }

    /// The colour of a point whose own is known.
    #[inline(always)]
    fn with_spawned(&mut self, local: Color, v: &Vertex, depth: u32, weight: f64) -> Color {
        if self.spawns(v.material, depth) { local + self.spawned(v, depth, weight) } else { local }
    }

    /// The colour of the surface itself, before it is lit; `None` where it shows none.
    #[inline(always)]
    fn body(&self, found: &Found, surface: &Surface) -> Option<Color> {
        let scene = self.scene;
        let material = self.material(found);
        if material.diffuse == 0.0 && material.specular == 0.0 {
            return None;
        }
        let paint = match material.paint {
            Paint::Color(color) => color,
            Paint::Texture(texture) => {
                let object = found.object;
                let mapping = scene.mappings[object as usize];
                scene.textures[texture as usize].color(surface, mapping, object)
            }
        };
        Some(paint * material.diffuse)
    }

    /// What the light adds.
    #[inline(always)]
    fn gift(&self, material: &Material, body: Color, color: Color, arriving: &Arriving<f64>) -> Gift {
        let mut gift = Gift { body: color * body * arriving.cosine, gloss: None };
        if material.specular > 0.0 && arriving.along > 0.0 {
            gift.gloss = Some(color * (material.specular * power(arriving.along, material.shininess)));
        }
        gift
    }

    /// Ambient light and the light of the lamps.
    #[inline(always)]
    fn local(&mut self, v: &Vertex) -> Color {
        let scene = self.scene;
        let Some(body) = self.body(v.found, v.surface) else { return Color::BLACK };
        let mut sum = scene.ambient * body;
        let from = v.surface.departure(v.found.object, v.found.hit, v.side);
        let at =
            Place { point: v.surface.point.into(), normal: v.normal.into(), direction: v.direction.into() };
        for (light, cube) in scene.lights.iter().zip(&scene.seen_by_lamp) {
            let arriving = Arriving::new(light, &at);
            if arriving.is_some() {
                self.receive(v.material, body, &from, light, cube.as_ref(), &arriving, &mut sum);
            }
        }
        sum
    }

    /// Adds the light of a lamp, unless something is in the way.
    #[inline(always)]
    #[allow(clippy::too_many_arguments)]
    fn receive(
        &mut self,
        material: &Material,
        body: Color,
        from: &Departure,
        light: &Light,
        cube: Option<&DirectionCube>,
        arriving: &Arriving<f64>,
        sum: &mut Color,
    ) {
        let mut color = light.color() * arriving.strength;
        if self.shadows {
            match self.visibility(from, light.position(), cube) {
                None => return,
                Some(visible) => color *= visible,
            }
        }
        self.gift(material, body, color, arriving).add_to(sum);
    }

    /// What a straight ray to a lamp leaves of its light; `None` when something opaque is in the way.
    #[inline(always)]
    fn visibility(&mut self, from: &Departure, lamp: DVec3, cube: Option<&DirectionCube>) -> Option<Color> {
        let scene = self.scene;
        self.visible(|each| match cube {
            Some(cube) => scene.geometry.blocked_towards(cube, from, &scene.screens, each),
            None => {
                let (ray, within) = shadow_ray(from, lamp);
                match scene.all_opaque {
                    true => scene.geometry.occluded_leaving(&ray, within, from),
                    false => scene.geometry.blocked(&ray, within, Some(from), &scene.screens, each),
                }
            }
        })
    }

    /// The same, by a search that reports what is crossed and answers whether anything opaque is in the way.
    #[inline(always)]
    fn visible(&mut self, blocked: impl FnOnce(&mut dyn FnMut(Found)) -> bool) -> Option<Color> {
        self.stats.shadow_rays += 1;
        let scene = self.scene;
        let filters = &mut self.filters;
        filters.clear();
        let transmit = |object: u32| scene.materials[scene.material_of[object as usize] as usize].transmit;
        let blocked = blocked(&mut |found| filters.push(transmit(found.object)));
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
                self.shade(ray, &found, depth, weight)
            }
        }
    }
}
