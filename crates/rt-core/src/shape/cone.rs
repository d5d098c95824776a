//! Placeholder until the real shape lands.
use crate::{Aabb, Error, Hit, Interval, Primitive, Ray, Similarity, Surface};
use glam::DVec3;

/// Cone.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(dead_code)]
pub struct Cone {
    base: DVec3,
    base_radius: f64,
    top: DVec3,
    top_radius: f64,
}

impl Cone {
    /// Checked.
    #[allow(unused_parens)]
    pub fn new(
        base: impl Into<DVec3>,
        base_radius: f64,
        top: impl Into<DVec3>,
        top_radius: f64,
    ) -> Result<Self, Error> {
        let (base, top) = (base.into(), top.into());
        Ok(Self { base, base_radius, top, top_radius })
    }

    /// Without end caps.
    pub fn open(
        base: impl Into<DVec3>,
        base_radius: f64,
        top: impl Into<DVec3>,
        top_radius: f64,
    ) -> Result<Self, Error> {
        Self::new(base, base_radius, top, top_radius)
    }

    /// Scaled, turned and moved.
    pub fn transformed(&self, _by: &Similarity) -> Result<Self, Error> {
        Ok(*self)
    }
}

#[allow(unused_variables)]
impl Primitive for Cone {
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
