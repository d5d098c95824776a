//! Rays that textbook formulas answer wrongly: aimed from far away, grazing, along axes, starting on the surface.

use super::Random;
use crate::{Aabb, Interval, Ray};
use glam::DVec3;

/// A seeded stream of hard rays at one shape.
#[derive(Clone, Debug)]
pub struct HardRays {
    random: Random,
    center: DVec3,
    half: DVec3,
}

impl HardRays {
    /// Rays at a shape in this box; without a box, at the cube from -1 to 1.
    pub fn new(seed: u64, bounds: Option<Aabb>) -> Self {
        let bounds = bounds.unwrap_or(Aabb::new(DVec3::NEG_ONE, DVec3::ONE));
        let (center, half) = (bounds.center(), bounds.max * 0.5 - bounds.min * 0.5);
        HardRays { random: Random::new(seed), center, half }
    }

    /// The random numbers, to go on with.
    pub fn random(&mut self) -> &mut Random {
        &mut self.random
    }

    /// The largest half edge of the box.
    pub fn size(&self) -> f64 {
        self.half.max_element()
    }

    /// The next ray aimed at the box, from inside it to 1e9 of its sizes away. In one of four the direction has one or
    /// two components of zero; its length varies by 1e+-12 in one of four.
    pub fn aimed(&mut self) -> Ray {
        let target = self.center + self.random.in_cube() * self.half;
        self.at(target)
    }

    /// The next ray through a corner of the box, or the middle of an edge or a face of it.
    pub fn at_feature(&mut self) -> Ray {
        let r = &mut self.random;
        let step = |r: &mut Random| f64::from(r.below(3)) - 1.0;
        let target = self.center + DVec3::new(step(r), step(r), step(r)) * self.half;
        self.at(target)
    }

    /// A ray at this point.
    pub fn at(&mut self, target: DVec3) -> Ray {
        let size = self.size();
        let r = &mut self.random;
        let far = match r.below(4) {
            0 => r.magnitude(-3.0, 0.0),
            1 | 2 => r.magnitude(0.0, 2.0),
            _ => r.magnitude(2.0, 9.0),
        };
        let mut away = r.direction();
        let axial = r.once_in(4);
        if axial {
            away[r.below(3) as usize] = 0.0;
            if r.once_in(2) {
                away[r.below(3) as usize] = -0.0;
            }
            if away == DVec3::ZERO {
                away[r.below(3) as usize] = 1.0;
            }
        }
        let origin = target + away * (size * far);
        let direction = if axial { -away } else { target - origin };
        Ray::new(origin, self.stretched(direction))
    }

    /// A ray past the point of a surface with this normal: nearly in its tangent plane, 1e-1 to 1e-15 of the size
    /// off it, by the angle or by the height.
    pub fn grazing(&mut self, point: DVec3, normal: DVec3) -> Ray {
        let size = self.size();
        let r = &mut self.random;
        let along = normal.cross(r.direction()).try_normalize().unwrap_or(normal.any_orthonormal_vector());
        let lift = normal * (r.sign() * r.magnitude(-15.0, -1.0));
        let far = size * r.magnitude(-1.0, 4.0);
        let (direction, passing) =
            if r.once_in(2) { (along + lift, point) } else { (along, point + lift * size) };
        Ray::new(passing - direction * far, self.stretched(direction))
    }

    /// A ray that starts at a point of a surface, or up to three roundings from it.
    pub fn starting_at(&mut self, point: DVec3) -> Ray {
        let r = &mut self.random;
        let nudge = |r: &mut Random, mut x: f64| {
            for _ in 0..r.below(4) {
                x = if r.once_in(2) { x.next_up() } else { x.next_down() };
            }
            x
        };
        let origin = DVec3::new(nudge(r, point.x), nudge(r, point.y), nudge(r, point.z));
        let direction = r.direction();
        Ray::new(origin, self.stretched(direction))
    }

    /// Any bits at all.
    pub fn anything(&mut self) -> (Ray, Interval) {
        let r = &mut self.random;
        (Ray::new(r.any_vector(), r.any_vector()), Interval::new(r.any_f64(), r.any_f64()))
    }

    fn stretched(&mut self, direction: DVec3) -> DVec3 {
        let r = &mut self.random;
        if r.once_in(4) { direction * r.magnitude(-12.0, 12.0) } else { direction }
    }
}
