//! Any numbers as a cuboid and as a ray: the contract of a shape holds, and the oracle finds the same crossings.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rt_core::shape::Cuboid;
use rt_fuzz::Case;

fuzz_target!(|case: Case| {
    case.check(|[a, b, _], _| Cuboid::new(a.min(b), a.max(b)), true);
});
