//! The solvers of quadratics, cubics and quartics, judged before they are timed.
//!
//! Quartics: the three methods on the hard quartics of `tests/data/quartics.jsonl`, whose roots are known to more digits
//! than a `f64` has: all, those of rays and tori, and plain random ones. Quadratics and cubics: planted roots of few
//! bits, so that the coefficients are exact and each root is a `f64`. The certified solvers must find every root with its
//! multiplicity, and the nearest `f64` or its neighbour; what the older methods miss is printed beside their time. An
//! element of the throughput is one polynomial.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use rt_core::Interval;
use rt_core::poly::{self, Method, Root};
use serde_json::Value;
use std::hint::black_box;
use std::time::Duration;

/// Coefficients in ascending powers and the real roots with their multiplicities, ascending.
struct Case<const N: usize> {
    family: String,
    c: [f64; N],
    roots: Vec<(f64, u32)>,
}

/// The quartics in the repository, 354 of 36 families.
fn quartics() -> Vec<Case<5>> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/quartics.jsonl");
    let text = std::fs::read_to_string(path).expect("the data are in the repository");
    let case = |line: &str| {
        let row: Value = serde_json::from_str(line).ok()?;
        let mut c = [0.0; 5];
        for (slot, value) in c.iter_mut().zip(row["c"].as_array()?) {
            *slot = value.as_f64()?;
        }
        let root = |r: &Value| Some((r[0].as_str()?.parse().ok()?, r[1].as_u64()? as u32));
        let roots = row["roots"].as_array()?.iter().map(root).collect::<Option<_>>()?;
        Some(Case { family: row["family"].as_str()?.into(), c, roots })
    };
    text.lines()
        .enumerate()
        .map(|(i, line)| case(line).unwrap_or_else(|| panic!("line {}: not a truth row", i + 1)))
        .collect()
}

/// Whole numbers over 64, and quadratic factors without real roots, as products: 3 factors of 12 bits are exact.
struct Planted(u64);

impl Planted {
    fn number(&mut self) -> f64 {
        // SplitMix64.
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 52) as f64 / 64.0 - 32.0
    }

    /// `(x - a)(x - b)`, or `(x - a)^2 + b^2` half of the time.
    fn quadratic(&mut self) -> Case<3> {
        let (a, b) = (self.number(), self.number());
        if self.number() < 0.0 && b != 0.0 {
            return Case { family: String::new(), c: [a * a + b * b, -2.0 * a, 1.0], roots: vec![] };
        }
        let roots = if a == b { vec![(a, 2)] } else { vec![(a.min(b), 1), (a.max(b), 1)] };
        Case { family: String::new(), c: [a * b, -a - b, 1.0], roots }
    }

    /// A quadratic as above times `x - d`.
    fn cubic(&mut self) -> Case<4> {
        let Case { c: [c0, c1, c2], mut roots, family } = self.quadratic();
        let d = self.number();
        match roots.iter_mut().find(|root| root.0 == d) {
            Some(root) => root.1 += 1,
            None => roots.push((d, 1)),
        }
        roots.sort_by(|a, b| a.0.total_cmp(&b.0));
        Case { family, c: [-d * c0, c0 - d * c1, c1 - d * c2, c2], roots }
    }
}

/// How many answers have a wrong number of roots, a wrong multiplicity or a root that is neither the nearest `f64` nor
/// its neighbour.
fn wrong<const N: usize>(cases: &[&Case<N>], solve: impl Fn([f64; N]) -> Vec<Root>) -> usize {
    let right = |case: &Case<N>| {
        let found = solve(case.c);
        found.len() == case.roots.len()
            && found.iter().zip(&case.roots).all(|(root, &(x, multiplicity))| {
                root.multiplicity == multiplicity && x.next_down() <= root.x && root.x <= x.next_up()
            })
    };
    cases.iter().filter(|case| !right(case)).count()
}

fn quartic(criterion: &mut Criterion) {
    let all = quartics();
    let chosen = |family: &str| all.iter().filter(|case| case.family.starts_with(family)).collect::<Vec<_>>();
    let mut group = criterion.benchmark_group("quartic");
    for (set, cases) in [("sample F", chosen("sample_F")), ("torus", chosen("torus")), ("all", chosen(""))] {
        group.throughput(Throughput::Elements(cases.len() as u64));
        for (name, method) in [
            ("certified", Method::Certified),
            ("Ferrari", Method::Ferrari),
            ("Graphics Gems", Method::GraphicsGems),
        ] {
            let wrong = wrong(&cases, |c| poly::roots(c, Interval::LINE, method).to_vec());
            println!("quartic, {set}, {name}: {wrong} of {} answers wrong", cases.len());
            assert!(wrong == 0 || method != Method::Certified);
            group.bench_with_input(BenchmarkId::new(name, set), &cases, |b, cases| {
                b.iter(|| {
                    for case in cases.iter() {
                        black_box(poly::roots(black_box(case.c), Interval::LINE, method));
                    }
                })
            });
        }
    }
    group.finish();
}

fn lower(criterion: &mut Criterion) {
    /// As many as fit the second cache.
    const COUNT: usize = 2000;
    let mut planted = Planted(1);
    let quadratics: Vec<_> = (0..COUNT).map(|_| planted.quadratic()).collect();
    let cubics: Vec<_> = (0..COUNT).map(|_| planted.cubic()).collect();
    let judged = |name: &str, wrong: usize| {
        println!("{name}: {wrong} of {COUNT} answers wrong");
        assert_eq!(wrong, 0, "{name}");
    };
    let solve = |c| poly::quadratic(c, Interval::LINE).to_vec();
    judged("quadratic", wrong(&quadratics.iter().collect::<Vec<_>>(), solve));
    let solve = |c| poly::cubic(c, Interval::LINE).to_vec();
    judged("cubic", wrong(&cubics.iter().collect::<Vec<_>>(), solve));

    let mut group = criterion.benchmark_group("planted roots");
    group.throughput(Throughput::Elements(COUNT as u64));
    group.bench_function("quadratic", |b| {
        b.iter(|| {
            for case in &quadratics {
                black_box(poly::quadratic(black_box(case.c), Interval::LINE));
            }
        })
    });
    group.bench_function("cubic", |b| {
        b.iter(|| {
            for case in &cubics {
                black_box(poly::cubic(black_box(case.c), Interval::LINE));
            }
        })
    });
    group.finish();
}

/// Short runs, so that all benches together take minutes: ratios within one run settle in a second.
fn short() -> Criterion {
    Criterion::default()
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_millis(1500))
}

criterion_group! { name = benches; config = short(); targets = quartic, lower }
criterion_main!(benches);
