//! The shape words, one table for every text that names shapes: scenes in TOML and rays cast from JSON.
//!
//! A shape is written as its kind and a table of fields, `torus = { center = [0, 0, 0], axis = [0, 1, 0], major = 2,
//! minor = 0.5 }` or `{"torus": {"center": [0, 0, 0], ...}}`. The text is turned into [`Value`]s by whoever parses it;
//! [`from_fields`] checks the fields and makes the shape.
//!
//! | kind | fields |
//! |---|---|
//! | `sphere` | `center`, `radius` |
//! | `plane` | `point`, `normal` (any length but zero) |
//! | `cuboid` | `min`, `max` |
//! | `cylinder`, `open_cylinder` | `base`, `top`, `radius` |
//! | `cone`, `open_cone` | `base`, `base_radius`, `top`, `top_radius` (either radius may be 0, not both) |
//! | `torus` | `center`, `axis` (any length but zero), `major`, `minor` |
//! | `disk` | `center`, `normal`, `radius` |
//! | `triangle` | `a`, `b`, `c`, and the vertex normals `na`, `nb`, `nc`: all three or none |
//!
//! Nothing has a default but the vertex normals of a triangle (without them it is flat).

use super::diagnostic::in_words;
use super::suggest;
use rt_core::glam::DVec3;
use rt_core::shape::{Cone, Cuboid, Cylinder, Disk, Plane, Sphere, Torus, Triangle};
use rt_core::{Error, Shape};

/// A field's value as the text gave it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// A number.
    Number(f64),
    /// A list of three numbers.
    Vector(DVec3),
    /// Anything else, with words for it: `"a string"`, `"a list of 2 numbers"`.
    Other(&'static str),
}

/// What a [`Problem`] is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// The word for the kind of shape.
    Kind,
    /// The table as a whole, when something is missing from it.
    Table,
    /// The key of the field with this index.
    Key(usize),
    /// The value of the field with this index.
    Value(usize),
}

/// One thing wrong with a shape's table, and how to mend it.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    /// Where.
    pub place: Place,
    /// What is wrong and how to mend it.
    pub message: String,
}

/// Whether a field holds a number or a vector.
#[derive(Clone, Copy, PartialEq)]
enum Type {
    Number,
    Vector,
}

impl Type {
    fn name(self) -> &'static str {
        match self {
            Type::Number => "a number",
            Type::Vector => "a list of three numbers [x, y, z]",
        }
    }
}

/// A kind of shape: its word, its fields, and the constructor that takes their values in this order.
struct Kind {
    word: &'static str,
    fields: &'static [(&'static str, Type)],
    /// How many of the fields, from the first, must be there.
    required: usize,
    make: fn(&Fields) -> Result<Shape, Error>,
}

/// The checked values of a kind's fields, in the order of the table below.
struct Fields([Option<Value>; 6]);

impl Fields {
    fn number(&self, index: usize) -> f64 {
        match self.0[index] {
            Some(Value::Number(x)) => x,
            _ => f64::NAN,
        }
    }

    fn vector(&self, index: usize) -> DVec3 {
        match self.0[index] {
            Some(Value::Vector(v)) => v,
            _ => DVec3::NAN,
        }
    }
}

use Type::{Number, Vector};

static KINDS: [Kind; 10] = [
    Kind {
        word: "sphere",
        fields: &[("center", Vector), ("radius", Number)],
        required: 2,
        make: |f| Ok(Sphere::new(f.vector(0), f.number(1))?.into()),
    },
    Kind {
        word: "plane",
        fields: &[("point", Vector), ("normal", Vector)],
        required: 2,
        make: |f| Ok(Plane::new(f.vector(0), f.vector(1))?.into()),
    },
    Kind {
        word: "cuboid",
        fields: &[("min", Vector), ("max", Vector)],
        required: 2,
        make: |f| Ok(Cuboid::new(f.vector(0), f.vector(1))?.into()),
    },
    Kind {
        word: "cylinder",
        fields: &[("base", Vector), ("top", Vector), ("radius", Number)],
        required: 3,
        make: |f| Ok(Cylinder::new(f.vector(0), f.vector(1), f.number(2))?.into()),
    },
    Kind {
        word: "open_cylinder",
        fields: &[("base", Vector), ("top", Vector), ("radius", Number)],
        required: 3,
        make: |f| Ok(Cylinder::open(f.vector(0), f.vector(1), f.number(2))?.into()),
    },
    Kind {
        word: "cone",
        fields: &[("base", Vector), ("base_radius", Number), ("top", Vector), ("top_radius", Number)],
        required: 4,
        make: |f| Ok(Cone::new(f.vector(0), f.number(1), f.vector(2), f.number(3))?.into()),
    },
    Kind {
        word: "open_cone",
        fields: &[("base", Vector), ("base_radius", Number), ("top", Vector), ("top_radius", Number)],
        required: 4,
        make: |f| Ok(Cone::open(f.vector(0), f.number(1), f.vector(2), f.number(3))?.into()),
    },
    Kind {
        word: "torus",
        fields: &[("center", Vector), ("axis", Vector), ("major", Number), ("minor", Number)],
        required: 4,
        make: |f| Ok(Torus::new(f.vector(0), f.vector(1), f.number(2), f.number(3))?.into()),
    },
    Kind {
        word: "disk",
        fields: &[("center", Vector), ("normal", Vector), ("radius", Number)],
        required: 3,
        make: |f| Ok(Disk::new(f.vector(0), f.vector(1), f.number(2))?.into()),
    },
    Kind {
        word: "triangle",
        fields: &[
            ("a", Vector),
            ("b", Vector),
            ("c", Vector),
            ("na", Vector),
            ("nb", Vector),
            ("nc", Vector),
        ],
        required: 3,
        make: triangle,
    },
];

