//! Textures: colours as functions of the place on a surface.

use crate::{Color, Error, guard};
use rt_core::Surface;
use rt_core::glam::{DVec2, DVec3};
use std::fmt;
use std::sync::Arc;

/// A texture of your own ([`Texture::Custom`]).
///
/// A panic or a colour with a NaN ends the rendering with an error that names the object.
pub trait Pattern: fmt::Debug + Send + Sync {
    /// The linear colour at this place of a surface.
    fn color(&self, at: &Surface) -> Color;
}

/// A texture.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Texture {
    /// One colour everywhere.
    Solid(Color),
    /// Cubes of two colours in the shape's own frame; squares on a plane and a disk.
    Checker(Checker),
    /// A picture, by texture coordinates.
    Image(ImageTexture),
    /// A texture of your own.
    Custom(Arc<dyn Pattern>),
}

/// How the texture coordinates of a shape lead to a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Mapping {
    /// Lengths along two axes: the picture is laid in tiles. Plane and disk.
    Tiles,
    /// Both are turns. Torus.
    Ring,
    /// `u` is a turn, `v` has two ends.
    Sheet,
}

impl Texture {
    /// The colour at this place of a surface. What is told at once is told without a call, whose answer would be written in
    /// parts that the caller waits for.
    #[inline(always)]
    pub(crate) fn color(&self, at: &Surface, mapping: Mapping, object: u32) -> Color {
        match self {
            Texture::Solid(color) => *color,
            Texture::Checker(checker) => checker.color(at.object_point),
            Texture::Image(image) => image.color(at.uv(), mapping),
            Texture::Custom(pattern) => guard::color(object, &**pattern, at),
        }
    }
}

/// Cubes of two colours: the first where `floor(x / size) + floor(y / size) + floor(z / size)` is even, with
/// `(x, y, z)` the point in the shape's own frame ([`Surface::object_point`]).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Checker {
    colors: [Color; 2],
    size: f64,
}

impl Checker {
    /// Two colours and the length of an edge.
    ///
    /// # Errors
    /// [`Error::Color`]; [`Error::Number`] unless the size is positive and finite.
    pub fn new(colors: [Color; 2], size: f64) -> Result<Self, Error> {
        for color in colors {
            crate::light::check_color("checker color", color)?;
        }
        check_size(size)?;
        Ok(Checker { colors, size })
    }

    /// The colour at this point of the shape's own frame.
    #[inline(always)]
    pub fn color(&self, p: DVec3) -> Color {
        // The parity of each floor, exact at any size: beyond 2^53 every number is even, as is what a cast makes of
        // numbers beyond the range of integers but for the largest one.
        let parity = |x: f64| {
            let x = x / self.size;
            let whole = x as i64;
            if x.abs() < EXACT { (whole - i64::from(whole as f64 > x)) & 1 } else { 0 }
        };
        self.colors[((parity(p.x) ^ parity(p.y) ^ parity(p.z)) & 1) as usize]
    }
}

/// A picture as a texture: bilinear between texel centres; `u` runs to the right, `v` upwards, one picture a turn;
/// on a plane and a disk one picture each `size` lengths.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageTexture {
    width: u32,
    height: u32,
    texels: Arc<[[f32; 3]]>,
    size: f64,
}

impl ImageTexture {
    /// A texture of linear texels in rows from the top.
    ///
    /// # Errors
    /// [`Error::Size`] unless there are `width x height` texels, at least one; [`Error::Number`] unless the size is
    /// positive and finite; [`Error::Color`] for a texel that is negative or not finite.
    pub fn new(width: u32, height: u32, texels: Vec<[f32; 3]>, size: f64) -> Result<Self, Error> {
        check_size(size)?;
        for (what, value) in [("texture width", width), ("texture height", height)] {
            if !(1..=crate::picture::MOST_TEXELS_ACROSS).contains(&value) {
                let most = crate::picture::MOST_TEXELS_ACROSS.into();
                return Err(Error::Size { what, value: value.into(), most });
            }
        }
        let most = u64::from(width) * u64::from(height);
        if texels.len() as u64 != most {
            return Err(Error::Size { what: "the count of texels", value: texels.len() as u64, most });
        }
        for &texel in &texels {
            crate::light::check_color("texel", texel.into())?;
        }
        Ok(ImageTexture { width, height, texels: texels.into(), size })
    }

    /// Decodes a PNG (with the exact sRGB curve; needs the feature `image`) or a PFM (linear as it is).
    ///
    /// # Errors
    /// [`Error::Decode`] for anything that is not such a picture, or is larger than 16384 pixels either way or
    /// 2^26 in all.
    pub fn decode(bytes: &[u8], size: f64) -> Result<Self, Error> {
        let picture = crate::Picture::decode(bytes)?;
        let (width, height) = (picture.width(), picture.height());
        ImageTexture::new(width, height, picture.into_pixels(), size)
    }

