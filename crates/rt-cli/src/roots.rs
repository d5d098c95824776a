//! `rt roots`: polynomials given as JSON lines, their real roots as JSON lines.

use crate::failure::Failure;
use crate::lines::{self, BadLine, write_number};
use rt_core::{Interval, poly};
use serde::Deserialize;

/// Which quartic method answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Solver {
    /// The method of this project: every root correctly rounded, or nearly so
    Ours,
    /// The textbook method of Ferrari
    Ferrari,
    /// The method of Graphics Gems I (Schwarze 1990)
    Gems,
}

impl Solver {
    fn method(self) -> poly::Method {
        match self {
            Solver::Ours => poly::Method::Certified,
            Solver::Ferrari => poly::Method::Ferrari,
            Solver::Gems => poly::Method::GraphicsGems,
        }
    }
}

#[derive(Deserialize)]
struct Question {
    c: Vec<f64>,
}

/// Reads polynomials from standard input and answers them on standard output.
pub fn run(solver: Solver) -> Result<(), Failure> {
    lines::answer(std::io::stdin().lock(), std::io::stdout().lock(), |line, reply| {
        answer(solver, line, reply)
    })
}

fn answer(solver: Solver, line: &[u8], reply: &mut Vec<u8>) -> Result<(), BadLine> {
    let question: Question = serde_json::from_slice(line)?;
    let mut c = [0.0; 5];
    let given = question.c.len();
    if given > c.len() {
        return Err(BadLine::new(1, format!("`c` must hold at most 5 coefficients, got {given}")));
    }
    c[..given].copy_from_slice(&question.c);
    let roots = poly::roots(c, Interval::LINE, solver.method());
    reply.extend_from_slice(b"{\"roots\":[");
    for (count, root) in roots.iter().enumerate() {
        reply.extend_from_slice(if count > 0 { b",[" } else { b"[" });
        write_number(root.x, reply);
        reply.extend_from_slice(format!(",{}]", root.multiplicity).as_bytes());
    }
    reply.extend_from_slice(if roots.all() { b"],\"all\":true}" } else { b"]}" });
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ask(line: &str) -> Result<String, BadLine> {
        let mut reply = Vec::new();
        answer(Solver::Ours, line.as_bytes(), &mut reply)?;
        Ok(String::from_utf8(reply).unwrap())
    }

    #[test]
    fn roots_are_listed_with_their_multiplicity() {
        let four = ask(r#"{"c": [24, -50, 35, -10, 1]}"#);
        assert_eq!(four.unwrap(), r#"{"roots":[[1.0,1],[2.0,1],[3.0,1],[4.0,1]]}"#);
        // (x - 1)^2 (x^2 + 1)
        assert_eq!(ask(r#"{"c": [1, -2, 2, -2, 1]}"#).unwrap(), r#"{"roots":[[1.0,2]]}"#);
        assert_eq!(ask(r#"{"c": [1, 0, 0, 0, 0]}"#).unwrap(), r#"{"roots":[]}"#);
    }

    #[test]
    fn the_zero_polynomial_says_so() {
        assert_eq!(ask(r#"{"c": [0, -0.0, 0, 0, 0]}"#).unwrap(), r#"{"roots":[],"all":true}"#);
    }

    #[test]
    fn bad_lines() {
        assert!(ask(r#"{"c": [1, 2, 3, 4, 5, 6]}"#).is_err());
        assert!(ask(r#"{"c": [1, 2, 3, 4, 1e400]}"#).is_err());
        assert!(ask(r#"{"c": [1, 2, 3, 4, NaN]}"#).is_err());
        assert!(ask(r#"{"d": [1]}"#).is_err());
    }
}
