//! Linear colours.

use core::ops::{Add, AddAssign, Mul, MulAssign};

/// A colour in linear light: red, green and blue of the sRGB primaries, 0 is black, 1 is white, more is brighter
/// than white.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Color {
    /// Red.
    pub r: f64,
    /// Green.
    pub g: f64,
    /// Blue.
    pub b: f64,
}

impl Color {
    /// No light.
    pub const BLACK: Color = Color::gray(0.0);
    /// All of the light.
    pub const WHITE: Color = Color::gray(1.0);

    /// Red, green, blue.
    #[inline]
    pub const fn new(r: f64, g: f64, b: f64) -> Self {
        Color { r, g, b }
    }

    /// Three equal channels.
    #[inline]
    pub const fn gray(v: f64) -> Self {
        Color { r: v, g: v, b: v }
    }

    /// Whether no channel is NaN or infinite.
    #[inline]
    pub fn is_finite(self) -> bool {
        self.r.is_finite() && self.g.is_finite() && self.b.is_finite()
    }

    /// Whether every channel is zero.
    #[inline]
    pub fn is_black(self) -> bool {
        self.r == 0.0 && self.g == 0.0 && self.b == 0.0
    }

    /// The largest channel.
    #[inline]
    pub fn max_channel(self) -> f64 {
        self.r.max(self.g).max(self.b)
    }

    /// The channels as the nearest finite `f32`.
    #[inline]
    pub fn to_f32(self) -> [f32; 3] {
        let finite = |v: f64| (v as f32).clamp(f32::MIN, f32::MAX);
        [finite(self.r), finite(self.g), finite(self.b)]
    }
}

impl From<[f64; 3]> for Color {
    #[inline]
    fn from([r, g, b]: [f64; 3]) -> Self {
        Color { r, g, b }
    }
}

impl From<Color> for [f64; 3] {
    #[inline]
    fn from(c: Color) -> [f64; 3] {
        [c.r, c.g, c.b]
    }
}

impl From<[f32; 3]> for Color {
    #[inline]
    fn from([r, g, b]: [f32; 3]) -> Self {
        Color { r: r.into(), g: g.into(), b: b.into() }
    }
}

impl Add for Color {
    type Output = Color;
    #[inline]
    fn add(self, o: Color) -> Color {
        Color::new(self.r + o.r, self.g + o.g, self.b + o.b)
    }
}

impl AddAssign for Color {
    #[inline]
    fn add_assign(&mut self, o: Color) {
        *self = *self + o;
    }
}

impl Mul for Color {
    type Output = Color;
    #[inline]
    fn mul(self, o: Color) -> Color {
        Color::new(self.r * o.r, self.g * o.g, self.b * o.b)
    }
}

impl MulAssign for Color {
    #[inline]
    fn mul_assign(&mut self, o: Color) {
        *self = *self * o;
    }
}

impl Mul<f64> for Color {
    type Output = Color;
    #[inline]
    fn mul(self, s: f64) -> Color {
        Color::new(self.r * s, self.g * s, self.b * s)
    }
}

impl Mul<Color> for f64 {
    type Output = Color;
    #[inline]
    fn mul(self, c: Color) -> Color {
        c * self
    }
}