    /// The colour at these texture coordinates in turns, `v` from 0 at the bottom to 1 at the top.
    pub fn color_at(&self, uv: DVec2) -> Color {
        self.color(uv, Mapping::Sheet)
    }

    /// The colour at these texture coordinates, bilinear between the four nearest texel centres.
    ///
    /// Columns are taken modulo the width; rows too where `v` goes on, else the outermost row goes on.
    #[inline]
    pub(crate) fn color(&self, uv: DVec2, mapping: Mapping) -> Color {
        let uv = if mapping == Mapping::Tiles { uv / self.size } else { uv };
        // The whole turns go first: what is left is exact, and its product with the width keeps its digits. Rows run
        // downwards, v upwards.
        let (left, right, x) = neighbours(uv.x - floor(uv.x), self.width, true);
        let v = if mapping == Mapping::Sheet { uv.y.clamp(0.0, 1.0) } else { uv.y - floor(uv.y) };
        let (top, bottom, y) = neighbours(1.0 - v, self.height, mapping != Mapping::Sheet);
        let texel = |column: usize, row: usize| {
            let index = row * self.width as usize + column;
            self.texels.get(index).map_or(Color::BLACK, |&t| Color::from(t))
        };
        let mix = |a: Color, b: Color, share: f64| a * (1.0 - share) + b * share;
        let upper = mix(texel(left, top), texel(right, top), x);
        let lower = mix(texel(left, bottom), texel(right, bottom), x);
        mix(upper, lower, y)
    }

    /// Columns.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The length of one picture on a plane or a disk.
    pub fn size(&self) -> f64 {
        self.size
    }
}

/// The two texels of `count` in a row on both sides of `at` (0 to 1), and the share of the second.
#[inline]
fn neighbours(at: f64, count: u32, wraps: bool) -> (usize, usize, f64) {
    let x = at * f64::from(count) - 0.5;
    let first = floor(x);
    let last = i64::from(count) - 1;
    // From -1 to `last`; NaN becomes 0.
    let index = first as i64;
    let (a, b) = (index, index + 1);
    let place = |i: i64| {
        let i = match (wraps, i) {
            (true, i) if i < 0 => i + last + 1,
            (true, i) if i > last => i - last - 1,
            _ => i,
        };
        i.clamp(0, last) as usize
    };
    (place(a), place(b), x - first)
}

/// From here on every number is an even integer.
const EXACT: f64 = 9_007_199_254_740_992.0;

/// The greatest integer that is not above `x`: without a call on machines that have no instruction for it.
#[inline(always)]
fn floor(x: f64) -> f64 {
    if x.abs() < EXACT {
        let whole = x as i64 as f64;
        if whole > x { whole - 1.0 } else { whole }
    } else {
        x
    }
}

