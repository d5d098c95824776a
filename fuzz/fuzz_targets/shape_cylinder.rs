//! Any numbers as a cylinder and as a ray: the contract of a shape holds, and the oracle finds the same crossings.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rt_core::glam::DVec3;
use rt_core::shape::Cylinder;
use rt_fuzz::Case;

fuzz_target!(|case: Case| {
    // The walls of a thinner or flatter one are nearer to each other than its points are known: unsupported.
    let supported = |base: DVec3, top: DVec3, radius: f64| {
        let height = (top - base).abs().max_element();
        radius >= 1e-12 * height && height >= 1e-12 * radius
    };
    let end = |base: DVec3, top: DVec3, radius: f64| if supported(base, top, radius) { top } else { base };
    case.check(|[base, top, _], [radius, _]| Cylinder::new(base, end(base, top, radius), radius), true);
    case.check(|[base, top, _], [radius, _]| Cylinder::open(base, end(base, top, radius), radius), false);
});
