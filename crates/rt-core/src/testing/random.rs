//! A small seeded generator: the same sequence on every machine.

use glam::DVec3;

/// Pseudo-random numbers by SplitMix64 (Steele, Lea, Flood 2014, doi:10.1145/2714064.2660195).
#[derive(Clone, Debug)]
pub struct Random {
    state: u64,
}

impl Random {
    /// The sequence of this seed.
    pub fn new(seed: u64) -> Self {
        Random { state: seed }
    }

    /// Sixty-four random bits.
    pub fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in `[least, most)`.
    pub fn uniform(&mut self, least: f64, most: f64) -> f64 {
        let unit = (self.bits() >> 11) as f64 * (1.0 / (1u64 << 53) as f64);
        least + (most - least) * unit
    }

    /// Uniform among `0..count`.
    pub fn below(&mut self, count: u32) -> u32 {
        (((self.bits() >> 32) * u64::from(count)) >> 32) as u32
    }

    /// True once in `count` times.
    pub fn once_in(&mut self, count: u32) -> bool {
        self.below(count) == 0
    }

    /// Ten to a power that is uniform in `[least, most)`.
    pub fn magnitude(&mut self, least: f64, most: f64) -> f64 {
        libm::exp10(self.uniform(least, most))
    }

    /// A number of either sign.
    pub fn sign(&mut self) -> f64 {
        if self.once_in(2) { -1.0 } else { 1.0 }
    }

    /// Uniform in the cube from -1 to 1.
    pub fn in_cube(&mut self) -> DVec3 {
        DVec3::new(self.uniform(-1.0, 1.0), self.uniform(-1.0, 1.0), self.uniform(-1.0, 1.0))
    }

    /// Uniform on the unit sphere.
    pub fn direction(&mut self) -> DVec3 {
        loop {
            let v = self.in_cube();
            let square = v.length_squared();
            if square > 0.01 && square <= 1.0 {
                return v / crate::math::sqrt(square);
            }
        }
    }

    /// Any bit pattern, with the special ones more often than by chance.
    pub fn any_f64(&mut self) -> f64 {
        const SPECIAL: [f64; 12] = [
            0.0,
            -0.0,
            1.0,
            -1.0,
            f64::NAN,
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::MAX,
            f64::MIN,
            f64::MIN_POSITIVE,
            f64::from_bits(1),
            // A signalling NaN.
            f64::from_bits(0x7ff0_0000_0000_0001),
        ];
        if self.once_in(3) { SPECIAL[self.below(12) as usize] } else { f64::from_bits(self.bits()) }
    }

    /// A vector of any bit patterns.
    pub fn any_vector(&mut self) -> DVec3 {
        DVec3::new(self.any_f64(), self.any_f64(), self.any_f64())
    }
}
