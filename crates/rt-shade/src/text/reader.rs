//! Reads values out of a parsed TOML document and notes everything that is wrong with them.
//!
//! A value that cannot be used is reported once and given back as `None`, so that the reader can go on and find the
//! rest of the errors.

use super::diagnostic::Report;
use super::shape::Value;
use super::suggest;
use rt_core::glam::DVec3;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A value with its key.
#[derive(Clone, Copy)]
pub(crate) struct Node<'t> {
    pub(crate) key: &'t Spanned<std::borrow::Cow<'t, str>>,
    value: &'t Spanned<DeValue<'t>>,
}

/// A table whose keys have been checked.
#[derive(Clone)]
pub(crate) struct Table<'t> {
    fields: &'t DeTable<'t>,
    pub(crate) place: Range<usize>,
}

/// Words for what kind of value was found.
pub(crate) fn kind_of(value: &DeValue<'_>) -> &'static str {
    match value {
        DeValue::String(_) => "a string",
        DeValue::Integer(_) | DeValue::Float(_) => "a number",
        DeValue::Boolean(_) => "true or false",
        DeValue::Datetime(_) => "a date or time",
        DeValue::Array(list) => match list.len() {
            0 => "an empty list",
            1 => "a list of 1 value",
            2 => "a list of 2 values",
            3 => "a list of 3 values",
            4 => "a list of 4 values",
            _ => "a list of more than 4 values",
        },
        DeValue::Table(_) => "a table",
    }
}

impl<'t> Node<'t> {
    /// The entries of a table of any content.
    pub(crate) fn of_table(table: &'t DeTable<'t>) -> impl Iterator<Item = Node<'t>> + use<'t> {
        table.iter().map(|(key, value)| Node { key, value })
    }

    pub(crate) fn name(&self) -> &'t str {
        self.key.get_ref()
    }

    pub(crate) fn place(&self) -> Range<usize> {
        self.value.span()
    }

    pub(crate) fn value(&self) -> &'t DeValue<'t> {
        self.value.get_ref()
    }

    /// The place of one value of a list.
    pub(crate) fn element(&self, index: usize) -> Range<usize> {
        self.value().as_array().and_then(|list| list.get(index)).map_or(self.place(), |value| value.span())
    }

    /// The string, for messages.
    pub(crate) fn text_or_empty(&self) -> &'t str {
        self.value().as_str().unwrap_or_default()
    }

    /// The value of a shape's field, whatever its type; `None` after reporting a bad number.
    pub(crate) fn shape_value(&self, report: &mut Report) -> Option<Value> {
        match self.value() {
            DeValue::Integer(_) | DeValue::Float(_) => self.number(report).map(Value::Number),
            DeValue::Array(list) if list.len() == 3 => self.vector(report).map(Value::Vector),
            other => Some(Value::Other(kind_of(other))),
        }
    }

    fn wrong_type(&self, expected: &str, report: &mut Report) {
        let (name, found) = (self.name(), kind_of(self.value()));
        report.error(self.place(), format!("`{name}` must be {expected}, not {found}"));
    }

    /// A finite number.
    pub(crate) fn number(&self, report: &mut Report) -> Option<f64> {
        if !matches!(self.value(), DeValue::Integer(_) | DeValue::Float(_)) {
            self.wrong_type("a number", report);
            return None;
        }
        finite(self.name(), self.value, report)
    }

    /// Three finite numbers.
    pub(crate) fn vector(&self, report: &mut Report) -> Option<DVec3> {
        let list = match self.value().as_array() {
            Some(list) if list.len() == 3 => list,
            _ => {
                self.wrong_type("a list of three numbers, such as [0, 1, 0]", report);
                return None;
            }
        };
        // All three are read before the answer is given, so that each bad one is reported.
        let mut numbers = [None; 3];
        for (number, value) in numbers.iter_mut().zip(list.iter()) {
            *number = finite(self.name(), value, report);
        }
        Some(DVec3::new(numbers[0]?, numbers[1]?, numbers[2]?))
    }

    /// A whole number within the range.
    pub(crate) fn whole(&self, range: std::ops::RangeInclusive<u32>, report: &mut Report) -> Option<u32> {
        let (least, most) = (*range.start(), *range.end());
        let given = match self.value() {
            DeValue::Integer(digits) => digits.to_string(),
            DeValue::Float(digits) => digits.as_str().to_string(),
            _ => {
                self.wrong_type("a whole number", report);
                return None;
            }
        };
        let value = match self.value() {
            DeValue::Integer(digits) => i128::from_str_radix(digits.as_str(), digits.radix()).ok(),
            _ => None,
        };
        match value.and_then(|value| u32::try_from(value).ok()) {
            Some(value) if range.contains(&value) => Some(value),
            _ => {
                let name = self.name();
                let message = format!("`{name}` must be a whole number from {least} to {most}, got {given}");
                report.error(self.place(), message);
                None
            }
        }
    }

    pub(crate) fn text(&self, report: &mut Report) -> Option<&'t str> {
        let text = self.value().as_str();
        if text.is_none() {
            self.wrong_type("a string in quotes", report);
        }
        text
    }

    pub(crate) fn boolean(&self, report: &mut Report) -> Option<bool> {
        let value = self.value().as_bool();
        if value.is_none() {
            self.wrong_type("true or false", report);
        }
        value
    }

    /// The values of a list of this length.
    pub(crate) fn items(
        &self,
        expected: &str,
        length: usize,
        report: &mut Report,
    ) -> Option<impl Iterator<Item = Node<'t>> + use<'t>> {
        let key = self.key;
        match self.value().as_array() {
            Some(list) if list.len() == length => Some(list.iter().map(move |value| Node { key, value })),
            _ => {
                self.wrong_type(expected, report);
                None
            }
        }
    }

    /// The entries of a list of tables, `[[name]]`.
    pub(crate) fn list(&self, report: &mut Report) -> Option<impl Iterator<Item = Node<'t>> + use<'t>> {
        let key = self.key;
        let list = self.value().as_array();
        if list.is_none() {
            let (name, found) = (self.name(), kind_of(self.value()));
            let message = format!("`{name}` must be a list of tables, not {found}: write [[{name}]]");
            report.error(self.key.span(), message);
        }
        Some(list?.iter().map(move |value| Node { key, value }))
    }

    /// The entries of a table with names of the writer's choice, `[material.name]`.
    pub(crate) fn entries(&self, report: &mut Report) -> Option<impl Iterator<Item = Node<'t>> + use<'t>> {
        let table = self.value().as_table();
        if table.is_none() {
            let (name, found) = (self.name(), kind_of(self.value()));
            let message =
                format!("`{name}` must be a table of named tables, not {found}: write [{name}.NAME]");
            report.error(self.key.span(), message);
        }
        Some(Node::of_table(table?))
    }

    /// A table; `what` says in messages which. Keys that are neither required nor optional are reported, as are
    /// required ones that are missing.
    pub(crate) fn table(
        &self,
        what: &str,
        required: &[&'static str],
        optional: &[&'static str],
        report: &mut Report,
    ) -> Option<Table<'t>> {
        let Some(fields) = self.value().as_table() else {
            let found = kind_of(self.value());
            report.error(self.place(), format!("{what} must be a table, not {found}"));
            return None;
        };
        let table = Table { fields, place: self.place() };
        table.check(what, required, optional, report);
        Some(table)
    }
}