pub(crate) fn check_size(size: f64) -> Result<(), Error> {
    if size > 0.0 && size.is_finite() {
        Ok(())
    } else {
        Err(Error::Number { what: "texture size", range: "greater than 0 and finite", value: size })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rt_core::double::{Double, two_sum};

    fn checker(size: f64) -> Checker {
        Checker::new([Color::WHITE, Color::BLACK], size).unwrap()
    }

    #[test]
    fn floors_are_exact() {
        for x in
            [0.0, 0.5, 1.0, -0.25, -1.0, -1.5, 1e15 + 0.5, -1e15 - 0.5, 4e15, 1e300, -1e300, f64::INFINITY]
        {
            assert_eq!(floor(x), x.floor());
            assert_eq!(floor(x.next_down()), x.next_down().floor());
            assert_eq!(floor(x.next_up()), x.next_up().floor());
        }
        assert!(floor(f64::NAN).is_nan());
    }

    #[test]
    fn squares_alternate() {
        let c = checker(0.5);
        let white = |x, y, z| c.color(DVec3::new(x, y, z)) == Color::WHITE;
        assert!(white(0.1, 0.1, 0.0) && !white(0.6, 0.1, 0.0) && white(0.6, 0.6, 0.0));
        assert!(!white(-0.1, 0.1, 0.0) && white(-0.1, -0.1, 0.0) && !white(-0.1, -0.1, -0.1));
        // The edge belongs to the square above it.
        assert!(!white(0.5, 0.0, 0.0) && white(1.0, 0.0, 0.0));
        // Beyond 2^53 squares every number is even; nothing overflows.
        assert!(white(1e300, -1e300, 1e307));
    }

    #[test]
    fn checker_is_that_of_exact_arithmetic() {
        // The square that x lies in, from its exact distance to the two edges next to it.
        let exact = |x: f64, size: f64| {
            let near = (x / size).round();
            // near * size exactly: near has at most 21 bits, so both halves of a split size are exact products.
            let high = f64::from(size as f32);
            let (edge, low) = two_sum(near * high, near * (size - high));
            let rest = Double::difference(x, edge) - low;
            let to_edge = rest.to_f64();
            let floor = if to_edge < 0.0 { near - 1.0 } else { near };
            (floor, to_edge.abs() <= 4.0 * (x.abs() * f64::EPSILON))
        };
        let mut state = 1u64;
        let mut random = move || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        let mut compared = 0;
        for i in 0..10_000 {
            let size = 0.1 + random();
            let near_an_edge = i % 2 == 0;
            let mut coordinate = || {
                let squares = (random() - 0.5) * 2e6;
                let x = if near_an_edge { squares.round() * size } else { squares * size };
                f64::from_bits(x.to_bits().wrapping_add((random() * 20.0) as u64).wrapping_sub(10))
            };
            let p = DVec3::new(coordinate(), coordinate(), coordinate());
            let axes = [exact(p.x, size), exact(p.y, size), exact(p.z, size)];
            if axes.iter().any(|&(_, at_edge)| at_edge) {
                continue;
            }
            compared += 1;
            let odd = axes.iter().fold(0.0, |sum, (floor, _)| sum + floor).rem_euclid(2.0) != 0.0;
            let expected = if odd { Color::BLACK } else { Color::WHITE };
            assert_eq!(checker(size).color(p), expected, "{p} {size}");
        }
        assert!(compared > 5000, "{compared}");
    }

    #[test]
    fn bilinear_at_centres_between_them_and_across_the_seam() {
        let texels = vec![[0.0; 3], [1.0; 3], [2.0; 3], [3.0; 3], [4.0; 3], [5.0; 3], [6.0; 3], [7.0; 3]];
        let image = ImageTexture::new(4, 2, texels, 1.0).unwrap();
        let at = |u, v, mapping| image.color(DVec2::new(u, v), mapping).r;
        // The upper row is 0 1 2 3, at v = 3/4.
        for (column, u) in [0.125, 0.375, 0.625, 0.875].into_iter().enumerate() {
            assert_eq!(at(u, 0.75, Mapping::Sheet), column as f64);
            assert_eq!(at(u, 0.25, Mapping::Sheet), 4.0 + column as f64);
            assert_eq!(at(u + 5.0, 0.25 - 3.0, Mapping::Ring), 4.0 + column as f64);
        }
        assert_eq!(at(0.25, 0.75, Mapping::Sheet), 0.5);
        assert_eq!(at(0.0, 0.75, Mapping::Sheet), 1.5);
        assert_eq!(at(1.0, 0.75, Mapping::Sheet), 1.5);
        assert_eq!(at(0.125, 0.5, Mapping::Sheet), 2.0);
        // The outermost rows go on, or meet.
        assert_eq!(at(0.125, 1.0, Mapping::Sheet), 0.0);
        assert_eq!(at(0.125, 1.0, Mapping::Ring), 2.0);
        assert_eq!(at(0.125, 0.0, Mapping::Sheet), 4.0);
    }

    #[test]
    fn any_coordinates_give_a_colour() {
        let image = ImageTexture::new(3, 1, vec![[1.0; 3]; 3], 1e-300).unwrap();
        for u in [f64::NAN, f64::INFINITY, -f64::INFINITY, 1e300, -1e-320, f64::MAX] {
            for mapping in [Mapping::Tiles, Mapping::Ring, Mapping::Sheet] {
                let _ = image.color(DVec2::new(u, u), mapping);
                let _ = image.color(DVec2::new(0.3, u), mapping);
            }
        }
        let _ = checker(1e-300).color(DVec3::new(f64::NAN, f64::INFINITY, 1e300));
    }

    #[test]
    fn what_is_no_texture_is_refused() {
        assert!(matches!(ImageTexture::new(2, 2, vec![[0.0; 3]; 3], 1.0), Err(Error::Size { .. })));
        assert!(matches!(ImageTexture::new(0, 2, vec![], 1.0), Err(Error::Size { .. })));
        assert!(matches!(ImageTexture::new(1, 1, vec![[f32::NAN; 3]], 1.0), Err(Error::Color { .. })));
        assert!(matches!(ImageTexture::new(1, 1, vec![[0.0; 3]], 0.0), Err(Error::Number { .. })));
        assert!(Checker::new([Color::WHITE, Color::gray(-1.0)], 1.0).is_err());
        assert!(Checker::new([Color::WHITE; 2], f64::NAN).is_err());
        assert!(matches!(ImageTexture::decode(b"nothing", 1.0), Err(Error::Decode { .. })));
    }
}
