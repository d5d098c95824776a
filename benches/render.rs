//! A whole picture, and reading a scene: the answers are checked first, a picture against the one that other tiles and
//! threads give.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use rt::rt_shade::text::{Loaded, load};
use rt::rt_shade::{Antialias, Settings, render};
use std::fmt::Write;
use std::hint::black_box;
use std::path::Path;
use std::time::Duration;

fn read(name: &str, text: &[u8]) -> Loaded {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let pictures = |file: &str| std::fs::read(scenes.join(file)).map_err(|e| e.to_string());
    load(name, text, &pictures).expect("a scene")
}

/// Some hundreds of spheres over a floor, as text.
fn spheres() -> String {
    let mut text =
        String::from("v\nfrom 9 7 9\nat 0 0 0\nup 0 1 0\nangle 45\nhither 1\nresolution 256 256\n");
    text += "l 8 12 3\nl -6 10 9\nf 0.8 0.7 0.6 0.9 0.1 20 0 0\n";
    text += "p 4\n-9 -2 -9\n-9 -2 9\n9 -2 9\n9 -2 -9\n";
    for i in 0..512 {
        let (x, y, z) = (i / 64, i / 8 % 8, i % 8);
        let _ = writeln!(text, "s {} {} {} 0.3", x - 4, f64::from(y) * 0.5 - 2.0, z - 4);
    }
    text
}

fn pictures(c: &mut Criterion) {
    let family =
        std::fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/family.toml")).expect("the scene");
    let spheres = spheres().into_bytes();
    for (name, text) in [("family.toml", &family), ("spheres.nff", &spheres)] {
        let loaded = read(name, text);
        let antialias = Antialias::Grid(2);
        let settings = Settings { width: 128, height: 128, threads: 1, antialias, ..loaded.settings };
        let rendered = render(&loaded.scene, &settings, &()).expect("a picture");
        let other =
            render(&loaded.scene, &Settings { threads: 2, tile: 7, ..settings }, &()).expect("a picture");
        assert!(
            rendered.picture == other.picture && rendered.stats == other.stats,
            "{name}: not the same bits"
        );
        assert!(rendered.stats.eye_hits > 0 && rendered.stats.shadow_hits > 0, "{name}: nothing to be seen");
        let mut group = c.benchmark_group(name);
        group.throughput(Throughput::Elements(rendered.stats.rays()));
        group.bench_function("render", |b| b.iter(|| render(black_box(&loaded.scene), &settings, &())));
        group.throughput(Throughput::Bytes(text.len() as u64));
        group.bench_function("read", |b| b.iter(|| read(name, black_box(text))));
        group.finish();
    }
}

/// Short runs, so that all benches together take minutes: ratios within one run settle in a second.
fn short() -> Criterion {
    Criterion::default()
        .sample_size(20)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_millis(1500))
}

criterion_group! { name = benches; config = short(); targets = pictures }
criterion_main!(benches);
