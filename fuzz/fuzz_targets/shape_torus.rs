//! Any numbers as a torus and as a ray: the contract of a shape holds.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rt_core::shape::Torus;
use rt_fuzz::Case;

fuzz_target!(|case: Case| {
    let [a, b, _] = case.points.map(|p| p.value());
    let [l, m] = case.lengths.map(|l| l.value());
    // The sheets of such a spindle are nearer to each other than a point is known: unsupported.
    if l < 1e-12 * m {
        return;
    }
    case.check(Torus::new(a, b, l, m), true);
});