fn triangle(f: &Fields) -> Result<Shape, Error> {
    let flat = Triangle::new(f.vector(0), f.vector(1), f.vector(2))?;
    let smooth = f.0[3].is_some();
    Ok(if smooth { flat.with_normals(f.vector(3), f.vector(4), f.vector(5))? } else { flat }.into())
}

/// The words for the kinds of shape.
pub fn kinds() -> impl Iterator<Item = &'static str> + Clone {
    KINDS.iter().map(|kind| kind.word)
}

/// Makes the shape of the given kind from its fields, in any order.
///
/// ```
/// use rt_shade::rt_core::glam::DVec3;
/// use rt_shade::text::shape::{Place, Value, from_fields};
///
/// let center = ("center", Value::Vector(DVec3::ZERO));
/// assert!(from_fields("sphere", &[center, ("radius", Value::Number(2.0))]).is_ok());
///
/// let problems = from_fields("sphere", &[center, ("raduis", Value::Number(2.0))]).unwrap_err();
/// assert_eq!(problems[0].place, Place::Key(1));
/// assert_eq!(problems[0].message, "unknown key `raduis` in sphere: did you mean `radius`?");
/// ```
///
/// # Errors
/// All that is wrong: an unknown kind or key, a missing field, a value of the wrong type, or what the shape's own
/// constructor refuses.
pub fn from_fields(kind: &str, fields: &[(&str, Value)]) -> Result<Shape, Vec<Problem>> {
    make(&check(kind, fields)?, fields).map_err(|problem| vec![problem])
}

/// Fields that fit their kind of shape.
pub(super) struct Checked {
    kind: &'static Kind,
    values: Fields,
}

/// Makes the shape of checked fields; the constructor may still refuse their values.
pub(super) fn make(checked: &Checked, fields: &[(&str, Value)]) -> Result<Shape, Problem> {
    (checked.kind.make)(&checked.values).map_err(|error| explain(checked.kind.word, fields, &error))
}

/// Checks the kind, the keys and the types of the values.
pub(super) fn check(kind: &str, fields: &[(&str, Value)]) -> Result<Checked, Vec<Problem>> {
    let Some(kind) = KINDS.iter().find(|k| k.word == kind) else {
        let message = format!("unknown shape `{kind}`: {}", suggest::advice(kind, kinds(), ""));
        return Err(vec![Problem { place: Place::Kind, message }]);
    };
    let mut problems = Vec::new();
    let mut values = Fields([None; 6]);
    // A misspelt key is reported once, not a second time as the field that it was meant to be.
    let mut meant: Vec<&str> = Vec::new();
    for (index, &(key, value)) in fields.iter().enumerate() {
        let names = kind.fields.iter().map(|f| f.0);
        let Some(field) = kind.fields.iter().position(|f| f.0 == key) else {
            meant.extend(suggest::nearest(key, names.clone()));
            let advice = suggest::advice(key, names, "");
            let message = format!("unknown key `{key}` in {}: {advice}", kind.word);
            problems.push(Problem { place: Place::Key(index), message });
            continue;
        };
        let expected = kind.fields[field].1;
        let fits = matches!((expected, value), (Number, Value::Number(_)) | (Vector, Value::Vector(_)));
        if values.0[field].is_some() {
            let message = format!("`{key}` is given twice: keep one of them");
            problems.push(Problem { place: Place::Key(index), message });
        } else if !fits {
            let found = match value {
                Value::Number(_) => "a number",
                Value::Vector(_) => "a list of three numbers",
                Value::Other(words) => words,
            };
            let message = format!("`{key}` must be {}, not {found}", expected.name());
            problems.push(Problem { place: Place::Value(index), message });
        }
        values.0[field] = Some(value);
    }
    let given = |field: usize| values.0[field].is_some() || meant.contains(&kind.fields[field].0);
    let optional = kind.required..kind.fields.len();
    let any_optional = optional.clone().any(given);
    let missing: Vec<&str> = (0..kind.fields.len())
        .filter(|&field| !given(field) && (field < kind.required || any_optional))
        .map(|field| kind.fields[field].0)
        .collect();
    if !missing.is_empty() {
        let message = format!("{} lacks `{}`", kind.word, missing.join("`, `"));
        problems.push(Problem { place: Place::Table, message });
    }
    if problems.is_empty() { Ok(Checked { kind, values }) } else { Err(problems) }
}

