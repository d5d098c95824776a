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

/// Whether a picture of this size fits in the memory, with its file beside it: found out before hours of work.
pub fn check_memory(width: u32, height: u32) -> Result<(), Failure> {
    // 12 bytes a pixel, and as many again in the largest of the formats.
    let bytes = (24 * u64::from(width)).saturating_mul(u64::from(height));
    let reserved =
        usize::try_from(bytes).is_ok_and(|bytes| Vec::<u8>::new().try_reserve_exact(bytes).is_ok());
    if reserved && available_memory().is_none_or(|available| bytes <= available) {
        return Ok(());
    }
    let needed = bytes as f64 / f64::from(1 << 30);
    Err(Failure::Work(format!(
        "{width} x {height} pixels take {needed:.1} GiB of memory, more than there is: render a region, or parts with --tile K/N"
    )))
}

/// What the system says it can still give, swap space included; `None` where it does not say. A reservation alone may
/// succeed and the process be killed later, when the memory is used.
fn available_memory() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let kilobytes = |key: &str| {
        let line = text.lines().find_map(|line| line.strip_prefix(key))?;
        line.trim().strip_suffix(" kB")?.parse::<u64>().ok()
    };
    Some(1024 * (kilobytes("MemAvailable:")? + kilobytes("SwapFree:").unwrap_or(0)))
}

/// The bytes of the file.
pub fn encode(picture: &Picture, format: Format) -> Result<Vec<u8>, Failure> {
    match format {
        Format::Png => picture.to_png().map_err(|error| Failure::Work(error.to_string())),
        Format::Pfm => Ok(picture.to_pfm()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_no_memory_holds_is_refused() {
        assert!(check_memory(1000, 1000).is_ok());
        let refused = check_memory(u32::MAX, u32::MAX).unwrap_err();
        assert_eq!(refused.exit_code(), 1);
        assert!(refused.to_string().contains("GiB"));
    }

    #[test]
    fn formats_by_ending() {
        assert_eq!(Format::of(Path::new("a/B.PNG")).ok(), Some(Format::Png));
        assert_eq!(Format::of(Path::new("-")).ok(), Some(Format::Png));
        assert_eq!(Format::of(Path::new("a.pfm")).ok(), Some(Format::Pfm));
        assert!(Format::of(Path::new("a.jpg")).is_err() && Format::of(Path::new("png")).is_err());
    }
}
