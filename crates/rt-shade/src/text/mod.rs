//! Scenes as text: TOML, and the Neutral File Format (NFF).
//!
//! [`load`] chooses by the ending of the file's name. Every error of a file is found in one go ([`Diagnostics`]): with
//! its place, the source line, and a word on how to mend it.

mod diagnostic;
mod nff;
mod picture;
mod reader;
pub mod shape;
mod suggest;
mod toml;

pub use diagnostic::{Diagnostic, Diagnostics, MOST_ERRORS};
pub use nff::load_nff;
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

/// Reads a scene from the bytes of a file, as NFF if the name ends in `.nff`, otherwise as TOML. A byte order mark is
/// passed over, and lines may end in any way.
///
/// # Errors
/// As [`load_toml`] and [`load_nff`]; also when the file is empty, or not text in UTF-8.
pub fn load(name: &str, bytes: &[u8], pictures: &dyn PictureLoader) -> Result<Loaded, Diagnostics> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let text = match std::str::from_utf8(bytes) {
        Ok(text) => text,
        Err(error) => {
            let at = error.valid_up_to();
            let byte = bytes.get(at).copied().unwrap_or(0);
            let message = format!("the byte 0x{byte:02x} is not UTF-8 text: save the file as UTF-8");
            return Err(Diagnostics::at(name, bytes, at, message));
        }
    };
    if let Some(at) = text.bytes().position(|b| b.is_ascii_control() && !matches!(b, b'\t'..=b'\r')) {
        let code = bytes[at];
        let message =
            format!("the control character 0x{code:02x} does not belong in a scene: is this a text file?");
        return Err(Diagnostics::at(name, bytes, at, message));
    }
    if text.trim().is_empty() {
        return Err(Diagnostics::of_file(name, "the file is empty: a scene needs at least a camera"));
    }
    let is_nff = name.len() >= 4 && name.as_bytes()[name.len() - 4..].eq_ignore_ascii_case(b".nff");
    if is_nff { load_nff(name, text) } else { load_toml(name, text, pictures) }
}
