//! Similarities: scale, then turn, then move.

use crate::Error;
use glam::{DMat3, DVec3};

/// The map `p -> rotation * (scale * p) + translation`, about the world's origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Similarity {
    scale: f64,
    rotation: DMat3,
    translation: DVec3,
}

impl Similarity {
    /// The map that changes nothing.
    pub const IDENTITY: Similarity =
        Similarity { scale: 1.0, rotation: DMat3::IDENTITY, translation: DVec3::ZERO };

    /// Scales by `scale`.
    ///
    /// # Errors
    /// [`Error::NotPositive`] unless the scale is positive and finite.
    pub fn scaled(mut self, scale: f64) -> Result<Self, Error> {
        if !(scale > 0.0 && scale.is_finite()) {
            return Err(Error::NotPositive { what: "scale", value: scale });
        }
        self.scale *= scale;
        self.translation *= scale;
        Ok(self)
    }

    /// Turns by `degrees` about `axis` (any length but zero), counter-clockwise as seen against the axis
    /// (right-handed). Multiples of 90 degrees about a coordinate axis are exact.
    ///
    /// # Errors
    /// [`Error::NotFinite`], [`Error::ZeroLength`] for the axis, [`Error::NotFinite`] for the angle.
    pub fn rotated(mut self, axis: impl Into<DVec3>, degrees: f64) -> Result<Self, Error> {
        let axis = axis.into();
        if !axis.is_finite() {
            return Err(Error::NotFinite { what: "rotation axis", value: axis });
        }
        if axis == DVec3::ZERO {
            return Err(Error::ZeroLength { what: "rotation axis", value: axis });
        }
        if !degrees.is_finite() {
            return Err(Error::NotFinite { what: "rotation angle", value: DVec3::splat(degrees) });
        }
        // Scale by a power of two first, so that no square under- or overflows.
        let power = crate::math::exponent(axis.abs().max_element()).clamp(-1021, 1021);
        let axis = (axis * crate::math::exp2i(-power)).normalize();
        let (sin, cos) = sin_cos_degrees(degrees);
        let turn = rotation_matrix(axis, sin, cos);
        self.rotation = turn * self.rotation;
        self.translation = turn * self.translation;
        Ok(self)
    }

    /// Moves by `offset`.
    ///
    /// # Errors
    /// [`Error::NotFinite`].
    pub fn translated(mut self, offset: impl Into<DVec3>) -> Result<Self, Error> {
        let offset = offset.into();
        if !offset.is_finite() {
            return Err(Error::NotFinite { what: "translation", value: offset });
        }
        self.translation += offset;
        Ok(self)
    }

    /// The factor on lengths.
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// The rotation, columns are the images of the axes.
    pub fn rotation(&self) -> DMat3 {
        self.rotation
    }

    /// What is added last.
    pub fn translation(&self) -> DVec3 {
        self.translation
    }

    /// The image of a point.
    pub fn point(&self, p: DVec3) -> DVec3 {
        let scaled = p * self.scale;
        let turned = if self.rotation == DMat3::IDENTITY { scaled } else { self.rotation * scaled };
        turned + self.translation
    }

    /// The image of a direction: turned only.
    pub fn direction(&self, d: DVec3) -> DVec3 {
        if self.rotation == DMat3::IDENTITY { d } else { self.rotation * d }
    }
}

/// Rodrigues' formula for a unit axis.
fn rotation_matrix(u: DVec3, sin: f64, cos: f64) -> DMat3 {
    let k = 1.0 - cos;
    DMat3::from_cols(
        DVec3::new(cos + u.x * u.x * k, u.x * u.y * k + u.z * sin, u.x * u.z * k - u.y * sin),
        DVec3::new(u.x * u.y * k - u.z * sin, cos + u.y * u.y * k, u.y * u.z * k + u.x * sin),
        DVec3::new(u.x * u.z * k + u.y * sin, u.y * u.z * k - u.x * sin, cos + u.z * u.z * k),
    )
}

