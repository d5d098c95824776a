//! Quartic solvers: ours, Ferrari and Graphics Gems on the hard quartics kept in the repository.

use crate::clock::{self, Pass};
use crate::plot::{Series, scatter};
use crate::quantile::{Errors, brief};
use crate::table::Table;
use crate::truth::{self, QuarticCase};
use crate::verdict::{self, Tally};
use crate::{Effort, Output};
use rt_core::Interval;
use rt_core::poly::{self, Method};
use std::collections::BTreeMap;

const METHODS: [(Method, &str); 3] =
    [(Method::Certified, "ours"), (Method::Ferrari, "Ferrari"), (Method::GraphicsGems, "Graphics Gems")];

/// Runs the section: tables, CSV, plot.
pub fn run(effort: Effort, output: &mut Output) {
    let cases = truth::quartics();
    let mut families: BTreeMap<&str, Vec<&QuarticCase>> = BTreeMap::new();
    for case in &cases {
        families.entry(&case.family).or_default().push(case);
    }
    let mut all: BTreeMap<&str, Tally> = BTreeMap::new();
    let mut by_family = Table::new(
        "quartics_families",
        "Quartics: every family",
        &[
            "family",
            "method",
            "rows",
            "ns per solve",
            "wrong counts",
            "without excuse",
            "error p50",
            "p99",
            "max",
        ],
    );
    let mut times: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    let mut points: BTreeMap<&str, Vec<(f64, f64, String)>> = BTreeMap::new();
    for (family, cases) in &families {
        let mut passes: Vec<Pass> = METHODS
            .iter()
            .map(|&(method, _)| {
                Box::new(move || {
                    let solve = |c: &&QuarticCase| poly::roots(c.coefficients, Interval::LINE, method).len();
                    cases.iter().map(solve).sum::<usize>() as f64
                }) as Pass
            })
            .collect();
        let timings = clock::compare(&mut passes, cases.len(), effort.rounds(), effort.round() / 4);
        drop(passes);
        for (&(method, name), timing) in METHODS.iter().zip(timings) {
            let timing = match timing {
                Ok(timing) => timing,
                Err(refused) => {
                    output.refuse(format!("{family}, {name}: {refused:?}"));
                    continue;
                }
            };
            let mut tally = Tally::default();
            for case in cases {
                let found = poly::roots(case.coefficients, Interval::LINE, method);
                let found: Vec<(f64, u32)> = found.iter().map(|r| (r.x, r.multiplicity)).collect();
                tally.add(case, &found);
                all.entry(name).or_default().add(case, &found);
            }
            times.entry(name).or_default().push(timing.median * cases.len() as f64);
            let errors = Errors::of(std::mem::take(&mut tally.errors), tally.wrong);
            if method == Method::Certified {
                output.demand(verdict::roots_hold(&errors), || {
                    format!("quartics, {family}: {} wrong counts, error {}", errors.wrong, errors.max)
                });
            }
            // A family without a simple root has no error to show.
            if errors.count > 0 || errors.wrong > 0 {
                points.entry(name).or_default().push((timing.median, errors.p99, String::new()));
            }
            by_family.row([
                family.to_string(),
                name.into(),
                tally.rows.to_string(),
                brief(timing.median),
                tally.wrong.to_string(),
                tally.wrong_without_excuse.to_string(),
                brief(errors.median),
                brief(errors.p99),
                brief(errors.max),
            ]);
        }
    }
    let mut summary = Table::new(
        "quartics",
        "Quartic solvers on hard quartics",
        &["method", "ns per solve", "wrong counts", "without excuse", "error p50", "p99", "max"],
    );
    let mut series = Vec::new();
    for (_, name) in METHODS {
        let method_name = name;
        let Some(tally) = all.remove(name) else { continue };
        let time = times[name].iter().sum::<f64>() / tally.rows as f64;
        let errors = Errors::of(tally.errors, tally.wrong);
        summary.row([
            name.into(),
            brief(time),
            format!("{} of {}", tally.wrong, tally.rows),
            tally.wrong_without_excuse.to_string(),
            brief(errors.median),
            brief(errors.p99),
            brief(errors.max),
        ]);
        let name = format!("{name}: {} wrong counts", tally.wrong);
        series.push(Series { name, points: points.remove(method_name).unwrap_or_default() });
    }
    output.summary(summary);
    output.csv_only(by_family);
    output.plot("quartics", |path| {
        scatter(
            path,
            "Quartic solvers: speed against error, a point for each family",
            "time per solve, nanoseconds",
            "99th percentile of the relative error of simple roots, units of 2^-53",
            &series,
        )
    });
}
