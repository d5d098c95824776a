//! Mirror directions, refraction and the Fresnel equations.
//!
//! Frame: `direction` is the unit direction of the arriving ray, `normal` the unit normal on the side of arrival, so
//! that `direction . normal <= 0`.

use rt_core::glam::DVec3;

/// The mirror direction `d - 2 (d . n) n`.
///
/// Of unit length within 8 ulps when both arguments are within 2.
#[inline]
pub fn mirror(direction: DVec3, normal: DVec3) -> DVec3 {
    direction - normal * (2.0 * direction.dot(normal))
}

/// What happens where two media meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Refraction {
    /// Light goes through.
    Through {
        /// The unit direction beyond the surface.
        direction: DVec3,
        /// The exact reflectance of unpolarised light, from 0 to 1.
        reflectance: f64,
    },
    /// Total internal reflection: nothing goes through.
    Total,
}

/// Refraction by Snell's law from a medium of index `from` into one of index `to`, with Fresnel's reflectance
/// `F = (rs^2 + rp^2) / 2`, `rs = (n1 c1 - n2 c2) / (n1 c1 + n2 c2)`, `rp = (n2 c1 - n1 c2) / (n2 c1 + n1 c2)`.
///
/// Equal indices leave the direction as it is, bit for bit, with reflectance 0. The residual
/// `|n1 sin a1 - n2 sin a2|` is at most 8 ulps of the larger index, and refracting back returns the sine within 16 (tested
/// at random angles, grazing ones too). Total reflection is decided by `(n1 / n2)^2 |d + c1 n|^2 >= 1`. The sine comes from the tangential part of the direction, not from the cosine, so that
/// it keeps its digits near perpendicular incidence.
#[inline]
pub fn refract(direction: DVec3, normal: DVec3, from: f64, to: f64) -> Refraction {
    if from == to {
        return Refraction::Through { direction, reflectance: 0.0 };
    }
    let cos_in = -direction.dot(normal);
    let ratio = from / to;
    let tangential = (direction + normal * cos_in) * ratio;
    let sin_squared = tangential.length_squared();
    if !(sin_squared < 1.0) {
        return Refraction::Total;
    }
    let cos_out = (1.0 - sin_squared).sqrt();
    let reflectance = fresnel(cos_in, cos_out, ratio);
    Refraction::Through { direction: tangential - normal * cos_out, reflectance }
}

