//! The command `rt`: reads files, calls the libraries, writes files.
#![forbid(unsafe_code)]

mod cast;
mod check;
mod failure;
mod interrupt;
mod lines;
mod output;
mod picture_file;
mod place;
mod progress;
mod render;
mod roots;
mod scene_file;
mod stitch;
mod usage;

use clap::{CommandFactory, Parser, Subcommand};
use failure::Failure;
use std::path::PathBuf;
use std::process::ExitCode;

const EXAMPLES: &str = "\
Examples:
  rt render scenes/family.toml -o family.png
  rt check scenes/family.toml
  rt cast < rays.jsonl > hits.jsonl
  echo '{\"c\": [24, -50, 35, -10, 1]}' | rt roots

Exit codes: 0 done, 1 input/output or rendering failed, 2 wrong usage, 3 bad scene or input,
130 or 143 interrupted (what was finished is written first).";

/// Exact, fast ray tracing of analytic shapes
#[derive(Parser)]
#[command(name = "rt", version, after_help = EXAMPLES, arg_required_else_help = true)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Render a scene into a picture
    #[command(after_help = RENDER_EXAMPLES)]
    Render(Box<render::Options>),
    /// Find all errors of a scene without rendering it
    #[command(after_help = CHECK_EXAMPLES)]
    Check {
        /// The scene, .toml or .nff; `-` reads TOML from standard input
        scene: PathBuf,
        /// Say nothing but errors
        #[arg(short, long)]
        quiet: bool,
    },
    /// Cast rays given as JSON lines on standard input; hits come as JSON lines
    #[command(after_help = CAST_EXAMPLES)]
    Cast {
        /// Answer with the nearest hit alone
        #[arg(long)]
        first: bool,
        /// Cast all rays at this scene; hits then carry the name of the "object", and lines no "shape"
        #[arg(long, value_name = "SCENE")]
        scene: Option<PathBuf>,
    },
    /// Find the real roots of quartics given as JSON lines on standard input
    #[command(after_help = ROOTS_EXAMPLES)]
    Roots {
        /// The method
        #[arg(long, value_enum, default_value = "ours")]
        solver: roots::Solver,
    },
    /// Put the parts of a picture together, rendered with `rt render --tile K/N`
    #[command(after_help = STITCH_EXAMPLES)]
    Stitch {
        /// The parts, in any order
        #[arg(required = true, value_name = "PART")]
        parts: Vec<PathBuf>,
        /// The picture: of the same kind as the parts
        #[arg(short, long, value_name = "OUT")]
        output: PathBuf,
    },
    /// Print a completion script for a shell
    #[command(after_help = "Example:\n  rt completions bash > ~/.local/share/bash-completion/completions/rt")]
    Completions {
        /// The shell
        #[arg(value_enum)]
        shell: clap_complete::Shell,
    },
}

const RENDER_EXAMPLES: &str = "\
The picture appears under its name when it is whole; until then the old file stays. The first Ctrl-C (or SIGTERM)
finishes the tiles in flight and writes what there is, the second quits at once.

Examples:
  rt render scenes/family.toml -o family.png
  rt render scenes/family.toml -o small.png --width 200 --height 200 --aa none
  rt render scenes/family.toml -o - | display
  rt render scenes/family.toml -o part-3.png --tile 3/8";

const CHECK_EXAMPLES: &str = "\
Errors go to standard error as file:line:column: error: ..., with the source line below. Exit code 0: none, 3: some,
1: the file cannot be read.

Examples:
  rt check scenes/family.toml
  for scene in scenes/*.toml; do rt check --quiet $scene || break; done";

const STITCH_EXAMPLES: &str = "\
The result is the same, bit for bit, as if the picture had been rendered at once. All parts must be there, finished,
and of the same scene and options.

Examples:
  for k in $(seq 8); do rt render scenes/family.toml -o part-$k.png --tile $k/8; done
  rt stitch part-*.png -o family.png";

const CAST_EXAMPLES: &str = "\
A line asks
  {\"id\": 1, \"shape\": {\"sphere\": {\"center\": [0, 0, 0], \"radius\": 1}},
   \"origin\": [0, 0, -5], \"direction\": [0, 0, 1], \"t_min\": 0, \"t_max\": 1e308}
(on one line; t_min defaults to 0, t_max to no limit) and is answered by
  {\"id\":1,\"hits\":[{\"t\":4.0,\"normal\":[0.0,0.0,-1.0],\"point\":[0.0,0.0,-1.0]},...]}
with every crossing strictly between t_min and t_max, ascending.

Examples:
  rt cast < rays.jsonl > hits.jsonl
  rt cast --first < rays.jsonl
  rt cast --scene scenes/family.toml < rays.jsonl";

const ROOTS_EXAMPLES: &str = "\
A line gives the coefficients in ascending powers, {\"c\": [c0, c1, c2, c3, c4]}; the answer lists each
real root with its multiplicity, ascending: {\"roots\":[[1.0,1],[2.0,1]]}. The zero polynomial, of which
every number is a root, is answered by {\"roots\":[],\"all\":true}.

Examples:
  echo '{\"c\": [24, -50, 35, -10, 1]}' | rt roots
  rt roots --solver ferrari < quartics.jsonl";

fn main() -> ExitCode {
    // Prints help, version and usage errors itself: exit code 2 for the last.
    let arguments = Arguments::try_parse().unwrap_or_else(|mut error| {
        usage::add_tip(&mut error);
        error.exit()
    });
    match run(arguments.command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            if let Some(text) = failure.report() {
                use std::io::Write;
                // When even standard error is closed, the exit code still tells.
                let _ = writeln!(std::io::stderr(), "{text}");
            }
            ExitCode::from(failure.exit_code())
        }
    }
}

fn run(command: Command) -> Result<(), Failure> {
    match command {
        Command::Render(options) => render::run(&options),
        Command::Check { scene, quiet } => check::run(&scene, quiet),
        Command::Stitch { parts, output } => stitch::run(&parts, &output),
        Command::Cast { first, scene } => {
            let target = match scene {
                Some(path) => cast::Target::Scene(Box::new(scene_file::load(&path)?)),
                None => cast::Target::Lines,
            };
            cast::run(&target, first)
        }
        Command::Roots { solver } => roots::run(solver),
        Command::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut Arguments::command(), "rt", &mut script);
            std::io::Write::write_all(&mut std::io::stdout(), &script).map_err(Failure::stdout)
        }
    }
}
