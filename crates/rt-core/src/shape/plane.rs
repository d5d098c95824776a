//! Placeholder until the real shape lands.
use crate::{Aabb, Error, Hit, Interval, Primitive, Ray, Similarity, Surface};
use glam::DVec3;

/// Plane.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(dead_code)]
pub struct Plane {
    point: DVec3,
    normal: DVec3,
}

impl Plane {
    /// Checked.
    #[allow(unused_parens)]
    pub fn new(point: impl Into<DVec3>, normal: impl Into<DVec3>) -> Result<Self, Error> {
        let (point, normal) = (point.into(), normal.into().normalize());
        Ok(Self { point, normal })
    }

    /// Scaled, turned and moved.
    pub fn transformed(&self, _by: &Similarity) -> Result<Self, Error> {
        Ok(*self)
    }
}

#[allow(unused_variables)]
impl Primitive for Plane {
    fn hit(&self, ray: &Ray, within: Interval) -> Option<Hit> {
        within.admit((self.point - ray.origin).dot(self.normal) / ray.direction.dot(self.normal), 0, 0)
    }
    fn surface(&self, ray: &Ray, hit: Hit) -> Surface {
        let p = ray.at(hit.t());
        Surface::new(hit.t(), p, p - self.point, self.normal, 1e-12)
    }
    fn bounds(&self) -> Option<Aabb> {
        None
    }
}