impl<'t> Table<'t> {
    /// The whole document.
    pub(crate) fn document(
        fields: &'t DeTable<'t>,
        required: &[&'static str],
        optional: &[&'static str],
        report: &mut Report,
    ) -> Table<'t> {
        let table = Table { fields, place: 0..0 };
        table.check("the scene", required, optional, report);
        table
    }

    pub(crate) fn get(&self, key: &str) -> Option<Node<'t>> {
        self.fields.get_key_value(key).map(|(key, value)| Node { key, value })
    }

    pub(crate) fn entries(&self) -> impl Iterator<Item = Node<'t>> + use<'t> {
        Node::of_table(self.fields)
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.fields.is_empty()
    }

    fn check(&self, what: &str, required: &[&'static str], optional: &[&'static str], report: &mut Report) {
        // A misspelt key is not reported a second time as the missing one that it was meant to be.
        let mut meant = Vec::new();
        for node in self.entries() {
            let name = node.name();
            let known = required.iter().chain(optional).copied();
            if known.clone().any(|k| k == name) {
                continue;
            }
            meant.extend(suggest::nearest(name, known.clone()));
            let advice = suggest::advice(name, known, "it takes no keys");
            report.error(node.key.span(), format!("unknown key `{name}` in {what}: {advice}"));
        }
        let missing: Vec<&str> =
            required.iter().copied().filter(|key| self.get(key).is_none() && !meant.contains(key)).collect();
        if !missing.is_empty() {
            report.error(self.place.clone(), format!("{what} lacks `{}`", missing.join("`, `")));
        }
    }
}

/// The number, if it is one and finite.
fn finite(name: &str, value: &Spanned<DeValue<'_>>, report: &mut Report) -> Option<f64> {
    let (number, digits) = match value.get_ref() {
        DeValue::Float(digits) => (digits.as_str().parse().ok(), digits.as_str()),
        DeValue::Integer(digits) if digits.radix() == 10 => (digits.as_str().parse().ok(), digits.as_str()),
        // An i128 rounds to the nearest f64; longer than that no one writes in hexadecimal.
        DeValue::Integer(digits) => (
            i128::from_str_radix(digits.as_str(), digits.radix()).ok().map(|whole| whole as f64),
            digits.as_str(),
        ),
        other => {
            let found = kind_of(other);
            report.error(value.span(), format!("`{name}` must hold numbers only, not {found}"));
            return None;
        }
    };
    match number {
        Some(number) if f64::is_finite(number) => Some(number),
        Some(_) if digits.contains("inf") || digits.contains("nan") => {
            report.error(value.span(), format!("`{name}` must be finite, got {digits}"));
            None
        }
        _ => {
            let shown: String = digits.chars().take(40).collect();
            let message = format!("`{name}` is out of range: {shown} exceeds 1.8e308, the largest number");
            report.error(value.span(), message);
            None
        }
    }
}
