//! Any numbers as a cuboid and as a ray: the contract of a shape holds.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rt_core::shape::Cuboid;
use rt_fuzz::Case;

fuzz_target!(|case: Case| {
    let [a, b, _] = case.points.map(|p| p.value());
    let [_, _] = case.lengths.map(|l| l.value());
    case.check(Cuboid::new(a.min(b), a.max(b)), true);
});
