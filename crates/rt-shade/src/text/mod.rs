//! Scenes as text: TOML, and the Neutral File Format (NFF, see [`nff`]).
//!
//! [`load`] chooses by the ending of the file's name. Every error of a file is found in one go ([`Diagnostics`]): with
//! its place, the source line, and a word on how to mend it.
//!
//! # The format in TOML
//!
//! Lengths are in any one unit, angles in degrees, the frame is right-handed. A point, direction or colour is a list of
//! three numbers; colours are linear, 1 is white. Unknown keys are errors, unused materials and textures are not.
//!
//! | table | key | meaning | default |
//! |---|---|---|---|
//! | | `version` | of the format: 1 | 1 |
//! | `[image]` | `width`, `height` | pixels, 1 to 65536 | 640, 480 |
//! | | `background` | what rays see that hit nothing | black |
//! | `[camera]` | `eye`, `look_at` | points | |
//! | | `up` | direction to the top of the picture, not along the view | `[0, 1, 0]` |
//! | | `fov` | full vertical angle, between 0 and 180 | 40 |
//! | `[render]` | `max_depth` | depth of the deepest rays, 1 to 1000, the eye ray is 1 | 8 |
//! | | `ambient` | light from everywhere | black |
//! | | `antialias` | `"none"`, `"grid:N"`, `"adaptive"` or `"adaptive:THRESHOLD:DEPTH"` | `"none"` |
//! | `[[light]]` | `point` or `spot` | a table, see below | |
//! | `[texture.NAME]` | `solid`, `checker` or `image` | a table, see below | |
//! | `[material.NAME]` | `color` | of diffuse and ambient light | white |
//! | | `texture` | the name of one, instead of `color` | |
//! | | `diffuse` | share of diffuse and ambient light | 1 |
//! | | `specular`, `shininess` | the highlight: `specular * cos^shininess` | 0, 50 |
//! | | `reflect` | share of the mirror ray, 0 to 1 | 0 |
//! | | `transmit` | what comes through, each channel 0 to 1 | black |
//! | | `ior` | index of refraction, 0.001 to 1000 | light goes straight through, no Fresnel |
//! | `[[object]]` | `material` | the name of one | |
//! | | `shape.KIND` | a table, see [`shape`] | |
//! | | `name` | for messages | empty |
//! | | `scale` | factor about the origin, greater than 0; first of the three | 1 |
//! | | `rotate` | `{ axis, degrees }` about the origin, counter-clockwise as seen against the axis | none |
//! | | `translate` | last of the three | none |
//! | | `no_shadow` | whether light passes | false |
//!
//! | table | key | meaning | default |
//! |---|---|---|---|
//! | `point`, `spot` | `position` | a point | |
//! | | `color` | | white |
//! | | `attenuation` | `[c, l, q]`: light fades as `1 / (c + l d + q d^2)` with the distance | `[1, 0, 0]` |
//! | `spot` | `target` | a point on the axis | |
//! | | `outer` | half angle of the cone, no light outside it, up to 180 | |
//! | | `inner` | half angle of full light | `outer`: a sharp edge |
//! | `solid` | `color` | | |
//! | `checker` | `colors` | two | |
//! | | `size` | edge of a cube or square | 1 |
//! | `image` | `path` | a PNG or PFM, relative to the scene and within its folder | |
//! | | `size` | width of one picture on a plane and a disk | 1 |

mod diagnostic;
pub mod nff;
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
