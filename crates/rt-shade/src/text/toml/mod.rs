//! Scenes in TOML: the document and its tables that are there once. See [`crate::text`] for the format.

mod light;
mod material;
mod object;

use super::diagnostic::{Report, in_words};
use super::reader::{Node, Table};
use super::{Diagnostics, Loaded, PictureLoader};
use crate::light::check_color;
use crate::{Antialias, Camera, Color, Error, Scene, SceneBuilder, Settings};
use ::toml::de::DeTable;
use rt_core::glam::DVec3;
use std::ops::Range;

/// The one version of the format.
const VERSION: u32 = 1;

/// The tables of a document. Only the camera must be there.
const REQUIRED: [&str; 1] = ["camera"];
const OPTIONAL: [&str; 7] = ["version", "image", "render", "light", "material", "texture", "object"];

/// Reads a scene in TOML; `name` is what messages call the file.
///
/// # Errors
/// The syntax errors, or else everything that is wrong with the scene.
///
/// ```
/// use rt_shade::text::{NoPictures, load_toml};
///
/// let text = "
/// [camera]
/// eye = [0, 0, 5]
/// look_at = [0, 0, 0]
///
/// [material.red]
/// color = [0.8, 0.1, 0.1]
///
/// [[object]]
/// material = 'red'
/// shape.sphere = { center = [0, 0, 0], radius = 1 }
/// ";
/// let loaded = load_toml("ball.toml", text, &NoPictures)?;
/// assert_eq!(loaded.scene.objects().len(), 1);
///
/// let wrong = load_toml("ball.toml", &text.replace("radius", "raduis"), &NoPictures).unwrap_err();
/// let message = "ball.toml:11:38: error: unknown key `raduis` in sphere: did you mean `radius`?";
/// assert!(wrong.to_string().starts_with(message));
/// # Ok::<(), rt_shade::text::Diagnostics>(())
/// ```
pub fn load_toml(name: &str, text: &str, pictures: &dyn PictureLoader) -> Result<Loaded, Diagnostics> {
    let mut report = Report::new(name, text);
    let document = match DeTable::parse(text) {
        Ok(document) => document.into_inner(),
        Err(error) => {
            syntax_errors(text, error, &mut report);
            return report.finish_failed();
        }
    };
    let mut scene = Scene::builder();
    let mut settings = Settings::default();
    let root = Table::document(&document, &REQUIRED, &OPTIONAL, &mut report);
    if let Some(node) = root.get("version") {
        node.whole(VERSION..=VERSION, &mut report);
    }
    if let Some(node) = root.get("image") {
        image(node, &mut scene, &mut settings, &mut report);
    }
    if let Some(node) = root.get("render") {
        render(node, &mut scene, &mut settings, &mut report);
    }
    if let Some(camera) = root.get("camera").and_then(|node| camera(node, &mut report)) {
        scene = scene.camera(camera);
    }
    for node in root.get("light").and_then(|node| node.list(&mut report)).into_iter().flatten() {
        if let Some(light) = light::light(node, &mut report) {
            scene.add_light(light);
        }
    }
    let textures = material::textures(root.get("texture"), pictures, &mut scene, &mut report);
    let materials = material::materials(root.get("material"), &textures, &mut scene, &mut report);
    for node in root.get("object").and_then(|node| node.list(&mut report)).into_iter().flatten() {
        object::object(node, &materials, &mut scene, &mut report);
    }
    if !report.is_clean() {
        return report.finish_failed();
    }
    // The document is several times as large as the scene.
    drop(document);
    let settled = settings.check().and_then(|()| scene.build());
    match settled {
        Ok(scene) => report.finish(Loaded { scene, settings }),
        Err(error) => {
            report.error(0..0, error.to_string());
            report.finish_failed()
        }
    }
}

fn image(node: Node, scene: &mut SceneBuilder, settings: &mut Settings, report: &mut Report) {
    let Some(table) = node.table("image", &[], &["width", "height", "background"], report) else { return };
    for (key, size) in [("width", &mut settings.width), ("height", &mut settings.height)] {
        if let Some(value) = table.get(key).and_then(|n| n.whole(1..=Settings::MOST_SIZE, report)) {
            *size = value;
        }
    }
    if let Some(color) = table.get("background").and_then(|n| color(n, report)) {
        *scene = std::mem::take(scene).background(color);
    }
}

fn render(node: Node, scene: &mut SceneBuilder, settings: &mut Settings, report: &mut Report) {
    let Some(table) = node.table("render", &[], &["max_depth", "ambient", "antialias"], report) else {
        return;
    };
    if let Some(depth) = table.get("max_depth").and_then(|n| n.whole(1..=Settings::MOST_DEPTH, report)) {
        settings.max_depth = depth;
    }
    if let Some(color) = table.get("ambient").and_then(|n| color(n, report)) {
        *scene = std::mem::take(scene).ambient(color);
    }
    if let Some(node) = table.get("antialias")
        && let Some(words) = node.text(report)
    {
        match words.parse::<Antialias>() {
            Ok(antialias) => settings.antialias = antialias,
            Err(error) => report.error(node.place(), error.to_string()),
        }
    }
}

