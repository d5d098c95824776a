//! The light of lamps on surfaces, four surfaces at a time.

use crate::highlight::power;
use crate::material::Paint;
use crate::onward::{Onward, Path, Vertex};
use crate::whitted::Tracer;
use crate::{Color, Material, Scene, Stats};
use rt_core::glam::DVec3;
use rt_core::kernel::{Four, Lanes, Real, Vector, Vectorized};
use rt_core::{Departure, Found, Geometry, Interval, Ray, Side, Surface};

/// Shadow rays of many points to one lamp, to be cast together.
#[derive(Default)]
pub(crate) struct ShadowQueue {
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

    /// Casts them; the light of the lamp is added where nothing is in the way.
    pub fn cast(&mut self, geometry: &Geometry, stats: &mut Stats, colors: &mut [Color]) {
        if self.rays.is_empty() {
            return;
        }
        let ShadowQueue { rays, within, from, blocked, gifts } = self;
        stats.shadow_rays += rays.len() as u64;
        blocked.resize(rays.len(), false);
        geometry.occluded_leaving_many(rays, within, from, blocked);
        for ((number, gift), blocked) in gifts.iter().zip(blocked) {
            if *blocked {
                stats.shadow_hits += 1;
            } else if let Some(color) = colors.get_mut(*number) {
                gift.add_to(color);
            }
        }
        self.clear();
    }

