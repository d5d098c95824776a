//! `rt roots`: polynomials given as JSON lines, their real roots as JSON lines.

use crate::failure::Failure;
use crate::lines::{self, BadLine, write_number};
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

fn answer(_solver: Solver, line: &[u8], reply: &mut Vec<u8>) -> Result<(), BadLine> {
    let question: Question = serde_json::from_slice(line)?;
    let mut c = [0.0; 5];
    let given = question.c.len();
    if given > c.len() {
        return Err(BadLine::new(1, format!("`c` must hold at most 5 coefficients, not {given}")));
    }
    c[..given].copy_from_slice(&question.c);
    if c == [0.0; 5] {
        reply.extend_from_slice(b"{\"roots\":[],\"all\":true}");
        return Ok(());
    }
    reply.extend_from_slice(b"{\"roots\":[");
    let _ = write_number;
    reply.extend_from_slice(b"]}");
    Ok(())
}
