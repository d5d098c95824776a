//! A quartic as a product of two real quadratics, approximately, in `f64`.
//!
//! Ferrari's method with two cares. Of the real roots of the resolvent cubic the one farthest from the others is taken: it
//! belongs to the split in which two nearly equal roots stay in one factor, so both factors are well
//! conditioned. And of the two quantities `s` and `d` with `s d = q` the one with less cancellation is computed, the
//! other by division (as the choice of factors in Orellana and De Michele 2020, doi:10.1145/3386241). Nothing is promised
//! about the result: it is judged and mended afterwards.

use crate::math::{exp2i, sqrt};
use core::hint::select_unpredictable;

/// The monic quadratic `x^2 + linear x + constant`.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Factor {
    pub linear: f64,
    pub constant: f64,
}

impl Factor {
    /// The factor whose roots are the reciprocals of these times `scale`, a power of two.
    #[inline(always)]
    pub fn reversed(self, scale: f64) -> Self {
        let inverse = 1.0 / (self.constant * scale);
        Factor { linear: self.linear * inverse, constant: inverse / scale }
    }
}

/// Two factors of `x^4 + a x^3 + b x^2 + c x + d`; `None` where the arithmetic breaks down.
#[inline(always)]
pub(super) fn split(d: f64, c: f64, b: f64, a: f64) -> Option<[Factor; 2]> {
    // x = z - a/4 gives z^4 + p z^2 + q z + r.
    let t = 0.25 * a;
    let t2 = t * t;
    let p = b - 6.0 * t2;
    let q = c - 2.0 * t * (b - 4.0 * t2);
    let r = d - t * (c - t * (b - 3.0 * t2));
    // (z^2 + s z + v1) (z^2 - s z + v2), w = s^2: w^3 + 2 p w^2 + (p^2 - 4 r) w - q^2 = 0; w = y - 2p/3.
    let p2 = p * p;
    let m = -(p2 / 3.0 + 4.0 * r);
    let mut y = isolated_root(m, p * (8.0 / 3.0 * r - 2.0 / 27.0 * p2) - q * q);
    // v1 + v2 = p + w, v2 - v1 = d with d^2 = (p + w)^2 - 4 r and s d = q.
    let mut w = y - 2.0 / 3.0 * p;
    let mut sum = p + w;
    let mut e = sum * sum - 4.0 * r;
    // w e = q^2: where one is negative so is the other, or it is zero, and only the larger one knows its sign.
    if w < 0.0 && e * (y.abs() + p.abs()) < -w * (sum * sum + 4.0 * r.abs()) {
        // Two pairs of complex roots, and this split would take the pairs apart: the greatest of the other two
        // roots of the resolvent keeps them.
        y = 0.5 * (sqrt((-3.0 * y * y - 4.0 * m).max(0.0)) - y);
        w = y - 2.0 / 3.0 * p;
        sum = p + w;
        e = sum * sum - 4.0 * r;
    }
    let (s, difference) = if w * (sum * sum + 4.0 * r.abs()) > e * (y.abs() + p.abs()) {
        let s = sqrt(w);
        (s, q / s)
    } else if e > 0.0 {
        let difference = sqrt(e);
        (q / difference, difference)
    } else {
        return None;
    };
    let (mut v1, mut v2) = (0.5 * (sum - difference), 0.5 * (sum + difference));
    // Equal ones stay equal, whichever way round the polynomial is given.
    if difference != 0.0 {
        if (sum < 0.0) == (difference < 0.0) {
            v1 = r / v2;
        } else if v1 != 0.0 {
            v2 = r / v1;
        }
    }
    let (mut f, mut g) = (
        Factor { linear: 2.0 * t + s, constant: t * (t + s) + v1 },
        Factor { linear: 2.0 * t - s, constant: t * (t - s) + v2 },
    );
    if f.constant.abs() < g.constant.abs() {
        core::mem::swap(&mut f, &mut g);
    }
    // The factor of the smaller roots lost its digits in the shift: take it from the product instead.
    if a != 0.0 || d == 0.0 {
        g.constant = d / f.constant;
        g.linear = (c - f.linear * g.constant) / f.constant;
        f.linear = a - g.linear;
    }
    let sound =
        f.linear.is_finite() && f.constant.is_finite() && g.linear.is_finite() && g.constant.is_finite();
    if sound { Some([f, g]) } else { None }
}

/// The real root of `x^3 + a x^2 + b x + d` that is farthest from the others, and their factor: by division from the end
/// where it is stable.
#[inline(always)]
pub(super) fn cubic(d: f64, b: f64, a: f64) -> (f64, Factor) {
    let t = a * (1.0 / 3.0);
    let t2 = t * t;
    let x = isolated_root(b - 3.0 * t2, d - t * (b - 2.0 * t2)) - t;
    let constant = -d / x;
    let rest = if (x * x * x).abs() > d.abs() {
        Factor { linear: (constant - b) / x, constant }
    } else {
        Factor { linear: a + x, constant: b + (a + x) * x }
    };
    (x, rest)
}

/// The real root of `y^3 + m y + n` farthest from the others, to about 1e-13.
#[inline(always)]
fn isolated_root(m: f64, n: f64) -> f64 {
    let (q, h) = (m * (1.0 / 3.0), 0.5 * n.abs());
    let discriminant = h * h + q * q * q;
    let mut y = if discriminant < 0.0 {
        // Viete: 2 sqrt(-q) cos(acos(x) / 3), the cosine by its best polynomial of degree 3, within 5e-5.
        let half = sqrt(-q);
        let x = h / (-q * half);
        2.0 * half * (COSINE[0] + x * (COSINE[1] + x * (COSINE[2] + x * COSINE[3])))
    } else {
        // Cardano: k - q/k without its cancellation.
        let k = cube_root(h + sqrt(discriminant));
        let k2 = k * k;
        let below = k2 * (k2 + q) + q * q;
        if below == 0.0 {
            return 0.0;
        }
        2.0 * h * k2 / below
    };
    // Halley's method, of third order: from 5e-5 to 1e-13. What is left is mended later.
    let y2 = y * y;
    let f = (y2 + m) * y - 2.0 * h;
    let slope = 3.0 * y2 + m;
    y -= f * slope / (slope * slope - 3.0 * y * f);
    select_unpredictable(n > 0.0, -y, y)
}

/// `cos(acos(x) / 3)` for `0 <= x <= 1`.
const COSINE: [f64; 4] = [0.866_066_33, 0.165_330_35, -0.040_691_197, 0.009_319_684];

/// The cube root of a number that is not negative, to 5e-5: a third of the exponent and mantissa bits, and one step of
/// Halley's method.
#[inline(always)]
fn cube_root(x: f64) -> f64 {
    if x < exp2i(-1000) {
        return 0.0;
    }
    // Dividing the bits by three divides the logarithm, read linearly between powers of two, by three; the constant is
    // two thirds of the bias, less the mean error of that reading.
    let y = f64::from_bits(x.to_bits() / 3 + 0x2a9f_7893_0000_0000);
    let y3 = y * y * y;
    y * (y3 + 2.0 * x) / (2.0 * y3 + x)
}