    fn clear(&mut self) {
        self.rays.clear();
        self.within.clear();
        self.from.clear();
        self.blocked.clear();
        self.gifts.clear();
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

/// A hit of one of many rays.
#[derive(Clone, Copy)]
pub(crate) struct Struck {
    /// The number of the ray.
    pub number: usize,
    pub found: Found,
}

/// The light of the surfaces that rays hit: their colours, but for what rays bring that go on; these are made ready.
pub(crate) struct LightMany<'a, 's> {
    pub tracer: &'a mut Tracer<'s>,
    /// What is added to the numbers of rays where others wait.
    pub start: usize,
    pub rays: &'a [Ray],
    pub surfaces: &'a [Surface],
    pub hits: &'a [Struck],
    pub colors: &'a mut [Color],
    /// Where shadow rays wait, by lamp, if they are to be cast together.
    pub queues: Option<&'a mut [ShadowQueue]>,
    /// What is known of each ray.
    pub paths: Paths<'a>,
    /// Where rays wait that go on, if any does.
    pub onward: Option<&'a mut Onward>,
}

/// What is known of many rays, by number.
#[derive(Clone, Copy)]
pub(crate) enum Paths<'a> {
    /// The same of each.
    Alike(Path),
    Each(&'a [Path]),
}

impl<'a> Paths<'a> {
    /// Those of the rays from `start` on, `count` of them.
    pub fn part(self, start: usize, count: usize) -> Paths<'a> {
        match self {
            Paths::Alike(path) => Paths::Alike(path),
            Paths::Each(paths) => Paths::Each(&paths[start..start + count]),
        }
    }

    fn of(&self, number: usize) -> &Path {
        match self {
            Paths::Alike(path) => path,
            Paths::Each(paths) => &paths[number],
        }
    }
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
    fn four<L: Lanes>(&mut self, lanes: L, hits: &[Struck]) {
        let LightMany { tracer, start: first, rays, surfaces, colors, queues, paths, onward, .. } = self;
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
        let point = Vector::new(lanes, surface.map(|surface| &surface.point));
        // On the side of arrival.
        let normal = Vector {
            x: Four::if_less(zero, away, -shading.x, shading.x),
            y: Four::if_less(zero, away, -shading.y, shading.y),
            z: Four::if_less(zero, away, -shading.z, shading.z),
        };
        let geometric = Vector::new(lanes, surface.map(|surface| &surface.normal));
        let against = direction.dot(geometric);
        let outside = against.less(zero);
        // As `Departure::ray` begins.
        let error = Four::new(lanes, surface.map(|surface| surface.error));
        let start = point + geometric * Four::if_less(against, zero, error, -error);
        let materials = four.map(|hit| scene.material_hit(&hit.found));
        let mut bodies = [Color::BLACK; 4];
        let mut shows = 0;
        for (i, hit) in hits.iter().enumerate() {
            if let Some(body) = body(scene, materials[i], &hit.found, surface[i]) {
                bodies[i] = body;
                shows |= 1 << i;
                colors[hit.number] = scene.ambient * body;
            } else {
                colors[hit.number] = Color::BLACK;
            }
        }
        for (lamp, (light, cube)) in scene.lights.iter().zip(&scene.seen_by_lamp).enumerate() {
            let to_light = Vector::all(zero, light.position()) - point;
            let distance = to_light.length();
            // A lamp at the very point has no direction, NaN, and gives nothing.
            let to_light = to_light * (zero.all(1.0) / distance);
            let cosine = normal.dot(to_light);
            let share = light.share_into(-to_light);
            let mut lit = zero.less(cosine) & zero.less(share) & shows;
            if lit == 0 {
                continue;
            }
            let mirrored = normal * (zero.all(2.0) * cosine) - to_light;
            let along = mirrored.dot(-direction).to_array();
            let strength = (share * light.attenuation().factor(distance)).to_array();
            let cosine = cosine.to_array();
            let (mut blocked, mut free) = (0, 0);
            let ways = match cube {
                Some(cube) if tracer.shadows && queues.is_none() => {
                    let mut ways = Geometry::four_towards(cube, start);
                    let left = [0, 1, 2, 3].map(|i| four[i].found.object);
                    blocked = scene.geometry.blocked_by_tori(cube, &mut ways, lit, left, &scene.screens);
                    free = lit & !blocked & Geometry::are_free(cube, &ways, left, outside);
                    Some((cube, ways))
                }
                _ => None,
            };
            tracer.stats.shadow_rays += u64::from((blocked | free).count_ones());
            tracer.stats.shadow_hits += u64::from(blocked.count_ones());
            lit &= !blocked;
            while lit != 0 {
                let i = lit.trailing_zeros() as usize & 3;
                lit &= lit - 1;
                let (hit, material) = (four[i], materials[i]);
                let from = || {
                    let side = if outside >> i & 1 == 1 { Side::Outside } else { Side::Inside };
                    surface[i].departure(hit.found.object, hit.found.hit, side)
                };
                let mut color = light.color() * strength[i];
                if let Some(queues) = queues {
                    let gift = gift(material, bodies[i], color, cosine[i], along[i]);
                    queues[lamp].push(*first + hit.number, &from(), light.position(), gift);
                    continue;
                }
                if tracer.shadows && free >> i & 1 == 0 {
                    let visible = match &ways {
                        Some((cube, ways)) => tracer.visible(|each| {
                            let object = hit.found.object;
                            scene.geometry.blocked_on(cube, &ways[i], object, from, &scene.screens, each)
                        }),
                        None => tracer.visibility(&from(), light.position()),
                    };
                    match visible {
                        None => continue,
                        Some(visible) => color *= visible,
                    }
                }
                gift(material, bodies[i], color, cosine[i], along[i]).add_to(&mut colors[hit.number]);
            }
        }
        let Some(onward) = onward else { return };
        if materials.iter().all(|material| material.is_matt()) {
            return;
        }
        let (direction, normal) = (direction.to_array(), normal.to_array());
        for (i, hit) in hits.iter().enumerate().filter(|(i, _)| !materials[*i].is_matt()) {
            let vertex = Vertex {
                found: &hit.found,
                surface: surface[i],
                material: materials[i],
                key: scene.material_of[hit.found.object as usize],
                direction: direction[i],
                normal: normal[i],
                side: if outside >> i & 1 == 1 { Side::Outside } else { Side::Inside },
            };
            let number = (*first + hit.number) as u32;
            let Tracer { media, cutoff, stats, .. } = tracer;
            onward.spawn(&vertex, number, paths.of(hit.number), media, *cutoff, stats);
        }
    }
}

/// The ray from a surface to a lamp, at which it ends.
#[inline(always)]
fn shadow_ray(from: &Departure, lamp: DVec3) -> (Ray, Interval) {
    let start = from.ray(DVec3::ZERO).0.origin;
    (Ray::new(start, lamp - start), Interval::new(0.0, 1.0))
}

/// The colour of the surface itself, before it is lit; `None` where it shows none.
#[inline(always)]
fn body(scene: &Scene, material: &Material, found: &Found, surface: &Surface) -> Option<Color> {
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

/// What light adds that arrives at an angle with this `cosine`, its mirror image with the cosine `along` to the ray.
#[inline(always)]
fn gift(material: &Material, body: Color, color: Color, cosine: f64, along: f64) -> Gift {
    let mut gift = Gift { body: color * body * cosine, gloss: None };
    if material.specular > 0.0 && along > 0.0 {
        gift.gloss = Some(color * (material.specular * power(along, material.shininess)));
    }
    gift
}

impl Tracer<'_> {
    /// What a straight ray to a lamp leaves of its light; `None` when something opaque is in the way.
    #[inline(always)]
    fn visibility(&mut self, from: &Departure, lamp: DVec3) -> Option<Color> {
        let scene = self.scene;
        let (ray, within) = shadow_ray(from, lamp);
        self.visible(|each| match scene.all_opaque {
            true => scene.geometry.occluded_leaving(&ray, within, from),
            false => scene.geometry.blocked(&ray, within, Some(from), &scene.screens, each),
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
}
