//! `rt cast`: rays given as JSON lines, their hits as JSON lines.

use crate::failure::Failure;
use crate::lines::{self, BadLine, write_number};
use crate::scene_file::Loaded;
use rt_core::glam::DVec3;
use rt_core::{Interval, Primitive, Ray, Shape, Surface};
use rt_shade::Scene;
use rt_shade::text::shape::{self, Place, Value};
use serde::Deserialize;
use serde::de::{Deserializer, MapAccess, Visitor};
use serde_json::value::RawValue;
use std::borrow::Cow;
use std::fmt;
use std::ops::ControlFlow;

/// One question. Keys that are not listed are passed over, so that a line may carry notes of its own.
#[derive(Deserialize)]
struct Question<'a> {
    /// Given back as it is.
    #[serde(borrow)]
    id: Option<&'a RawValue>,
    #[serde(borrow)]
    shape: Option<&'a RawValue>,
    origin: [f64; 3],
    direction: [f64; 3],
    #[serde(default)]
    t_min: f64,
    #[serde(default = "unbounded")]
    t_max: f64,
}

fn unbounded() -> f64 {
    f64::INFINITY
}

/// What rays are cast at.
pub enum Target {
    /// Each line brings its own shape.
    Lines,
    /// All rays meet this scene.
    Scene(Box<Loaded>),
}

/// Reads questions from standard input and answers them on standard output.
pub fn run(target: &Target, first: bool) -> Result<(), Failure> {
    lines::answer(std::io::stdin().lock(), std::io::stdout().lock(), |line, reply| {
        answer(target, first, line, reply)
    })
}

fn answer(target: &Target, first: bool, line: &[u8], reply: &mut Vec<u8>) -> Result<(), BadLine> {
    let question: Question = serde_json::from_slice(line)?;
    let ray = Ray::new(question.origin, question.direction);
    let within = Interval::new(question.t_min, question.t_max);
    let column = |raw: &RawValue| offset(line, raw.get()) + 1;
    reply.extend_from_slice(b"{\"id\":");
    reply.extend_from_slice(question.id.map_or("null", RawValue::get).as_bytes());
    reply.extend_from_slice(b",\"hits\":[");
    match (target, question.shape) {
        (Target::Lines, Some(raw)) => {
            let shape = read_shape(raw, &column)?;
            let mut count = 0;
            each_surface(&shape, &ray, within, first, &mut |surface| {
                write_hit(&surface, None, count, reply);
                count += 1;
            });
        }
        (Target::Lines, None) => {
            let advice = r#"missing `shape`: give one, as in "shape": {"sphere": {"center": [0, 0, 0], "radius": 1}}, or name a scene with --scene"#;
            return Err(BadLine::new(1, advice));
        }
        (Target::Scene(_), Some(raw)) => {
            return Err(BadLine::new(column(raw), "`shape` does not go with --scene: leave one of them out"));
        }
        (Target::Scene(loaded), None) => {
            for (count, (name, surface)) in scene_hits(&loaded.scene, &ray, within, first).iter().enumerate()
            {
                write_hit(surface, Some(name), count, reply);
            }
        }
    }
    reply.extend_from_slice(b"]}");
    Ok(())
}

/// The crossings of all objects, ascending, or the nearest alone, each with its object's name.
fn scene_hits<'a>(scene: &'a Scene, ray: &Ray, within: Interval, first: bool) -> Vec<(&'a str, Surface)> {
    let geometry = scene.geometry();
    let name = |object: u32| scene.objects().get(object as usize).map_or("", |o| o.name.as_str());
    if first {
        let nearest = geometry.nearest(ray, within);
        return nearest.map(|f| (name(f.object), geometry.surface(ray, f))).into_iter().collect();
    }
    let mut found = Vec::new();
    geometry.crossings(ray, within, None, &mut |crossing| {
        found.push((crossing.object, geometry.surface(ray, crossing)));
        ControlFlow::Continue(())
    });
    // Crossings of one object come in order and a stable sort keeps them so where two round to one t.
    found.sort_by(|(a, x), (b, y)| x.t.total_cmp(&y.t).then(a.cmp(b)));
    found.into_iter().map(|(object, surface)| (name(object), surface)).collect()
}

/// The full records of the crossings of a shape, or of the nearest alone.
fn each_surface(shape: &Shape, ray: &Ray, within: Interval, first: bool, each: &mut dyn FnMut(Surface)) {
    if first {
        if let Some(hit) = shape.hit(ray, within) {
            each(shape.surface(ray, hit));
        }
    } else {
        shape.crossings(ray, within, &mut |hit| each(shape.surface(ray, hit)));
    }
}

fn write_hit(surface: &Surface, object: Option<&str>, count: usize, reply: &mut Vec<u8>) {
    if count > 0 {
        reply.push(b',');
    }
    reply.extend_from_slice(b"{\"t\":");
    write_number(surface.t, reply);
    reply.extend_from_slice(b",\"normal\":");
    write_vector(surface.normal, reply);
    reply.extend_from_slice(b",\"point\":");
    write_vector(surface.point, reply);
    if let Some(name) = object {
        reply.extend_from_slice(b",\"object\":");
        // Writing to a vector does not fail.
        let _ = serde_json::to_writer(&mut *reply, name);
    }
    reply.push(b'}');
}

