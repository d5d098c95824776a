//! Any coefficients: the roots are finite and ascend, at most four with their multiplicities, and the mirrored polynomial
//! has the mirrored roots, bit for bit.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rt_core::Interval;
use rt_core::poly::{Method, quartic, roots};
use rt_fuzz::Number;

fuzz_target!(|case: [Number; 5]| {
    let c = case.map(Number::value);
    let found = quartic(c, Interval::LINE);
    assert!(found.windows(2).all(|pair| pair[0].x < pair[1].x || (pair[0].x == pair[1].x)));
    let count: u32 = found.iter().map(|root| root.multiplicity).sum();
    assert!(count <= 4 && found.iter().all(|root| root.x.is_finite() && root.multiplicity > 0));
    assert_eq!(found.all(), c == [0.0; 5]);
    // The mirrored polynomial has the mirrored roots, bit for bit.
    let mirrored = quartic([c[0], -c[1], c[2], -c[3], c[4]], Interval::LINE);
    let back: Vec<(f64, u32)> = mirrored.iter().rev().map(|root| (-root.x, root.multiplicity)).collect();
    let there: Vec<(f64, u32)> = found.iter().map(|root| (root.x, root.multiplicity)).collect();
    assert_eq!(there, back, "{c:?}");
    // The older methods promise less, but not to panic.
    for method in [Method::Ferrari, Method::GraphicsGems] {
        assert!(roots(c, Interval::LINE, method).len() <= 4);
    }
});
