//! Textures: colours as functions of the place on a surface.

use crate::{Color, Error};
use rt_core::Surface;
use rt_core::glam::DVec3;
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
        let _ = (width, height);
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

pub(crate) fn check_size(size: f64) -> Result<(), Error> {
    if size > 0.0 && size.is_finite() {
        Ok(())
    } else {
        Err(Error::Number { what: "texture size", range: "greater than 0 and finite", value: size })
    }
}
