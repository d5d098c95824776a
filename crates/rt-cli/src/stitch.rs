//! `rt stitch`: puts the parts of a picture together.

use crate::failure::Failure;
use crate::output::Output;
use crate::picture_file::{self, Format};
use crate::place::Place;
use rt_shade::Picture;
use std::fs;
use std::path::{Path, PathBuf};

/// Reads all parts and writes the whole picture.
pub fn run(parts: &[PathBuf], output: &Path) -> Result<(), Failure> {
    let format = Format::of(output)?;
    let target = Output::check(output)?;
    // Places first: they are small, and all that is wrong with the set shows before a pixel is decoded.
    let mut found: Vec<(Place, &Path)> = Vec::with_capacity(parts.len());
    for path in parts {
        let bytes = fs::read(path).map_err(Failure::file("read", path))?;
        if Format::of(path)? != format {
            let advice = "stitch parts to a file of their own kind, PNG to PNG and PFM to PFM";
            return Err(Failure::Usage(format!(
                "{}: not of the kind of {}: {advice}",
                path.display(),
                output.display()
            )));
        }
        let Some((place, _)) = Place::find(&bytes) else {
            return Err(wrong(path, "not a part of a picture: parts are rendered with --tile K/N"));
        };
        found.push((place, path));
    }
    check(&mut found)?;
    let Some(&(Place { width, height, .. }, _)) = found.first() else {
        return Err(Failure::Usage("no parts given".into()));
    };
    picture_file::check_memory(width, height)?;
    let mut whole = Picture::new(width, height);
    let columns = width as usize;
    for (place, path) in &found {
        let bytes = fs::read(path).map_err(Failure::file("read", *path))?;
        let (_, picture) = Place::find(&bytes).unwrap_or((*place, &bytes));
        let part = Picture::decode(picture).map_err(|error| wrong(path, &error.to_string()))?;
        let (first, end) = place.part.rows(height);
        if (part.width(), part.height()) != (width, end - first) {
            let (w, h) = (part.width(), part.height());
            return Err(wrong(
                path,
                &format!("{w} x {h} pixels, but its place says {width} x {}", end - first),
            ));
        }
        whole.pixels_mut()[first as usize * columns..end as usize * columns].copy_from_slice(part.pixels());
    }
    target.write(&picture_file::encode(&whole, format)?)
}

fn wrong(path: &Path, message: &str) -> Failure {
    Failure::Input(format!("{}: error: {message}", path.display()))
}

/// Sorts the parts and finds what is missing, repeated, unfinished or of another picture.
fn check(found: &mut [(Place, &Path)]) -> Result<(), Failure> {
    let Some(&(first, first_path)) = found.first() else { return Ok(()) };
    for (place, path) in found.iter() {
        let same = |p: &Place| (p.part.of, p.width, p.height, p.picture);
        if same(place) != same(&first) {
            let message =
                format!("part of another picture than {}: {place}, not {first}", first_path.display());
            return Err(wrong(path, &message));
        }
        if !place.finished {
            return Err(wrong(path, &format!("part {} was interrupted: render it again", place.part)));
        }
    }
    found.sort_by_key(|(place, _)| place.part.number);
    for pair in found.windows(2) {
        let [(a, a_path), (b, b_path)] = pair else { continue };
        if a.part == b.part {
            return Err(wrong(
                b_path,
                &format!("part {} is there twice, also as {}", b.part, a_path.display()),
            ));
        }
    }
    let present: Vec<u32> = found.iter().map(|(place, _)| place.part.number).collect();
    let missing: Vec<u32> = (1..=first.part.of).filter(|k| present.binary_search(k).is_err()).collect();
    if missing.is_empty() {
        return Ok(());
    }
    let mut list: Vec<String> = missing.iter().take(10).map(|k| format!("{k}/{}", first.part.of)).collect();
    if missing.len() > list.len() {
        list.push(format!("and {} more", missing.len() - list.len()));
    }
    Err(Failure::Input(format!("error: parts are missing: {}", list.join(", "))))
}
