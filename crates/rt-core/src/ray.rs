//! A ray: an origin and a direction.

use glam::DVec3;

/// The half line `origin + t * direction`.
///
/// The direction need not be of unit length; `t` counts in lengths of the direction. A ray with a NaN, an infinite
/// component or a zero direction is legal to build and hits nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where `t` is zero.
    pub origin: DVec3,
    /// The displacement for one unit of `t`.
    pub direction: DVec3,
}

impl Ray {
    /// A ray from `origin` along `direction`.
    #[inline]
    pub fn new(origin: impl Into<DVec3>, direction: impl Into<DVec3>) -> Self {
        Ray { origin: origin.into(), direction: direction.into() }
    }

    /// `origin + t * direction`, rounded as plain `f64` arithmetic rounds it.
    ///
    /// Far from the origin this loses digits; [`Surface::point`](crate::Surface::point) does not.
    #[inline]
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }

    /// Whether every component is finite and the direction is not zero.
    #[inline]
    pub fn is_valid(&self) -> bool {
        // Zero times a number is zero, unless the number is infinite or NaN: one branch for all six.
        let zero = self.origin * 0.0 + self.direction * 0.0;
        zero.x + zero.y + zero.z == 0.0 && self.direction != DVec3::ZERO
    }
}
