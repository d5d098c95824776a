//! How far a rendering is: a bar on a terminal, plain lines in a log, JSON lines for programs. All on standard error.

use crate::interrupt;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use rt_shade::Progress;
use std::io::{IsTerminal, Write};
use std::sync::Mutex;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// What `--progress` takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Mode {
    /// A bar on a terminal, plain lines elsewhere
    Auto,
    /// A line every 10 % or 30 s
    Plain,
    /// JSON lines
    Json,
    /// Nothing
    None,
}

/// Listens to the renderer.
pub struct Listener {
    show: Show,
    start: Instant,
    last: Mutex<Last>,
}

enum Show {
    Nothing,
    Bar(ProgressBar),
    /// With the shortest time between two lines.
    Plain(Duration),
    Json,
}

struct Last {
    tenth: u64,
    time: Instant,
}

impl Listener {
    pub fn new(mode: Mode, quiet: bool) -> Listener {
        let terminal =
            std::io::stderr().is_terminal() && std::env::var_os("TERM").is_none_or(|t| t != "dumb");
        let show = match mode {
            _ if quiet => Show::Nothing,
            Mode::None => Show::Nothing,
            Mode::Json => Show::Json,
            Mode::Plain => Show::Plain(Duration::ZERO),
            Mode::Auto if terminal => Show::Bar(bar()),
            // A short rendering does not fill a log.
            Mode::Auto => Show::Plain(Duration::from_secs(1)),
        };
        let start = Instant::now();
        Listener { show, start, last: Mutex::new(Last { tenth: 0, time: start }) }
    }

    /// Ends the display.
    pub fn finish(&self) {
        if let Show::Bar(bar) = &self.show {
            bar.finish_and_clear();
        }
    }

    /// Whether a closing sentence is wanted.
    pub fn talks(&self) -> bool {
        matches!(self.show, Show::Bar(_) | Show::Plain(_))
    }

    /// Whether `done` of `total` deserves a line, and notes that it was written. `every` in tenths of the whole.
    fn due(&self, done: u64, total: u64, least: Duration, most: Duration) -> bool {
        let Ok(mut last) = self.last.lock() else { return false };
        let tenth = 10 * done / total.max(1);
        let since = last.time.elapsed();
        let due = (tenth > last.tenth && since >= least) || since >= most;
        if due {
            *last = Last { tenth, time: Instant::now() };
        }
        due
    }
}

fn bar() -> ProgressBar {
    let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
    let style = ProgressStyle::with_template("{bar:40} {percent:>3}%  {msg}  {elapsed} gone, {eta} left");
    if let Ok(style) = style {
        bar.set_style(style);
    }
    bar
}

/// Rays a second in words.
pub fn rate(rays: u64, time: Duration) -> String {
    let per_second = rays as f64 / time.as_secs_f64().max(1e-9);
    match per_second {
        r if r >= 1e6 => format!("{:.2} Mrays/s", r / 1e6),
        r => format!("{:.1} krays/s", r / 1e3),
    }
}

impl Progress for Listener {
    fn tile(&self, done: u64, total: u64, rays: u64) {
        let elapsed = self.start.elapsed();
        let left = elapsed.as_secs_f64() * (total.saturating_sub(done)) as f64 / done.max(1) as f64;
        let percent = 100 * done / total.max(1);
        // When standard error is closed nobody looks on; the rendering goes on.
        match &self.show {
            Show::Nothing => {}
            Show::Bar(bar) => {
                bar.set_length(total);
                bar.set_position(done);
                bar.set_message(rate(rays, elapsed));
            }
            Show::Plain(least) => {
                if self.due(done, total, *least, Duration::from_secs(30)) {
                    let rate = rate(rays, elapsed);
                    let _ = writeln!(std::io::stderr(), "{percent}% done, {rate}, {left:.0} s left");
                }
            }
            Show::Json => {
                if self.due(done, total, Duration::ZERO, Duration::from_secs(1)) {
                    let per_second = rays as f64 / elapsed.as_secs_f64().max(1e-9);
                    let line = serde_json::json!({
                        "done": done, "total": total, "percent": percent, "rays": rays,
                        "rays_per_s": per_second.round(), "elapsed_s": elapsed.as_secs_f64(), "left_s": left,
                    });
                    let _ = writeln!(std::io::stderr(), "{line}");
                }
            }
        }
    }

    fn cancelled(&self) -> bool {
        interrupt::STOP.load(Ordering::Relaxed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_for_each_tenth_and_no_more() {
        let listener = Listener::new(Mode::Plain, false);
        let hour = Duration::from_secs(3600);
        let lines = (1..=1000).filter(|&done| listener.due(done, 1000, Duration::ZERO, hour)).count();
        assert_eq!(lines, 10);
        let listener = Listener::new(Mode::Plain, false);
        assert_eq!((1..=1000).filter(|&done| listener.due(done, 1000, hour, hour)).count(), 0);
        assert!(!listener.due(0, 0, Duration::ZERO, hour));
    }

    #[test]
    fn rates_in_words() {
        assert_eq!(rate(1_500_000, Duration::from_secs(1)), "1.50 Mrays/s");
        assert_eq!(rate(1_500, Duration::from_secs(1)), "1.5 krays/s");
    }
}
