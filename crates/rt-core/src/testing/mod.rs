//! The contract of a shape as a callable test, and the hard rays it runs (feature `testing`).
//!
//! [`check_primitive`] casts hard rays at any [`Primitive`](crate::Primitive) and checks what the library relies on.
//! Run it on a shape of your own before you render it:
//!
//! ```
//! use rt_core::glam::DVec3;
//! use rt_core::testing::{Effort, check_primitive};
//! use rt_core::{Aabb, Departure, Hit, Interval, Primitive, Ray, Surface};
//!
//! /// The square with corners (-1, 0, -1) and (1, 0, 1).
//! #[derive(Debug)]
//! struct Tile;
//!
//! impl Primitive for Tile {
//!     fn hit(&self, ray: &Ray, within: Interval) -> Option<Hit> {
//!         let t = -ray.origin.y / ray.direction.y;
//!         let p = ray.at(t);
//!         if ray.is_valid() && p.x.abs() <= 1.0 && p.z.abs() <= 1.0 { within.admit(t, 0, 0) } else { None }
//!     }
//!     fn surface(&self, ray: &Ray, hit: Hit) -> Surface {
//!         let mut p = ray.at(hit.t());
//!         p.y = 0.0;
//!         // Two roundings in t, one in the product, one in the sum: 4 u (|o| + |t d|), u = EPSILON / 2.
//!         let reach = (ray.origin.abs() + (ray.direction * hit.t()).abs()).element_sum();
//!         Surface::new(hit.t(), p, p, DVec3::Y, 2.0 * f64::EPSILON * reach)
//!     }
//!     fn bounds(&self) -> Option<Aabb> {
//!         Some(Aabb::new(DVec3::new(-1.0, 0.0, -1.0), DVec3::new(1.0, 0.0, 1.0)))
//!     }
//!     // A flat shape never meets again a ray that leaves it.
//!     fn hit_leaving(&self, _: &Ray, _: Interval, _: &Departure) -> Option<Hit> {
//!         None
//!     }
//! }
//!
//! check_primitive(&Tile, &Effort::default()).unwrap();
//! ```

mod contract;
mod hard_rays;
pub mod oracle;
mod random;
mod truth;

pub use contract::{Effort, Failure, check_primitive};
pub use hard_rays::HardRays;
pub use random::Random;
pub use truth::check_crossings;
