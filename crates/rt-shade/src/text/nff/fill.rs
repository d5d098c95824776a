//! The fill of an NFF file as a material.

use crate::light::check_color;
use crate::{Color, Error, Material, Optics, Paint};

/// The numbers of a fill, in the order of the file.
pub(super) const NUMBERS: [&str; 8] = ["red", "green", "blue", "Kd", "Ks", "Shine", "T", "ior"];

pub(super) fn material(numbers: [f64; 8]) -> Material {
    let [red, green, blue, diffuse, specular, shininess, transmit, ior] = numbers;
    Material {
        paint: Paint::Color(Color::new(red, green, blue)),
        diffuse,
        specular,
        shininess,
        reflect: specular,
        transmit: Color::gray(transmit),
        // The index of what lets no light through means nothing; it is 0 in most files.
        ior: (transmit > 0.0 && ior != 0.0).then_some(ior),
        optics: Optics::Plain,
    }
}

/// Which of a fill's numbers the error is about.
pub(super) fn wrong_number(error: &Error, numbers: [f64; 8]) -> usize {
    match error {
        Error::Color { what: "transmit", .. } | Error::Number { what: "transmit", .. } => 6,
        Error::Color { .. } => {
            numbers[..3].iter().position(|c| check_color("color", Color::gray(*c)).is_err()).unwrap_or(0)
        }
        Error::Number { what: "diffuse", .. } => 3,
        Error::Number { what: "shininess", .. } => 5,
        Error::Number { what: "ior", .. } => 7,
        // What is left is both highlight and mirror.
        _ => 4,
    }
}