/// The fields that are directions.
const DIRECTIONS: [&str; 5] = ["axis", "normal", "na", "nb", "nc"];

/// The constructor's complaint at the field that carries the offending value.
fn explain(kind: &str, fields: &[(&str, Value)], error: &Error) -> Problem {
    let same = |a: f64, b: f64| a.to_bits() == b.to_bits();
    let holds = |value: &Value, wanted: f64| match value {
        Value::Number(x) => same(*x, wanted),
        Value::Vector(v) => v.to_array().iter().any(|x| same(*x, wanted)),
        Value::Other(_) => false,
    };
    let is = |value: &Value, wanted: DVec3| match value {
        Value::Vector(v) => v.to_array().into_iter().zip(wanted.to_array()).all(|(x, y)| same(x, y)),
        _ => false,
    };
    // Of several fields with the offending value the one that the message names.
    let pick = |what: &str, fits: &dyn Fn(&str, &Value) -> bool| {
        let named = |key: &str| what.ends_with(&key.replace('_', " ")) || what.ends_with(key);
        let places = || (0..fields.len()).filter(|&index| fits(fields[index].0, &fields[index].1));
        places().find(|&index| named(fields[index].0)).or_else(|| places().next())
    };
    let index = match error {
        Error::NotPositive { what, value }
        | Error::Negative { what, value }
        | Error::OutOfRange { what, value } => pick(what, &|_, given| holds(given, *value)),
        Error::NotFinite { what, value } => pick(what, &|_, given| is(given, *value)),
        Error::ZeroLength { what, value } => {
            pick(what, &|key, given| DIRECTIONS.contains(&key) && is(given, *value))
        }
        // The second of the two points.
        Error::Coincident { value, .. } => fields.iter().rposition(|f| is(&f.1, *value)),
        Error::Unordered { .. } => fields.iter().position(|f| f.0 == "max"),
        _ => None,
    };
    let text = in_words(error);
    let says_which = text.contains(kind.trim_start_matches("open_"));
    let message = if says_which { text } else { format!("{kind} {text}") };
    Problem { place: index.map_or(Place::Table, Place::Value), message }
}

#[cfg(test)]
mod tests {
    use super::*;

    const O: Value = Value::Vector(DVec3::ZERO);
    const X: Value = Value::Vector(DVec3::X);
    const Y: Value = Value::Vector(DVec3::Y);
    const ONE: Value = Value::Number(1.0);

    fn wrong(kind: &str, fields: &[(&str, Value)]) -> Vec<Problem> {
        from_fields(kind, fields).unwrap_err()
    }

    #[test]
    fn every_kind_is_made() {
        let all: [&[(&str, Value)]; 10] = [
            &[("radius", ONE), ("center", O)],
            &[("point", O), ("normal", X)],
            &[("min", O), ("max", Value::Vector(DVec3::ONE))],
            &[("base", O), ("top", X), ("radius", ONE)],
            &[("base", O), ("top", X), ("radius", ONE)],
            &[("base", O), ("top", X), ("base_radius", ONE), ("top_radius", Value::Number(0.5))],
            &[("base", O), ("top", X), ("base_radius", ONE), ("top_radius", Value::Number(0.5))],
            &[("center", O), ("axis", X), ("major", ONE), ("minor", Value::Number(0.5))],
            &[("center", O), ("normal", X), ("radius", ONE)],
            &[("a", O), ("b", X), ("c", Y)],
        ];
        for (kind, fields) in kinds().zip(all) {
            assert!(from_fields(kind, fields).is_ok(), "{kind}");
            let mut extra = fields.to_vec();
            extra.push(("frobnicate", ONE));
            assert_eq!(wrong(kind, &extra)[0].place, Place::Key(fields.len()), "{kind}");
            for left_out in 0..fields.len() {
                let mut fields = fields.to_vec();
                let (key, _) = fields.remove(left_out);
                assert_eq!(wrong(kind, &fields)[0].message, format!("{kind} lacks `{key}`"));
            }
        }
    }

    #[test]
    fn all_problems_at_once() {
        let found = wrong("torus", &[("centre", O), ("axis", ONE), ("major", Value::Other("a string"))]);
        let places: Vec<Place> = found.iter().map(|p| p.place).collect();
        assert_eq!(places, [Place::Key(0), Place::Value(1), Place::Value(2), Place::Table]);
        assert_eq!(found[3].message, "torus lacks `minor`");
    }

    #[test]
    fn unknown_kind_names_the_nearest() {
        assert_eq!(wrong("spehre", &[])[0].message, "unknown shape `spehre`: did you mean `sphere`?");
    }

    #[test]
    fn triangle_normals_come_together() {
        let found = wrong("triangle", &[("a", O), ("b", X), ("c", Y), ("na", X)]);
        assert_eq!(found[0].message, "triangle lacks `nb`, `nc`");
    }
}
