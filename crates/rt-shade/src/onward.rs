//! What mirrors and glass see: rays that go on from a surface.

use crate::material::Optics;
use crate::medium::{Around, Media, Medium};
use crate::optics::{Refraction, mirror, refract};
use crate::{Color, Material, Stats};
use rt_core::glam::DVec3;
use rt_core::{Departure, Found, Interval, Ray, Side, Surface};

/// What is known of a ray beside where it goes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Path {
    /// The number of the ray at whose end this one begins.
    pub parent: u32,
    /// What this ray's colour is worth there.
    pub share: Color,
    /// What it is worth to the eye, at most.
    pub weight: f64,
    /// The media that it is in.
    pub around: Around,
}

/// Rays that leave surfaces, to be followed together.
#[derive(Debug, Default)]
pub(crate) struct Rays {
    pub rays: Vec<Ray>,
    pub within: Vec<Interval>,
    pub from: Vec<Departure>,
    pub paths: Vec<Path>,
    /// What they hit, when that is known.
    pub found: Vec<Option<Found>>,
    /// The colours that they see, when these are known.
    pub colors: Vec<Color>,
}

impl Rays {
    #[inline(always)]
    fn push(&mut self, (ray, within): (Ray, Interval), from: Departure, path: Path) {
        self.rays.push(ray);
        self.within.push(within);
        self.from.push(from);
        self.paths.push(path);
    }

    /// Takes the other's rays, too.
    fn append(&mut self, other: &mut Rays) {
        self.rays.append(&mut other.rays);
        self.within.append(&mut other.within);
        self.from.append(&mut other.from);
        self.paths.append(&mut other.paths);
    }

    fn clear(&mut self) {
        self.rays.clear();
        self.within.clear();
        self.from.clear();
        self.paths.clear();
    }
}

/// The rays that go on from the surfaces that some rays have hit.
#[derive(Debug, Default)]
pub(crate) struct Onward {
    /// Those that are reflected and, when they are [merged](Onward::merge), all.
    pub rays: Rays,
    refracted: Rays,
}

/// A point that a ray hit, where others begin.
pub(crate) struct Vertex<'a> {
    pub found: &'a Found,
    pub surface: &'a Surface,
    pub material: &'a Material,
    /// The number of the material.
    pub key: u32,
    /// The unit direction of the ray that arrived.
    pub direction: DVec3,
    /// The shading normal, on the side of arrival.
    pub normal: DVec3,
    /// The side of arrival.
    pub side: Side,
}

impl Onward {
    /// No rays, in room that was used before.
    pub fn clear(&mut self) {
        self.rays.clear();
        self.refracted.clear();
    }

    /// Puts all together: those alike are neighbours.
    pub fn merge(&mut self) {
        self.rays.append(&mut self.refracted);
    }

    /// Adds the mirror ray and the transmitted ray of a point where the ray of a `path` arrives, which has this number; what
    /// is worth less than `cutoff` is left out.
    #[inline(always)]
    pub fn spawn(
        &mut self,
        v: &Vertex,
        number: u32,
        path: &Path,
        media: &mut Media,
        cutoff: f64,
        stats: &mut Stats,
    ) {
        let material = v.material;
        let transmits = !material.transmit.is_black();
        let entering = v.side == Side::Outside;
        // An opaque body with an index is never entered: its back is as good as its front.
        let medium = material.ior.map(|ior| Medium { key: v.key, ior });
        let refraction = match medium {
            None => Refraction::Through { direction: v.direction, reflectance: 0.0 },
            Some(medium) => {
                let boundary = media.boundary(path.around, medium, entering || !transmits);
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
        let counts = |share: Color| !share.is_black() && path.weight * share.max_channel() >= cutoff;
        let next = |share: Color, around| Path {
            parent: number,
            share,
            weight: path.weight * share.max_channel(),
            around,
        };
        if counts(reflect) {
            stats.reflected_rays += 1;
            let from = v.surface.departure(v.found.object, v.found.hit, v.side);
            let ray = from.ray(mirror(v.direction, v.normal));
            self.rays.push(ray, from, next(reflect, path.around));
        }
        if let Some((direction, share)) = through
            && counts(share)
        {
            stats.refracted_rays += 1;
            let around = medium.map_or(path.around, |medium| media.cross(path.around, medium, entering));
            let from = v.surface.departure(v.found.object, v.found.hit, v.side.other());
            self.refracted.push(from.through(direction), from, next(share, around));
        }
    }
}
