//! The pinhole camera.

use crate::Error;
use rt_core::Ray;
use rt_core::glam::DVec3;

/// A pinhole camera: eye, axes and angle. Pixels are square, `right = forward x up`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    eye: DVec3,
    forward: DVec3,
    right: DVec3,
    up: DVec3,
    /// Tangent of half the vertical angle.
    tangent: f64,
}

impl Camera {
    /// A camera at `eye` whose picture has `look_at` in its middle, `up` pointing upwards (any length, not
    /// perpendicular to the view), and whose full vertical angle is `fov` degrees.
    ///
    /// # Errors
    /// [`Error::NotFinite`] for NaN and infinity, [`Error::Coincident`] when `look_at` equals `eye`, [`Error::Up`]
    /// when `up` is zero or parallel to the view, [`Error::Number`] unless `0 < fov < 180`.
    pub fn new(
        eye: impl Into<DVec3>,
        look_at: impl Into<DVec3>,
        up: impl Into<DVec3>,
        fov: f64,
    ) -> Result<Self, Error> {
        let (eye, look_at, up) = (eye.into(), look_at.into(), up.into());
        for (what, value) in [("camera eye", eye), ("camera look_at", look_at), ("camera up", up)] {
            if !value.is_finite() {
                return Err(Error::NotFinite { what, value });
            }
        }
        if !(fov > 0.0 && fov < 180.0) {
            return Err(Error::Number {
                what: "camera fov",
                range: "greater than 0 and less than 180",
                value: fov,
            });
        }
        if eye == look_at {
            return Err(Error::Coincident { what: "camera eye and look_at", value: eye });
        }
        // Halves first: the difference of two finite points then cannot overflow.
        let forward =
            unit(look_at * 0.5 - eye * 0.5).or_else(|| unit(look_at - eye)).ok_or(Error::Up { up })?;
        let right = unit(up).and_then(|up| unit(forward.cross(up))).ok_or(Error::Up { up })?;
        let tangent = libm::tan((0.5 * fov).to_radians());
        Ok(Camera { eye, forward, right, up: right.cross(forward), tangent })
    }

    /// Where all rays start.
    pub fn eye(&self) -> DVec3 {
        self.eye
    }

    /// The unit vector into the picture.
    pub fn forward(&self) -> DVec3 {
        self.forward
    }

    /// The unit vector to the right of the picture.
    pub fn right(&self) -> DVec3 {
        self.right
    }

    /// The unit vector to the top of the picture.
    pub fn up(&self) -> DVec3 {
        self.up
    }

    /// The ray through the place `(x, y)` of a raster of `width x height` pixels: `(0, 0)` is the top left corner of
    /// the top left pixel, `(0.5, 0.5)` its centre.
    ///
    /// The direction is not of unit length: its part along the view is 1.
    #[inline]
    pub fn ray(&self, x: f64, y: f64, width: u32, height: u32) -> Ray {
        let step = self.tangent / f64::from(height);
        let right = (2.0 * x - f64::from(width)) * step;
        let up = (f64::from(height) - 2.0 * y) * step;
        Ray::new(self.eye, self.forward + self.right * right + self.up * up)
    }
}

/// The unit vector along `v`; `None` for zero. An exact power of two first keeps squares in range.
pub(crate) fn unit(v: DVec3) -> Option<DVec3> {
    let largest = v.abs().max_element();
    if !(largest > 0.0 && largest.is_finite()) {
        return None;
    }
    // 2^-e twice by halves, so that neither factor leaves the range of normal numbers.
    let exponent = libm::frexp(largest).1;
    let v = DVec3::new(libm::ldexp(v.x, -exponent), libm::ldexp(v.y, -exponent), libm::ldexp(v.z, -exponent));
    Some(v / v.length())
}
