//! Truth rows: rays with exact hits and quartics with exact roots, from the files kept in the repository.

use rt_core::glam::DVec3;
use rt_core::shape::{Cone, Cuboid, Cylinder, Disk, Plane, Sphere, Torus, Triangle};
use rt_core::{Interval, Ray, Shape};
use serde_json::Value;
use std::path::Path;

/// The unit of all errors: 2^-53.
pub const UNIT: f64 = 1.110_223_024_625_156_5e-16;

/// A decimal number to about 30 digits: the nearest `f64` and the rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decimal {
    /// The correctly rounded value.
    pub nearest: f64,
    rest: f64,
}

impl Decimal {
    /// Reads a decimal string of any length. The rest is found by subtracting, digit by digit in integers, the exact
    /// decimal expansion of the nearest `f64`, which `{:.n}` prints exactly.
    pub fn parse(text: &str) -> Option<Decimal> {
        let nearest: f64 = text.parse().ok()?;
        if nearest == 0.0 {
            return Some(Decimal { nearest, rest: 0.0 });
        }
        let (digits, exponent) = scientific(text)?;
        let (near_digits, near_exponent) = scientific(&format!("{nearest:.60e}"))?;
        // Align both on 60 digits after the leading digit of the larger exponent, and subtract.
        let top = exponent.max(near_exponent);
        let mut difference = [0i32; 64];
        for (digits, exponent, sign) in [(&digits, exponent, 1), (&near_digits, near_exponent, -1)] {
            let shift = (top - exponent) as usize;
            for (k, d) in digits.iter().enumerate() {
                if let Some(slot) = difference.get_mut(k + shift) {
                    *slot += sign * i32::from(*d);
                }
            }
        }
        // The leading digits cancel; what is left fits a f64 to its own precision.
        let mut rest = 0.0;
        let mut sum: i128 = 0;
        for (k, d) in difference.iter().enumerate().take(50) {
            sum = sum * 10 + i128::from(*d);
            if sum.abs() > 10i128.pow(30) || k == 49 {
                rest = sum as f64 * pow10(top - k as i32);
                break;
            }
        }
        let sign = if text.trim_start().starts_with('-') { -1.0 } else { 1.0 };
        Some(Decimal { nearest, rest: sign * rest })
    }

    /// The distance to `x`, to a relative accuracy far below one unit.
    pub fn distance(&self, x: f64) -> f64 {
        ((self.nearest - x) + self.rest).abs()
    }
}

fn pow10(exponent: i32) -> f64 {
    format!("1e{exponent}").parse().unwrap_or(0.0)
}

/// The significant digits (first one not zero) and the exponent of the first digit.
fn scientific(text: &str) -> Option<(Vec<u8>, i32)> {
    let text = text.trim().trim_start_matches(['-', '+']);
    let (mantissa, exponent) = match text.split_once(['e', 'E']) {
        Some((m, e)) => (m, e.parse().ok()?),
        None => (text, 0),
    };
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let digits: Vec<u8> = whole.bytes().chain(fraction.bytes()).map(|b| b.wrapping_sub(b'0')).collect();
    let zeros = digits.iter().take_while(|d| **d == 0).count();
    Some((digits[zeros..].to_vec(), exponent + whole.len() as i32 - 1 - zeros as i32))
}

/// A ray, a shape and the exact crossings.
pub struct RayCase {
    /// The kind of shape.
    pub kind: String,
    /// The family of hard cases.
    pub family: String,
    /// The numbers of the shape.
    pub numbers: Value,
    /// The ray.
    pub ray: Ray,
    /// Where hits count.
    pub within: Interval,
    /// The exact parameters, ascending.
    pub hits: Vec<Decimal>,
    /// The least perturbation, over the scene's size, that could change the count.
    pub margin: f64,
    /// What turns an error of t into a distance off the surface, in units of the scene's and of the local scale.
    pub off_surface: Vec<f64>,
}

/// A quartic and its exact real roots.
pub struct QuarticCase {
    /// The family of hard cases.
    pub family: String,
    /// Coefficients, ascending powers.
    pub coefficients: [f64; 5],
    /// Roots, ascending, with multiplicity.
    pub roots: Vec<(Decimal, u32)>,
    /// The least relative perturbation that could change the count.
    pub margin: f64,
}

fn vector(v: &Value) -> Option<DVec3> {
    Some(DVec3::new(v[0].as_f64()?, v[1].as_f64()?, v[2].as_f64()?))
}

