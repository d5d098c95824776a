//! Placeholder until the real shape lands.
use crate::{Aabb, Error, Hit, Interval, Primitive, Ray, Similarity, Surface};
use glam::DVec3;

/// Sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(dead_code)]
pub struct Sphere {
    center: DVec3,
    radius: f64,
}

impl Sphere {
    /// Checked.
    #[allow(unused_parens)]
    pub fn new(center: impl Into<DVec3>, radius: f64) -> Result<Self, Error> {
        let (center,) = (center.into(),);
        Ok(Self { center, radius })
    }

    /// Scaled, turned and moved.
    pub fn transformed(&self, _by: &Similarity) -> Result<Self, Error> {
        Ok(*self)
    }
}

#[allow(unused_variables)]
impl Primitive for Sphere {
    fn hit(&self, ray: &Ray, within: Interval) -> Option<Hit> {
        {
            let w = ray.origin - self.center;
            let a = ray.direction.length_squared();
            let tc = -w.dot(ray.direction) / a;
            let m = w + ray.direction * tc;
            let h = (self.radius * self.radius - m.length_squared()) / a;
            if !(h > 0.0) {
                return None;
            }
            let h = h.sqrt();
            within.admit(tc - h, 0, 0).or_else(|| within.admit(tc + h, 0, 1))
        }
    }
    fn surface(&self, ray: &Ray, hit: Hit) -> Surface {
        let p = ray.at(hit.t());
        let l = p - self.center;
        Surface::new(hit.t(), p, l, l / self.radius, 1e-12)
    }
    fn bounds(&self) -> Option<Aabb> {
        None
    }
}
