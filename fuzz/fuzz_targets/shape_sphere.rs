//! Any numbers as a sphere and as a ray: the contract of a shape holds, and the oracle finds the same crossings.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rt_core::shape::Sphere;
use rt_fuzz::Case;

fuzz_target!(|case: Case| {
    case.check(|[center, ..], [radius, _]| Sphere::new(center, radius), true);
});
