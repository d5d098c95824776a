//! `[[object]]`: a shape with its material, scaled, turned and moved.

use super::super::diagnostic::{Report, in_words};
use super::super::reader::{Node, Table};
use super::super::shape::{self, Place, Value, check, make};
use super::super::suggest;
use super::material::{Names, named};
use crate::{Object, SceneBuilder};
use rt_core::{Shape, Similarity};

pub(super) fn object(node: Node, materials: &Names, scene: &mut SceneBuilder, report: &mut Report) {
    let optional = ["name", "scale", "rotate", "translate", "no_shadow"];
    let Some(table) = node.table("object", &["material", "shape"], &optional, report) else { return };
    let name = table.get("name").map_or(Some(""), |n| n.text(report));
    let material = table.get("material").and_then(|n| named(n, materials, report));
    let no_shadow = table.get("no_shadow").map_or(Some(false), |n| n.boolean(report));
    let steps = steps(&table, report);
    let shape = table.get("shape").and_then(|n| shape(n, report));
    // All has been read: from here on nothing is left unreported.
    let (Some(name), Some(material), Some(no_shadow)) = (name, material, no_shadow) else { return };
    let (Some(steps), Some(shape)) = (steps, shape) else { return };
    let moved = steps.last().map_or(Ok(shape.clone()), |(_, all)| shape.transformed(all));
    match moved {
        Ok(shape) => {
            scene.add_object(Object { name: name.to_string(), material, no_shadow }, shape);
        }
        Err(error) => {
            // The first step that is too much for the shape.
            let culprit = steps.iter().find(|(_, so_far)| shape.transformed(so_far).is_err());
            let place = culprit.map_or(table.place, |(node, _)| node.place());
            let error = in_words(&error);
            report.error(place, format!("scaled, turned and moved the shape is not legal: {error}"));
        }
    }
}

/// Scale, rotate and translate as far as they are given, in this order, each with those before it.
fn steps<'t>(table: &Table<'t>, report: &mut Report) -> Option<Vec<(Node<'t>, Similarity)>> {
    let mut steps = Vec::new();
    let mut good = true;
    let mut so_far = Similarity::IDENTITY;
    for key in ["scale", "rotate", "translate"] {
        let Some(node) = table.get(key) else { continue };
        let after = match key {
            "scale" => node.number(report).and_then(|factor| place(node, so_far.scaled(factor), report)),
            "rotate" => rotated(node, so_far, report),
            _ => node.vector(report).and_then(|by| place(node, so_far.translated(by), report)),
        };
        match after {
            Some(after) => {
                so_far = after;
                steps.push((node, so_far));
            }
            None => good = false,
        }
    }
    good.then_some(steps)
}

fn rotated(node: Node, before: Similarity, report: &mut Report) -> Option<Similarity> {
    let table = node.table("rotate", &["axis", "degrees"], &[], report)?;
    let axis = table.get("axis").and_then(|n| n.vector(report));
    let degrees = table.get("degrees").and_then(|n| n.number(report));
    let (axis, degrees) = (axis?, degrees?);
    place(table.get("axis")?, before.rotated(axis, degrees), report)
}

fn place<T>(node: Node, result: Result<T, rt_core::Error>, report: &mut Report) -> Option<T> {
    result.map_err(|error| report.error(node.place(), in_words(&error))).ok()
}

fn shape(node: Node, report: &mut Report) -> Option<Shape> {
    let Some(kinds) = node.value().as_table() else {
        let message = "`shape` must be a table: write shape.sphere = { center = [0, 0, 0], radius = 1 }";
        report.error(node.place(), message);
        return None;
    };
    let mut found: Option<Node> = None;
    for node in Node::of_table(kinds) {
        let name = node.name();
        if !shape::kinds().any(|kind| kind == name) {
            let advice = suggest::advice(name, shape::kinds(), "");
            report.error(node.key.span(), format!("unknown shape `{name}`: {advice}"));
        } else if let Some(first) = found {
            let first = first.name();
            let message =
                format!("this object is already a {first}: write another [[object]] for the {name}");
            report.error(node.key.span(), message);
        } else {
            found = Some(node);
        }
    }
    if kinds.is_empty() {
        report.error(node.place(), "`shape` is empty: write shape.sphere, shape.torus or another");
    }
    let kind = found?;
    let Some(fields) = kind.value().as_table() else {
        let message = format!("`{}` must be a table {{ .. }} with the shape's numbers", kind.name());
        report.error(kind.place(), message);
        return None;
    };
    let nodes: Vec<Node> = Node::of_table(fields).collect();
    let mut all_finite = true;
    let mut values = Vec::with_capacity(nodes.len());
    for node in &nodes {
        let value = node.shape_value(report);
        all_finite &= value.is_some();
        // A stand-in of the right type: the shape is not made.
        let is_list = node.value().is_array();
        let stand_in = if is_list { Value::Vector(rt_core::glam::DVec3::ONE) } else { Value::Number(1.0) };
        values.push((node.name(), value.unwrap_or(stand_in)));
    }
    let made = match check(kind.name(), &values) {
        Ok(checked) if all_finite => make(&checked, &values).map_err(|problem| vec![problem]),
        Ok(_) => return None,
        Err(problems) => Err(problems),
    };
    made.map_err(|problems| {
        for problem in problems {
            let place = match problem.place {
                Place::Kind => kind.key.span(),
                Place::Table => kind.place(),
                Place::Key(index) => nodes.get(index).map_or(kind.place(), |n| n.key.span()),
                Place::Value(index) => nodes.get(index).map_or(kind.place(), |n| n.place()),
            };
            report.error(place, problem.message);
        }
    })
    .ok()
}
