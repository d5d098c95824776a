//! The solver of *Graphics Gems*: how ray tracers did it for thirty years.

use super::super::Roots;
use crate::Interval;
use crate::math::sqrt;
use core::f64::consts::FRAC_PI_3;

/// What counts as zero, in the units of the coefficients. This absolute tolerance is the method's, not ours: it is what
/// makes small or finely balanced polynomials fail.
const EPSILON: f64 = 1e-9;

/// The real roots inside `within` of `c[0] + c[1] x + .. + c[4] x^4` by the method of *Graphics Gems*.
///
/// Kept as the reference of how it was: the closed form with everything below 1e-9 taken for zero. It promises no error;
/// many quartics with small coefficients or nearly tangent ones lose roots or gain some. Roots are listed ascending,
/// equal ones once with their multiplicity. With `c[4] = 0` it is [`cubic`](super::super::cubic); with a NaN or
/// infinite coefficient there are no roots.
///
/// Source: J. Schwarze, *Cubic and quartic roots*, Graphics Gems, 1990, p. 404; written anew from the description there.
pub fn graphics_gems(c: [f64; 5], within: Interval) -> Roots<4> {
    if !c.iter().all(|c| c.is_finite()) || c[4] == 0.0 {
        return super::lower_degree(c, within);
    }
    let [d, c1, b, a] = [c[0] / c[4], c[1] / c[4], c[2] / c[4], c[3] / c[4]];
    // x = y - a/4 removes the cubic term: y^4 + p y^2 + q y + r.
    let a2 = a * a;
    let p = -3.0 / 8.0 * a2 + b;
    let q = a2 * a / 8.0 - a * b / 2.0 + c1;
    let r = -3.0 / 256.0 * a2 * a2 + a2 * b / 16.0 - a * c1 / 4.0 + d;
    let shift = a / 4.0;
    let mut found = Roots::<4>::default();
    let mut add = |y: f64| {
        if y.is_finite() {
            found.insert(y - shift, 1);
        }
    };
    if is_zero(r) {
        // y (y^3 + p y + q)
        let (roots, count) = cubic(q, p, 0.0);
        add(0.0);
        roots.iter().take(count).for_each(|&y| add(y));
    } else {
        // A real root z of the resolvent splits the quartic into two quadratics.
        let (roots, _) = cubic(r * p / 2.0 - q * q / 8.0, -r, -p / 2.0);
        let z = roots[0];
        let u = z * z - r;
        let v = 2.0 * z - p;
        let u = if is_zero(u) {
            Some(0.0)
        } else if u > 0.0 {
            Some(sqrt(u))
        } else {
            None
        };
        let v = if is_zero(v) {
            Some(0.0)
        } else if v > 0.0 {
            Some(sqrt(v))
        } else {
            None
        };
        if let (Some(u), Some(v)) = (u, v) {
            let v = if q < 0.0 { -v } else { v };
            for (linear, constant) in [(v, z - u), (-v, z + u)] {
                let (roots, count) = quadratic(linear, constant);
                roots.iter().take(count).for_each(|&y| add(y));
            }
        }
    }
    super::gathered(&found, within)
}

fn is_zero(x: f64) -> bool {
    -EPSILON < x && x < EPSILON
}

/// The real roots of `y^2 + 2 h y + q` with `linear = 2h`.
fn quadratic(linear: f64, q: f64) -> ([f64; 2], usize) {
    let h = linear / 2.0;
    let discriminant = h * h - q;
    if is_zero(discriminant) {
        ([-h, 0.0], 1)
    } else if discriminant < 0.0 {
        ([0.0; 2], 0)
    } else {
        let s = sqrt(discriminant);
        ([s - h, -s - h], 2)
    }
}

/// The real roots of `x^3 + a x^2 + b x + c`.
fn cubic(c: f64, b: f64, a: f64) -> ([f64; 3], usize) {
    let a2 = a * a;
    let p = (-a2 / 3.0 + b) / 3.0;
    let q = (2.0 / 27.0 * a * a2 - a * b / 3.0 + c) / 2.0;
    let cube = p * p * p;
    let discriminant = q * q + cube;
    let (mut roots, count) = if is_zero(discriminant) {
        if is_zero(q) {
            ([0.0; 3], 1)
        } else {
            let u = libm::cbrt(-q);
            ([2.0 * u, -u, 0.0], 2)
        }
    } else if discriminant < 0.0 {
        let angle = libm::acos((-q / sqrt(-cube)).clamp(-1.0, 1.0)) / 3.0;
        let t = 2.0 * sqrt(-p);
        ([t * libm::cos(angle), -t * libm::cos(angle + FRAC_PI_3), -t * libm::cos(angle - FRAC_PI_3)], 3)
    } else {
        let s = sqrt(discriminant);
        ([libm::cbrt(s - q) - libm::cbrt(s + q), 0.0, 0.0], 1)
    };
    for root in roots.iter_mut().take(count) {
        *root -= a / 3.0;
    }
    (roots, count)
}
