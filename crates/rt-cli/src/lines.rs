//! JSON lines: one question a line on standard input, one answer a line on standard output.

use crate::failure::Failure;
use std::io::{self, BufRead, Read, Write};

/// The longest line that is accepted. A question takes some hundred bytes; without a limit a file without line ends
/// would fill the memory.
const LONGEST: u64 = 16 << 20;

/// What is wrong with a line, and at which column (counted in bytes from 1).
#[derive(Debug, PartialEq)]
pub struct BadLine {
    pub column: usize,
    pub message: String,
}

impl BadLine {
    pub fn new(column: usize, message: impl Into<String>) -> Self {
        BadLine { column, message: message.into() }
    }
}

impl From<serde_json::Error> for BadLine {
    fn from(error: serde_json::Error) -> Self {
        let text = error.to_string();
        // The parser sees one line at a time: its own place would read "line 1".
        let message = text.rsplit_once(" at line ").map_or(text.as_str(), |(message, _)| message);
        BadLine::new(error.column().max(1), message)
    }
}

/// Answers each line of `input` on `output` until the input ends.
///
/// Answers are buffered, but whenever the next question has not arrived yet all answers so far are sent, so that
/// a program that asks one question at a time gets its answers.
///
/// # Errors
/// The first bad line ends the work, after the answers to the lines before it. Blank lines are passed over.
pub fn answer(
    input: impl Read,
    output: impl Write,
    mut answer: impl FnMut(&[u8], &mut Vec<u8>) -> Result<(), BadLine>,
) -> Result<(), Failure> {
    let mut input = io::BufReader::with_capacity(1 << 16, input);
    let mut output = io::BufWriter::with_capacity(1 << 16, output);
    let mut question = Vec::new();
    let mut reply = Vec::new();
    let mut number = 0u64;
    loop {
        if !input.buffer().contains(&b'\n') {
            output.flush().map_err(Failure::stdout)?;
        }
        question.clear();
        let read = (&mut input).take(LONGEST + 1).read_until(b'\n', &mut question);
        let read = read.map_err(|source| Failure::Stream { action: "read standard input", source })?;
        if read == 0 {
            return output.flush().map_err(Failure::stdout);
        }
        number += 1;
        let result = if read as u64 > LONGEST {
            Err(BadLine::new(1, "the line is longer than 16 MiB"))
        } else {
            let line = question.trim_ascii_end();
            if line.is_empty() {
                continue;
            }
            reply.clear();
            answer(line, &mut reply)
        };
        if let Err(BadLine { column, message }) = result {
            output.flush().map_err(Failure::stdout)?;
            return Err(Failure::Input(format!("<stdin>:{number}:{column}: error: {message}")));
        }
        reply.push(b'\n');
        output.write_all(&reply).map_err(Failure::stdout)?;
    }
}

/// Writes a number as the shortest text that reads back to the same bits; `null` for NaN and infinities, which JSON
/// cannot hold.
pub fn write_number(x: f64, to: &mut Vec<u8>) {
    // Writing to a vector does not fail.
    let _ = serde_json::to_writer(to, &x);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn echo(line: &[u8], reply: &mut Vec<u8>) -> Result<(), BadLine> {
        if line == b"bad" {
            return Err(BadLine::new(2, "no good"));
        }
        reply.extend_from_slice(line);
        Ok(())
    }

    #[test]
    fn the_lines_before_a_bad_one_are_answered() {
        let mut out = Vec::new();
        let failure = answer(&b"one\n\r\ntwo\nbad\nthree\n"[..], &mut out, echo).unwrap_err();
        assert_eq!(out, b"one\ntwo\n");
        assert_eq!(failure.to_string(), "<stdin>:4:2: error: no good");
        assert_eq!(failure.exit_code(), 3);
    }

    #[test]
    fn the_last_line_needs_no_end() {
        let mut out = Vec::new();
        answer(&b"one\ntwo"[..], &mut out, echo).unwrap();
        assert_eq!(out, b"one\ntwo\n");
    }

    #[test]
    fn numbers_keep_their_bits() {
        for x in [0.0, -0.0, 1e308, 5e-324, 0.1, -1.0 / 3.0, f64::MAX, 9007199254740993.0] {
            let mut text = Vec::new();
            write_number(x, &mut text);
            let back: f64 = serde_json::from_slice(&text).unwrap();
            assert_eq!(back.to_bits(), x.to_bits(), "{x:e}");
        }
    }
}
