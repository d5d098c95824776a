//! Pictures of linear colours, and their files.

use crate::Error;
#[cfg(feature = "image")]
use crate::srgb;

/// The most columns or rows of a picture that is read as a texture.
pub(crate) const MOST_TEXELS_ACROSS: u32 = 16384;

/// The most texels of such a picture.
#[cfg(feature = "image")]
const MOST_TEXELS: u64 = 1 << 26;

/// A picture: rows of linear `f32` colours from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    width: u32,
    height: u32,
    pixels: Vec<[f32; 3]>,
}

impl Picture {
    /// A black picture. Aborts when there is no memory for it: see [`Picture::try_new`].
    pub fn new(width: u32, height: u32) -> Self {
        Picture { width, height, pixels: vec![[0.0; 3]; width as usize * height as usize] }
    }

    /// A black picture.
    ///
    /// # Errors
    /// [`Error::Memory`] when there is no memory for it.
    pub fn try_new(width: u32, height: u32) -> Result<Self, Error> {
        Ok(Picture::within(Picture::reserve(width, height)?, width, height))
    }

    /// Room for the pixels of a picture, untouched.
    pub(crate) fn reserve(width: u32, height: u32) -> Result<Vec<[f32; 3]>, Error> {
        let mut room = Vec::new();
        let count = (width as usize).checked_mul(height as usize);
        match count.map(|count| room.try_reserve_exact(count)) {
            Some(Ok(())) => Ok(room),
            _ => Err(Error::Memory { bytes: 12 * u128::from(width) * u128::from(height) }),
        }
    }

