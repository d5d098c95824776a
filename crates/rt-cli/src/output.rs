//! Files are written whole or not at all: into a temporary file beside the target, synced, then renamed over it.

use crate::failure::Failure;
use std::fs::{self, File, OpenOptions};
use std::io::{self, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// Where a result goes, found writable before the work begins.
#[derive(Debug)]
pub enum Output {
    /// Standard output.
    Stdout,
    /// A device or a pipe: written straight, a rename would replace it.
    Device(PathBuf),
    /// A regular file, there already or not.
    File {
        /// As the user named it.
        shown: PathBuf,
        /// With symbolic links followed, so that the link stays and its target is replaced.
        path: PathBuf,
    },
}

/// The temporary file being written, to be removed when a second signal ends the process on the spot.
static UNFINISHED: Mutex<Option<PathBuf>> = Mutex::new(None);

/// Removes the temporary file being written, if there is one. Called just before the process exits.
pub fn abandon() {
    // The lock is held only to store a path, so this waits for nothing long.
    if let Ok(unfinished) = UNFINISHED.lock()
        && let Some(path) = unfinished.as_deref()
    {
        let _ = fs::remove_file(path);
    }
}

fn set_unfinished(path: Option<PathBuf>) {
    if let Ok(mut unfinished) = UNFINISHED.lock() {
        *unfinished = path;
    }
}

impl Output {
    /// Finds out whether `path` can be written, without touching what is there. `-` is standard output.
    pub fn check(path: &Path) -> Result<Output, Failure> {
        if path.as_os_str() == "-" {
            if io::stdout().is_terminal() {
                let advice =
                    "standard output is a terminal: send it to a file or a program, or name a file with -o";
                return Err(Failure::Usage(advice.into()));
            }
            return Ok(Output::Stdout);
        }
        let failed = |source| Failure::File { action: "write", path: path.into(), source };
        if path == Path::new("/dev/stdout") {
            return Ok(Output::Stdout);
        }
        // `/dev/fd/3` and its like lead to open files, which a rename would take away from their other writers.
        if path.starts_with("/dev") && fs::metadata(path).is_ok_and(|found| !found.is_dir()) {
            return Ok(Output::Device(path.into()));
        }
        let target = follow_links(path).map_err(failed)?;
        match fs::metadata(&target) {
            Ok(found) if found.is_dir() => return Err(failed(io::ErrorKind::IsADirectory.into())),
            Ok(found) if !found.is_file() => return Ok(Output::Device(target)),
            Ok(found) => {
                // A rename needs no leave of the old file; a file marked read-only is meant to stay all the same.
                if found.permissions().readonly() {
                    return Err(failed(io::ErrorKind::PermissionDenied.into()));
                }
                OpenOptions::new().append(true).open(&target).map_err(failed)?;
            }
            Err(error) if error.kind() == io::ErrorKind::NotFound => {}
            Err(error) => return Err(failed(error)),
        }
        // The folder must take a new file; this one goes away at once.
        temporary_beside(&target).map_err(failed)?;
        Ok(Output::File { shown: path.into(), path: target })
    }

    /// The file that will be replaced, if there is one.
    pub fn file(&self) -> Option<&Path> {
        match self {
            Output::File { path, .. } => Some(path),
            _ => None,
        }
    }

    /// Writes `bytes`. Whatever fails, and whenever the process is killed, a file holds either what it held before
    /// or all of `bytes`.
    pub fn write(&self, bytes: &[u8]) -> Result<(), Failure> {
        match self {
            Output::Stdout => {
                let mut stdout = io::stdout().lock();
                stdout.write_all(bytes).and_then(|()| stdout.flush()).map_err(Failure::stdout)
            }
            Output::Device(path) => {
                let write = || OpenOptions::new().append(true).open(path)?.write_all(bytes);
                write().map_err(Failure::file("write", path))
            }
            Output::File { shown, path } => {
                let result = replace(path, bytes);
                set_unfinished(None);
                result.map_err(Failure::file("write", shown))
            }
        }
    }
}

fn replace(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut temporary = temporary_beside(path)?;
    set_unfinished(Some(temporary.path().to_path_buf()));
    temporary.write_all(bytes).and_then(|()| temporary.flush()).map_err(plain)?;
    if let Ok(old) = fs::metadata(path) {
        temporary.as_file().set_permissions(old.permissions())?;
    }
    temporary.as_file().sync_all()?;
    // On failure the temporary file is removed as it is dropped.
    temporary.persist(path).map_err(|error| error.error)?;
    sync_folder(path);
    Ok(())
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

fn temporary_beside(path: &Path) -> io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    // A short name of its own: the target's name may be as long as names can be.
    builder.prefix(".rt-").suffix(".tmp");
    #[cfg(unix)]
    {
        // Like any new file, not private like most temporary ones; the process's mask applies.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder_of(path)).map_err(plain)
}

/// The system's own error: the temporary file's name, which the wrapped one adds, tells nobody anything.
fn plain(error: io::Error) -> io::Error {
    let inner = error.get_ref().and_then(|e| e.source()).and_then(|e| e.downcast_ref::<io::Error>());
    match inner.and_then(io::Error::raw_os_error) {
        Some(code) => io::Error::from_raw_os_error(code),
        None => error,
    }
}

/// Makes the rename itself last. Not every file system can: then the data are safe and the name follows when it may.
fn sync_folder(path: &Path) {
    #[cfg(unix)]
    if let Ok(folder) = File::open(folder_of(path)) {
        let _ = folder.sync_all();
    }
    #[cfg(not(unix))]
    let _ = path;
}

/// The path behind symbolic links, even when the last one points at nothing yet.
fn follow_links(path: &Path) -> io::Result<PathBuf> {
    let mut path = path.to_path_buf();
    // Linux gives up after 40 links as well.
    for _ in 0..40 {
        match fs::symlink_metadata(&path) {
            Ok(found) if found.file_type().is_symlink() => {
                let to = fs::read_link(&path)?;
                path = folder_of(&path).join(to);
            }
            _ => return Ok(path),
        }
    }
    Err(io::Error::other("too many symbolic links"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> =
            fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn checking_touches_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("new.png");
        Output::check(&path).unwrap();
        assert!(names(folder.path()).is_empty());
        fs::write(&path, "old").unwrap();
        Output::check(&path).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(names(folder.path()), ["new.png"]);
    }

    #[test]
    fn writing_replaces_and_leaves_nothing_behind() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        fs::write(&path, "old").unwrap();
        Output::check(&path).unwrap().write(b"new").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(names(folder.path()), ["a.png"]);
    }

    #[test]
    fn a_folder_is_no_file() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(Output::check(folder.path()).unwrap_err().exit_code(), 1);
        assert_eq!(Output::check(&folder.path().join("missing/a.png")).unwrap_err().exit_code(), 1);
    }

    #[cfg(unix)]
    #[test]
    fn links_stay_and_their_target_is_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let link = folder.path().join("link.png");
        std::os::unix::fs::symlink("target.png", &link).unwrap();
        Output::check(&link).unwrap().write(b"new").unwrap();
        assert_eq!(fs::read(folder.path().join("target.png")).unwrap(), b"new");
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    }

    #[cfg(unix)]
    #[test]
    fn permissions_are_those_of_a_new_file_or_of_the_old_one() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode() & 0o777;
        let plain = folder.path().join("plain");
        fs::write(&plain, "").unwrap();
        let new = folder.path().join("new.png");
        Output::check(&new).unwrap().write(b"new").unwrap();
        assert_eq!(mode(&new), mode(&plain));
        fs::set_permissions(&new, fs::Permissions::from_mode(0o640)).unwrap();
        Output::check(&new).unwrap().write(b"newer").unwrap();
        assert_eq!(mode(&new), 0o640);
        fs::set_permissions(&new, fs::Permissions::from_mode(0o440)).unwrap();
        assert_eq!(Output::check(&new).unwrap_err().exit_code(), 1);
    }
}
