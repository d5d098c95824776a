//! What a surface does with light.

use crate::light::{MOST_LIGHT, check_color};
use crate::{Color, Error};

/// Where the colour of a surface comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Paint {
    /// One colour.
    Color(Color),
    /// The texture with this index in the scene.
    Texture(u32),
}

/// How mirror and transmitted light are weighted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Optics {
    /// `R = reflect + (1 - reflect) F` for the mirror and `(1 - R) transmit` for what goes through, with the exact
    /// unpolarised Fresnel reflectance `F` where `ior` is set, else 0.
    #[default]
    Fresnel,
    /// As in the Neutral File Format: `reflect` for the mirror and `transmit` for what goes through, no Fresnel.
    Plain,
}

/// A material. Colours are linear; a surface may do several of these things at once.
///
/// ```
/// use rt_shade::{Color, Material, Paint};
/// let red = Material { paint: Paint::Color(Color::new(0.8, 0.1, 0.1)), specular: 0.4, ..Material::default() };
/// assert_eq!(red.diffuse, 1.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// The colour that diffuse and ambient light are multiplied by. Default: white.
    pub paint: Paint,
    /// The share of diffuse and ambient light. Default 1.
    pub diffuse: f64,
    /// Phong's highlight: `specular * cos^shininess`, in the colour of the lamp. Default 0.
    pub specular: f64,
    /// The exponent of the highlight. Default 50.
    pub shininess: f64,
    /// The share of the mirror ray. Default 0.
    pub reflect: f64,
    /// The share of what comes through, per channel; also what each crossing leaves of a lamp's light. Default:
    /// black.
    pub transmit: Color,
    /// The index of refraction; `None`: light goes straight through, and there is no Fresnel reflection. Default:
    /// `None`.
    pub ior: Option<f64>,
    /// How mirror and transmission are weighted. Default: Fresnel.
    pub optics: Optics,
}

impl Default for Material {
    fn default() -> Self {
        Material {
            paint: Paint::Color(Color::WHITE),
            diffuse: 1.0,
            specular: 0.0,
            shininess: 50.0,
            reflect: 0.0,
            transmit: Color::BLACK,
            ior: None,
            optics: Optics::Fresnel,
        }
    }
}

impl Material {
    /// Whether it spawns neither mirror nor transmitted rays.
    #[inline]
    pub(crate) fn is_matt(&self) -> bool {
        self.reflect == 0.0
            && self.transmit.is_black()
            && (self.ior.is_none() || self.optics == Optics::Plain)
    }

    /// Whether every number is legal: colours, `diffuse` and `specular` from 0 to 1e30, `shininess` from 0 to 1e9,
    /// `reflect` and the channels of `transmit` from 0 to 1, `ior` from 0.001 to 1000.
    ///
    /// # Errors
    /// [`Error::Number`] or [`Error::Color`].
    pub fn check(&self) -> Result<(), Error> {
        if let Paint::Color(color) = self.paint {
            check_color("color", color)?;
        }
        let number = |what, value: f64, most: f64, range| {
            if (0.0..=most).contains(&value) { Ok(()) } else { Err(Error::Number { what, range, value }) }
        };
        number("diffuse", self.diffuse, MOST_LIGHT, "from 0 to 1e30")?;
        number("specular", self.specular, MOST_LIGHT, "from 0 to 1e30")?;
        number("shininess", self.shininess, 1e9, "from 0 to 1e9")?;
        number("reflect", self.reflect, 1.0, "from 0 to 1")?;
        for value in <[f64; 3]>::from(self.transmit) {
            number("transmit", value, 1.0, "from 0 to 1")?;
        }
        if let Some(value) = self.ior
            && !(0.001..=1000.0).contains(&value)
        {
            return Err(Error::Number { what: "ior", range: "from 0.001 to 1000", value });
        }
        Ok(())
    }
}