/// Builds the shape of a row.
pub fn shape(kind: &str, n: &Value) -> Option<Shape> {
    let v = |key: &str| vector(&n[key]);
    let f = |key: &str| n[key].as_f64();
    Some(match kind {
        "sphere" => Sphere::new(v("center")?, f("radius")?).ok()?.into(),
        "plane" => Plane::new(v("point")?, v("normal")?).ok()?.into(),
        "cuboid" => Cuboid::new(v("min")?, v("max")?).ok()?.into(),
        "cylinder" => Cylinder::new(v("base")?, v("top")?, f("radius")?).ok()?.into(),
        "open_cylinder" => Cylinder::open(v("base")?, v("top")?, f("radius")?).ok()?.into(),
        "cone" => Cone::new(v("base")?, f("base_radius")?, v("top")?, f("top_radius")?).ok()?.into(),
        "open_cone" => Cone::open(v("base")?, f("base_radius")?, v("top")?, f("top_radius")?).ok()?.into(),
        "torus" => Torus::new(v("center")?, v("axis")?, f("major")?, f("minor")?).ok()?.into(),
        "disk" => Disk::new(v("center")?, v("normal")?, f("radius")?).ok()?.into(),
        "triangle" => Triangle::new(v("a")?, v("b")?, v("c")?).ok()?.into(),
        _ => return None,
    })
}

/// The middle of a shape, as the local scale is measured from it.
fn anchor(kind: &str, n: &Value) -> Option<DVec3> {
    let v = |key: &str| vector(&n[key]);
    Some(match kind {
        "plane" => v("point")?,
        "cuboid" => (v("min")? + v("max")?) * 0.5,
        "cylinder" | "open_cylinder" | "cone" | "open_cone" => (v("base")? + v("top")?) * 0.5,
        "triangle" => (v("a")? + v("b")? + v("c")?) / 3.0,
        _ => v("center")?,
    })
}

fn ray_case(row: &Value) -> Option<RayCase> {
    let (kind, numbers) = row["shape"].as_object()?.iter().next()?;
    let ray = Ray::new(vector(&row["origin"])?, vector(&row["direction"])?);
    let hits: Vec<Decimal> =
        row["hits"].as_array()?.iter().map(|h| Decimal::parse(h["t"].as_str()?)).collect::<Option<_>>()?;
    // Lengths of directions reach 1e300: scale by the largest component first.
    let length = |v: DVec3| {
        let m = v.abs().max_element();
        if m > 0.0 { (v / m).length() * m } else { 0.0 }
    };
    let size = row["size"].as_f64()?;
    let off_surface = hits
        .iter()
        .zip(row["cond"].as_array()?)
        .map(|(t, cond)| {
            let d = length(ray.direction);
            let from_anchor = length(ray.origin - anchor(kind, numbers)?);
            let local = (t.nearest * d).abs().max(from_anchor).max(size);
            Some(d / cond.as_f64()? / local / UNIT)
        })
        .collect::<Option<_>>()?;
    Some(RayCase {
        kind: kind.clone(),
        family: row["family"].as_str()?.into(),
        numbers: numbers.clone(),
        ray,
        within: Interval::new(row["t_min"].as_f64()?, row["t_max"].as_f64()?),
        hits,
        margin: row["margin"].as_f64()?,
        off_surface,
    })
}

fn quartic_case(row: &Value) -> Option<QuarticCase> {
    let mut coefficients = [0.0; 5];
    for (slot, c) in coefficients.iter_mut().zip(row["c"].as_array()?) {
        *slot = c.as_f64()?;
    }
    let roots = row["roots"]
        .as_array()?
        .iter()
        .map(|r| Some((Decimal::parse(r[0].as_str()?)?, r[1].as_u64()? as u32)))
        .collect::<Option<_>>()?;
    Some(QuarticCase {
        family: row["family"].as_str()?.into(),
        coefficients,
        roots,
        margin: row["margin"].as_f64()?,
    })
}

fn rows<T>(prefix: &str, read: fn(&Value) -> Option<T>) -> Vec<T> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("crates/rt-core/tests/data");
    let mut files: Vec<_> = std::fs::read_dir(&folder)
        .unwrap_or_else(|e| panic!("{}: {e}", folder.display()))
        .filter_map(|f| Some(f.ok()?.path()))
        .filter(|p| p.extension().is_some_and(|e| e == "jsonl"))
        .filter(|p| p.file_name().is_some_and(|n| n.to_string_lossy().starts_with(prefix)))
        .collect();
    files.sort();
    let mut cases = Vec::new();
    for file in files {
        let text = std::fs::read_to_string(&file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
        for (number, line) in text.lines().enumerate().filter(|(_, l)| !l.trim().is_empty()) {
            let case = serde_json::from_str(line).ok().as_ref().and_then(read);
            cases.push(case.unwrap_or_else(|| panic!("{}:{}: not a truth row", file.display(), number + 1)));
        }
    }
    cases
}

/// All rays with exact hits.
pub fn rays() -> Vec<RayCase> {
    rows("rays", ray_case)
}

/// All quartics with exact roots.
pub fn quartics() -> Vec<QuarticCase> {
    rows("quartics", quartic_case)
}
