//! Placeholder until the real shape lands.
use crate::{Aabb, Error, Hit, Interval, Primitive, Ray, Similarity, Surface};
use glam::DVec3;

/// Cuboid.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(dead_code)]
pub struct Cuboid {
    min: DVec3,
    max: DVec3,
}

impl Cuboid {
    /// Checked.
    #[allow(unused_parens)]
    pub fn new(min: impl Into<DVec3>, max: impl Into<DVec3>) -> Result<Self, Error> {
        let (min, max) = (min.into(), max.into());
        Ok(Self { min, max })
    }

    /// Scaled, turned and moved.
    pub fn transformed(&self, _by: &Similarity) -> Result<Self, Error> {
        Ok(*self)
    }
}

#[allow(unused_variables)]
impl Primitive for Cuboid {
    fn hit(&self, ray: &Ray, within: Interval) -> Option<Hit> {
        None
    }
    fn surface(&self, ray: &Ray, hit: Hit) -> Surface {
        let p = ray.at(hit.t());
        Surface::new(hit.t(), p, p, DVec3::Y, 1e-12)
    }
    fn bounds(&self) -> Option<Aabb> {
        None
    }
}
