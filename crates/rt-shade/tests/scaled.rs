//! The family scene scaled by powers of two: the same bits.
#![cfg(feature = "text")]

use rt_shade::{Picture, Settings, render, text};
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

fn family(factor: f64) -> Picture {
    let scenes = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/");
    let mut value: Value =
        toml::from_str(&std::fs::read_to_string(format!("{scenes}family.toml")).unwrap()).unwrap();
    scale(&mut value, factor);
    let pictures = |path: &str| std::fs::read(format!("{scenes}{path}")).map_err(|e| e.to_string());
    let text = toml::to_string(&value).unwrap();
    let loaded = text::load("family.toml", text.as_bytes(), &pictures).unwrap();
    let settings = Settings { width: 80, height: 80, ..loaded.settings };
    render(&loaded.scene, &settings, &()).unwrap().picture
}

#[test]
fn powers_of_two_change_no_bit() {
    let picture = family(1.0);
    // 2^40 and 2^-40.
    let factor = f64::from(1 << 20) * f64::from(1 << 20);
    assert!(family(factor) == picture, "2^40");
    assert!(family(1.0 / factor) == picture, "2^-40");
}
