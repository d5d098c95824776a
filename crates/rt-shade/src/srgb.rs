//! The exact sRGB curve (IEC 61966-2-1): linear light to encoded values and back.

/// The linear value of an encoded one, both from 0 to 1: `v / 12.92` up to 0.04045, else `((v + 0.055) / 1.055)^2.4`.
pub(crate) fn decode(v: f64) -> f64 {
    if v <= 0.04045 { v / 12.92 } else { libm::pow((v + 0.055) / 1.055, 2.4) }
}

/// Encodes linear values in 8 bits: the nearest code, without a power a pixel.
///
/// Code `k` begins at the linear value of `(k - 1/2) / 255`. The upper half of the bits of an `f32` picks a short run of
/// codes, a comparison or two the code.
pub(crate) struct Encoder {
    /// By code: the least linear value that is encoded as more than the code.
    ends: [f32; 256],
    /// By upper bits from those of 2^-13 to those of 1: the code of the least such value.
    starts: Vec<u8>,
}

/// The upper bits of 2^-13: everything below is code 0, whose end is above 2^-13 (0.5 / 255 / 12.92 = 1.5e-4).
const FIRST: u32 = 0x3900_0000 >> 16;
/// The upper bits of 1.
const LAST: u32 = 0x3f80_0000 >> 16;

impl Encoder {
    pub fn new() -> Self {
        let mut ends = [f32::INFINITY; 256];
        for (code, end) in ends.iter_mut().take(255).enumerate() {
            let exact = decode((code as f64 + 0.5) / 255.0);
            // The least f32 that is not below the exact value.
            let near = exact as f32;
            *end = if f64::from(near) < exact { f32::from_bits(near.to_bits() + 1) } else { near };
        }
        let mut starts = Vec::with_capacity((LAST - FIRST) as usize);
        let mut code = 0;
        for bits in FIRST..LAST {
            let least = f32::from_bits(bits << 16);
            while least >= ends[code] {
                code += 1;
            }
            starts.push(code as u8);
        }
        Encoder { ends, starts }
    }

    /// The code of a linear value; 0 for NaN and below, 255 for more than white.
    #[inline]
    pub fn encode(&self, v: f32) -> u8 {
        if v >= 1.0 {
            return 255;
        }
        let bits = v.to_bits() >> 16;
        if !(v > 0.0) || bits < FIRST {
            return 0;
        }
        let mut code = self.starts[(bits - FIRST) as usize];
        while v >= self.ends[usize::from(code)] {
            code += 1;
        }
        code
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn encode_by_power(v: f64) -> u8 {
        let v = v.clamp(0.0, 1.0);
        let e = if v <= 0.0031308 { 12.92 * v } else { 1.055 * libm::pow(v, 1.0 / 2.4) - 0.055 };
        libm::round(255.0 * e) as u8
    }

    #[test]
    fn encodes_as_the_power_does() {
        let encoder = Encoder::new();
        for i in 0..=1_000_000 {
            let v = (f64::from(i) / 1e6) as f32;
            assert_eq!(encoder.encode(v), encode_by_power(v.into()), "{v}");
        }
    }

    #[test]
    fn codes_return() {
        let encoder = Encoder::new();
        for code in 0..=255u8 {
            assert_eq!(encoder.encode(decode(f64::from(code) / 255.0) as f32), code);
        }
    }

    #[test]
    fn nothing_is_out_of_range() {
        let encoder = Encoder::new();
        for (v, code) in [
            (f32::NAN, 0),
            (-f32::NAN, 0),
            (-1.0, 0),
            (-0.0, 0),
            (f32::NEG_INFINITY, 0),
            (f32::MIN_POSITIVE, 0),
            (0.9999999, 255),
            (7.0, 255),
            (f32::INFINITY, 255),
        ] {
            assert_eq!(encoder.encode(v), code, "{v}");
        }
    }
}
