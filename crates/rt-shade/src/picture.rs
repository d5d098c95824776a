//! Pictures of linear colours, and their files.

use crate::Error;

/// A picture: rows of linear `f32` colours from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    width: u32,
    height: u32,
    pixels: Vec<[f32; 3]>,
}

impl Picture {
    /// A black picture.
    pub fn new(width: u32, height: u32) -> Self {
        Picture { width, height, pixels: vec![[0.0; 3]; width as usize * height as usize] }
    }

    /// Columns.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The pixels, row by row from the top.
    pub fn pixels(&self) -> &[[f32; 3]] {
        &self.pixels
    }

    /// The pixels, to write to.
    pub fn pixels_mut(&mut self) -> &mut [[f32; 3]] {
        &mut self.pixels
    }

    /// The pixels themselves.
    pub fn into_pixels(self) -> Vec<[f32; 3]> {
        self.pixels
    }

    /// A portable float map: `PF`, size, `-1.0`, then little-endian `f32` in rows from the bottom. Linear, exact.
    pub fn to_pfm(&self) -> Vec<u8> {
        let mut out = format!("PF\n{} {}\n-1.0\n", self.width, self.height).into_bytes();
        out.reserve(12 * self.pixels.len());
        for row in self.pixels.chunks_exact(self.width.max(1) as usize).rev() {
            for channel in row.iter().flatten() {
                out.extend_from_slice(&channel.to_le_bytes());
            }
        }
        out
    }

    /// Reads a portable float map (`PF`, either byte order).
    ///
    /// # Errors
    /// [`Error::Decode`].
    pub fn from_pfm(_bytes: &[u8]) -> Result<Self, Error> {
        Err(Error::Decode { reason: "not yet".into() })
    }

    /// Reads a PNG (feature `image`) or a PFM.
    ///
    /// # Errors
    /// [`Error::Decode`].
    pub fn decode(bytes: &[u8]) -> Result<Self, Error> {
        Picture::from_pfm(bytes)
    }

    /// An 8-bit PNG in sRGB by the exact curve; brighter than white is white.
    ///
    /// # Errors
    /// [`Error::Encode`], for a picture without pixels.
    #[cfg(feature = "image")]
    #[cfg_attr(docsrs, doc(cfg(feature = "image")))]
    pub fn to_png(&self) -> Result<Vec<u8>, Error> {
        Err(Error::Encode { reason: "not yet".into() })
    }
}
