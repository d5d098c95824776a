//! Many shapes: the nearest hit, or whether anything is in the way.

use crate::{Departure, Hit, Interval, Primitive, Ray, Shape, Surface};
use alloc::vec::Vec;
use core::ops::ControlFlow;

/// A hit and the object it belongs to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// The index of the object, in the order of [`GeometryBuilder::add`].
    pub object: u32,
    /// The hit.
    pub hit: Hit,
}

/// A set of shapes, ready for rays.
#[derive(Clone, Debug, Default)]
pub struct Geometry {
    shapes: Vec<Shape>,
}

/// Collects shapes for a [`Geometry`].
#[derive(Clone, Debug, Default)]
pub struct GeometryBuilder {
    shapes: Vec<Shape>,
}

impl GeometryBuilder {
    /// Adds a shape: its index is the count of those added before.
    #[allow(clippy::should_implement_trait)]
    pub fn add(mut self, shape: impl Into<Shape>) -> Self {
        self.push(shape);
        self
    }

    /// Adds a shape and returns its index.
    pub fn push(&mut self, shape: impl Into<Shape>) -> u32 {
        self.shapes.push(shape.into());
        (self.shapes.len() - 1) as u32
    }

    /// Prepares the set for rays.
    pub fn build(self) -> Geometry {
        Geometry { shapes: self.shapes }
    }
}

impl Geometry {
    /// An empty builder.
    pub fn builder() -> GeometryBuilder {
        GeometryBuilder::default()
    }

    /// The shapes, by index.
    pub fn shapes(&self) -> &[Shape] {
        &self.shapes
    }

    /// The nearest hit inside the interval; equal ones are ordered by index.
    pub fn nearest(&self, ray: &Ray, within: Interval) -> Option<Found> {
        self.nearest_by(within, |_, s, within| s.hit(ray, within))
    }

    /// The nearest hit of a ray that leaves a surface: see [`Departure`].
    pub fn nearest_leaving(&self, ray: &Ray, within: Interval, from: &Departure) -> Option<Found> {
        self.nearest_by(within, |id, s, within| {
            if id == from.object { s.hit_leaving(ray, within, from) } else { s.hit(ray, within) }
        })
    }

    fn nearest_by(
        &self,
        within: Interval,
        test: impl Fn(u32, &Shape, Interval) -> Option<Hit>,
    ) -> Option<Found> {
        let mut best: Option<Found> = None;
        let mut rest = within;
        for (id, shape) in self.shapes.iter().enumerate() {
            if let Some(hit) = test(id as u32, shape, rest) {
                best = Some(Found { object: id as u32, hit });
                rest = rest.until(hit.t());
            }
        }
        best
    }

    /// Whether anything lies inside the interval.
    pub fn occluded(&self, ray: &Ray, within: Interval) -> bool {
        self.shapes.iter().any(|s| s.hit(ray, within).is_some())
    }

    /// All crossings inside the interval of all objects, in no particular order, but ascending for each object;
    /// stops when `each` breaks. With `from`, the ray leaves that surface.
    pub fn crossings(
        &self,
        ray: &Ray,
        within: Interval,
        from: Option<&Departure>,
        each: &mut dyn FnMut(Found) -> ControlFlow<()>,
    ) {
        for (id, shape) in self.shapes.iter().enumerate() {
            let object = id as u32;
            let mut flow = ControlFlow::Continue(());
            let mut report = |hit| {
                if flow.is_continue() {
                    flow = each(Found { object, hit });
                }
            };
            match from {
                Some(from) if from.object == object => {
                    shape.crossings_leaving(ray, within, from, &mut report)
                }
                _ => shape.crossings(ray, within, &mut report),
            }
            if flow.is_break() {
                return;
            }
        }
    }

    /// The full record of a hit found with this ray.
    pub fn surface(&self, ray: &Ray, found: Found) -> Surface {
        self.shapes[found.object as usize].surface(ray, found.hit)
    }
}
