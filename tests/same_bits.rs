//! Every scene of the repository has one picture, to the last bit: whatever the number of threads, the size of tiles,
//! the instruction set, in debug and release builds, today and on other machines. `tests/golden.txt` holds the hashes.
//!
//! A change that means to alter pictures says so in the changelog and writes the file anew:
//! `RT_GOLDEN=write cargo test --test same_bits`.

use rt::rt_core::kernel::{Level, level, set_level};
use rt::rt_shade::text::{Loaded, load};
use rt::rt_shade::{Antialias, Region, Settings, render};
use std::fmt::Write;
use std::path::Path;

fn repository() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// FNV-1a, 64 bits.
fn hash(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xCBF2_9CE4_8422_2325, |h, &b| (h ^ u64::from(b)).wrapping_mul(0x0000_0100_0000_01B3))
}

fn picture(loaded: &Loaded, settings: &Settings) -> Vec<u8> {
    render(&loaded.scene, settings, &()).unwrap().picture.to_pfm()
}

#[test]
fn every_scene_has_one_picture() {
    let mut paths: Vec<_> = std::fs::read_dir(repository().join("scenes"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "toml" || e == "nff"))
        .collect();
    paths.sort();
    assert!(!paths.is_empty());
    let best = level();
    let mut found = String::new();
    for path in paths {
        let name = path.file_name().unwrap().to_string_lossy();
        let pictures =
            |file: &str| std::fs::read(repository().join("scenes").join(file)).map_err(|e| e.to_string());
        let loaded = load(&name, &std::fs::read(&path).unwrap(), &pictures).unwrap();
        let settings = Settings { width: 31, height: 23, threads: 1, tile: 32, ..loaded.settings };
        let first = picture(&loaded, &settings);
        for (threads, tile) in [(2, 8), (7, 17), (3, 1)] {
            assert!(
                picture(&loaded, &Settings { threads, tile, ..settings }) == first,
                "{name}: {threads} threads, tiles of {tile}"
            );
        }
        set_level(Level::Portable);
        assert!(picture(&loaded, &settings) == first, "{name}: without AVX2");
        set_level(best);
        let region = Some(Region { x: 5, y: 3, width: 7, height: 11 });
        let part = render(&loaded.scene, &Settings { region, ..settings }, &()).unwrap().picture;
        let whole = render(&loaded.scene, &settings, &()).unwrap().picture;
        for y in 0..11 {
            assert_eq!(
                part.pixels()[y * 7..][..7],
                whole.pixels()[(y + 3) * 31 + 5..][..7],
                "{name}: row {y}"
            );
        }
        let adaptive = picture(&loaded, &Settings { antialias: Antialias::ADAPTIVE, ..settings });
        let _ = writeln!(found, "{name} {:016x} adaptive {:016x}", hash(&first), hash(&adaptive));
    }
    let golden = repository().join("tests/golden.txt");
    if std::env::var("RT_GOLDEN").is_ok_and(|value| value == "write") {
        std::fs::write(&golden, found).unwrap();
        return;
    }
    assert_eq!(found, std::fs::read_to_string(&golden).unwrap(), "see the head of this test");
}
