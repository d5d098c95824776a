//! The two picture formats, told by the file's ending.

use crate::failure::Failure;
use rt_shade::Picture;
use std::path::Path;

/// How a picture is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// 8 bits a channel, sRGB.
    Png,
    /// Linear `f32`, rows from the bottom.
    Pfm,
}

impl Format {
    /// The format for this file; standard output, `-`, takes PNG.
    pub fn of(path: &Path) -> Result<Format, Failure> {
        if path.as_os_str() == "-" {
            return Ok(Format::Png);
        }
        match path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).as_deref() {
            Some("png") => Ok(Format::Png),
            Some("pfm") => Ok(Format::Pfm),
            // Devices have no ending: `/dev/full` and `/dev/null` take PNG, as standard output does.
            None if path.starts_with("/dev") => Ok(Format::Png),
            _ => Err(Failure::Usage(format!("{}: a picture must end in .png or .pfm", path.display()))),
        }
    }
}

/// The bytes of the file.
pub fn encode(picture: &Picture, format: Format) -> Result<Vec<u8>, Failure> {
    match format {
        Format::Png => picture.to_png().map_err(|error| Failure::Work(error.to_string())),
        Format::Pfm => Ok(picture.to_pfm()),
    }
}
