//! Hard rays with exact hits, scored shape by shape: `tests/data/rays_*.jsonl` and, where present, the shared cases.
//!
//! Units are u = 2^-53. A hit's parameter error is turned into the distance of the answered point from the surface
//! (times the cosine between ray and normal) and divided by the scale of the scene (`conditioned`) or by the distance
//! between ray and shape (`local`), neither of which can be zero for arithmetic in `f64`.

use rt_core::double::Double;
use rt_core::kernel::{Product, Task, run};
use rt_core::shape::*;
use rt_core::{Error, Hit, Interval, Primitive, Ray};
use serde_json::Value;
use std::path::{Path, PathBuf};

const U: f64 = f64::EPSILON / 2.0;

/// What the answers of one shape must keep to.
struct Limits {
    conditioned: f64,
    conditioned_p99: f64,
}

const PLAIN: Limits = Limits { conditioned: 4.0, conditioned_p99: 2.0 };
const FLAT: Limits = Limits { conditioned: 3.0, conditioned_p99: 2.0 };
const BOX: Limits = Limits { conditioned: 2.0, conditioned_p99: 1.3 };
const TORUS: Limits = Limits { conditioned: 2.5, conditioned_p99: 1.5 };

#[test]
fn sphere() {
    judge("sphere", &PLAIN);
}

#[test]
fn plane() {
    judge("plane", &FLAT);
}

#[test]
fn disk() {
    judge("disk", &FLAT);
}

#[test]
fn cuboid() {
    judge("cuboid", &BOX);
}

#[test]
fn triangle() {
    judge("triangle", &PLAIN);
}

#[test]
fn cylinder() {
    judge("cylinder", &PLAIN);
    judge("open_cylinder", &PLAIN);
}

#[test]
fn cone() {
    judge("cone", &PLAIN);
}

#[test]
fn torus() {
    judge("torus", &TORUS);
}

/// All crossings, then the first alone, of every row of this kind in every file.
fn judge(kind: &str, limits: &Limits) {
    let rows = rows(kind);
    assert!(!rows.is_empty(), "no rows for {kind}");
    for first in [false, true] {
        let mut score = Score::default();
        for row in &rows {
            score.row(kind, row, first);
        }
        score.check(kind, limits);
    }
}

fn files() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files: Vec<PathBuf> = std::fs::read_dir(root.join("tests/data"))
        .expect("tests/data")
        .map(|entry| entry.expect("an entry of tests/data").path())
        .filter(|path| {
            let name = path.file_name().and_then(|n| n.to_str()).unwrap_or("");
            name.starts_with("rays") && name.ends_with(".jsonl")
        })
        .collect();
    files.sort();
    let shared = root.join("../../../shared/cases/rays.jsonl");
    if shared.exists() {
        files.push(shared)
    } else {
        println!("skipped: no shared data")
    }
    files
}

fn rows(kind: &str) -> Vec<Value> {
    let mut rows = Vec::new();
    for file in files() {
        let text = std::fs::read_to_string(&file).expect("a readable file");
        let parsed = text.lines().filter(|line| line.contains(kind)).map(|line| {
            serde_json::from_str::<Value>(line).unwrap_or_else(|e| panic!("{}: {e}", file.display()))
        });
        rows.extend(parsed.filter(|row| row["shape"].get(kind).is_some()));
    }
    rows
}

fn vector(v: &Value) -> [f64; 3] {
    [0, 1, 2].map(|i| v[i].as_f64().expect("a number"))
}

fn shape(kind: &str, d: &Value) -> Result<Shape, Error> {
    let f = |n: &str| d[n].as_f64().expect("a number");
    let p = |n: &str| vector(&d[n]);
    Ok(match kind {
        "sphere" => Sphere::new(p("center"), f("radius"))?.into(),
        "plane" => Plane::new(p("point"), p("normal"))?.into(),
        "cuboid" => Cuboid::new(p("min"), p("max"))?.into(),
        "cylinder" => Cylinder::new(p("base"), p("top"), f("radius"))?.into(),
        "open_cylinder" => Cylinder::open(p("base"), p("top"), f("radius"))?.into(),
        "cone" => Cone::new(p("base"), f("base_radius"), p("top"), f("top_radius"))?.into(),
        "torus" => Torus::new(p("center"), p("axis"), f("major"), f("minor"))?.into(),
        "disk" => Disk::new(p("center"), p("normal"), f("radius"))?.into(),
        "triangle" => Triangle::new(p("a"), p("b"), p("c"))?.into(),
        _ => panic!("unknown shape {kind}"),
    })
}

/// The anchor of the local scale: the centre of the shape, for a plane its point.
fn centre(kind: &str, d: &Value) -> [f64; 3] {
    let ends = match kind {
        "plane" => vec!["point"],
        "sphere" | "torus" | "disk" => vec!["center"],
        "cuboid" => vec!["min", "max"],
        "triangle" => vec!["a", "b", "c"],
        _ => vec!["base", "top"],
    };
    let share = 1.0 / ends.len() as f64;
    [0, 1, 2].map(|i| ends.iter().map(|e| vector(&d[*e])[i] * share).sum())
}

