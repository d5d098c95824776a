//! Any numbers as a sphere and as a ray: the contract of a shape holds.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rt_core::shape::Sphere;
use rt_fuzz::Case;

fuzz_target!(|case: Case| {
    let [a, _, _] = case.points.map(|p| p.value());
    let [l, _] = case.lengths.map(|l| l.value());
    case.check(Sphere::new(a, l), true);
});
