//! The few functions that `core` lacks. All of them are exact or portable: the same bits on every platform.

/// The square root, correctly rounded.
#[inline(always)]
pub(crate) fn sqrt(x: f64) -> f64 {
    #[cfg(any(feature = "std", test))]
    return x.sqrt();
    #[cfg(not(any(feature = "std", test)))]
    return libm::sqrt(x);
}

/// The lesser of two; the second where one is NaN. Unlike `min` it is one instruction.
#[inline(always)]
pub(crate) fn lesser(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// The greater of two; the second where one is NaN.
#[inline(always)]
pub(crate) fn greater(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// Two to the power of `exponent`, exactly, for `-1022 <= exponent <= 1023`.
#[inline(always)]
pub(crate) const fn exp2i(exponent: i32) -> f64 {
    debug_assert!(-1023 < exponent && exponent < 1024);
    f64::from_bits(((exponent + 1023) as u64) << 52)
}

/// Says that the branch it is called in is the rarer one: the code goes straight on with the other. Only time depends on it.
#[cold]
#[inline(always)]
pub(crate) const fn rarely() {}

/// The exponent `e` with `2^e <= |x| < 2^(e+1)` of a normal number; -1023 for zero and subnormal numbers, 1024 for
/// infinities and NaN.
#[inline(always)]
pub(crate) const fn exponent(x: f64) -> i32 {
    ((x.to_bits() >> 52) & 0x7ff) as i32 - 1023
}
