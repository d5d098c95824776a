//! Reads the entities of an NFF file and makes the scene.

use super::super::diagnostic::{Report, in_words};
use super::super::suggest;
use super::super::{Diagnostics, Loaded};
use super::fill;
use super::polygon::{MOST_VERTICES, triangulate};
use super::token::{Token, Tokens};
use crate::light::check_color;
use crate::{Attenuation, Camera, Color, Light, Object, Scene, SceneBuilder, Settings};
use rt_core::Shape;
use rt_core::glam::DVec3;
use rt_core::shape::{Cone, Cylinder, Sphere, Triangle};
use std::collections::HashMap;
use std::fmt::Display;
use std::ops::Range;

/// The depth of rays that the format's ray counts are made with.
const DEPTH: u32 = 5;

const ENTITIES: [&str; 8] = ["v", "b", "l", "f", "s", "c", "p", "pp"];

/// Reads a scene in the Neutral File Format; `name` is what messages call the file.
///
/// # Errors
/// Everything that is wrong with the file.
///
/// ```
/// use rt_shade::text::load_nff;
///
/// let text = "v from 0 0 5 at 0 0 0 up 0 1 0 angle 40 hither 1 resolution 64 64
///             l 3 4 5   f 1 .2 .2 .8 .2 20 0 0   s 0 0 0 1";
/// let loaded = load_nff("ball.nff", text)?;
/// assert_eq!(loaded.scene.objects().len(), 1);
/// assert!(load_nff("ball.nff", &text.replace("0 0 0 1", "0 0 0")).is_err());
/// # Ok::<(), rt_shade::text::Diagnostics>(())
/// ```
pub fn load_nff(name: &str, text: &str) -> Result<Loaded, Diagnostics> {
    let mut reader = Reader {
        tokens: Tokens::new(text),
        report: Report::new(name, text),
        scene: Scene::builder(),
        settings: Settings { max_depth: DEPTH, ..Settings::default() },
        view: None,
        lights: Vec::new(),
        fill: None,
        fills: HashMap::new(),
    };
    while let Some(token) = reader.tokens.next() {
        reader.entity(token);
    }
    reader.finish()
}

struct Reader<'a> {
    tokens: Tokens<'a>,
    report: Report<'a>,
    scene: SceneBuilder,
    settings: Settings,
    /// Where the view is, once it has been seen.
    view: Option<Range<usize>>,
    lights: Vec<(DVec3, Color, Range<usize>)>,
    /// The material of what follows.
    fill: Option<u32>,
    /// The materials by the bits of their numbers.
    fills: HashMap<[u64; 8], u32>,
}

/// A value that is missing or wrong, and has been reported.
struct Reported;

impl<'a> Reader<'a> {
    /// One entity; after an error the tokens up to the next entity are passed over.
    fn entity(&mut self, token: Token<'a>) {
        let read = match token.text {
            "v" => self.view(token),
            "b" => self.background(),
            "l" => self.light(token),
            "f" => self.fill(),
            "s" => self.sphere(token),
            "c" => self.cone(token),
            "p" => self.polygon(token, false),
            "pp" => self.polygon(token, true),
            word => {
                let message = if token.is_numeric() {
                    format!(
                        "the number {word} belongs to nothing: the entity before it has all of its numbers"
                    )
                } else {
                    let advice = suggest::advice(word, ENTITIES, "");
                    format!("unknown entity `{word}`: {advice}")
                };
                self.report.error(token.span(), message);
                Err(Reported)
            }
        };
        if read.is_err() {
            while self.tokens.peek().is_some_and(|next| !ENTITIES.contains(&next.text)) {
                self.tokens.next();
            }
        }
    }

