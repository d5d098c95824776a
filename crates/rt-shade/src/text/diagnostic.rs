//! What is wrong with a scene's text, and where: `file:line:column: error: what is wrong and how to mend it`, with the
//! source line and a caret below.

use std::fmt;
use std::ops::Range;

/// The most errors that are kept of one file; the rest is only counted.
pub const MOST_ERRORS: usize = 20;

/// The widest piece of a source line that is shown, in characters.
const WIDEST: usize = 120;

/// One error and its place.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Diagnostic {
    /// The name of the file, as it was given to the loader.
    pub file: String,
    /// The line, counted from 1.
    pub line: usize,
    /// The column, counted from 1 in characters.
    pub column: usize,
    /// What is wrong and how to mend it.
    pub message: String,
    /// The source line, or the piece of it about the column when it is very long. Control characters are replaced.
    pub source: String,
    /// The characters of `source` to mark, counted from 0.
    pub caret: Range<usize>,
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Diagnostic { file, line, column, message, source, caret } = self;
        write!(f, "{file}:{line}:{column}: error: {message}")?;
        let number = line.to_string();
        write!(f, "\n {number} | {source}\n {:width$} | ", "", width = number.len())?;
        // Tabs stay tabs, so that the caret stands below its character whatever their width.
        for c in source.chars().take(caret.start) {
            write!(f, "{}", if c == '\t' { '\t' } else { ' ' })?;
        }
        write!(f, "{}", "^".repeat(caret.len().max(1)))
    }
}

impl std::error::Error for Diagnostic {}

/// All errors of one file in the order of their places, at most [`MOST_ERRORS`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostics {
    errors: Vec<Diagnostic>,
    more: usize,
}

impl Diagnostics {
    /// An error about the file as a whole, placed at its very beginning.
    pub fn of_file(file: &str, message: impl Into<String>) -> Diagnostics {
        Diagnostics::at(file, b"", 0, message)
    }

    /// An error at one byte of a file that need not be text.
    pub(crate) fn at(file: &str, bytes: &[u8], at: usize, message: impl Into<String>) -> Diagnostics {
        let mut report = Report { file, text: bytes, found: Vec::new(), more: 0 };
        report.error(at..at + 1, message);
        match report.finish_failed::<std::convert::Infallible>() {
            Err(diagnostics) => diagnostics,
            Ok(never) => match never {},
        }
    }

    /// How many errors were found, those that were not kept included.
    pub fn count(&self) -> usize {
        self.errors.len() + self.more
    }
}

impl std::ops::Deref for Diagnostics {
    type Target = [Diagnostic];

    fn deref(&self) -> &[Diagnostic] {
        &self.errors
    }
}

impl<'a> IntoIterator for &'a Diagnostics {
    type Item = &'a Diagnostic;
    type IntoIter = std::slice::Iter<'a, Diagnostic>;

    fn into_iter(self) -> Self::IntoIter {
        self.errors.iter()
    }
}

impl fmt::Display for Diagnostics {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, error) in self.errors.iter().enumerate() {
            if index > 0 {
                writeln!(f)?;
            }
            write!(f, "{error}")?;
        }
        if self.more > 0 {
            write!(f, "\nand {} more errors", self.more)?;
        }
        Ok(())
    }
}

impl std::error::Error for Diagnostics {}

/// Collects the errors of one text while it is read.
pub(crate) struct Report<'a> {
    file: &'a str,
    text: &'a [u8],
    /// Sorted by place, at most `MOST_ERRORS`.
    found: Vec<(Range<usize>, String)>,
    more: usize,
}

impl<'a> Report<'a> {
    pub(crate) fn new(file: &'a str, text: &'a str) -> Report<'a> {
        Report { file, text: text.as_bytes(), found: Vec::new(), more: 0 }
    }

    /// Notes an error about these bytes of the text.
    pub(crate) fn error(&mut self, span: Range<usize>, message: impl Into<String>) {
        let at = self.found.partition_point(|(other, _)| other.start <= span.start);
        if at < MOST_ERRORS {
            self.found.insert(at, (span, message.into()));
        } else {
            self.more += 1;
        }
        if self.found.len() > MOST_ERRORS {
            self.found.pop();
            self.more += 1;
        }
    }

    pub(crate) fn is_clean(&self) -> bool {
        self.found.is_empty()
    }

    /// Whether a further error at the end of the file would only be counted.
    pub(crate) fn is_full(&self) -> bool {
        self.found.len() >= MOST_ERRORS
    }

    /// The errors, of which there is at least one.
    pub(crate) fn finish_failed<T>(mut self) -> Result<T, Diagnostics> {
        if self.is_clean() {
            self.error(0..0, "the file cannot be read as a scene");
        }
        let errors = self.found.iter().map(|(span, message)| self.diagnostic(span, message)).collect();
        Err(Diagnostics { errors, more: self.more })
    }

    /// The value, or the errors if there were any.
    pub(crate) fn finish<T>(self, value: T) -> Result<T, Diagnostics> {
        if self.is_clean() {
            return Ok(value);
        }
        self.finish_failed()
    }

    fn diagnostic(&self, span: &Range<usize>, message: &str) -> Diagnostic {
        let bytes = self.text;
        let start = span.start.min(bytes.len());
        let begin = bytes[..start].iter().rposition(|&b| b == b'\n').map_or(0, |at| at + 1);
        let line = 1 + bytes[..begin].iter().filter(|&&b| b == b'\n').count();
        let rest = &bytes[begin..];
        let rest = &rest[..rest.iter().position(|&b| b == b'\n').unwrap_or(rest.len())];
        let rest = rest.strip_suffix(b"\r").unwrap_or(rest);
        // Characters are counted after mending a cut one: a span from outside may lie within a character.
        let count = |piece: &[u8]| String::from_utf8_lossy(piece).chars().count();
        let before = count(&rest[..(start - begin).min(rest.len())]);
        let end = span.end.clamp(start, begin + rest.len().max(start - begin));
        let marked = count(&bytes[start..end.max(start)]).max(1);
        let column = before + 1;
        let whole = String::from_utf8_lossy(rest);
        let (source, caret) = window(&whole, before, marked);
        let message = message.chars().map(printable).collect();
        Diagnostic { file: self.file.to_string(), line, column, message, source, caret }
    }
}