fn write_vector(v: DVec3, to: &mut Vec<u8>) {
    to.push(b'[');
    write_number(v.x, to);
    to.push(b',');
    write_number(v.y, to);
    to.push(b',');
    write_number(v.z, to);
    to.push(b']');
}

/// How many bytes into `line` its part `text` begins.
fn offset(line: &[u8], text: &str) -> usize {
    (text.as_ptr() as usize).saturating_sub(line.as_ptr() as usize).min(line.len())
}

/// A JSON object with its keys in order, repeated ones too, and its values unread.
struct Entries<'a>(Vec<(Cow<'a, str>, &'a RawValue)>);

impl<'de> Deserialize<'de> for Entries<'de> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Collect;
        impl<'de> Visitor<'de> for Collect {
            type Value = Entries<'de>;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a table such as {\"sphere\": {\"center\": [0, 0, 0], \"radius\": 1}}")
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                let mut entries = Vec::with_capacity(6);
                while let Some(entry) = map.next_entry::<Key<'de>, &'de RawValue>()? {
                    entries.push((entry.0.0, entry.1));
                }
                Ok(Entries(entries))
            }
        }
        deserializer.deserialize_map(Collect)
    }
}

/// A key, borrowed from the line unless it holds escapes.
#[derive(Deserialize)]
struct Key<'a>(#[serde(borrow)] Cow<'a, str>);

fn read_entries<'a>(
    raw: &'a RawValue,
    column: &dyn Fn(&RawValue) -> usize,
) -> Result<Vec<(Cow<'a, str>, &'a RawValue)>, BadLine> {
    match serde_json::from_str::<Entries>(raw.get()) {
        Ok(entries) => Ok(entries.0),
        Err(error) => Err(BadLine::new(column(raw), BadLine::from(error).message)),
    }
}

/// Reads `{KIND: {FIELD: VALUE, ..}}`.
fn read_shape(raw: &RawValue, column: &dyn Fn(&RawValue) -> usize) -> Result<Shape, BadLine> {
    let kinds = read_entries(raw, column)?;
    let [(kind, table)] = kinds.as_slice() else {
        return Err(BadLine::new(column(raw), format!("`shape` must name one shape, not {}", kinds.len())));
    };
    let table = *table;
    let fields = read_entries(table, column)?;
    let values: Vec<(&str, Value)> =
        fields.iter().map(|(key, raw)| (key.as_ref(), read_value(raw))).collect();
    shape::from_fields(kind, &values).map_err(|problems| {
        let messages: Vec<&str> = problems.iter().map(|p| p.message.as_str()).collect();
        let at = match problems.first().map(|p| p.place) {
            Some(Place::Value(index) | Place::Key(index)) => fields.get(index).map_or(table, |field| field.1),
            Some(Place::Table) => table,
            _ => raw,
        };
        BadLine::new(column(at), messages.join("; "))
    })
}

fn read_value(raw: &RawValue) -> Value {
    let text = raw.get();
    match text.as_bytes().first() {
        Some(b'[') => match serde_json::from_str(text) {
            Ok(vector) => Value::Vector(DVec3::from_array(vector)),
            Err(_) => Value::Other("this list"),
        },
        Some(b'"') => Value::Other("a text"),
        Some(b'{') => Value::Other("a table"),
        Some(b't' | b'f') => Value::Other("true or false"),
        Some(b'n') => Value::Other("null"),
        _ => serde_json::from_str(text).map_or(Value::Other("a number beyond 1.8e308"), Value::Number),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ask(line: &str) -> Result<String, BadLine> {
        let mut reply = Vec::new();
        answer(&Target::Lines, false, line.as_bytes(), &mut reply)?;
        Ok(String::from_utf8(reply).unwrap())
    }

    #[test]
    fn the_id_comes_back_as_it_was() {
        let miss =
            r#""shape":{"sphere":{"center":[0,0,0],"radius":1}},"origin":[0,9,0],"direction":[1,0,0]}"#;
        assert_eq!(
            ask(&format!(r#"{{"id":12345678901234567890123,{miss}"#)).unwrap(),
            r#"{"id":12345678901234567890123,"hits":[]}"#
        );
        assert_eq!(ask(&format!(r#"{{"id":"a",{miss}"#)).unwrap(), r#"{"id":"a","hits":[]}"#);
        assert_eq!(ask(&format!("{{{miss}")).unwrap(), r#"{"id":null,"hits":[]}"#);
    }

    #[test]
    fn a_wrong_field_is_named_with_its_column() {
        let line = r#"{"id":1,"shape":{"sphere":{"center":[0,0,0],"radius":-1}},"origin":[0,9,0],"direction":[1,0,0]}"#;
        let bad = ask(line).unwrap_err();
        assert_eq!(&line[bad.column - 1..bad.column + 1], "-1");
        assert!(bad.message.contains("radius") && bad.message.contains("-1"), "{}", bad.message);
    }

    #[test]
    fn numbers_beyond_the_range_are_refused() {
        let line = r#"{"id":1,"shape":{"sphere":{"center":[0,0,0],"radius":1e400}},"origin":[0,9,0],"direction":[1,0,0]}"#;
        assert!(ask(line).is_err());
        let line = r#"{"id":1,"shape":{"sphere":{"center":[0,0,0],"radius":1}},"origin":[0,1e400,0],"direction":[1,0,0]}"#;
        assert!(ask(line).is_err());
    }
}
