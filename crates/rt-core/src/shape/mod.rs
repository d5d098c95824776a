//! The shapes, one a file: type, checked constructor, hit, surface, bounds and tests.

mod cone;
mod cuboid;
mod cylinder;
mod disk;
pub(crate) mod flat;
mod frustum;
mod meeting;
mod paired;
mod plane;
mod sphere;
pub(crate) mod torus;
mod triangle;

pub use cone::Cone;
pub use cuboid::Cuboid;
pub use cylinder::Cylinder;
pub use disk::Disk;
pub use plane::Plane;
pub use sphere::Sphere;
pub use torus::Torus;
pub use triangle::Triangle;

use crate::kernel::Lanes;
use crate::{Aabb, Departure, Error, Hit, Interval, Primitive, Ray, Similarity, Surface};
use alloc::sync::Arc;

/// Shapes whose records are made four at a time, each with a shape of its own.
pub(crate) trait SurfaceEach: Primitive {
    /// [`Primitive::surface`] for each of four hits.
    fn surface_each<L: Lanes>(
        lanes: L,
        shapes: [&Self; 4],
        rays: [&Ray; 4],
        hits: [Hit; 4],
        surfaces: [&mut Surface; 4],
    );
}

/// Any of the shapes: a closed set, so that a test costs a jump rather than a call through a table.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Shape {
    /// A sphere.
    Sphere(Sphere),
    /// An infinite plane.
    Plane(Plane),
    /// A box, along the axes or turned.
    Cuboid(Cuboid),
    /// A cylinder, closed or open.
    Cylinder(Cylinder),
    /// A cone or a frustum of one, closed or open.
    Cone(Cone),
    /// A torus.
    Torus(Torus),
    /// A flat disk.
    Disk(Disk),
    /// A triangle.
    Triangle(Triangle),
    /// A shape of your own.
    Custom(Arc<dyn Primitive>),
}

macro_rules! each_shape {
    ($self:expr, $shape:ident => $body:expr) => {
        match $self {
            Shape::Sphere($shape) => $body,
            Shape::Plane($shape) => $body,
            Shape::Cuboid($shape) => $body,
            Shape::Cylinder($shape) => $body,
            Shape::Cone($shape) => $body,
            Shape::Torus($shape) => $body,
            Shape::Disk($shape) => $body,
            Shape::Triangle($shape) => $body,
            Shape::Custom($shape) => $body,
        }
    };
}

impl Shape {
    /// The same shape scaled, turned and moved: the similarity is applied to the shape's own numbers.
    ///
    /// # Errors
    /// When the result is not a legal shape (its size under- or overflows). A custom shape cannot be transformed
    /// and is returned as it is.
    pub fn transformed(&self, by: &Similarity) -> Result<Shape, Error> {
        Ok(match self {
            Shape::Sphere(s) => s.transformed(by)?.into(),
            Shape::Plane(s) => s.transformed(by)?.into(),
            Shape::Cuboid(s) => s.transformed(by)?.into(),
            Shape::Cylinder(s) => s.transformed(by)?.into(),
            Shape::Cone(s) => s.transformed(by)?.into(),
            Shape::Torus(s) => s.transformed(by)?.into(),
            Shape::Disk(s) => s.transformed(by)?.into(),
            Shape::Triangle(s) => s.transformed(by)?.into(),
            Shape::Custom(s) => Shape::Custom(s.clone()),
        })
    }
}

impl Primitive for Shape {
    #[inline]
    fn hit(&self, ray: &Ray, within: Interval) -> Option<Hit> {
        each_shape!(self, s => s.hit(ray, within))
    }
    fn crossings(&self, ray: &Ray, within: Interval, each: &mut dyn FnMut(Hit)) {
        each_shape!(self, s => s.crossings(ray, within, each))
    }
    fn surface(&self, ray: &Ray, hit: Hit) -> Surface {
        each_shape!(self, s => s.surface(ray, hit))
    }
    fn bounds(&self) -> Option<Aabb> {
        each_shape!(self, s => s.bounds())
    }
    fn hit_leaving(&self, ray: &Ray, within: Interval, from: &Departure) -> Option<Hit> {
        each_shape!(self, s => s.hit_leaving(ray, within, from))
    }
    fn crossings_leaving(&self, ray: &Ray, within: Interval, from: &Departure, each: &mut dyn FnMut(Hit)) {
        each_shape!(self, s => s.crossings_leaving(ray, within, from, each))
    }
}

macro_rules! into_shape {
    ($($kind:ident)*) => {
        $(impl From<$kind> for Shape {
            #[inline]
            fn from(shape: $kind) -> Shape {
                Shape::$kind(shape)
            }
        })*
    };
}
into_shape!(Sphere Plane Cuboid Cylinder Cone Torus Disk Triangle);

impl From<Arc<dyn Primitive>> for Shape {
    fn from(shape: Arc<dyn Primitive>) -> Shape {
        Shape::Custom(shape)
    }
}
