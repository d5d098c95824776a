//! `[texture.NAME]` and `[material.NAME]`.

use super::super::diagnostic::Report;
use super::super::picture::{PictureLoader, check_path};
use super::super::reader::{Node, Table};
use super::super::suggest;
use super::{blame, color};
use crate::{Checker, ImageTexture, Material, Paint, SceneBuilder, Texture};
use std::collections::HashMap;

/// Names and their indices in the scene. A name whose table is wrong is known too, so that it is reported once.
pub(super) type Names<'t> = HashMap<&'t str, u32>;

pub(super) fn textures<'t>(
    node: Option<Node<'t>>,
    pictures: &dyn PictureLoader,
    scene: &mut SceneBuilder,
    report: &mut Report,
) -> Names<'t> {
    let mut names = Names::new();
    for node in node.and_then(|node| node.entries(report)).into_iter().flatten() {
        let texture = texture(node, pictures, report).unwrap_or(Texture::Solid(crate::Color::WHITE));
        names.insert(node.name(), scene.add_texture(texture));
    }
    names
}

fn texture(node: Node, pictures: &dyn PictureLoader, report: &mut Report) -> Option<Texture> {
    let what = format!("texture `{}`", node.name());
    let table = node.table(&what, &[], &["solid", "checker", "image"], report)?;
    let mut kinds = table.entries();
    let (Some(kind), second) = (kinds.next(), kinds.next()) else {
        report.error(table.place, format!("{what} lacks `solid`, `checker` or `image`"));
        return None;
    };
    if let Some(second) = second {
        let message = format!("{what} is already `{}`: a texture is of one kind", kind.name());
        report.error(second.key.span(), message);
    }
    match kind.name() {
        "solid" => {
            let table = kind.table("solid texture", &["color"], &[], report)?;
            Some(Texture::Solid(color(table.get("color")?, report)?))
        }
        "checker" => {
            let table = kind.table("checker texture", &["colors"], &["size"], report)?;
            let colors = table.get("colors").and_then(|n| two_colors(n, report));
            let size = size(&table, report);
            let checker = Checker::new(colors?, size?);
            blame(checker, &table, report).map(Texture::Checker)
        }
        "image" => {
            let table = kind.table("image texture", &["path"], &["size"], report)?;
            let size = size(&table, report);
            let node = table.get("path")?;
            let bytes = picture(node, pictures, report);
            let image = ImageTexture::decode(&bytes?, size?);
            let place = node.place();
            image
                .map_err(|error| report.error(place, format!("`{}`: {error}", node.text_or_empty())))
                .ok()
                .map(Texture::Image)
        }
        // Reported as an unknown key.
        _ => None,
    }
}

/// The `size` of a texture, default 1.
fn size(table: &Table, report: &mut Report) -> Option<f64> {
    let Some(node) = table.get("size") else { return Some(1.0) };
    let size = node.number(report)?;
    let checked = crate::texture::check_size(size).map(|()| size);
    blame(checked, table, report)
}

fn two_colors(node: Node, report: &mut Report) -> Option<[crate::Color; 2]> {
    let mut items = node.items("a list of two colours, such as [[1, 1, 1], [0, 0, 0]]", 2, report)?;
    let colors = [color(items.next()?, report), color(items.next()?, report)];
    Some([colors[0]?, colors[1]?])
}

fn picture(node: Node, pictures: &dyn PictureLoader, report: &mut Report) -> Option<Vec<u8>> {
    let path = node.text(report)?;
    let loaded = check_path(path)
        .and_then(|()| pictures.load(path).map_err(|reason| format!("cannot read `{path}`: {reason}")));
    loaded.map_err(|message| report.error(node.place(), message)).ok()
}

pub(super) fn materials<'t>(
    node: Option<Node<'t>>,
    textures: &Names,
    scene: &mut SceneBuilder,
    report: &mut Report,
) -> Names<'t> {
    let mut names = Names::new();
    for node in node.and_then(|node| node.entries(report)).into_iter().flatten() {
        let material = material(node, textures, report).unwrap_or_default();
        names.insert(node.name(), scene.add_material(material));
    }
    names
}

type Setter = fn(&mut Material, f64);

/// The numbers of a material.
const NUMBERS: [(&str, Setter); 5] = [
    ("diffuse", |m, x| m.diffuse = x),
    ("specular", |m, x| m.specular = x),
    ("shininess", |m, x| m.shininess = x),
    ("reflect", |m, x| m.reflect = x),
    ("ior", |m, x| m.ior = Some(x)),
];

fn material(node: Node, textures: &Names, report: &mut Report) -> Option<Material> {
    let what = format!("material `{}`", node.name());
    let optional = ["color", "texture", "diffuse", "specular", "shininess", "reflect", "transmit", "ior"];
    let table = node.table(&what, &[], &optional, report)?;
    let mut material = Material::default();
    for (key, set) in NUMBERS {
        let Some(number) = table.get(key).and_then(|n| n.number(report)) else { continue };
        // Checked alone, so that each wrong number is reported.
        let mut alone = Material::default();
        set(&mut alone, number);
        let checked = alone.check();
        blame(checked, &table, report);
        set(&mut material, number);
    }
    if let Some(transmit) = table.get("transmit").and_then(|n| color(n, report)) {
        let checked = Material { transmit, ..Material::default() }.check();
        blame(checked, &table, report);
        material.transmit = transmit;
    }
    if let Some(color) = table.get("color").and_then(|n| color(n, report)) {
        material.paint = Paint::Color(color);
    }
    if let Some(node) = table.get("texture") {
        if table.get("color").is_some() {
            let message = format!("{what} has both `color` and `texture`: keep one of them");
            report.error(node.key.span(), message);
        }
        if let Some(index) = named(node, textures, report) {
            material.paint = Paint::Texture(index);
        }
    }
    Some(material)
}

/// The index of what the node names.
pub(super) fn named(node: Node, names: &Names, report: &mut Report) -> Option<u32> {
    let name = node.text(report)?;
    let index = names.get(name).copied();
    if index.is_none() {
        let what = node.name();
        // In the order of the file, so that the advice is the same every time.
        let mut known: Vec<(u32, &str)> = Vec::new();
        if !report.is_full() {
            known = names.iter().map(|(name, index)| (*index, *name)).collect();
            known.sort_unstable();
        }
        let known = known.iter().map(|(_, name)| *name);
        let advice = suggest::advice(name, known, &format!("add a table [{what}.{name}]"));
        report.error(node.place(), format!("there is no {what} `{name}`: {advice}"));
    }
    index
}
