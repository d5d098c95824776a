//! The report's judgements can fail: right answers pass them, answers broken on purpose do not.
// Printing alone uses the system's logarithm.
#![allow(dead_code, clippy::disallowed_methods)]

#[path = "../benches/report/clock.rs"]
mod clock;
#[path = "../benches/report/quantile.rs"]
mod quantile;
#[path = "../benches/report/truth.rs"]
mod truth;
#[path = "../benches/report/verdict.rs"]
mod verdict;

use quantile::Errors;
use rt_core::poly::{self, Method};
use rt_core::{Interval, Primitive};
use std::time::Duration;

/// Errors of our refined first hits over all rays kept in the repository, each answer passed through `change`.
fn hits(change: impl Fn(Option<f64>) -> Option<f64>) -> Errors {
    let (mut errors, mut wrong) = (Vec::new(), 0);
    for case in truth::rays() {
        let shape = truth::shape(&case.kind, &case.numbers).expect("a legal shape");
        let t = shape.hit(&case.ray, case.within).map(|hit| shape.surface(&case.ray, hit).t);
        match verdict::first_hit(&case, change(t)) {
            None => wrong += usize::from(case.margin > 64.0 * truth::UNIT),
            Some(Some(error)) if case.margin > 4.0 * truth::UNIT => errors.push(error),
            Some(_) => {}
        }
    }
    Errors::of(errors, wrong)
}

#[test]
fn hits_broken_on_purpose_are_found() {
    assert!(verdict::surface_holds(&hits(|t| t)));
    // Five units in the last place too far, a ray in every hit; no hit at all; a hit where there is none.
    assert!(!verdict::surface_holds(&hits(|t| t.map(|t| t * (1.0 + 5.0 * f64::EPSILON)))));
    assert!(!verdict::surface_holds(&hits(|_| None)));
    assert!(!verdict::surface_holds(&hits(|t| t.or(Some(1.0)))));
}

/// Errors of our roots, each answer passed through `change`.
fn roots(change: impl Fn(&mut Vec<(f64, u32)>)) -> Errors {
    let mut tally = verdict::Tally::default();
    for case in truth::quartics() {
        let found = poly::roots(case.coefficients, Interval::LINE, Method::Certified);
        let mut found = found.iter().map(|r| (r.x, r.multiplicity)).collect();
        change(&mut found);
        tally.add(&case, &found);
    }
    Errors::of(tally.errors, tally.wrong)
}

#[test]
fn roots_broken_on_purpose_are_found() {
    assert!(verdict::roots_hold(&roots(|_| {})));
    assert!(!verdict::roots_hold(&roots(|found| found
        .iter_mut()
        .for_each(|r| r.0 *= 1.0 + 2.0 * f64::EPSILON))));
    assert!(!verdict::roots_hold(&roots(|found| found.truncate(1))));
    assert!(!verdict::roots_hold(&roots(|found| found.push((1e9, 1)))));
}

#[test]
fn what_the_clock_cannot_resolve_is_refused() {
    let tick = Duration::from_nanos(30);
    let long = &mut [Duration::from_micros(40), Duration::from_micros(50), Duration::from_micros(31)];
    assert!(clock::judge(long, 10, tick).is_ok());
    let short = &mut [Duration::from_micros(40), Duration::from_micros(50), Duration::from_micros(29)];
    assert!(clock::judge(short, 10, tick).is_err());
}
