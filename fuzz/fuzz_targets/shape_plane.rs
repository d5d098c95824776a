//! Any numbers as a plane and as a ray: the contract of a shape holds, and the oracle finds the same crossings.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rt_core::shape::Plane;
use rt_fuzz::Case;

fuzz_target!(|case: Case| {
    case.check(|[point, normal, _], _| Plane::new(point, normal), false);
});