/// The line if it is short, else the piece of it about the marked characters.
fn window(line: &str, before: usize, marked: usize) -> (String, Range<usize>) {
    let length = line.chars().count();
    let from = if length <= WIDEST { 0 } else { before.saturating_sub(WIDEST / 2) };
    let mut source: String = line.chars().skip(from).take(WIDEST).map(printable).collect();
    let mut start = before - from;
    if from > 0 {
        source.insert_str(0, "... ");
        start += 4;
    }
    let shown = source.chars().count();
    if from + WIDEST < length {
        source.push_str(" ...");
    }
    (source, start..(start + marked).min(shown.max(start + 1)))
}

/// The error's own words, with numbers of very many digits in the form `1e308`.
pub(crate) fn in_words(error: &dyn fmt::Display) -> String {
    let text = error.to_string();
    let of_number = |c: char| c.is_ascii_digit() || c == '.';
    let mut words = String::with_capacity(text.len());
    let mut rest = text.as_str();
    while let Some(start) = rest.find(of_number) {
        let length = rest[start..].find(|c| !of_number(c)).unwrap_or(rest.len() - start);
        // A full stop after the number, or one without a number, is none of its digits.
        let length = rest[start..start + length].trim_end_matches('.').len().max(1);
        let (before, number) = (&rest[..start], &rest[start..start + length]);
        words.push_str(before);
        match number.parse::<f64>() {
            // No f64 has more than 17 significant digits.
            Ok(value) if length > 24 => words.push_str(&format!("{value:e}")),
            _ => words.push_str(number),
        }
        rest = &rest[start + length..];
    }
    words + rest
}

/// Control characters could do anything to a terminal.
fn printable(c: char) -> char {
    if c.is_control() && c != '\t' { '\u{fffd}' } else { c }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one(text: &str, span: Range<usize>) -> Diagnostic {
        let mut report = Report::new("f", text);
        report.error(span, "bad");
        report.finish(()).unwrap_err()[0].clone()
    }

    #[test]
    fn line_column_source_and_caret() {
        let text = "first\r\nsecond = \"ä\" ; x\r\n";
        let at = text.find('x').unwrap();
        let d = one(text, at..at + 1);
        assert_eq!((d.line, d.column), (2, 16));
        assert_eq!(d.to_string(), "f:2:16: error: bad\n 2 | second = \"ä\" ; x\n   |                ^");
        assert_eq!(one(text, 0..5).to_string(), "f:1:1: error: bad\n 1 | first\n   | ^^^^^");
    }

    #[test]
    fn places_at_and_past_the_end_and_across_lines() {
        let d = one("ab\n", 3..3);
        assert_eq!((d.line, d.column, d.caret), (2, 1, 0..1));
        let d = one("ab", 99..120);
        assert_eq!((d.line, d.column), (1, 3));
        let d = one("abc\ndef", 1..6);
        assert_eq!((d.line, d.caret), (1, 1..3));
        assert_eq!(one("", 0..0).to_string(), "f:1:1: error: bad\n 1 | \n   | ^");
        // The line feed itself, and within a character.
        assert_eq!(one("ab\r\ncd", 3..4).line, 1);
        assert_eq!(one("äb", 1..2).column, 2);
    }

    #[test]
    fn huge_and_tiny_numbers_stay_readable() {
        let of = |value: f64| in_words(&format!("radius must be less than 1.5, got {value}."));
        assert_eq!(of(-1e308), "radius must be less than 1.5, got -1e308.");
        assert_eq!(of(2.5e-310), "radius must be less than 1.5, got 2.5e-310.");
        assert_eq!(of(0.1 + 0.2), "radius must be less than 1.5, got 0.30000000000000004.");
        assert_eq!(in_words(&"no number... 7..8"), "no number... 7..8");
    }

    #[test]
    fn long_lines_are_cut_and_control_characters_replaced() {
        let text = format!("{}\u{1b}[31mX{}", "a".repeat(5000), "b".repeat(5000));
        let at = text.find('X').unwrap();
        let d = one(&text, at..at + 1);
        assert_eq!(d.column, 5006);
        assert_eq!(d.source.chars().nth(d.caret.start), Some('X'));
        assert!(d.source.chars().count() < 140 && !d.source.contains('\u{1b}'));
    }

    #[test]
    fn only_the_first_errors_are_kept() {
        let text = "x".repeat(100);
        let mut report = Report::new("f", &text);
        for at in (0..100).rev() {
            report.error(at..at + 1, format!("{at}"));
        }
        let found = report.finish(()).unwrap_err();
        assert_eq!((found.len(), found.count()), (MOST_ERRORS, 100));
        assert!(found.iter().enumerate().all(|(index, d)| d.message == index.to_string()));
        assert!(found.to_string().ends_with("\nand 80 more errors"));
    }
}
