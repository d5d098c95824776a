//! `rt check`: all that is wrong with a scene.

use crate::failure::Failure;
use crate::scene_file;
use std::io::Write;
use std::path::Path;

/// Reads the scene as `rt render` would, its pictures too, and renders nothing.
pub fn run(path: &Path, quiet: bool) -> Result<(), Failure> {
    let loaded = scene_file::load(path)?;
    if !quiet {
        let (objects, lights) = (loaded.scene.objects().len(), loaded.scene.lights().len());
        let counted = |n: usize, what: &str| format!("{n} {what}{}", if n == 1 { "" } else { "s" });
        let counts = format!("{}, {}", counted(objects, "object"), counted(lights, "light"));
        let _ = writeln!(std::io::stderr(), "{}: no errors, {counts}", path.display());
    }
    Ok(())
}
