//! The family scene scaled by powers of two: the same bits. Scaled by other numbers and moved far from the world's
//! origin, where every number is rounded: the same picture.
//!
//! `RT_SCALED_PIXELS` sets the width and height of the pictures that are compared (default 200).
#![cfg(feature = "text")]

use rt_shade::{Antialias, Picture, Settings, render, text};
use toml::Value;

const LENGTHS: [&str; 18] = [
    "eye",
    "look_at",
    "position",
    "target",
    "point",
    "center",
    "min",
    "max",
    "base",
    "top",
    "radius",
    "base_radius",
    "top_radius",
    "major",
    "minor",
    "translate",
    "size",
    "a",
];

fn times(value: &mut Value, factor: f64) {
    match value {
        Value::Float(x) => *x *= factor,
        Value::Integer(x) => *value = Value::Float(*x as f64 * factor),
        Value::Array(values) => values.iter_mut().for_each(|value| times(value, factor)),
        // A lamp's table is called `point`, too.
        table => scale(table, factor),
    }
}

/// All lengths times `factor`; the linear part of an attenuation divided by it, the quadratic part by its square.
fn scale(value: &mut Value, factor: f64) {
    match value {
        Value::Table(table) => {
            for (key, value) in table.iter_mut() {
                match (key.as_str(), &mut *value) {
                    ("attenuation", Value::Array(parts)) => {
                        times(&mut parts[1], 1.0 / factor);
                        times(&mut parts[2], 1.0 / (factor * factor));
                    }
                    (key, value) if LENGTHS.contains(&key) => times(value, factor),
                    (_, value) => scale(value, factor),
                }
            }
        }
        Value::Array(values) => values.iter_mut().for_each(|value| scale(value, factor)),
        _ => {}
    }
}

/// Where the scene goes, as a share of the length by which it is moved.
const WAY: [f64; 3] = [0.57, 0.61, -0.55];

/// The keys of points. The points of an object that is turned or moved itself stay: its translation says where it is.
const POINTS: [&str; 11] =
    ["eye", "look_at", "position", "target", "point", "center", "min", "max", "base", "top", "translate"];

fn shift(value: &mut Value, by: f64) {
    match value {
        Value::Array(parts) if parts.len() == 3 && !parts[0].is_table() => {
            for (part, way) in parts.iter_mut().zip(WAY) {
                let x = part.as_float().unwrap_or_else(|| part.as_integer().expect("a number") as f64);
                *part = Value::Float(x + by * way);
            }
        }
        other => move_points(other, by),
    }
}

/// All points moved by the same vector of about this length.
fn move_points(value: &mut Value, by: f64) {
    match value {
        Value::Table(table) if table.contains_key("translate") => shift(&mut table["translate"], by),
        Value::Table(table) => {
            assert!(!table.contains_key("rotate"), "a turn about the old origin");
            for (key, value) in table.iter_mut() {
                if POINTS.contains(&key.as_str()) { shift(value, by) } else { move_points(value, by) }
            }
        }
        Value::Array(values) => values.iter_mut().for_each(|value| move_points(value, by)),
        _ => {}
    }
}

/// The family scene times `factor`, then moved by about `distance`; a picture of `pixels` times as many.
fn family(factor: f64, distance: f64, pixels: u32, antialias: Antialias) -> Picture {
    let scenes = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/");
    let mut value: Value =
        toml::from_str(&std::fs::read_to_string(format!("{scenes}family.toml")).unwrap()).unwrap();
    scale(&mut value, factor);
    if distance > 0.0 {
        move_points(&mut value, distance);
    }
    let pictures = |path: &str| std::fs::read(format!("{scenes}{path}")).map_err(|e| e.to_string());
    let text = toml::to_string(&value).unwrap();
    let loaded = text::load("family.toml", text.as_bytes(), &pictures).unwrap();
    let settings = Settings { width: pixels, height: pixels, antialias, ..loaded.settings };
    render(&loaded.scene, &settings, &()).unwrap().picture
}

#[test]
fn powers_of_two_change_no_bit() {
    let picture = family(1.0, 0.0, 80, Antialias::Grid(2));
    // 2^40 and 2^-40.
    let factor = f64::from(1 << 20) * f64::from(1 << 20);
    assert!(family(factor, 0.0, 80, Antialias::Grid(2)) == picture, "2^40");
    assert!(family(1.0 / factor, 0.0, 80, Antialias::Grid(2)) == picture, "2^-40");
}

/// How many pixels of two pictures differ by more than 8 of 255 in a channel, as a screen shows them (sRGB).
fn differences(a: &Picture, b: &Picture) -> usize {
    let encoded = |v: f32| {
        let v = f64::from(v.clamp(0.0, 1.0));
        if v <= 0.0031308 { 12.92 * v } else { 1.055 * libm::pow(v, 1.0 / 2.4) - 0.055 }
    };
    let apart = |(a, b): (&f32, &f32)| (encoded(*a) - encoded(*b)).abs() > 8.0 / 255.0;
    a.pixels().iter().zip(b.pixels()).filter(|(a, b)| a.iter().zip(*b).any(apart)).count()
}

/// Lengths times 1e-6 to 1e6, moved by up to 1e6 times the unit of the scene: at most one pixel in 10,000 differs by
/// more than 8 of 255. Such pixels lie on the outlines of objects and the edges of squares of the floor.
#[test]
fn other_scales_and_places_change_next_to_no_pixel() {
    let pixels = std::env::var("RT_SCALED_PIXELS").ok().and_then(|n| n.parse().ok()).unwrap_or(200);
    let picture = family(1.0, 0.0, pixels, Antialias::None);
    // What a picture must not be for this to say anything: empty.
    assert!(differences(&Picture::new(pixels, pixels), &picture) > (pixels * pixels / 2) as usize);
    for factor in [1e-6, 1e-3, 1.0, 1e3, 1e6] {
        for distance in [0.0, 1e3, 1e6] {
            let differ = differences(&family(factor, distance * factor, pixels, Antialias::None), &picture);
            println!("times {factor:e}, moved by {distance:e}: {differ} of {}", pixels * pixels);
            assert!(differ * 10_000 <= (pixels * pixels) as usize, "times {factor:e}, moved by {distance:e}");
        }
    }
}
