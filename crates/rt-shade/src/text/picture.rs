//! Pictures that a scene refers to: through a loader that the caller gives, as this crate reads no files.

/// Gives the bytes of the pictures that a scene refers to.
///
/// Any `Fn(&str) -> Result<Vec<u8>, String>` is a loader. A scene that may not refer to pictures is read with
/// [`NoPictures`].
pub trait PictureLoader {
    /// The bytes of the file at this path, which is relative to the scene's folder and has passed [`check_path`].
    ///
    /// # Errors
    /// Why it cannot be read, in words that make sense after "cannot read PATH: ".
    fn load(&self, path: &str) -> Result<Vec<u8>, String>;
}

impl<F: Fn(&str) -> Result<Vec<u8>, String>> PictureLoader for F {
    fn load(&self, path: &str) -> Result<Vec<u8>, String> {
        self(path)
    }
}

/// Has no pictures at all.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoPictures;

impl PictureLoader for NoPictures {
    fn load(&self, _path: &str) -> Result<Vec<u8>, String> {
        Err("pictures are not available here".to_string())
    }
}

/// Whether a path of a scene stays within the scene's folder on every system: relative, with `/` between its parts,
/// none of them `..`.
///
/// A loader that reads files must check one thing more: that no symbolic link leads out of the folder.
///
/// # Errors
/// What is wrong with the path and how to mend it.
///
/// ```
/// use rt_shade::text::check_path;
/// assert!(check_path("textures/wood.png").is_ok());
/// assert!(check_path("../wood.png").is_err());
/// assert!(check_path("/wood.png").is_err());
/// ```
pub fn check_path(path: &str) -> Result<(), String> {
    let wrong = if path.is_empty() {
        "is empty: name a PNG or PFM file in the scene's folder"
    } else if path.contains('\\') {
        "contains a backslash: write / between folders"
    } else if path.starts_with('/') || path.as_bytes().get(1) == Some(&b':') {
        "is absolute: give it relative to the scene's folder"
    } else if path.split('/').any(|part| part == "..") {
        "leaves the scene's folder: put the picture beside the scene"
    } else if path.chars().any(char::is_control) {
        "contains a control character: rename the file"
    } else {
        return Ok(());
    };
    Err(format!("the path `{path}` {wrong}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths() {
        for good in ["a.png", "a/b/c.png", "./a.png", "a..b/..c.png", "ä ö.png", "..."] {
            assert_eq!(check_path(good), Ok(()), "{good}");
        }
        for bad in
            ["", "/a", "..", "../a", "a/../b", "a/..", "C:a", "c:\\a", "a\\b", "\\\\host\\a", "a\0b", "a\nb"]
        {
            assert!(check_path(bad).is_err(), "{bad:?}");
        }
    }
}
