//! Any numbers as a cone and as a ray: the contract of a shape holds.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rt_core::shape::Cone;
use rt_fuzz::Case;

fuzz_target!(|case: Case| {
    let [a, b, _] = case.points.map(|p| p.value());
    let [l, m] = case.lengths.map(|l| l.value());
    case.check(Cone::new(a, l, b, m), true);
    case.check(Cone::open(a, l, b, m), false);
});
