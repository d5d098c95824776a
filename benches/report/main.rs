//! The report: speed against error, in one run.
//!
//! `cargo bench --bench report` measures quartic solvers, shapes, acceleration and anti-aliasing. Tables go to standard
//! output; CSV, Markdown and SVG under `target/report`. `-- --quick` takes under a minute; `-- --readme` puts the
//! summary into README.md between its markers.
// Printing and plotting only: these numbers never reach a picture.
#![allow(clippy::disallowed_methods)]

mod acceleration;
mod antialias;
mod clock;
mod output;
mod plot;
mod quantile;
mod quartics;
mod shapes;
mod table;
mod textbook;
mod truth;
mod verdict;

pub use output::Output;
use std::process::ExitCode;
use std::time::Duration;

/// How long to measure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// Under a minute in all.
    Quick,
    /// Under ten minutes in all.
    Full,
}

impl Effort {
    /// Rounds of each comparison: an odd number, so that the median is one of them.
    pub fn rounds(self) -> usize {
        match self {
            Effort::Quick => 5,
            Effort::Full => 15,
        }
    }

    /// The length of a round of one method.
    pub fn round(self) -> Duration {
        match self {
            Effort::Quick => Duration::from_millis(4),
            Effort::Full => Duration::from_millis(20),
        }
    }
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let has = |name: &str| arguments.iter().any(|a| a == name);
    if has("--test") || has("--list") {
        // `cargo test --benches` and listing tools: nothing to measure.
        return ExitCode::SUCCESS;
    }
    let effort = if has("--quick") { Effort::Quick } else { Effort::Full };
    let mut output = match Output::new(effort) {
        Ok(output) => output,
        Err(error) => {
            eprintln!("report: {error}");
            return ExitCode::FAILURE;
        }
    };
    quartics::run(effort, &mut output);
    shapes::run(effort, &mut output);
    acceleration::run(effort, &mut output);
    antialias::run(effort, &mut output);
    match output.finish(has("--readme")) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("report: {error}");
            ExitCode::FAILURE
        }
    }
}