/// Fresnel's reflectance of unpolarised light from both cosines and `ratio = n1 / n2`.
#[inline]
fn fresnel(cos_in: f64, cos_out: f64, ratio: f64) -> f64 {
    let perpendicular = (ratio * cos_in - cos_out) / (ratio * cos_in + cos_out);
    let parallel = (cos_in - ratio * cos_out) / (cos_in + ratio * cos_out);
    let f = 0.5 * (perpendicular * perpendicular + parallel * parallel);
    // Both quotients are at most 1 in size while the cosines are not negative; a cosine that rounding made negative at
    // grazing incidence is a mirror.
    if f <= 1.0 { f } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const U: f64 = f64::EPSILON / 2.0;

    fn unit() -> impl Strategy<Value = DVec3> {
        (-1.0..1.0f64, -1.0..1.0f64, -1.0..1.0f64)
            .prop_map(|(x, y, z)| DVec3::new(x, y, z))
            .prop_filter("not zero", |v| v.length() > 0.01)
            .prop_map(|v| v.normalize())
    }

    /// The unit vector across `n` on the side of `side`; across to a rounding also where the two are nearly parallel, since the
    /// second time nothing cancels.
    fn across(n: DVec3, side: DVec3) -> DVec3 {
        let once = (side - n * side.dot(n)).normalize();
        (once - n * once.dot(n)).normalize()
    }

    /// A unit normal and a unit direction that arrives on its side, at any angle, grazing ones too.
    fn arrival() -> impl Strategy<Value = (DVec3, DVec3)> {
        (unit(), unit(), -16.0..0.0f64).prop_filter_map("not along the normal", |(n, side, exponent)| {
            let tangent = across(n, side);
            let cosine = libm::exp2(exponent);
            let d = (tangent * (1.0 - cosine * cosine).sqrt() - n * cosine).normalize();
            (d.is_finite() && d.dot(n) < 0.0).then_some((n, d))
        })
    }

    fn sine(d: DVec3, n: DVec3) -> f64 {
        d.cross(n).length()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn mirrors_return((n, d) in arrival()) {
            let r = mirror(d, n);
            prop_assert!((r.length() - 1.0).abs() <= 16.0 * U);
            prop_assert!((r.dot(n) + d.dot(n)).abs() <= 16.0 * U);
            prop_assert!((mirror(r, -n) - d).length() <= 32.0 * U);
        }

        #[test]
        fn snell_holds_and_is_reciprocal((n, d) in arrival(), from in 0.5..3.0f64, to in 0.5..3.0f64) {
            match refract(d, n, from, to) {
                Refraction::Through { direction, reflectance } => {
                    prop_assert!((0.0..=1.0).contains(&reflectance));
                    // |out|^2 - 1 is 2 c2 (tangential . n) but for a few roundings, and tangential . n is the ratio of
                    // the indices times what d . n (3 u) and |n|^2 - 1 (6 u after normalising) err.
                    prop_assert!((direction.length() - 1.0).abs() <= (8.0 + 9.0 * from / to) * U);
                    prop_assert!(direction.dot(n) <= 0.0);
                    let residual = from * sine(d, n) - to * sine(direction, n);
                    prop_assert!(residual.abs() <= 8.0 * 2.0 * U * from.max(to), "{residual:e}");
                    // Back again: near the critical angle the cosine is a square root of what rounding left, so the
                    // sine is what returns, and the reflectance is the same from both sides.
                    if let Refraction::Through { direction: back, reflectance: same } = refract(-direction, -n, to, from) {
                        let residual = sine(back, n) - sine(d, n);
                        prop_assert!(residual.abs() <= 16.0 * 2.0 * U * (to / from).max(1.0), "{residual:e}");
                        let least = direction.dot(n).abs().min(d.dot(n).abs());
                        if least > 0.01 {
                            prop_assert!((back + d).length() <= 16.0 * 2.0 * U * 100.0 * (to / from).max(1.0));
                            // r = (a - b) / (a + b) changes by at most half of what a and b, which are cosines times
                            // indices, change relative to themselves, and so does R = (rs^2 + rp^2) / 2. A cosine
                            // changes by the residual of the sine over its square; 16 u pay for evaluating r twice.
                            let change = 16.0 * 2.0 * U * (to / from).max(1.0) / (least * least) + 16.0 * U;
                            prop_assert!((same - reflectance).abs() <= change, "{same} {reflectance}");
                        }
                    }
                }
                Refraction::Total => prop_assert!(from * sine(d, n) >= to * (1.0 - 8.0 * U)),
            }
        }

        #[test]
        fn total_reflection_begins_at_the_critical_angle(n in unit(), side in unit(), ratio in 1.01..3.0f64) {
            let tangent = across(n, side);
            for (factor, total) in [(1.0 - 1e-13, false), (1.0 + 1e-13, true)] {
                let sin = factor / ratio;
                let d = (tangent * sin - n * (1.0 - sin * sin).sqrt()).normalize();
                prop_assert_eq!(refract(d, n, ratio, 1.0) == Refraction::Total, total);
            }
        }
    }

    #[test]
    fn equal_indices_change_nothing() {
        let d = DVec3::new(0.3, -0.8, 0.1).normalize();
        assert_eq!(refract(d, DVec3::Y, 1.33, 1.33), Refraction::Through { direction: d, reflectance: 0.0 });
    }

    #[test]
    fn reflectance_at_known_angles() {
        // Perpendicular: ((n1 - n2) / (n1 + n2))^2 = 0.04 for glass in air.
        let Refraction::Through { reflectance, .. } = refract(-DVec3::Y, DVec3::Y, 1.0, 1.5) else {
            panic!()
        };
        assert!((reflectance - 0.04).abs() < 1e-15);
        // Brewster's angle, tan a = 1.5: only perpendicular light is reflected, F = ((1 - n^2) / (1 + n^2))^2 / 2.
        let a = libm::atan(1.5);
        let d = DVec3::new(libm::sin(a), -libm::cos(a), 0.0);
        let Refraction::Through { reflectance, .. } = refract(d, DVec3::Y, 1.0, 1.5) else { panic!() };
        let expected = 0.5 * (1.25f64 / 3.25) * (1.25 / 3.25);
        assert!((reflectance - expected).abs() < 1e-15, "{reflectance}");
    }

    #[test]
    fn no_argument_panics() {
        for x in [0.0, -0.0, 1.0, f64::NAN, f64::INFINITY, f64::MIN_POSITIVE, f64::MAX] {
            for y in [0.0, 1.0, f64::NAN, f64::NEG_INFINITY, 1e-300] {
                let _ = refract(DVec3::new(x, y, x), DVec3::new(y, x, 1.0), x, y);
                let _ = mirror(DVec3::new(x, y, x), DVec3::new(y, x, 1.0));
            }
        }
    }
}
