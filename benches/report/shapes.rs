//! Each shape: our two stages, and the textbook's formulas in `f64` and `f32`.

use crate::clock::{self, Pass};
use crate::plot::{Series, scatter};
use crate::quantile::{Errors, brief};
use crate::table::Table;
use crate::textbook::{double, single};
use crate::truth::{self, RayCase, UNIT};
use crate::verdict;
use crate::{Effort, Output};
use rt_core::glam::DVec3;
use rt_core::poly::{self, Method};
use rt_core::{Interval, Primitive, Ray, Shape};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::hint::black_box;

/// Every way of answering that the report compares.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Way {
    Hit,
    Surface,
    Textbook,
    Single,
    Original,
}

impl Way {
    fn name(self) -> &'static str {
        match self {
            Way::Hit => "ours, hit",
            Way::Surface => "ours, hit + surface",
            Way::Textbook => "textbook f64",
            Way::Single => "textbook f32",
            Way::Original => "blog formula + Graphics Gems",
        }
    }

    /// Those that a kind of shape is measured with.
    fn of(kind: &str) -> &'static [Way] {
        match kind {
            "torus" => &[Way::Hit, Way::Surface, Way::Textbook, Way::Single, Way::Original],
            _ => &[Way::Hit, Way::Surface, Way::Textbook, Way::Single],
        }
    }
}

/// A shape prepared for every way.
struct Prepared {
    ours: Shape,
    double: double::Shape,
    single: single::Shape,
}

/// A ray prepared for every way.
struct Cast {
    ray: Ray,
    within: Interval,
    double: double::Ray,
    single: single::Ray,
}

impl Cast {
    fn new(ray: Ray, within: Interval) -> Cast {
        let double = double::Ray {
            o: ray.origin.to_array(),
            d: ray.direction.to_array(),
            min: within.min,
            max: within.max,
        };
        let single = single::Ray {
            o: double.o.map(|x| x as f32),
            d: double.d.map(|x| x as f32),
            min: within.min as f32,
            max: within.max as f32,
        };
        Cast { ray, within, double, single }
    }
}

impl Prepared {
    fn new(kind: &str, numbers: &Value) -> Option<Prepared> {
        Some(Prepared {
            ours: truth::shape(kind, numbers)?,
            double: double::Shape::prepare(kind, numbers),
            single: single::Shape::prepare(kind, numbers),
        })
    }

    /// The parameter of the first hit.
    #[inline]
    fn first(&self, way: Way, cast: &Cast) -> Option<f64> {
        match way {
            Way::Hit => self.ours.hit(&cast.ray, cast.within).map(|h| h.t()),
            Way::Surface => {
                self.ours.hit(&cast.ray, cast.within).map(|h| black_box(self.ours.surface(&cast.ray, h)).t)
            }
            Way::Textbook => self.double.hit(&cast.double, double::ferrari),
            Way::Single => self.single.hit(&cast.single, single::ferrari).map(f64::from),
            Way::Original => self.double.hit(&cast.double, |c, roots| {
                let found = poly::roots(c, Interval::LINE, Method::GraphicsGems);
                for (slot, root) in roots.iter_mut().zip(found.iter()) {
                    *slot = root.x;
                }
                found.len().min(4)
            }),
        }
    }
}

/// One line of the report.
struct Row {
    kind: String,
    set: String,
    way: Way,
    rays: usize,
    errors: Errors,
    nanoseconds: Option<clock::Timing>,
}

/// What the answers to one family are worth.
#[derive(Default)]
struct Group {
    errors: Vec<f64>,
    wrong: usize,
    rays: usize,
}

/// Accuracy of every way on the truth rows, by kind and by family.
fn accuracy(cases: &[RayCase]) -> Vec<Row> {
    let mut groups: BTreeMap<(String, String, Way), Group> = BTreeMap::new();
    for case in cases {
        let Some(prepared) = Prepared::new(&case.kind, &case.numbers) else { continue };
        let cast = Cast::new(case.ray, case.within);
        for &way in Way::of(&case.kind) {
            let verdict = verdict::first_hit(case, prepared.first(way, &cast));
            for set in ["all hard cases", &case.family] {
                let group = groups.entry((case.kind.clone(), set.into(), way)).or_default();
                group.rays += 1;
                match verdict {
                    // Judged where the truth is robust to 4 units.
                    None if case.margin > 4.0 * UNIT => group.wrong += 1,
                    Some(Some(error)) if case.margin > 4.0 * UNIT => group.errors.push(error),
                    _ => {}
                }
            }
        }
    }
    groups
        .into_iter()
        .map(|((kind, set, way), Group { errors, wrong, rays })| Row {
            kind,
            set,
            way,
            rays,
            errors: Errors::of(errors, wrong),
            nanoseconds: None,
        })
        .collect()
}