    /// A black picture in this room.
    pub(crate) fn within(mut room: Vec<[f32; 3]>, width: u32, height: u32) -> Self {
        room.clear();
        room.resize(width as usize * height as usize, [0.0; 3]);
        Picture { width, height, pixels: room }
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

    /// Reads a portable float map (`PF`; a negative scale is little-endian, its size is ignored).
    ///
    /// # Errors
    /// [`Error::Decode`] for any other header, a size of 0 or above 65537 either way, and too few or too many bytes.
    pub fn from_pfm(bytes: &[u8]) -> Result<Self, Error> {
        let bad = |reason: &str| Error::Decode { reason: reason.to_owned() };
        let mut rest = bytes;
        let mut line = || -> Option<&str> {
            let end = rest.iter().take(64).position(|&b| b == b'\n')?;
            let line = std::str::from_utf8(&rest[..end]).ok()?;
            rest = &rest[end + 1..];
            Some(line.trim())
        };
        if line() != Some("PF") {
            return Err(bad("a PFM file begins with a line PF"));
        }
        let size = line().and_then(|line| {
            let (width, height) = line.split_once(' ')?;
            Some((width.parse::<u32>().ok()?, height.trim().parse::<u32>().ok()?))
        });
        let (width, height) = size.ok_or_else(|| bad("the second line of a PFM file is WIDTH HEIGHT"))?;
        let scale: f64 = line()
            .and_then(|line| line.parse().ok())
            .ok_or_else(|| bad("the third line of a PFM file is a number"))?;
        let most = crate::Settings::MOST_SIZE + 1;
        if !(1..=most).contains(&width) || !(1..=most).contains(&height) {
            return Err(Error::Decode {
                reason: format!("its size must be from 1 to {most}, got {width} x {height}"),
            });
        }
        let needed = u64::from(width) * u64::from(height) * 12;
        if rest.len() as u64 != needed {
            let reason = format!("{width} x {height} pixels take {needed} bytes, got {}", rest.len());
            return Err(Error::Decode { reason });
        }
        let mut pixels = Vec::with_capacity(width as usize * height as usize);
        for row in rest.chunks_exact(12 * width as usize).rev() {
            for texel in row.chunks_exact(12) {
                let channel = |i: usize| {
                    let b = [texel[i], texel[i + 1], texel[i + 2], texel[i + 3]];
                    if scale < 0.0 { f32::from_le_bytes(b) } else { f32::from_be_bytes(b) }
                };
                pixels.push([channel(0), channel(4), channel(8)]);
            }
        }
        Ok(Picture { width, height, pixels })
    }

    /// Reads a PNG (feature `image`; decoded from sRGB by the exact curve, transparency dropped) or a PFM (linear).
    ///
    /// # Errors
    /// [`Error::Decode`] for anything else, for broken data, and for PNGs of more than 16384 pixels either way or
    /// 2^26 in all, which are refused before any pixel is read.
    pub fn decode(bytes: &[u8]) -> Result<Self, Error> {
        if bytes.starts_with(b"PF") {
            return Picture::from_pfm(bytes);
        }
        decode_png(bytes)
    }

    /// An 8-bit PNG in sRGB by the exact curve; brighter than white is white.
    ///
    /// # Errors
    /// [`Error::Encode`], for a picture without pixels.
    #[cfg(feature = "image")]
    #[cfg_attr(docsrs, doc(cfg(feature = "image")))]
    pub fn to_png(&self) -> Result<Vec<u8>, Error> {
        use image::ImageEncoder;
        use image::codecs::png::{CompressionType, FilterType, PngEncoder};
        let curve = srgb::Encoder::new();
        let bytes: Vec<u8> = self.pixels.iter().flatten().map(|&v| curve.encode(v)).collect();
        let mut out = Vec::new();
        PngEncoder::new_with_quality(&mut out, CompressionType::Fast, FilterType::Adaptive)
            .write_image(&bytes, self.width, self.height, image::ExtendedColorType::Rgb8)
            .map_err(|e| Error::Encode { reason: e.to_string() })?;
        Ok(out)
    }
}

#[cfg(not(feature = "image"))]
fn decode_png(_bytes: &[u8]) -> Result<Picture, Error> {
    Err(Error::Decode {
        reason: "it is no PFM file, and this build reads nothing else (feature `image`)".to_owned(),
    })
}

#[cfg(feature = "image")]
fn decode_png(bytes: &[u8]) -> Result<Picture, Error> {
    use image::{DynamicImage, ImageDecoder};
    let error = |e: image::ImageError| Error::Decode { reason: e.to_string() };
    let mut limits = image::Limits::default();
    limits.max_image_width = Some(MOST_TEXELS_ACROSS);
    limits.max_image_height = Some(MOST_TEXELS_ACROSS);
    limits.max_alloc = Some(8 * MOST_TEXELS);
    let decoder = image::codecs::png::PngDecoder::with_limits(std::io::Cursor::new(bytes), limits.clone());
    let mut decoder = decoder.map_err(error)?;
    let (width, height) = decoder.dimensions();
    if width > MOST_TEXELS_ACROSS
        || height > MOST_TEXELS_ACROSS
        || u64::from(width) * u64::from(height) > MOST_TEXELS
    {
        let reason = format!(
            "{width} x {height} pixels are more than {MOST_TEXELS_ACROSS} either way or {MOST_TEXELS} in all"
        );
        return Err(Error::Decode { reason });
    }
    decoder.set_limits(limits).map_err(error)?;
    let image = DynamicImage::from_decoder(decoder).map_err(error)?;
    let pixels = match image.color().bytes_per_pixel() / image.color().channel_count() {
        1 => {
            let table: Vec<f32> = (0..=255).map(|v| srgb::decode(f64::from(v) / 255.0) as f32).collect();
            image.into_rgb8().pixels().map(|p| p.0.map(|v| table[usize::from(v)])).collect()
        }
        _ => {
            let table: Vec<f32> = (0..=65535).map(|v| srgb::decode(f64::from(v) / 65535.0) as f32).collect();
            image.into_rgb16().pixels().map(|p| p.0.map(|v| table[usize::from(v)])).collect()
        }
    };
    Ok(Picture { width, height, pixels })
}
