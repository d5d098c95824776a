//! The words and numbers of an NFF file: separated by white space, `#` starts a comment to the end of the line.

use std::ops::Range;

/// A word or number and where it stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Token<'a> {
    pub(super) text: &'a str,
    pub(super) start: usize,
}

impl Token<'_> {
    pub(super) fn span(&self) -> Range<usize> {
        self.start..self.start + self.text.len()
    }

    /// Whether it starts as a number does. `nan` and `inf` are taken for numbers too: they stand in the place of one.
    pub(super) fn is_numeric(&self) -> bool {
        let first = self.text.as_bytes().first().copied().unwrap_or(0);
        first.is_ascii_digit() || matches!(first, b'+' | b'-' | b'.') || self.text.parse::<f64>().is_ok()
    }
}

/// The tokens of a text, one by one, with a look at the next.
pub(super) struct Tokens<'a> {
    text: &'a str,
    at: usize,
}

impl<'a> Tokens<'a> {
    pub(super) fn new(text: &'a str) -> Tokens<'a> {
        Tokens { text, at: 0 }
    }

    /// The next token, which stays the next.
    pub(super) fn peek(&mut self) -> Option<Token<'a>> {
        let bytes = self.text.as_bytes();
        loop {
            match bytes.get(self.at)? {
                b'#' => {
                    let rest = &bytes[self.at..];
                    self.at += rest.iter().position(|&b| b == b'\n').unwrap_or(rest.len());
                }
                b if is_space(*b) => self.at += 1,
                _ => break,
            }
        }
        let rest = &bytes[self.at..];
        let length = rest.iter().position(|&b| is_space(b) || b == b'#').unwrap_or(rest.len());
        // Both ends are at ASCII bytes or at the end, never within a character.
        Some(Token { text: self.text.get(self.at..self.at + length)?, start: self.at })
    }

    pub(super) fn next(&mut self) -> Option<Token<'a>> {
        let token = self.peek()?;
        self.at = token.start + token.text.len();
        Some(token)
    }

    /// The place of the next token, or of the end of the text.
    pub(super) fn place(&mut self) -> Range<usize> {
        self.peek().map_or(self.text.len()..self.text.len(), |token| token.span())
    }
}

/// White space of C's `scanf`.
fn is_space(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\n' | b'\r' | 0x0b | 0x0c)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_numbers_and_comments() {
        let mut tokens = Tokens::new("# head\n s 1\t-2.5e3#tail\r\n\x0c ä # end");
        let mut all = Vec::new();
        while let Some(token) = tokens.next() {
            all.push((token.text, token.start, token.is_numeric()));
        }
        assert_eq!(all, [("s", 8, false), ("1", 10, true), ("-2.5e3", 12, true), ("ä", 27, false)]);
        assert_eq!(tokens.place(), 35..35);
        assert!(Tokens::new("nan").next().unwrap().is_numeric());
    }
}
