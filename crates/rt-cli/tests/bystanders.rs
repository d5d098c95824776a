//! Hard rays at shapes in a crowd: what `rt cast --scene` says of a shape among 1,000 others that the ray misses is
//! what `rt cast` says of it alone, bit for bit.
//!
//! `RT_BYSTANDERS` sets the number of rows of each kind of shape (default 25).

mod support;

use rt_core::glam::DVec3;
use serde_json::Value;
use std::fmt::Write;
use support::{Workshop, repository, shared};

/// How many others there are in each scene.
const OTHERS: usize = 1000;

const HEAD: &str = "version = 1\n[image]\nwidth = 1\nheight = 1\n[camera]\neye = [0, 0, 1]\nlook_at = [0, 0, 0]\n[material.plain]\n";

/// Pseudo-random numbers from 0 to 1: a linear congruential generator (Knuth's MMIX).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn in_cube(&mut self) -> DVec3 {
        DVec3::new(self.next() - 0.5, self.next() - 0.5, self.next() - 0.5) * 2.0
    }
}

fn vector(value: &Value) -> DVec3 {
    DVec3::from([0, 1, 2].map(|i| value[i].as_f64().unwrap()))
}

/// A list of three numbers that TOML and Rust read alike, to the last bit.
fn list(v: DVec3) -> String {
    format!("[{:?}, {:?}, {:?}]", v.x, v.y, v.z)
}

/// The middle of a shape and its size; of a plane, its point and the distance from the ray's origin.
fn place(kind: &str, numbers: &Value, origin: DVec3) -> (DVec3, f64) {
    let points: Vec<DVec3> = ["point", "center", "min", "max", "base", "top", "a", "b", "c"]
        .into_iter()
        .filter_map(|key| numbers.get(key))
        .map(vector)
        .collect();
    let middle = points.iter().map(|p| *p / points.len() as f64).sum::<DVec3>();
    let radii = ["radius", "base_radius", "top_radius", "major", "minor"];
    let radius: f64 = radii.into_iter().filter_map(|key| numbers.get(key)?.as_f64()).sum();
    let size = points.iter().fold(radius, |size, p| size.max((*p - middle).abs().max_element()));
    if kind == "plane" { (middle, (origin - middle).abs().max_element().max(1e-300)) } else { (middle, size) }
}

/// A vector times a power of two that makes its largest component about one, so that squares stay in range.
fn reduced(v: DVec3) -> DVec3 {
    v / v.abs().max_element()
}

/// A shape of one of four kinds inside the ball of this radius.
fn other(kind: usize, center: DVec3, radius: f64, random: &mut Random) -> String {
    let (half, axis) = (radius * 0.5, random.in_cube());
    match kind {
        0 => format!("sphere = {{ center = {}, radius = {radius:?} }}", list(center)),
        1 => format!("cuboid = {{ min = {}, max = {} }}", list(center - half), list(center + half)),
        2 => {
            let up = reduced(axis) * (half * 0.5);
            let (base, top) = (list(center - up), list(center + up));
            format!("cylinder = {{ base = {base}, top = {top}, radius = {:?} }}", half * 0.5)
        }
        _ => {
            let (center, axis) = (list(center), list(reduced(axis)));
            format!(
                "torus = {{ center = {center}, axis = {axis}, major = {half:?}, minor = {:?} }}",
                half * 0.5
            )
        }
    }
}

