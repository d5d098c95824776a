//! Placeholder until the real shape lands.
use crate::{Aabb, Error, Hit, Interval, Primitive, Ray, Similarity, Surface};
use glam::DVec3;

/// Torus.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(dead_code)]
pub struct Torus {
    center: DVec3,
    axis: DVec3,
    major: f64,
    minor: f64,
}

impl Torus {
    /// Checked.
    #[allow(unused_parens)]
    pub fn new(
        center: impl Into<DVec3>,
        axis: impl Into<DVec3>,
        major: f64,
        minor: f64,
    ) -> Result<Self, Error> {
        let (center, axis) = (center.into(), axis.into().normalize());
        Ok(Self { center, axis, major, minor })
    }

    /// Scaled, turned and moved.
    pub fn transformed(&self, _by: &Similarity) -> Result<Self, Error> {
        Ok(*self)
    }
}

#[allow(unused_variables)]
impl Primitive for Torus {
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
