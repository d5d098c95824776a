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
    done: u64,
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
        Listener { show, start, last: Mutex::new(Last { done: 0, tenth: 0, time: start }) }
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

    /// Writes a line when `done` of `total` is worth one: at each tenth, but not within `least` of the line before,
    /// and after `most` at any rate. Threads may report out of order; lines never go back.
    fn line(&self, done: u64, total: u64, [least, most]: [Duration; 2], text: impl FnOnce() -> String) {
        let Ok(mut last) = self.last.lock() else { return };
        let tenth = 10 * done / total.max(1);
        let since = last.time.elapsed();
        if done > last.done && ((tenth > last.tenth && since >= least) || since >= most) {
            *last = Last { done, tenth, time: Instant::now() };
            // When standard error is closed nobody looks on; the rendering goes on.
            let _ = writeln!(std::io::stderr(), "{}", text());
        }
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
        match &self.show {
            Show::Nothing => {}
            Show::Bar(bar) => {
                bar.set_length(total);
                bar.set_position(done);
                bar.set_message(rate(rays, elapsed));
            }
            Show::Plain(least) => self.line(done, total, [*least, Duration::from_secs(30)], || {
                format!("{percent}% done, {}, {left:.0} s left", rate(rays, elapsed))
            }),
            Show::Json => self.line(done, total, [Duration::ZERO, Duration::from_secs(1)], || {
                let per_second = rays as f64 / elapsed.as_secs_f64().max(1e-9);
                let line = serde_json::json!({
                    "done": done, "total": total, "percent": percent, "rays": rays,
                    "rays_per_s": per_second.round(), "elapsed_s": elapsed.as_secs_f64(), "left_s": left,
                });
                line.to_string()
            }),
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
        let hour = Duration::from_secs(3600);
        let count = |reports: &mut dyn Iterator<Item = u64>, total: u64, least: Duration| {
            let (listener, mut lines) = (Listener::new(Mode::Plain, true), 0);
            for done in reports {
                listener.line(done, total, [least, hour], || {
                    lines += 1;
                    format!("test: {done} of {total}")
                });
            }
            lines
        };
        assert_eq!(count(&mut (1..=1000), 1000, Duration::ZERO), 10);
        assert_eq!(count(&mut (1..=1000), 1000, hour), 0);
        // The last two tiles are reported the wrong way round.
        assert_eq!(count(&mut [6, 5, 7, 6].into_iter(), 7, Duration::ZERO), 2);
        assert_eq!(count(&mut [0].into_iter(), 0, Duration::ZERO), 0);
    }

    #[test]
    fn rates_in_words() {
        assert_eq!(rate(1_500_000, Duration::from_secs(1)), "1.50 Mrays/s");
        assert_eq!(rate(1_500, Duration::from_secs(1)), "1.5 krays/s");
    }
}
