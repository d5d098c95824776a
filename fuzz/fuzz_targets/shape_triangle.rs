//! Any numbers as a triangle and as a ray: the contract of a shape holds, and the oracle finds the same crossings.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rt_core::shape::Triangle;
use rt_fuzz::Case;

fuzz_target!(|case: Case| {
    case.check(|[a, b, c], _| Triangle::new(a, b, c), false);
});
