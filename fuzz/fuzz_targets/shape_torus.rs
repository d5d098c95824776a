//! Any numbers as a torus and as a ray: the contract of a shape holds, and the oracle finds the same crossings.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rt_core::shape::Torus;
use rt_fuzz::Case;

fuzz_target!(|case: Case| {
    case.check(
        |[center, axis, _], [major, minor]| {
            // The sheets of such a spindle are too near to each other: unsupported. A line through
            // the pinch of a horn meets it or misses it by its last bits, and so does the way back.
            let supported = major >= 1e-9 * minor && !((major - minor).abs() < 1e-6 * minor);
            Torus::new(center, axis, if supported { major } else { f64::NAN }, minor)
        },
        true,
    );
});