/// The shapes that are timed: of size about 1, tilted, off the origin.
fn timed() -> Vec<(&'static str, &'static str, Value)> {
    let torus =
        |center: Value| json!({"center": center, "axis": [0.3, 0.9, 0.2], "major": 1.0, "minor": 0.25});
    vec![
        ("sphere", "random", json!({"center": [0.3, -0.2, 0.1], "radius": 1.0})),
        ("plane", "random", json!({"point": [0.3, -0.2, 0.1], "normal": [0.3, 0.9, 0.2]})),
        ("cuboid", "random", json!({"min": [-0.7, -0.9, -0.6], "max": [0.8, 0.7, 0.9]})),
        ("cylinder", "random", json!({"base": [0.1, -0.8, 0.2], "top": [-0.2, 0.9, 0.1], "radius": 0.6})),
        (
            "cone",
            "random",
            json!({"base": [0.1, -0.8, 0.2], "base_radius": 0.9, "top": [-0.2, 0.9, 0.1], "top_radius": 0.2}),
        ),
        ("torus", "random, at the origin", torus(json!([0.0, 0.0, 0.0]))),
        ("torus", "random, 1000 off the origin", torus(json!([1000.0, -1000.0, 1000.0]))),
        ("disk", "random", json!({"center": [0.3, -0.2, 0.1], "normal": [0.3, 0.9, 0.2], "radius": 1.0})),
        ("triangle", "random", json!({"a": [-0.9, -0.7, 0.1], "b": [0.9, -0.6, -0.2], "c": [0.1, 0.9, 0.3]})),
    ]
}

/// Rays from a shell of radius 4 aimed at a ball of radius 1 about `center`: SplitMix64, the same everywhere.
fn aimed(center: DVec3, count: usize) -> Vec<Cast> {
    let mut state = 7u64;
    let mut uniform = move || {
        state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
    };
    let mut in_ball = move || {
        loop {
            let p = DVec3::new(uniform(), uniform(), uniform()) * 2.0 - 1.0;
            if p.length_squared() <= 1.0 {
                return p;
            }
        }
    };
    (0..count)
        .map(|_| {
            let (from, to) = (center + in_ball().normalize_or(DVec3::X) * 4.0, center + in_ball());
            Cast::new(Ray::new(from, to - from), Interval::FORWARD)
        })
        .collect()
}

/// Time of every way on random rays; errors against our refined parameter, which the truth rows vouch for.
fn speed(effort: Effort, output: &mut Output) -> Vec<Row> {
    let mut rows = Vec::new();
    for (kind, set, numbers) in timed() {
        let Some(prepared) = Prepared::new(kind, &numbers) else { continue };
        let center = numbers.get("center").map_or(DVec3::ZERO, |v| DVec3::from(double::vector(v)));
        let casts = aimed(center, 4096);
        let exact: Vec<Option<f64>> = casts.iter().map(|c| prepared.first(Way::Surface, c)).collect();
        let ways = Way::of(kind);
        let mut passes: Vec<Pass> = ways
            .iter()
            .map(|&way| {
                let (prepared, casts) = (&prepared, &casts);
                Box::new(move || casts.iter().filter_map(|c| prepared.first(way, c)).sum()) as Pass
            })
            .collect();
        let timings = clock::compare(&mut passes, casts.len(), effort.rounds(), effort.round());
        drop(passes);
        for (&way, timing) in ways.iter().zip(timings) {
            let mut wrong = 0;
            let mut errors = Vec::new();
            for (cast, exact) in casts.iter().zip(&exact) {
                match (exact, prepared.first(way, cast)) {
                    (None, None) => {}
                    (Some(e), Some(a)) => errors.push((a - e).abs() / e.abs() / UNIT),
                    _ => wrong += 1,
                }
            }
            let errors = Errors::of(errors, wrong);
            if matches!(way, Way::Hit | Way::Surface) {
                output.demand(errors.wrong == 0, || format!("{kind}, {set}: hit and surface disagree"));
            }
            match timing {
                Ok(t) => rows.push(Row {
                    kind: kind.into(),
                    set: set.into(),
                    way,
                    rays: casts.len(),
                    errors,
                    nanoseconds: Some(t),
                }),
                Err(refused) => output.refuse(format!("{kind}, {}: {refused:?}", way.name())),
            }
        }
    }
    rows
}