    /// A finite number; `what` says in messages which.
    fn number(&mut self, what: &dyn Display) -> Result<f64, Reported> {
        let Some(token) = self.tokens.peek() else {
            let place = self.tokens.place();
            self.report.error(place, format!("the file ends where {what} should stand"));
            return Err(Reported);
        };
        let message = match token.text.parse::<f64>() {
            Ok(number) if number.is_finite() => {
                self.tokens.next();
                return Ok(number);
            }
            Ok(number) if token.text.bytes().any(|b| b.is_ascii_digit()) && !number.is_nan() => {
                format!("{what} is out of range: {} exceeds 1.8e308, the largest number", short(token.text))
            }
            Ok(_) => format!("{what} must be finite, got {}", token.text),
            Err(_) => format!("{what} must be a number, got `{}`", short(token.text)),
        };
        self.report.error(token.span(), message);
        Err(Reported)
    }

    fn vector(&mut self, what: &dyn Display) -> Result<DVec3, Reported> {
        Ok(DVec3::new(self.number(what)?, self.number(what)?, self.number(what)?))
    }

    fn color(&mut self, what: &'static str) -> Result<Color, Reported> {
        let mut channels = [0.0; 3];
        for channel in &mut channels {
            let place = self.tokens.place();
            *channel = self.number(&what)?;
            if check_color(what, Color::gray(*channel)).is_err() {
                let message = format!("{what} must have channels from 0 to 1e30, got {}", in_words(channel));
                self.report.error(place, message);
                return Err(Reported);
            }
        }
        Ok(channels.into())
    }

    /// A whole number within the range.
    fn whole(&mut self, what: &dyn Display, least: u32, most: u32) -> Result<u32, Reported> {
        let place = self.tokens.place();
        let text = self.tokens.peek().map_or("", |token| token.text);
        match text.parse::<u32>() {
            Ok(value) if (least..=most).contains(&value) => {
                self.tokens.next();
                Ok(value)
            }
            _ if text.is_empty() => {
                self.report.error(place, format!("the file ends where {what} should stand"));
                Err(Reported)
            }
            _ => {
                let message =
                    format!("{what} must be a whole number from {least} to {most}, got {}", short(text));
                self.report.error(place, message);
                Err(Reported)
            }
        }
    }

    /// The value, or the error at this place.
    fn checked<T, E: Display>(&mut self, result: Result<T, E>, place: Range<usize>) -> Result<T, Reported> {
        result.map_err(|error| {
            self.report.error(place, in_words(&error));
            Reported
        })
    }

    fn view(&mut self, token: Token) -> Result<(), Reported> {
        if self.view.is_some() {
            self.report.error(token.span(), "a second view: a scene has one, remove the other");
        }
        self.view = Some(token.span());
        let (mut from, mut at, mut up, mut angle, mut size) = (None, None, None, None, None);
        while let Some(word) = self.tokens.peek() {
            let place = word.span();
            let keyword = ["from", "at", "up", "angle", "hither", "resolution"].contains(&word.text);
            if !keyword {
                // The next entity, or a word that is reported as an unknown one.
                break;
            }
            self.tokens.next();
            match word.text {
                "from" => from = Some(self.vector(&"`from`")?),
                "at" => at = Some((self.vector(&"`at`")?, place)),
                "up" => up = Some((self.vector(&"`up`")?, place)),
                "angle" => angle = Some((self.number(&"`angle`")?, place)),
                "hither" => {
                    self.number(&"`hither`")?;
                }
                _ => {
                    let most = Settings::MOST_SIZE;
                    let width = self.whole(&"the width of the resolution", 1, most)?;
                    size = Some((width, self.whole(&"the height of the resolution", 1, most)?));
                }
            }
        }
        let given = [
            ("from", from.is_some()),
            ("at", at.is_some()),
            ("up", up.is_some()),
            ("angle", angle.is_some()),
            ("resolution", size.is_some()),
        ];
        let missing: Vec<&str> = given.iter().filter(|(_, there)| !there).map(|(word, _)| *word).collect();
        let (Some(from), Some((at, at_place)), Some((up, up_place)), Some((angle, angle_place)), Some(size)) =
            (from, at, up, angle, size)
        else {
            let place = self.tokens.place();
            self.report.error(place, format!("the view lacks `{}` before this", missing.join("`, `")));
            return Err(Reported);
        };
        (self.settings.width, self.settings.height) = size;
        let camera = Camera::new(from, at, up, angle);
        let place = match &camera {
            Err(crate::Error::Coincident { .. }) => at_place,
            Err(crate::Error::Number { .. }) => angle_place,
            _ => up_place,
        };
        let camera = self.checked(camera, place)?;
        self.scene = std::mem::take(&mut self.scene).camera(camera);
        Ok(())
    }

