//! Whitted-style shading of analytic shapes: lights, shadows, mirrors, glass, textures, anti-aliasing.
//!
//! A [`Scene`] is checked once, when it is built; [`render`] then draws it into a [`Picture`] of linear colours. The
//! picture has the same bits for any number of threads, any tile size and any region.
#![forbid(unsafe_code)]
// `!(a < b)` is meant: it is true for NaN.
#![allow(clippy::neg_cmp_op_on_partial_ord)]
#![cfg_attr(docsrs, feature(doc_cfg))]

pub use rt_core;

mod adaptive;
mod camera;
mod color;
mod error;
mod guard;
mod highlight;
mod light;
mod lighting;
mod material;
mod medium;
mod onward;
pub mod optics;
mod picture;
mod render;
mod sample;
mod scene;
mod settings;
#[cfg(feature = "image")]
mod srgb;
#[cfg(feature = "text")]
pub mod text;
mod texture;
mod whitted;

pub use camera::Camera;
pub use color::Color;
pub use error::Error;
pub use light::{Attenuation, Light};
pub use material::{Material, Optics, Paint};
pub use picture::Picture;
pub use render::{Progress, Rendering, render};
pub use scene::{Object, Scene, SceneBuilder};
pub use settings::{Antialias, Region, Settings, Stats};
pub use texture::{Checker, ImageTexture, Pattern, Texture};
