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

#[cfg(test)]
mod tests {
    use super::*;

    /// How far the line passes from a point, and whether the point lies ahead.
    fn passes(ray: &Ray, point: DVec3) -> (f64, bool) {
        let (way, unit) = (point - ray.origin, ray.direction.normalize());
        (way.cross(unit).length(), way.dot(unit) > 0.0)
    }

    #[test]
    fn rays_go_where_they_are_said_to_go() {
        let bounds = Aabb::new(DVec3::new(-1.0, 0.0, 2.0), DVec3::new(1.0, 6.0, 4.0));
        let mut rays = HardRays::new(1, Some(bounds));
        assert_eq!(
            (rays.size(), rays.center, rays.half),
            (3.0, DVec3::new(0.0, 3.0, 3.0), DVec3::new(1.0, 3.0, 1.0))
        );
        let (mut axial, mut long, mut beside) = (0, 0, 0.0_f64);
        for _ in 0..1000 {
            let target = rays.center + rays.random().in_cube();
            let ray = rays.at(target);
            let far = (ray.origin - target).length();
            let (off, ahead) = passes(&ray, target);
            assert!(ahead && off <= 1e-15 * (far + 10.0), "{ray:?}");
            assert!(far > 0.0 && far < 3.1e9, "{far}");
            axial += u32::from(ray.direction.to_array().contains(&0.0));
            long += u32::from(!(1e-3..1e10).contains(&ray.direction.length()));

            let normal = rays.random().direction();
            let ray = rays.grazing(target, normal);
            let (off, ahead) = passes(&ray, target);
            let far = (ray.origin - target).length();
            let slope = ray.direction.normalize().dot(normal).abs();
            assert!(ahead && off <= 0.11 * (far + 3.0) && slope < 0.11, "{ray:?}");
            beside = beside.max(off);
            let lift = (ray.origin - target).dot(normal).abs();
            assert!(lift <= 0.11 * (far + 3.0));

            let ray = rays.starting_at(target);
            assert!((ray.origin - target).abs().cmple(target.abs() * 1e-15).all());
        }
        assert!(axial > 200 && long > 50, "{axial} {long}");
        // By a tenth of the size at most, and nearly so sometimes.
        assert!((0.2..0.31).contains(&beside), "{beside}");
        for _ in 0..200 {
            let ray = rays.at_feature();
            let steps = [-1.0, 0.0, 1.0];
            let met = steps.iter().any(|x| {
                steps.iter().any(|y| {
                    steps.iter().any(|z| {
                        let corner = rays.center + DVec3::new(*x, *y, *z) * rays.half;
                        passes(&ray, corner).0 <= 1e-15 * ((ray.origin - corner).length() + 10.0)
                    })
                })
            });
            assert!(met, "{ray:?}");
            assert!(rays.aimed().is_valid());
        }
    }
}
