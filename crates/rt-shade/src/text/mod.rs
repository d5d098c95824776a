//! Scenes as text: TOML, and the Neutral File Format (NFF).
//!
//! [`load`] chooses by the ending of the file's name. Every error of a file is found in one go ([`Diagnostics`]): with
//! its place, the source line, and a word on how to mend it.

mod diagnostic;
mod picture;
mod reader;
pub mod shape;
mod suggest;
mod toml;

pub use diagnostic::{Diagnostic, Diagnostics, MOST_ERRORS};
pub use picture::{NoPictures, PictureLoader, check_path};
pub use toml::load_toml;

use crate::{Scene, Settings};

/// The full vertical angle of a camera that names none, in degrees.
const DEFAULT_FOV: f64 = 40.0;

/// A scene and how its file wants it to be rendered.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Loaded {
    /// The checked scene.
    pub scene: Scene,
    /// Size, depth and anti-aliasing as the file says, otherwise the defaults.
    pub settings: Settings,
}
