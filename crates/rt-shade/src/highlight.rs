//! The power in Phong's highlight.

/// Up to half of this exponents are taken by multiplication. The result errs by u = 2^-53 a factor, that is by 2^-43 at most,
/// and by the square root's u: nothing in a colour.
const MOST: f64 = 2048.0;

/// `cosine^exponent` for `cosine > 0`, `exponent >= 0`.
///
/// Whole and half exponents, which is what people write, by repeated squaring (and one square root): a fraction of the
/// time of the general power.
#[inline(always)]
pub(crate) fn power(cosine: f64, exponent: f64) -> f64 {
    let twice = 2.0 * exponent;
    let whole = twice as u32;
    if !(twice <= MOST && f64::from(whole) == twice) {
        return libm::pow(cosine, exponent);
    }
    let mut product = if whole & 1 == 1 { cosine.sqrt() } else { 1.0 };
    let (mut square, mut rest) = (cosine, whole >> 1);
    while rest != 0 {
        if rest & 1 == 1 {
            product *= square;
        }
        square *= square;
        rest >>= 1;
    }
    product
}

#[cfg(test)]
mod tests {
    use super::power;

    #[test]
    fn whole_half_and_other_exponents_are_the_power() {
        for exponent in [0.0, 0.5, 1.0, 2.0, 12.5, 27.07570, 50.0, 125.0, 999.5, 1024.0, 1024.5, 1e9] {
            for cosine in [1e-300, 1e-3, 0.5, 0.9, 0.999, 1.0 - 1e-9, 1.0, 1.0 + 1e-15] {
                let (ours, exact) = (power(cosine, exponent), libm::pow(cosine, exponent));
                // Two roundings of each product, and the last place of `libm`.
                assert!(
                    (ours - exact).abs() <= exact * (2.0 * exponent + 4.0) * f64::EPSILON,
                    "{cosine}^{exponent}"
                );
            }
        }
        assert_eq!(power(0.25, 0.5), 0.5);
        assert_eq!(power(0.5, 3.0), 0.125);
    }
}
