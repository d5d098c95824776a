//! Any numbers as a disk and as a ray: the contract of a shape holds, and the oracle finds the same crossings.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rt_core::shape::Disk;
use rt_fuzz::Case;

fuzz_target!(|case: Case| {
    case.check(|[center, normal, _], [radius, _]| Disk::new(center, normal, radius), false);
});
