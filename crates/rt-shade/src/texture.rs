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
    /// The colour at this place of a surface.
    #[inline]
    pub(crate) fn color(&self, at: &Surface, mapping: Mapping, object: u32) -> Color {
        match self {
            Texture::Solid(color) => *color,
            Texture::Checker(checker) => checker.color(at.object_point),
            Texture::Image(image) => image.color(at.uv, mapping),
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
    #[inline]
    pub fn color(&self, p: DVec3) -> Color {
        // The parity of each floor, exact at any size: f - 2 floor(f / 2) is 0 or 1.
        let parity = |x: f64| {
            let f = (x / self.size).floor();
            f - 2.0 * (0.5 * f).floor()
        };
        let odd = (parity(p.x) != 0.0) ^ (parity(p.y) != 0.0) ^ (parity(p.z) != 0.0);
        self.colors[usize::from(odd)]
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

    /// The colour at these texture coordinates, bilinear between the four nearest texel centres.
    ///
    /// Columns are taken modulo the width; rows too where `v` goes on, else the outermost row goes on.
    #[inline]
    pub(crate) fn color(&self, uv: DVec2, mapping: Mapping) -> Color {
        let uv = if mapping == Mapping::Tiles { uv / self.size } else { uv };
        // The whole turns go first: what is left is exact, and its product with the width keeps its digits. Rows run
        // downwards, v upwards.
        let (left, right, x) = neighbours(uv.x - uv.x.floor(), self.width, true);
        let v = if mapping == Mapping::Sheet { uv.y.clamp(0.0, 1.0) } else { uv.y - uv.y.floor() };
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
    let first = x.floor();
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

pub(crate) fn check_size(size: f64) -> Result<(), Error> {
    if size > 0.0 && size.is_finite() {
        Ok(())
    } else {
        Err(Error::Number { what: "texture size", range: "greater than 0 and finite", value: size })
    }
}
