//! Placeholder until the real shape lands.
use crate::{Aabb, Error, Hit, Interval, Primitive, Ray, Similarity, Surface};
use glam::DVec3;

/// Triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(dead_code)]
pub struct Triangle {
    a: DVec3,
    b: DVec3,
    c: DVec3,
}

impl Triangle {
    /// Checked.
    #[allow(unused_parens)]
    pub fn new(a: impl Into<DVec3>, b: impl Into<DVec3>, c: impl Into<DVec3>) -> Result<Self, Error> {
        let (a, b, c) = (a.into(), b.into(), c.into());
        Ok(Self { a, b, c })
    }

    /// Scaled, turned and moved.
    pub fn transformed(&self, _by: &Similarity) -> Result<Self, Error> {
        Ok(*self)
    }
}

#[allow(unused_variables)]
impl Primitive for Triangle {
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