    fn background(&mut self) -> Result<(), Reported> {
        let color = self.color("background")?;
        self.scene = std::mem::take(&mut self.scene).background(color);
        Ok(())
    }

    fn light(&mut self, token: Token) -> Result<(), Reported> {
        let position = self.vector(&"the position of a light")?;
        let mut color = Color::WHITE;
        if self.tokens.peek().is_some_and(|next| next.is_numeric()) {
            color = self.color("light color")?;
        }
        self.lights.push((position, color, token.span()));
        Ok(())
    }

    fn fill(&mut self) -> Result<(), Reported> {
        // Objects after a wrong fill are not reported as having none.
        self.fill = Some(self.fill.unwrap_or(0));
        let mut numbers = [0.0; 8];
        let mut bits = [0; 8];
        let mut places: [Range<usize>; 8] = Default::default();
        for (index, what) in fill::NUMBERS.into_iter().enumerate() {
            places[index] = self.tokens.place();
            numbers[index] = self.number(&what)?;
            bits[index] = numbers[index].to_bits();
        }
        if let Some(known) = self.fills.get(&bits) {
            self.fill = Some(*known);
            return Ok(());
        }
        let material = fill::material(numbers);
        let checked = material.check();
        let place = checked.as_ref().err().map_or(0, |error| fill::wrong_number(error, numbers));
        self.checked(checked, places[place].clone())?;
        let index = self.scene.add_material(material);
        self.fills.insert(bits, index);
        self.fill = Some(index);
        Ok(())
    }

    fn add(&mut self, token: Token, shape: Result<Shape, rt_core::Error>) -> Result<(), Reported> {
        let Some(material) = self.fill else {
            let message = format!("`{}` has no fill: put an `f` entity before it", token.text);
            self.report.error(token.span(), message);
            // One such error is enough.
            self.fill = Some(0);
            return Err(Reported);
        };
        let shape = self.checked(shape, token.span())?;
        self.scene.add_object(Object { name: String::new(), material, no_shadow: false }, shape);
        Ok(())
    }

    fn sphere(&mut self, token: Token) -> Result<(), Reported> {
        let center = self.vector(&"the center of a sphere")?;
        let radius = self.number(&"the radius of a sphere")?.abs();
        self.add(token, Sphere::new(center, radius).map(Shape::from))
    }

    fn cone(&mut self, token: Token) -> Result<(), Reported> {
        let base = self.vector(&"the base of a cone")?;
        let base_radius = self.number(&"the base radius of a cone")?;
        let apex = self.vector(&"the apex of a cone")?;
        let apex_radius = self.number(&"the apex radius of a cone")?;
        if base_radius * apex_radius < 0.0 {
            let message =
                format!("the radii {base_radius} and {apex_radius} of a cone must have the same sign");
            self.report.error(token.span(), message);
            return Ok(());
        }
        let (base_radius, apex_radius) = (base_radius.abs(), apex_radius.abs());
        let shape = if base_radius == apex_radius {
            Cylinder::open(base, apex, base_radius).map(Shape::from)
        } else {
            Cone::open(base, base_radius, apex, apex_radius).map(Shape::from)
        };
        self.add(token, shape)
    }

