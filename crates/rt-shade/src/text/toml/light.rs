//! `[[light]]`: a point or a spotlight.

use super::super::diagnostic::Report;
use super::super::reader::{Node, Table};
use super::{blame, color};
use crate::{Attenuation, Color, Light};
use rt_core::glam::DVec3;

pub(super) fn light(node: Node, report: &mut Report) -> Option<Light> {
    let table = node.table("light", &[], &["point", "spot"], report)?;
    match (table.get("point"), table.get("spot")) {
        (Some(point), None) => {
            let table = point.table("point light", &["position"], &["color", "attenuation"], report)?;
            let (position, color, attenuation) = common(&table, report);
            let light = Light::point(position?, color?, attenuation?);
            blame(light, &table, report)
        }
        (None, Some(spot)) => {
            let required = ["position", "target", "outer"];
            let table = spot.table("spotlight", &required, &["inner", "color", "attenuation"], report)?;
            let (position, color, attenuation) = common(&table, report);
            let target = table.get("target").and_then(|n| n.vector(report));
            let outer = table.get("outer").and_then(|n| n.number(report));
            let inner = table.get("inner").map_or(outer, |n| n.number(report));
            let light = Light::spot(position?, target?, inner?, outer?, color?, attenuation?);
            blame(light, &table, report)
        }
        (Some(point), Some(spot)) => {
            let second = point.key.span().start.max(spot.key.span().start);
            let message = "a light is either `point` or `spot`: write another [[light]] for this one";
            report.error(second..second + 5, message);
            None
        }
        (None, None) => {
            // Nothing more to say when an unknown key has been reported.
            if table.is_empty() {
                report.error(table.place, "light lacks `point` or `spot`");
            }
            None
        }
    }
}

/// What both kinds have.
fn common(table: &Table, report: &mut Report) -> (Option<DVec3>, Option<Color>, Option<Attenuation>) {
    let position = table.get("position").and_then(|n| n.vector(report));
    let color = table.get("color").map_or(Some(Color::WHITE), |n| color(n, report));
    let attenuation = table.get("attenuation").map_or(Some(Attenuation::NONE), |node| {
        let [constant, linear, quadratic] = node.vector(report)?.to_array();
        let attenuation = Attenuation::new(constant, linear, quadratic);
        blame(attenuation, table, report)
    });
    (position, color, attenuation)
}