/// What README.md shows: a line for each shape.
fn summary(timed: &[Row], accurate: &[Row]) -> Table {
    let mut table = Table::new(
        "shapes_summary",
        "Shapes: ours beside the textbook",
        &[
            "shape",
            "`hit`, ns",
            "`hit` + `surface`, ns",
            "textbook `f64`, ns",
            "wrong hits: ours",
            "`f64`",
            "`f32`",
            "largest error: ours",
            "`f64`",
            "`f32`",
        ],
    );
    for row in timed.iter().filter(|t| t.way == Way::Hit && !t.set.contains("off the origin")) {
        let time = |way| {
            let same = timed.iter().find(|t| t.kind == row.kind && t.set == row.set && t.way == way);
            same.and_then(|t| t.nanoseconds).map_or("-".into(), |t| brief(t.median))
        };
        let errors = |way| {
            let hard =
                accurate.iter().find(|a| a.kind == row.kind && a.way == way && a.set == "all hard cases");
            hard.map(|a| (a.errors, a.rays)).unwrap_or_default()
        };
        let (ours, textbook, single) = (errors(Way::Surface), errors(Way::Textbook), errors(Way::Single));
        table.row([
            row.kind.clone(),
            time(Way::Hit),
            time(Way::Surface),
            time(Way::Textbook),
            format!("{} of {}", ours.0.wrong, ours.1),
            textbook.0.wrong.to_string(),
            single.0.wrong.to_string(),
            brief(ours.0.max),
            brief(textbook.0.max),
            brief(single.0.max),
        ]);
    }
    table
}

/// Runs the section: tables, CSV, plot.
pub fn run(effort: Effort, output: &mut Output) {
    let cases = truth::rays();
    let accurate = accuracy(&cases);
    for row in &accurate {
        if row.way == Way::Surface {
            output.demand(verdict::surface_holds(&row.errors), || {
                format!(
                    "{}, {}: {} wrong counts, error {}",
                    row.kind, row.set, row.errors.wrong, row.errors.max
                )
            });
        }
        if row.way == Way::Hit {
            output.demand(row.errors.wrong == 0, || {
                format!("{}, {}: hit has {} wrong counts", row.kind, row.set, row.errors.wrong)
            });
        }
    }
    let timed = speed(effort, output);
    let mut table = Table::new(
        "shapes",
        "Shapes: time on random rays, error on hard cases",
        &["shape", "method", "ns per ray", "spread", "wrong hits", "error p50", "p99", "max"],
    );
    let mut series: BTreeMap<Way, Vec<(f64, f64, String)>> = BTreeMap::new();
    for t in timed.iter().filter(|t| !t.set.contains("off the origin")) {
        let hard = accurate.iter().find(|a| a.kind == t.kind && a.way == t.way && a.set == "all hard cases");
        let (Some(hard), Some(time)) = (hard, t.nanoseconds) else { continue };
        table.row([
            t.kind.clone(),
            t.way.name().into(),
            brief(time.median),
            format!("{}-{}", brief(time.low), brief(time.high)),
            format!("{} of {}", hard.errors.wrong, hard.rays),
            brief(hard.errors.median),
            brief(hard.errors.p99),
            brief(hard.errors.max),
        ]);
        series.entry(t.way).or_default().push((time.median, hard.errors.p99, t.kind.clone()));
    }
    output.table(table);
    output.summary(summary(&timed, &accurate));

    let mut table = Table::new(
        "shapes_random",
        "Shapes: time and error on random rays",
        &["shape", "rays", "method", "ns per ray", "wrong hits", "relative error p50", "p99", "max"],
    );
    for t in &timed {
        table.row([
            t.kind.clone(),
            t.set.clone(),
            t.way.name().into(),
            t.nanoseconds.map_or("-".into(), |n| brief(n.median)),
            format!("{} of {}", t.errors.wrong, t.rays),
            brief(t.errors.median),
            brief(t.errors.p99),
            brief(t.errors.max),
        ]);
    }
    output.table(table);

    let mut table = Table::new(
        "shapes_families",
        "Shapes: every family of hard cases",
        &["shape", "family", "method", "rows", "wrong hits", "error p50", "p99", "max"],
    );
    for a in accurate.iter().filter(|a| a.set != "all hard cases") {
        table.row([
            a.kind.clone(),
            a.set.clone(),
            a.way.name().into(),
            a.rays.to_string(),
            a.errors.wrong.to_string(),
            brief(a.errors.median),
            brief(a.errors.p99),
            brief(a.errors.max),
        ]);
    }
    output.csv_only(table);

    let series: Vec<Series> =
        series.into_iter().map(|(way, points)| Series { name: way.name().into(), points }).collect();
    output.plot("shapes", |path| {
        scatter(
            path,
            "Shapes: speed against error",
            "time per random ray, nanoseconds",
            "99th percentile of error on hard cases, units of 2^-53 of the local scale",
            &series,
        )
    });
}
