//! The textbook: Ferrari's reduction to a cubic, solved by Cardano's formula.

use super::super::{Roots, quadratic};
use crate::Interval;
use crate::math::sqrt;

/// The real roots inside `within` of `c[0] + c[1] x + .. + c[4] x^4` by Ferrari's formula as textbooks print it.
///
/// Kept as the reference of what a plain closed form is worth: it promises no error. Cancellation loses up to all digits of a
/// root, a double root may be missed or come as two, and coefficients beyond about 1e75 or below 1e-75 overflow. Roots
/// are listed ascending, equal ones once with their multiplicity. With `c[4] = 0` it is [`cubic`](super::super::cubic);
/// with a NaN or infinite coefficient there are no roots.
///
/// Source: L. Ferrari, in G. Cardano, *Ars Magna*, 1545; the resolvent after G. Cardano.
pub fn ferrari(c: [f64; 5], within: Interval) -> Roots<4> {
    if !c.iter().all(|c| c.is_finite()) || c[4] == 0.0 {
        return super::lower_degree(c, within);
    }
    let [d, c1, b, a] = [c[0] / c[4], c[1] / c[4], c[2] / c[4], c[3] / c[4]];
    // x = z - a/4 gives z^4 + p z^2 + q z + r.
    let a2 = a * a;
    let p = b - 3.0 / 8.0 * a2;
    let q = c1 - a * b / 2.0 + a2 * a / 8.0;
    let r = d - a * c1 / 4.0 + a2 * b / 16.0 - 3.0 / 256.0 * a2 * a2;
    let shift = -a / 4.0;
    let mut found = Roots::<4>::default();
    if q == 0.0 {
        for square in quadratic([r, p, 1.0], Interval::LINE).iter() {
            if square.x >= 0.0 {
                let z = sqrt(square.x);
                found.insert(shift - z, 1);
                found.insert(shift + z, 1);
            }
        }
        return super::gathered(&found, within);
    }
    // (z^2 + p/2 + m)^2 - (2m z^2 - q z + m^2 + m p + p^2/4 - r) is a difference of squares for a positive root m of
    // m^3 + p m^2 + (p^2/4 - r) m - q^2/8.
    let m = cardano(p, p * p / 4.0 - r, -q * q / 8.0);
    if m > 0.0 {
        let s = sqrt(2.0 * m);
        for sign in [1.0, -1.0] {
            let discriminant = -(2.0 * p + 2.0 * m + sign * 2.0 * q / s);
            if discriminant >= 0.0 {
                let w = sqrt(discriminant);
                found.insert(shift + (sign * s - w) / 2.0, 1);
                found.insert(shift + (sign * s + w) / 2.0, 1);
            }
        }
    }
    super::gathered(&found, within)
}

/// The largest real root of `x^3 + a x^2 + b x + c`.
fn cardano(a: f64, b: f64, c: f64) -> f64 {
    let p = b - a * a / 3.0;
    let q = 2.0 / 27.0 * a * a * a - a * b / 3.0 + c;
    let discriminant = q * q / 4.0 + p * p * p / 27.0;
    let y = if discriminant >= 0.0 {
        let s = sqrt(discriminant);
        libm::cbrt(-q / 2.0 + s) + libm::cbrt(-q / 2.0 - s)
    } else {
        let t = 2.0 * sqrt(-p / 3.0);
        let angle = libm::acos((3.0 * q / (p * t)).clamp(-1.0, 1.0));
        t * libm::cos(angle / 3.0)
    };
    y - a / 3.0
}
