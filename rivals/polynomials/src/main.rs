//! Polynomial solvers side by side: time, wrong counts and error of each on the hard quartics.
//!
//!     cargo run --release -p rivals-polynomials [-- [quartics.jsonl] [families]]
//!
//! Every answer is judged before anything is timed; what is timed is the solver alone, with its own list. The solvers take turns, pass by pass, so that a change of clock or a
//! neighbour on the machine meets all of them; the figure is the least time of all passes, per polynomial.

use rt_core::Interval;
use rt_core::poly::{self, Method};
use serde_json::Value;
use std::hint::black_box;
use std::time::Instant;

/// A quartic with its real roots and what its count can bear.
struct Case {
    family: String,
    c: [f64; 5],
    roots: Vec<(f64, u32)>,
    margin: f64,
}

/// At most four roots, without allocation.
#[derive(Clone, Copy, Default)]
struct Answer {
    roots: [(f64, u32); 8],
    count: usize,
}

impl Answer {
    fn add(&mut self, x: f64, multiplicity: u32) {
        if self.count < self.roots.len() {
            self.roots[self.count] = (x, multiplicity);
            self.count += 1;
        }
    }
}

/// A name, the answer to be judged, and the bare call to be timed.
type Solver = (&'static str, fn(&[f64; 5]) -> Answer, fn(&[f64; 5]));

fn by(method: Method, c: &[f64; 5]) -> Answer {
    let mut answer = Answer::default();
    for root in poly::roots(*c, Interval::LINE, method).iter() {
        answer.add(root.x, root.multiplicity);
    }
    answer
}

fn of(list: impl IntoIterator<Item = f64>) -> Answer {
    let mut answer = Answer::default();
    list.into_iter().for_each(|x| answer.add(x, 1));
    answer
}

/// An interval with all roots, for polycool.
fn bound(c: &[f64; 5]) -> f64 {
    1.0 + c[..4].iter().fold(0.0f64, |m, x| m.max((x / c[4]).abs()))
}

fn polycool(c: &[f64; 5]) -> Answer {
    let bound = bound(c);
    if !bound.is_finite() {
        return Answer::default();
    }
    of(polycool::Poly::new(*c).roots_between(-bound, bound, 1e-15))
}

fn timed_polycool(c: &[f64; 5]) {
    let bound = bound(c);
    if bound.is_finite() {
        black_box(polycool::Poly::new(*c).roots_between(-bound, bound, 1e-15));
    }
}

fn timed(method: Method, c: &[f64; 5]) {
    black_box(poly::roots(*c, Interval::LINE, method));
}

const SOLVERS: &[Solver] = &[
    (
        "kurbo",
        |c| of(kurbo::common::solve_quartic(c[0], c[1], c[2], c[3], c[4])),
        |c| {
            black_box(kurbo::common::solve_quartic(c[0], c[1], c[2], c[3], c[4]));
        },
    ),
    ("ours", |c| by(Method::Certified, c), |c| timed(Method::Certified, c)),
    ("ferrari", |c| by(Method::Ferrari, c), |c| timed(Method::Ferrari, c)),
    ("graphics gems", |c| by(Method::GraphicsGems, c), |c| timed(Method::GraphicsGems, c)),
    (
        "roots",
        |c| of(roots::find_roots_quartic(c[4], c[3], c[2], c[1], c[0]).as_ref().iter().copied()),
        |c| {
            black_box(roots::find_roots_quartic(c[4], c[3], c[2], c[1], c[0]));
        },
    ),
    ("polycool", polycool, timed_polycool),
];

fn load(path: &std::path::Path) -> Vec<Case> {
    let text = std::fs::read_to_string(path).unwrap_or_else(|error| {
        eprintln!("{}: {error}", path.display());
        std::process::exit(2);
    });
    let case = |line: &str| {
        let row: Value = serde_json::from_str(line).expect("JSON");
        let roots = row["roots"].as_array().expect("roots");
        Case {
            family: row["family"].as_str().expect("family").into(),
            c: std::array::from_fn(|i| row["c"][i].as_f64().expect("coefficient")),
            roots: roots
                .iter()
                .map(|r| {
                    (
                        r[0].as_str().expect("root").parse().expect("root"),
                        r[1].as_u64().expect("times") as u32,
                    )
                })
                .collect(),
            margin: row["margin"].as_f64().expect("margin"),
        }
    };
    text.lines().filter(|l| !l.trim().is_empty()).map(case).collect()
}

/// Wrong counts, and the errors of simple roots in units of 2^-53 where the count is right.
fn judge(cases: &[&Case], solver: fn(&[f64; 5]) -> Answer) -> (usize, Vec<f64>) {
    let (mut wrong, mut errors) = (0, vec![]);
    for case in cases {
        let answer = solver(&case.c);
        let mut got: Vec<(f64, u32)> = answer.roots[..answer.count].to_vec();
        got.sort_by(|a, b| a.0.total_cmp(&b.0));
        let listed: u32 = got.iter().map(|r| r.1).sum();
        let degree: u32 = case.roots.iter().map(|r| r.1).sum();
        let multiple = case.roots.iter().any(|r| r.1 > 1);
        if got.len() == case.roots.len() {
            for (g, w) in got.iter().zip(&case.roots) {
                if w.1 == 1 && w.0 != 0.0 {
                    errors.push(((g.0 - w.0) / w.0).abs() * 2f64.powi(53));
                }
            }
        } else if (case.margin > 1e-24 || multiple) && listed != degree {
            wrong += 1;
        }
    }
    errors.sort_by(f64::total_cmp);
    (wrong, errors)
}

/// Least time of one pass over all cases, in ns per case, of each solver.
fn times(cases: &[&Case], solvers: &[Solver], seconds: f64) -> Vec<f64> {
    let mut least = vec![f64::INFINITY; solvers.len()];
    let begun = Instant::now();
    let mut passes = 0;
    while begun.elapsed().as_secs_f64() < seconds || passes < 5 {
        for (least, (_, _, solver)) in least.iter_mut().zip(solvers) {
            let start = Instant::now();
            for case in cases {
                solver(black_box(&case.c));
            }
            *least = least.min(start.elapsed().as_nanos() as f64 / cases.len() as f64);
        }
        passes += 1;
    }
    least
}

fn listed<const N: usize>(roots: poly::Roots<N>) -> Answer {
    let mut answer = Answer::default();
    roots.iter().for_each(|root| answer.add(root.x, root.multiplicity));
    answer
}

/// Quadratics and cubics of uniform random coefficients: kurbo and ours in turns.
fn lower_degrees() {
    let mut state = 88_172_645_463_325_252_u64;
    let mut next = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    let cases: Vec<Case> = (0..2000)
        .map(|_| Case {
            family: String::new(),
            c: std::array::from_fn(|k| if k < 4 { next() } else { 0.0 }),
            roots: vec![],
            margin: 0.0,
        })
        .collect();
    let cases: Vec<&Case> = cases.iter().collect();
    let solvers: [Solver; 4] = [
        (
            "kurbo quadratic",
            |c| of(kurbo::common::solve_quadratic(c[0], c[1], c[2])),
            |c| {
                black_box(kurbo::common::solve_quadratic(c[0], c[1], c[2]));
            },
        ),
        (
            "ours quadratic",
            |c| listed(poly::quadratic([c[0], c[1], c[2]], Interval::LINE)),
            |c| {
                black_box(poly::quadratic([c[0], c[1], c[2]], Interval::LINE));
            },
        ),
        (
            "kurbo cubic",
            |c| of(kurbo::common::solve_cubic(c[0], c[1], c[2], c[3])),
            |c| {
                black_box(kurbo::common::solve_cubic(c[0], c[1], c[2], c[3]));
            },
        ),
        (
            "ours cubic",
            |c| listed(poly::cubic([c[0], c[1], c[2], c[3]], Interval::LINE)),
            |c| {
                black_box(poly::cubic([c[0], c[1], c[2], c[3]], Interval::LINE));
            },
        ),
    ];
    // The counts of ours are exact: how often kurbo's differ.
    for pair in solvers.chunks(2) {
        let differ = cases.iter().filter(|case| pair[0].1(&case.c).count != pair[1].1(&case.c).count).count();
        println!("{} and {}: {differ} of {} counts differ", pair[0].0, pair[1].0, cases.len());
    }
    let ns = times(&cases, &solvers, 2.0);
    for (k, (name, ..)) in solvers.iter().enumerate() {
        println!("{:<22}{:<15}{:>8.1}{:>8.2}", "uniform", name, ns[k], ns[k] / ns[k / 2 * 2]);
    }
}

const USAGE: &str = "\
usage: rivals-polynomials [QUARTICS.jsonl] [families]

Time, wrong counts and error of polynomial solvers, in turns: quadratics and cubics of
uniform coefficients, and the quartics of a file (without one: ../shared/cases/quartics.jsonl
beside the repository if it is there, otherwise those of the tests): sample_F, torus*, all.
With 'families' each family by itself, ours and kurbo only.
";

fn main() {
    let (mut path, mut detail) = (None, false);
    for argument in std::env::args().skip(1) {
        match argument.as_str() {
            "-h" | "--help" => return print!("{USAGE}"),
            "families" => detail = true,
            option if option.starts_with('-') => {
                eprintln!("unknown option {option}\n{USAGE}");
                std::process::exit(2);
            }
            file => path = Some(std::path::PathBuf::from(file)),
        }
    }
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    // The large set if it is here, otherwise the part of it in the repository.
    let path = path.unwrap_or_else(|| {
        let shared = root.join("../shared/cases/quartics.jsonl");
        if shared.is_file() { shared } else { root.join("crates/rt-core/tests/data/quartics.jsonl") }
    });
    lower_degrees();
    let all = load(&path);
    let mut sets: Vec<(String, Vec<&Case>)> = vec![
        ("sample_F".into(), all.iter().filter(|c| c.family == "sample_F").collect()),
        ("torus".into(), all.iter().filter(|c| c.family.starts_with("torus")).collect()),
        ("all".into(), all.iter().collect()),
    ];
    if detail {
        let mut names: Vec<&String> = all.iter().map(|c| &c.family).collect();
        names.dedup();
        sets.extend(names.iter().map(|&n| (n.clone(), all.iter().filter(|c| &c.family == n).collect())));
    }
    let solvers = if detail { &SOLVERS[..2] } else { SOLVERS };
    println!(
        "{:<22}{:<15}{:>8}{:>8}{:>7}{:>10}{:>10}",
        "set", "solver", "ns", "/kurbo", "wrong", "p99 (u)", "max (u)"
    );
    for (name, cases) in sets.iter().filter(|s| !s.1.is_empty()) {
        let judged: Vec<_> = solvers.iter().map(|(_, s, _)| judge(cases, *s)).collect();
        let ns = times(cases, solvers, if detail { 0.15 } else { 3.0 });
        for ((solver, ns_one), (wrong, errors)) in solvers.iter().zip(&ns).zip(&judged) {
            let at = |q: f64| {
                errors
                    .get(((errors.len() as f64 * q) as usize).min(errors.len().max(1) - 1))
                    .copied()
                    .unwrap_or(0.0)
            };
            println!(
                "{:<22}{:<15}{:>8.0}{:>8.2}{:>7} {:>9.2e} {:>9.2e}",
                name,
                solver.0,
                ns_one,
                ns_one / ns[0],
                wrong,
                at(0.99),
                at(1.0)
            );
        }
    }
}
