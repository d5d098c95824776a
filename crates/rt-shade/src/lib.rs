//! Whitted-style shading of analytic shapes.
#![forbid(unsafe_code)]
#![cfg_attr(docsrs, feature(doc_cfg))]

pub use rt_core;

#[cfg(feature = "text")]
pub mod text;
