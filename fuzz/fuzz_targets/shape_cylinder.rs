//! Any numbers as a cylinder and as a ray: the contract of a shape holds.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rt_core::shape::Cylinder;
use rt_fuzz::Case;

fuzz_target!(|case: Case| {
    let [a, b, _] = case.points.map(|p| p.value());
    let [l, _] = case.lengths.map(|l| l.value());
    case.check(Cylinder::new(a, b, l), true);
    case.check(Cylinder::open(a, b, l), false);
});
