//! Placeholder until the real shape lands.
use crate::{Aabb, Error, Hit, Interval, Primitive, Ray, Similarity, Surface};
use glam::DVec3;

/// Disk.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(dead_code)]
pub struct Disk {
    center: DVec3,
    normal: DVec3,
    radius: f64,
}

impl Disk {
    /// Checked.
    #[allow(unused_parens)]
    pub fn new(center: impl Into<DVec3>, normal: impl Into<DVec3>, radius: f64) -> Result<Self, Error> {
        let (center, normal) = (center.into(), normal.into().normalize());
        Ok(Self { center, normal, radius })
    }

    /// Scaled, turned and moved.
    pub fn transformed(&self, _by: &Similarity) -> Result<Self, Error> {
        Ok(*self)
    }
}

#[allow(unused_variables)]
impl Primitive for Disk {
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