/// A scene of the shape, as object `it`, and the others, none of which the line of the ray comes near.
fn scene(row: &Value, seed: u64) -> String {
    let (kind, numbers) = row["shape"].as_object().unwrap().iter().next().unwrap();
    let (origin, direction) = (vector(&row["origin"]), vector(&row["direction"]));
    let along = reduced(direction).normalize();
    let (middle, size) = place(kind, numbers, origin);
    let fields: Vec<String> = numbers
        .as_object()
        .unwrap()
        .iter()
        .map(|(key, value)| format!("{key} = {}", number(value)))
        .collect();
    let it = format!(
        "[[object]]\nname = \"it\"\nmaterial = \"plain\"\nshape.{kind} = {{ {} }}\n",
        fields.join(", ")
    );
    let mut text = String::from(HEAD);
    let mut random = Random(seed);
    let mut count = 0;
    while count < OTHERS {
        if count == OTHERS / 2 && !text.contains("\"it\"") {
            text.push_str(&it);
        }
        // Three in four about the shape, the others beside the ray's way to it.
        let radius = size * (0.01 + 0.1 * random.next());
        let anchor = if count % 4 == 0 { middle + (origin - middle) * random.next() } else { middle };
        let center = anchor + random.in_cube() * (3.0 * size);
        // In units of the size; the distance from the line is known to some roundings of the way to the place.
        let way = (center - origin) / size;
        let apart = along.cross(way).length() - 1e-14 * (way.length() + center.abs().max_element() / size);
        if apart > 1.5 * radius / size {
            let shape = other(count % 4, center, radius, &mut random);
            // Writing to a text does not fail.
            let _ = writeln!(text, "[[object]]\nmaterial = \"plain\"\nshape.{shape}");
            count += 1;
        }
    }
    text
}

fn number(value: &Value) -> String {
    if value.is_array() { list(vector(value)) } else { format!("{:?}", value.as_f64().unwrap()) }
}

/// This many rows of the kind, evenly spread over what there is: the shared ones, else those that the repository keeps.
fn rows(kind: &str, count: usize) -> Vec<String> {
    let mut files = vec![];
    match shared() {
        Some(folder) => files.push(folder.join("cases/rays.jsonl")),
        None => {
            files.extend(["rays_flat", "rays_quadrics", "rays_torus"].map(|name| {
                repository().join("crates/rt-core/tests/data").join(name).with_extension("jsonl")
            }))
        }
    }
    let key = format!("\"shape\": {{\"{kind}\":");
    let all: Vec<String> = files
        .iter()
        .flat_map(|file| {
            let text = std::fs::read_to_string(file).unwrap();
            text.lines().filter(|line| line.contains(&key)).map(String::from).collect::<Vec<_>>()
        })
        .collect();
    assert!(!all.is_empty(), "no rows for {kind}");
    let count = count.min(all.len());
    (0..count).map(|i| all[i * all.len() / count].clone()).collect()
}

fn check(kind: &str) {
    let count = std::env::var("RT_BYSTANDERS").ok().and_then(|n| n.parse().ok()).unwrap_or(25);
    let workshop = Workshop::new();
    let mut hits = 0;
    for (index, line) in rows(kind, count).into_iter().enumerate() {
        let mut row: Value = serde_json::from_str(&line).unwrap();
        workshop.write("crowd.toml", scene(&row, index as u64));
        let alone = workshop.rt_with(&["cast"], line.as_bytes());
        assert_eq!(alone.code(), 0, "{}", alone.stderr);
        row.as_object_mut().unwrap().remove("shape");
        let ray = row.to_string();
        // Without `--first` all crossings of all shapes are looked for, with it the tree is searched for the nearest.
        let among = |first: &[&str]| {
            let outcome =
                workshop.rt_with(&[&["cast", "--scene", "crowd.toml"], first].concat(), ray.as_bytes());
            assert_eq!(outcome.code(), 0, "{}", outcome.stderr);
            outcome.text().replace(",\"object\":\"it\"", "")
        };
        assert_eq!(among(&[]), alone.text(), "{line}");
        let first = workshop.rt_with(&["cast", "--first"], line.as_bytes());
        assert_eq!(among(&["--first"]), first.text(), "first of {line}");
        hits += alone.text().matches("\"t\"").count();
    }
    assert!(hits > 0, "{kind}: nothing was hit");
}

macro_rules! kinds {
    ($($kind:ident)*) => {
        $(#[test]
        fn $kind() {
            check(stringify!($kind));
        })*
    };
}

kinds! { sphere plane cuboid cylinder open_cylinder cone torus disk triangle }