    fn polygon(&mut self, token: Token, smooth: bool) -> Result<(), Reported> {
        let count = self.whole(&"the number of vertices", 3, MOST_VERTICES as u32)? as usize;
        let mut vertices = Vec::with_capacity(count);
        let mut normals = Vec::with_capacity(if smooth { count } else { 0 });
        for index in 0..count {
            let number = index + 1;
            vertices.push(self.vector(&format_args!("vertex {number} of {count}"))?);
            if smooth {
                normals.push(self.vector(&format_args!("the normal of vertex {number} of {count}"))?);
            }
        }
        if vertices.iter().any(|v| v.abs().max_element() > f64::MAX / 4.0) {
            self.report.error(token.span(), "a vertex is out of the supported range");
            return Ok(());
        }
        let Ok(triangles) = triangulate(&vertices) else {
            // A patch drawn together to a line: nothing to be seen. Generators write them at the poles of a surface.
            return self.add_nothing(token);
        };
        for [a, b, c] in triangles {
            let corners = [vertices[a], vertices[b], vertices[c]];
            let shape = match (normals.get(a), normals.get(b), normals.get(c)) {
                (Some(na), Some(nb), Some(nc)) => smooth_triangle(corners, [*na, *nb, *nc]),
                _ => Triangle::new(corners[0], corners[1], corners[2]),
            };
            match shape {
                // As above, in one corner of the polygon.
                Err(rt_core::Error::Degenerate { .. }) => {}
                shape => self.add(token, shape.map(Shape::from))?,
            }
        }
        Ok(())
    }

    /// A polygon without an area: checked as any other object, but not drawn.
    fn add_nothing(&mut self, token: Token) -> Result<(), Reported> {
        if self.fill.is_none() {
            return self.add(token, Err(rt_core::Error::Degenerate { vertices: [DVec3::ZERO; 3] }));
        }
        Ok(())
    }

    fn finish(mut self) -> Result<Loaded, Diagnostics> {
        if self.view.is_none() {
            let place = self.tokens.place();
            self.report.error(place, "the file ends without a view: a scene needs a `v` entity");
        }
        // The usual choice for this format: 1/2 for one lamp, 1/4 each for four.
        let count = self.lights.len().max(1) as f64;
        let share = count.sqrt() / (2.0 * count);
        self.scene = std::mem::take(&mut self.scene).ambient(Color::gray(share));
        for (position, color, place) in std::mem::take(&mut self.lights) {
            let light = Light::point(position, color * share, Attenuation::NONE);
            if let Ok(light) = self.checked(light, place) {
                self.scene.add_light(light);
            }
        }
        if !self.report.is_clean() {
            return self.report.finish_failed();
        }
        match self.settings.check().and_then(|()| self.scene.build()) {
            Ok(scene) => self.report.finish(Loaded { scene, settings: self.settings }),
            Err(error) => {
                self.report.error(0..0, error.to_string());
                self.report.finish_failed()
            }
        }
    }
}

/// The start of a word from the file, for messages.
fn short(text: &str) -> String {
    text.chars().take(40).collect()
}

/// A triangle with vertex normals, which may point against the order of rotation (whole files do): they are turned to
/// the side that the vertices' order says is outside. A normal of length zero makes the triangle flat.
fn smooth_triangle(corners: [DVec3; 3], normals: [DVec3; 3]) -> Result<Triangle, rt_core::Error> {
    let flat = Triangle::new(corners[0], corners[1], corners[2])?;
    let [na, nb, nc] = normals;
    let outward: f64 = normals.iter().map(|n| flat.normal().dot(n.normalize_or_zero())).sum();
    let side = if outward < 0.0 { -1.0 } else { 1.0 };
    match flat.clone().with_normals(na * side, nb * side, nc * side) {
        Err(rt_core::Error::ZeroLength { .. }) => Ok(flat),
        smooth => smooth,
    }
}
