//! Where the report goes: standard output, `target/report`, and the summary in README.md.

use crate::Effort;
use crate::table::Table;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{fs, io};

/// The markers in README.md between which the summary stands.
const BEGIN: &str = "<!-- report: begin -->";
const END: &str = "<!-- report: end -->";

/// Collects tables, plots and complaints.
pub struct Output {
    folder: PathBuf,
    origin: String,
    markdown: String,
    summary: String,
    complaints: Vec<String>,
    refused: Vec<String>,
}

impl Output {
    /// An empty report about this machine.
    pub fn new(effort: Effort) -> io::Result<Output> {
        let folder = root().join("target/report");
        fs::create_dir_all(&folder)?;
        let origin = origin(effort);
        println!("{origin}\n");
        let markdown = format!("# Speed against error\n\n{origin}\n\n");
        Ok(Output { folder, origin, markdown, summary: String::new(), complaints: vec![], refused: vec![] })
    }

    /// Prints a table and keeps it as Markdown and CSV.
    pub fn table(&mut self, table: Table) {
        println!("{}", table.text());
        let _ = write!(self.markdown, "## {}\n\n{}\n", table.title, table.markdown());
        self.csv_only(table);
    }

    /// The same, and the table becomes part of the summary in README.md.
    pub fn summary(&mut self, table: Table) {
        let _ = write!(self.summary, "\n{}\n", table.markdown());
        self.table(table);
    }

    /// Keeps a table as CSV only: it is too long to read.
    pub fn csv_only(&mut self, table: Table) {
        let path = self.folder.join(format!("{}.csv", table.name));
        let written = fs::write(&path, table.csv(&self.origin));
        self.demand(written.is_ok(), || format!("{}: cannot be written", path.display()));
    }

    /// Draws a plot.
    pub fn plot(&mut self, name: &str, draw: impl FnOnce(&Path) -> Result<(), Box<dyn std::error::Error>>) {
        let path = self.folder.join(format!("{name}.svg"));
        let drawn = draw(&path);
        self.demand(drawn.is_ok(), || format!("{}: {:?}", path.display(), drawn.as_ref().err()));
        let _ = write!(self.markdown, "![{name}]({name}.svg)\n\n");
    }

    /// Complains unless the condition holds: the run then fails at its end.
    pub fn demand(&mut self, holds: bool, complaint: impl FnOnce() -> String) {
        if !holds {
            let complaint = complaint();
            eprintln!("WRONG: {complaint}");
            self.complaints.push(complaint);
        }
    }

    /// Notes a row that the clock could not resolve.
    pub fn refuse(&mut self, row: String) {
        eprintln!("refused: {row}");
        self.refused.push(row);
    }

    /// Writes the Markdown and, on demand, the README's summary. False when an answer was wrong.
    pub fn finish(mut self, readme: bool) -> io::Result<bool> {
        if !self.refused.is_empty() {
            let _ = write!(self.markdown, "## Refused: under 1000 ticks of the clock\n\n");
            for row in &self.refused {
                let _ = writeln!(self.markdown, "- {row}");
            }
        }
        fs::write(self.folder.join("report.md"), &self.markdown)?;
        println!("tables and plots: target/report");
        if readme && self.complaints.is_empty() {
            let path = root().join("README.md");
            let text = fs::read_to_string(&path)?;
            let spliced = splice(&text, &format!("\n{}\n{}", self.origin, self.summary));
            let spliced = spliced.ok_or_else(|| io::Error::other("README.md lacks the report's markers"))?;
            fs::write(&path, spliced)?;
            println!("README.md: summary replaced");
        }
        for complaint in &self.complaints {
            println!("WRONG: {complaint}");
        }
        println!("{} wrong answers", self.complaints.len());
        Ok(self.complaints.is_empty())
    }
}

/// The text with `summary` between the markers.
pub fn splice(text: &str, summary: &str) -> Option<String> {
    let begin = text.find(BEGIN)? + BEGIN.len();
    let end = begin + text[begin..].find(END)?;
    Some(format!("{}{summary}{}", &text[..begin], &text[end..]))
}

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// Machine, compiler, commit and date.
fn origin(effort: Effort) -> String {
    let run = |program: &str, arguments: &[&str]| {
        let output = Command::new(program).args(arguments).current_dir(root()).output().ok()?;
        output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_string())
    };
    let cpu = fs::read_to_string("/proc/cpuinfo")
        .ok()
        .and_then(|text| {
            Some(text.lines().find(|l| l.starts_with("model name"))?.split_once(':')?.1.trim().to_string())
        })
        .unwrap_or_else(|| std::env::consts::ARCH.into());
    let threads = std::thread::available_parallelism().map_or(1, |n| n.get());
    let rustc = run("rustc", &["--version"]).unwrap_or_else(|| "unknown compiler".into());
    let commit = run("git", &["describe", "--always", "--dirty"]).unwrap_or_else(|| "no commit".into());
    let date = run("date", &["-u", "+%Y-%m-%d"]).unwrap_or_else(|| "no date".into());
    let effort = match effort {
        Effort::Quick => "quick run",
        Effort::Full => "full run",
    };
    format!("{cpu}, {threads} hardware threads, {rustc}, commit {commit}, {date}, {effort}, default build")
}
