//! Axis-aligned bounding boxes.

use glam::DVec3;

/// A closed axis-aligned box in world coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// The least coordinates.
    pub min: DVec3,
    /// The greatest coordinates.
    pub max: DVec3,
}

impl Aabb {
    /// The box between two corners, whichever way round.
    #[inline]
    pub fn new(a: DVec3, b: DVec3) -> Self {
        Aabb { min: a.min(b), max: a.max(b) }
    }

    /// The smallest box that holds both.
    #[inline]
    pub fn union(&self, other: &Aabb) -> Self {
        Aabb { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Whether a point lies inside or on the boundary.
    #[inline]
    pub fn contains(&self, p: DVec3) -> bool {
        p.cmpge(self.min).all() && p.cmple(self.max).all()
    }

    /// Half the sum of the corners.
    #[inline]
    pub fn center(&self) -> DVec3 {
        self.min * 0.5 + self.max * 0.5
    }
}
