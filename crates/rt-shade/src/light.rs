//! Lamps: points and spotlights.

use crate::{Color, Error};
use rt_core::glam::DVec3;
use rt_core::kernel::{Real, Vector};

/// The brightest legal channel of any colour, and the largest legal share: products of a few of them stay finite.
pub(crate) const MOST_LIGHT: f64 = 1e30;

/// How light fades with the distance `d`: `1 / (constant + linear d + quadratic d^2)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attenuation {
    constant: f64,
    linear: f64,
    quadratic: f64,
}

impl Attenuation {
    /// Light that does not fade: 1, 0, 0.
    pub const NONE: Attenuation = Attenuation { constant: 1.0, linear: 0.0, quadratic: 0.0 };

    /// The three coefficients.
    ///
    /// # Errors
    /// [`Error::Number`] unless each is finite, at least 0, and one of them greater than 0.
    pub fn new(constant: f64, linear: f64, quadratic: f64) -> Result<Self, Error> {
        for value in [constant, linear, quadratic] {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(Error::Number { what: "attenuation", range: "at least 0 and finite", value });
            }
        }
        if constant == 0.0 && linear == 0.0 && quadratic == 0.0 {
            return Err(Error::Number {
                what: "attenuation",
                range: "greater than 0 in one of its numbers",
                value: 0.0,
            });
        }
        Ok(Attenuation { constant, linear, quadratic })
    }

    /// The factor on the light at this distance; at most 1e30, so that no colour overflows next to a lamp.
    #[inline]
    pub fn at(&self, distance: f64) -> f64 {
        self.factor(distance)
    }

    /// [`at`](Attenuation::at), for any lanes.
    #[inline(always)]
    pub(crate) fn factor<R: Real>(&self, distance: R) -> R {
        let of = |x| distance.all(x);
        let divisor =
            of(self.constant) + of(self.linear) * distance + of(self.quadratic) * (distance * distance);
        let factor = of(1.0) / divisor;
        R::if_less(factor, of(MOST_LIGHT), factor, of(MOST_LIGHT))
    }
}

impl Default for Attenuation {
    fn default() -> Self {
        Attenuation::NONE
    }
}

/// A lamp: a point that shines in all directions, or inside a cone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    position: DVec3,
    color: Color,
    attenuation: Attenuation,
    cone: Option<Cone>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Cone {
    axis: DVec3,
    cos_inner: f64,
    cos_outer: f64,
    /// `1 / (cos_inner - cos_outer)`: infinite for a sharp edge, where no cosine lies between.
    scale: f64,
}

impl Light {
    /// A lamp that shines in all directions.
    ///
    /// # Errors
    /// [`Error::NotFinite`] for the position, [`Error::Color`] for a negative or infinite colour.
    pub fn point(
        position: impl Into<DVec3>,
        color: impl Into<Color>,
        attenuation: Attenuation,
    ) -> Result<Self, Error> {
        let (position, color) = (position.into(), color.into());
        if !position.is_finite() {
            return Err(Error::NotFinite { what: "light position", value: position });
        }
        check_color("light color", color)?;
        Ok(Light { position, color, attenuation, cone: None })
    }

    /// A lamp that shines towards `target`: fully inside the half angle `inner`, not at all outside the half angle
    /// `outer` (degrees), between them by the smooth cubic `s^2 (3 - 2 s)` in the cosine of the angle.
    /// `inner == outer` makes a sharp edge.
    ///
    /// # Errors
    /// As [`Light::point`]; [`Error::Coincident`] when `target` is the position; [`Error::Number`] unless
    /// `0 <= inner <= outer`, `0 < outer <= 180`.
    pub fn spot(
        position: impl Into<DVec3>,
        target: impl Into<DVec3>,
        inner: f64,
        outer: f64,
        color: impl Into<Color>,
        attenuation: Attenuation,
    ) -> Result<Self, Error> {
        let mut light = Light::point(position, color, attenuation)?;
        let target = target.into();
        if !target.is_finite() {
            return Err(Error::NotFinite { what: "light target", value: target });
        }
        if !(outer > 0.0 && outer <= 180.0) {
            return Err(Error::Number {
                what: "light outer",
                range: "greater than 0 and at most 180",
                value: outer,
            });
        }
        if !(inner >= 0.0 && inner <= outer) {
            return Err(Error::Number {
                what: "light inner",
                range: "at least 0 and at most outer",
                value: inner,
            });
        }
        let axis = crate::camera::unit(target * 0.5 - light.position * 0.5)
            .or_else(|| crate::camera::unit(target - light.position))
            .ok_or(Error::Coincident { what: "light position and target", value: target })?;
        let cosine = |degrees: f64| libm::cos(degrees.to_radians());
        let (cos_inner, cos_outer) = (cosine(inner), cosine(outer));
        let scale = 1.0 / (cos_inner - cos_outer);
        light.cone = Some(Cone { axis, cos_inner, cos_outer, scale });
        Ok(light)
    }

    /// Where the lamp is.
    #[inline]
    pub fn position(&self) -> DVec3 {
        self.position
    }

    /// Its colour.
    #[inline]
    pub fn color(&self) -> Color {
        self.color
    }

    /// How it fades with the distance.
    #[inline]
    pub fn attenuation(&self) -> Attenuation {
        self.attenuation
    }

    /// The share of the light that goes into this unit direction, away from the lamp: 1 for a point light.
    #[inline]
    pub fn share(&self, direction: DVec3) -> f64 {
        self.share_into(Vector::from(direction))
    }

    /// [`share`](Light::share), for any lanes.
    #[inline(always)]
    pub(crate) fn share_into<R: Real>(&self, direction: Vector<R>) -> R {
        let of = |x| direction.x.all(x);
        let Some(cone) = &self.cone else { return of(1.0) };
        let cosine = Vector::all(direction.x, cone.axis).dot(direction);
        let s = (cosine - of(cone.cos_outer)) * of(cone.scale);
        let between = s * s * (of(3.0) - of(2.0) * s);
        let outer = R::if_less(of(cone.cos_outer), cosine, between, of(0.0));
        R::if_at_most(of(cone.cos_inner), cosine, of(1.0), outer)
    }
}

pub(crate) fn check_color(what: &'static str, color: Color) -> Result<(), Error> {
    let legal = |v: f64| (0.0..=MOST_LIGHT).contains(&v);
    if legal(color.r) && legal(color.g) && legal(color.b) {
        Ok(())
    } else {
        Err(Error::Color { what, value: color.into() })
    }
}
