//! Rays meet analytic shapes: exact hits in `f64`.
//!
//! A [`Ray`] is cast at a shape within an [`Interval`]; a [`Hit`] records where along the ray, and
//! [`Primitive::surface`] turns the winning hit into a [`Surface`]: the refined parameter, the point, the normal.
#![cfg_attr(not(any(feature = "std", test)), no_std)]
#![cfg_attr(docsrs, feature(doc_cfg))]
#![deny(unsafe_code)]

extern crate alloc;

pub use glam;

mod bounds;
pub mod double;
mod double_vector;
mod error;
mod expansion;
mod frame;
pub mod geometry;
mod hit;
pub mod kernel;
mod math;
pub mod poly;
mod primitive;
mod ray;
mod scaled;
pub mod shape;
mod surface;
#[cfg(any(test, feature = "testing"))]
#[cfg_attr(docsrs, doc(cfg(feature = "testing")))]
pub mod testing;
mod transform;

pub use bounds::Aabb;
pub use error::Error;
pub use geometry::{DirectionCube, Found, Geometry, GeometryBuilder, Screen};
pub use hit::{Hit, Interval};
pub use primitive::Primitive;
pub use ray::Ray;
pub use shape::Shape;
pub use surface::{Departure, Side, Surface};
pub use transform::Similarity;
