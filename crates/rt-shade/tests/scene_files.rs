//! The scenes of this repository and those of others: all are read, and none does harm when it is cut off.

use rt_shade::text::{Diagnostics, Loaded, load};
use std::path::{Path, PathBuf};

/// The files of a folder with this ending, by name.
fn files(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut found: Vec<PathBuf> = entries
        .map(|entry| entry.path())
        .filter(|path| path.extension().is_some_and(|e| e == ending))
        .collect();
    found.sort();
    found
}

/// Reads the first bytes of a scene; every picture is one grey texel.
fn read(path: &Path, bytes: &[u8]) -> Result<Loaded, Diagnostics> {
    let pictures = |_: &str| Ok([&b"PF\n1 1\n-1.0\n"[..], &[0, 0, 0, 63].repeat(3)].concat());
    load(&path.to_string_lossy(), bytes, &pictures)
}

#[test]
fn scenes_of_the_repository() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let scenes = files(&folder, "toml");
    if scenes.is_empty() {
        println!("skipped: no scenes beside the crate");
        return;
    }
    let mut cuts = 0;
    for path in scenes {
        let bytes = std::fs::read(&path).unwrap();
        // With its own pictures.
        let pictures = |name: &str| std::fs::read(folder.join(name)).map_err(|e| e.to_string());
        if let Err(found) = load(&path.to_string_lossy(), &bytes, &pictures) {
            panic!("{found}");
        }
        for end in 0..bytes.len() {
            if let Err(found) = read(&path, &bytes[..end]) {
                assert!(found.iter().all(|d| d.line > 0 && d.column > 0));
            }
            cuts += 1;
        }
    }
    println!("{cuts} scenes cut off: each an error with its place, or a smaller scene");
}

#[test]
fn scenes_of_others() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/scenes/nff");
    let scenes = files(&folder, "nff");
    if scenes.is_empty() {
        println!("skipped: no shared data");
        return;
    }
    // What the file is made of, so that nothing is lost: each entity once, each polygon as its triangles.
    let expected = |text: &str| -> usize {
        let mut words = text.split_whitespace();
        let mut count = 0;
        while let Some(word) = words.next() {
            count += match word {
                "s" | "c" => 1,
                "p" | "pp" => words.next().unwrap().parse::<usize>().unwrap() - 2,
                _ => 0,
            };
        }
        count
    };
    for path in scenes {
        let text = std::fs::read_to_string(&path).unwrap();
        let loaded = read(&path, text.as_bytes()).unwrap_or_else(|found| panic!("{found}"));
        assert_eq!(loaded.scene.objects().len(), expected(&text), "{path:?}");
        for part in 0..50 {
            let _ = read(&path, &text.as_bytes()[..text.len() * part / 50]);
        }
        // Every fortieth number is not one.
        for bad in ["nan", "-inf", "1e999", "99999999999", "p"] {
            let words: Vec<&str> = text.split(' ').collect();
            let broken: Vec<&str> =
                words.iter().enumerate().map(|(i, w)| if i % 40 == 39 { bad } else { *w }).collect();
            if bad != "99999999999" {
                let found = read(&path, broken.join(" ").as_bytes()).unwrap_err();
                assert!(found.iter().all(|d| d.line > 0 && d.column > 0));
            } else {
                let _ = read(&path, broken.join(" ").as_bytes());
            }
        }
    }
}