/// Sine and cosine of an angle in degrees, exact at multiples of 90.
fn sin_cos_degrees(degrees: f64) -> (f64, f64) {
    let turned = degrees % 360.0;
    let quarters = libm::round(turned / 90.0);
    // Exact: both are within a factor of two of each other, or the quarter is zero (Sterbenz).
    let rest = turned - 90.0 * quarters;
    let (s, c) = libm::sincos(rest.to_radians());
    match (quarters as i32).rem_euclid(4) {
        0 => (s, c),
        1 => (c, -s),
        2 => (-s, -c),
        _ => (-c, s),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quarter_turns_are_exact() {
        let s = Similarity::IDENTITY.rotated(DVec3::Z, 90.0).unwrap();
        assert_eq!(s.point(DVec3::X), DVec3::Y);
        let s = Similarity::IDENTITY.rotated(DVec3::Y, -450.0).unwrap();
        assert_eq!(s.point(DVec3::X), DVec3::Z);
    }

    /// In every quadrant, on either side of zero.
    #[test]
    fn sines_and_cosines_of_degrees() {
        for k in -100..=100 {
            let degrees = f64::from(k) * 7.5;
            let (sin, cos) = sin_cos_degrees(degrees);
            let (s, c) = libm::sincos(degrees.to_radians());
            assert!((sin - s).abs() < 1e-14 && (cos - c).abs() < 1e-14, "{degrees}: {sin} {cos}");
            if k % 12 == 0 {
                assert!(sin * cos == 0.0 && sin + cos != 0.0 && (sin + cos).abs() == 1.0, "{degrees}");
            }
        }
        // As a map: right-handed about any axis, lengths and the axis stay.
        let axis = DVec3::new(0.3, -1.2, 0.7);
        for k in -8..=8 {
            let degrees = f64::from(k) * 50.0;
            let turn = Similarity::IDENTITY.rotated(axis, degrees).unwrap();
            let v = DVec3::new(-0.4, 0.9, 2.0);
            let expected = glam::DQuat::from_axis_angle(axis.normalize(), degrees.to_radians()) * v;
            assert!((turn.point(v) - expected).length() < 1e-14, "{degrees}");
            assert!((turn.point(axis) - axis).length() < 1e-15);
        }
    }

    #[test]
    fn scale_then_rotate_then_translate() {
        let s = Similarity::IDENTITY.scaled(2.0).unwrap().rotated([0.0, 0.0, 3.0], 90.0).unwrap();
        let s = s.translated([1.0, 0.0, 0.0]).unwrap();
        assert_eq!(s.point(DVec3::X), DVec3::new(1.0, 2.0, 0.0));
    }

    #[test]
    fn its_parts_are_those_it_was_made_of() {
        let s = Similarity::IDENTITY.scaled(2.0).unwrap().rotated(DVec3::Z, 90.0).unwrap();
        let s = s.translated([1.0, -3.0, 0.5]).unwrap();
        assert_eq!((s.scale(), s.translation()), (2.0, DVec3::new(1.0, -3.0, 0.5)));
        assert_eq!(s.rotation() * DVec3::X, DVec3::Y);
        assert_eq!(s.direction(DVec3::X), DVec3::Y);
        assert_eq!(Similarity::IDENTITY.translation(), DVec3::ZERO);
    }

    /// The length of the axis does not matter, up to the greatest and down to the least numbers.
    #[test]
    fn axes_of_any_length() {
        let axis = DVec3::new(0.25, -1.5, 0.75);
        let turn = Similarity::IDENTITY.rotated(axis, 33.0).unwrap();
        for power in [-1020, -900, -600, -3, 1, 600, 1000, 1023] {
            let unit = crate::math::exp2i(power / 2) * crate::math::exp2i(power - power / 2);
            let other = Similarity::IDENTITY.rotated(axis * unit, 33.0).unwrap();
            assert_eq!(other.rotation(), turn.rotation(), "{power}");
        }
    }
}
