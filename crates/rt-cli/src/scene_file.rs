//! Reads a scene and its pictures from files.

use crate::failure::Failure;
use rt_shade::{Scene, Settings, text};
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// The longest scene that is read: a million spheres in NFF take a tenth of it. Without a limit a device such as
/// `/dev/zero` would fill the memory.
const LONGEST_SCENE: u64 = 1 << 30;
/// The longest file that is read as a texture.
const LONGEST_PICTURE: u64 = 1 << 28;

/// A checked scene and what its text says about rendering it.
pub struct Loaded {
    pub scene: Scene,
    pub settings: Settings,
    /// A hash of the text: what parts of one picture have in common.
    pub hash: u64,
    /// How long reading, parsing and checking took.
    pub load: Duration,
    /// How long the acceleration structure took.
    pub build: Duration,
}

/// Reads and checks a scene. `-` is standard input, taken as TOML whose pictures lie in the current folder.
///
/// # Errors
/// [`Failure::File`] when it cannot be read, [`Failure::Input`] with all errors in it.
pub fn load(path: &Path) -> Result<Loaded, Failure> {
    let start = Instant::now();
    let stdin = path.as_os_str() == "-";
    let name = if stdin { "<stdin>".into() } else { path.to_string_lossy() };
    let bytes = if stdin {
        read_at_most(io::stdin().lock(), LONGEST_SCENE)
    } else {
        File::open(path).and_then(|file| read_at_most(file, LONGEST_SCENE))
    };
    let bytes = bytes.map_err(Failure::file("read", path))?;
    let folder = match path.parent() {
        Some(folder) if !stdin && !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let pictures = |path: &str| read_picture(folder, path);
    let loaded = text::load(&name, &bytes, &pictures);
    let text::Loaded { scene, settings, .. } = loaded.map_err(|errors| Failure::Input(errors.to_string()))?;
    let hash = crate::place::mix(crate::place::EMPTY_HASH, &bytes);
    let build = scene.build_time();
    Ok(Loaded { scene, settings, hash, load: start.elapsed().saturating_sub(build), build })
}

fn read_at_most(mut from: impl Read, most: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let read = from.by_ref().take(most + 1).read_to_end(&mut bytes)?;
    if read as u64 > most {
        return Err(io::Error::new(io::ErrorKind::FileTooLarge, format!("larger than {most} bytes")));
    }
    Ok(bytes)
}

/// Reads a picture that a scene names. The words of its path have been checked; here symbolic links are followed, and
/// must not lead out of the scene's folder either.
fn read_picture(folder: &Path, path: &str) -> Result<Vec<u8>, String> {
    let tried = folder.join(path);
    let failed = |error: io::Error| format!("{} ({})", reason(&error), tried.display());
    let real = tried.canonicalize().map_err(failed)?;
    if !real.starts_with(folder.canonicalize().map_err(failed)?) {
        return Err(
            "a symbolic link leads out of the scene's folder: put the picture beside the scene".into()
        );
    }
    // Opening a pipe would wait for a writer, a device might never end.
    let is_file = |path: &PathBuf| path.metadata().map(|found| found.is_file());
    if !is_file(&real).map_err(failed)? {
        return Err(format!("not a file ({})", tried.display()));
    }
    File::open(&real).and_then(|file| read_at_most(file, LONGEST_PICTURE)).map_err(failed)
}

/// The system's words without its number.
fn reason(error: &io::Error) -> String {
    let text = error.to_string();
    text.split(" (os error").next().unwrap_or(&text).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn pictures_come_from_the_scenes_folder_alone() {
        let outer = tempfile::tempdir().unwrap();
        let folder = outer.path().join("scenes");
        fs::create_dir(&folder).unwrap();
        fs::write(folder.join("in.png"), "in").unwrap();
        fs::write(outer.path().join("out.png"), "out").unwrap();
        assert_eq!(read_picture(&folder, "in.png").unwrap(), b"in");
        assert_eq!(read_picture(&folder, "./in.png").unwrap(), b"in");
        assert!(read_picture(&folder, "missing.png").unwrap_err().contains("missing.png"));
        assert!(read_picture(&folder, "../out.png").is_err());
        assert!(read_picture(&folder, ".").is_err());
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(outer.path().join("out.png"), folder.join("link.png")).unwrap();
            assert!(read_picture(&folder, "link.png").unwrap_err().contains("symbolic link"));
            std::os::unix::fs::symlink("in.png", folder.join("inner.png")).unwrap();
            assert_eq!(read_picture(&folder, "inner.png").unwrap(), b"in");
        }
    }

    #[test]
    fn what_is_too_long_is_refused() {
        assert_eq!(read_at_most(&b"12345"[..], 5).unwrap(), b"12345");
        assert!(read_at_most(&b"123456"[..], 5).is_err());
    }
}