fn camera(node: Node, report: &mut Report) -> Option<Camera> {
    let table = node.table("camera", &["eye", "look_at"], &["up", "fov"], report)?;
    let eye = table.get("eye").and_then(|n| n.vector(report));
    let look_at = table.get("look_at").and_then(|n| n.vector(report));
    let up = table.get("up").map_or(Some(DVec3::Y), |n| n.vector(report));
    let fov = table.get("fov").map_or(Some(super::DEFAULT_FOV), |n| n.number(report));
    let camera = Camera::new(eye?, look_at?, up?, fov?);
    blame(camera, &table, report)
}

/// Three legal channels, each checked by itself so that the wrong one is marked.
fn color(node: Node, report: &mut Report) -> Option<Color> {
    let channels = node.vector(report)?.to_array();
    for (index, channel) in channels.into_iter().enumerate() {
        if check_color("color", Color::gray(channel)).is_err() {
            let (name, channel) = (node.name(), in_words(&channel));
            let message = format!("`{name}` must have channels from 0 to 1e30, got {channel}");
            report.error(node.element(index), message);
            return None;
        }
    }
    Some(channels.into())
}

/// The value, or the error at the field of the table that it is about.
fn blame<T>(result: Result<T, Error>, table: &Table, report: &mut Report) -> Option<T> {
    let error = match result {
        Ok(value) => return Some(value),
        Err(error) => error,
    };
    let what = match &error {
        Error::Number { what, .. }
        | Error::NotFinite { what, .. }
        | Error::Color { what, .. }
        | Error::Coincident { what, .. } => what,
        Error::Up { .. } => "up",
        _ => "",
    };
    // "camera eye and look_at" is about the second of them; "camera fov" may be about the default.
    let key = what.rsplit(' ').next().unwrap_or(what);
    let hint = match &error {
        Error::Coincident { .. } => format!(": move `{key}` away"),
        Error::Up { .. } => ": choose another up, such as [0, 1, 0] or [0, 0, 1]".to_string(),
        _ => String::new(),
    };
    let place = table.get(key).map_or(table.place.clone(), |node| node.place());
    report.error(place, format!("{}{hint}", in_words(&error)));
    None
}

/// The first syntax error of each line, in better words where the parser is short of them.
fn syntax_errors(text: &str, first: ::toml::de::Error, report: &mut Report) {
    // Going on after an error costs memory for each of them: not for a large file that is no TOML at all.
    const LARGE: usize = 1 << 20;
    let mut errors = vec![first];
    if text.len() <= LARGE {
        errors = DeTable::parse_recoverable(text).1;
    }
    let mut found: Vec<(Range<usize>, &str)> =
        errors.iter().map(|e| (e.span().unwrap_or_else(|| deepest(text)), e.message())).collect();
    found.sort_by_key(|(span, _)| span.start);
    let mut last = None;
    for (span, message) in found {
        let line = text.as_bytes()[..span.start.min(text.len())].iter().filter(|&&b| b == b'\n').count();
        if last != Some(line) {
            report.error(span, plain_words(message));
        }
        // What comes after an open string or list is misread.
        if message.contains("unclosed") || message.contains("string, expected") {
            break;
        }
        last = Some(line);
    }
}

fn plain_words(message: &str) -> String {
    let better = match message {
        "string values must be quoted, expected literal string" => {
            "this is no value: a string stands in quotes, a list in [ ], a table in { }"
        }
        "invalid mantissa, expected digits" => "a number needs a digit before the point, such as 0.5",
        "invalid fraction, expected digits" => "a number needs a digit after the point, such as 5.0",
        "unexpected leading zero, expected nothing" => {
            "a number does not start with a superfluous 0: leave it out"
        }
        "missing comma between array elements, expected `,`" => {
            "a comma is missing here, or the `]` of the list before"
        }
        "missing comma between key-value pairs, expected `,`" => {
            "a comma is missing here, or the `}` of the table before"
        }
        "duplicate key" => "this key is given twice: rename or remove one of them",
        "recursion limit" => "tables are nested too deeply: at most 80 levels",
        "key with no value, expected `=`" => "a key needs a value: write KEY = VALUE",
        "unexpected key or value, expected newline, `#`" => {
            "unexpected text after a value: a list stands in [ ], the next key on a line of its own"
        }
        other => other,
    };
    better.to_string()
}

/// The first line with more dots than the parser nests: it gives no place for that error.
fn deepest(text: &str) -> Range<usize> {
    const DEEP: usize = 80;
    let mut start = 0;
    for line in text.split_inclusive('\n') {
        if line.bytes().filter(|&b| b == b'.').count() >= DEEP {
            return start..start + 1;
        }
        start += line.len();
    }
    0..0
}