/// The Euclidean length, for components of any size.
fn length(v: [f64; 3]) -> f64 {
    let largest = v.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    if largest == 0.0 || !largest.is_finite() {
        return largest;
    }
    largest * v.iter().map(|x| (x / largest) * (x / largest)).sum::<f64>().sqrt()
}

fn difference(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// A number `value * 2^power` with about 100 certain bits, the value's size in `[1, 2)`.
#[derive(Clone, Copy)]
struct Truth {
    value: Double,
    power: i32,
}

impl Truth {
    /// From decimal digits such as `-1.25E-7`.
    fn parse(text: &str) -> Truth {
        let lower = text.to_ascii_lowercase();
        let (mantissa, exponent) = lower.split_once('e').unwrap_or((&lower, "0"));
        let mut exponent: i32 = exponent.parse().expect("an exponent");
        let (sign, mantissa) = match mantissa.strip_prefix('-') {
            Some(rest) => (-1.0, rest),
            None => (1.0, mantissa),
        };
        let (whole, part) = mantissa.split_once('.').unwrap_or((mantissa, ""));
        exponent -= part.len() as i32;
        let mut truth = Truth { value: Double::ZERO, power: 0 };
        for digit in whole.bytes().chain(part.bytes()) {
            // Small numbers first times ten are exact; rounding begins beyond 2^106, where all digits that count are in.
            truth = truth.times(10.0);
            let unit = two_to(-truth.power);
            truth.value = truth.value + f64::from(digit - b'0') * unit;
        }
        truth.value = truth.value.scale_exact(sign);
        for _ in 0..exponent.abs() {
            truth = if exponent > 0 { truth.times(10.0) } else { truth.over(10.0) };
        }
        truth
    }

    fn times(self, factor: f64) -> Truth {
        struct Scale(Double, f64);
        impl Task for Scale {
            type Output = Double;
            fn run<P: Product>(self) -> Double {
                self.0.scale::<P>(self.1)
            }
        }
        Truth { value: run(Scale(self.value, factor)), ..self }.normalised()
    }

    fn over(self, divisor: f64) -> Truth {
        struct Divide(Double, f64);
        impl Task for Divide {
            type Output = Double;
            fn run<P: Product>(self) -> Double {
                self.0.div::<P>(Double::from(self.1))
            }
        }
        Truth { value: run(Divide(self.value, divisor)), ..self }.normalised()
    }

    /// The value's size in `[1, 2)`; numbers below 2^200 in all keep the power 0, so that digits add exactly.
    fn normalised(mut self) -> Truth {
        let size = self.value.high.abs();
        if size != 0.0 && !(two_to(-200)..two_to(200)).contains(&size) {
            let shift = ((size.to_bits() >> 52) & 0x7ff) as i32 - 1023;
            self.value = self.value.scale_exact(two_to(-shift));
            self.power += shift;
        }
        self
    }

    fn to_f64(self) -> f64 {
        let half = self.power / 2;
        self.value.to_f64() * two_to(half) * two_to(self.power - half)
    }

    /// `|x - self|`, rounded.
    fn distance(self, x: f64) -> f64 {
        let half = self.power / 2;
        let scaled = x * two_to(-half) * two_to(half - self.power);
        (self.value - scaled).to_f64().abs() * two_to(half) * two_to(self.power - half)
    }
}

fn two_to(power: i32) -> f64 {
    f64::from_bits(((power.clamp(-1022, 1023) + 1023) as u64) << 52)
}

/// The largest coordinate error of a point over the larger of its largest coordinate and the size of the shape.
fn point_error(point: [f64; 3], ray: &Ray, truth: Truth, size: f64) -> f64 {
    struct At(f64, Double, f64);
    impl Task for At {
        type Output = Double;
        fn run<P: Product>(self) -> Double {
            self.1.scale::<P>(self.2) + self.0
        }
    }
    // t d in two factors of moderate size: the direction takes the power of t.
    let half = truth.power / 2;
    let (o, d) = (ray.origin.to_array(), ray.direction.to_array());
    let exact =
        [0, 1, 2].map(|i| run(At(o[i], truth.value, d[i] * two_to(half) * two_to(truth.power - half))));
    let scale = exact.iter().fold(size, |m, x| m.max(x.high.abs()));
    let error =
        [0, 1, 2].map(|i| (exact[i] - point[i]).to_f64().abs()).iter().fold(0.0_f64, |m, e| m.max(*e));
    // Three roundings of double-double of the largest number involved are the test's own.
    let largest = o.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let own = largest * two_to(-100);
    if error <= own { 0.0 } else { (error - own) / scale / U }
}

#[derive(Default)]
struct Score {
    rows: usize,
    wrong: Vec<String>,
    bad: Vec<String>,
    inexact: usize,
    conditioned: Vec<f64>,
    local: Vec<f64>,
    normal: Vec<f64>,
    point: Vec<f64>,
}

impl Score {
    fn row(&mut self, kind: &str, row: &Value, first: bool) {
        let d = &row["shape"][kind];
        let ray = Ray::new(vector(&row["origin"]), vector(&row["direction"]));
        let number = |n: &str| row[n].as_f64().expect("a number");
        let within = Interval::new(number("t_min"), number("t_max"));
        let margin = number("margin");
        self.rows += 1;
        let name = format!("row {} {} {kind}", row["id"], row["family"]);
        let shape = match shape(kind, d) {
            Ok(shape) => shape,
            Err(e) => return self.bad.push(format!("{name}: {e}")),
        };
        let mut hits: Vec<Hit> = Vec::new();
        if first {
            hits.extend(shape.hit(&ray, within));
        } else {
            shape.crossings(&ray, within, &mut |hit| hits.push(hit));
        }
        let truth = row["hits"].as_array().expect("hits");
        let expected = if first { truth.len().min(1) } else { truth.len() };
        if !hits.is_sorted_by(|a, b| a.t() <= b.t()) || !hits.iter().all(|h| within.contains(h.t())) {
            self.bad.push(format!("{name}: unsorted or out of the interval"));
        }
        if margin <= 4.0 * U {
            return;
        }
        if hits.len() != expected {
            return self
                .wrong
                .push(format!("{name}: {} hits, not {expected}, margin {margin:e}", hits.len()));
        }
        for (k, hit) in hits.iter().enumerate() {
            let surface = shape.surface(&ray, *hit);
            let exact = Truth::parse(truth[k]["t"].as_str().expect("digits"));
            let t = exact.to_f64();
            let size = number("size");
            let (o, v) = (ray.origin.to_array(), ray.direction.to_array());
            let place = ray.at(t).to_array();
            let scale = length(o).max(length(place)).max(size);
            let near = (t.abs() * length(v)).max(length(difference(o, centre(kind, d)))).max(size);
            let cond = row["cond"][k].as_f64().expect("a number");
            // The direction may be as large as 1e300: by its length last.
            let error = exact.distance(surface.t) / cond / U;
            self.conditioned.push(error / scale * length(v));
            self.local.push(error / near * length(v));
            self.inexact += usize::from(surface.t != t);
            self.point.push(point_error(surface.point.to_array(), &ray, exact, size));
            let crease = row["crease"][k].as_f64();
            if crease.is_none_or(|c| c > 64.0 * U) {
                let error = length(difference(surface.normal.to_array(), vector(&truth[k]["normal"]))) / U;
                let bend = row["ncond"][k].as_f64().expect("a number") - 1.0;
                self.normal.push(error / (1.0 + bend * (near / scale).min(1.0)));
            }
        }
    }

    fn check(&mut self, kind: &str, limits: &Limits) {
        let most = |v: &[f64]| v.iter().fold(0.0_f64, |m, x| m.max(*x));
        let p99 = |v: &mut Vec<f64>| {
            v.sort_by(f64::total_cmp);
            v.get((v.len() * 99).div_ceil(100).saturating_sub(1)).copied().unwrap_or(0.0)
        };
        assert!(self.bad.is_empty(), "{}", self.bad.join("\n"));
        assert!(self.wrong.is_empty(), "{}", self.wrong.join("\n"));
        println!(
            "{kind}: {} rows, {} hits; conditioned {:.2}, local {:.2}, normal {:.2}, point {:.2}, inexact {}",
            self.rows,
            self.local.len(),
            most(&self.conditioned),
            most(&self.local),
            most(&self.normal),
            most(&self.point),
            self.inexact
        );
        for errors in [&mut self.conditioned, &mut self.local] {
            assert!(most(errors) <= limits.conditioned, "{kind}: {} u", most(errors));
            assert!(p99(errors) <= limits.conditioned_p99, "{kind}: {} u", p99(errors));
        }
        assert!(most(&self.normal) <= 5.0, "{kind}: normal {} u", most(&self.normal));
        assert!(most(&self.point) <= 2.0, "{kind}: point {} u", most(&self.point));
        // One in a thousand; and one more, since the digits of an exact tie may round either way.
        assert!(self.inexact <= self.local.len() / 1000 + 1, "{kind}: {} inexact", self.inexact);
    }
}

#[test]
fn decimals_are_read_exactly() {
    for (text, value) in [("0", 0.0), ("1.5", 1.5), ("-2.5e-1", -0.25), ("1E+22", 1e22), ("6.25e-2", 0.0625)]
    {
        let truth = Truth::parse(text);
        assert_eq!(truth.to_f64(), value, "{text}");
        assert_eq!(truth.distance(value), 0.0, "{text}");
    }
    assert_eq!(Truth::parse("1.797693134862315708145274237317e-290").to_f64(), 1.7976931348623156e-290);
    assert!((Truth::parse("0.1").distance(0.1) / 5.551115123125783e-18 - 1.0).abs() < 1e-10);
}
