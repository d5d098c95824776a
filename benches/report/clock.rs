//! Timing that refuses to report what the clock cannot resolve.

use std::hint::black_box;
use std::time::{Duration, Instant};

/// How long one unit of work took: median over rounds, and the spread.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timing {
    /// Median, in nanoseconds per unit.
    pub median: f64,
    /// The fastest round.
    pub low: f64,
    /// The slowest round.
    pub high: f64,
}

/// Why a row has no time.
#[derive(Clone, Debug, PartialEq)]
pub enum Refused {
    /// One pass was shorter than 1000 ticks of the clock.
    TooShort {
        /// How long the pass took.
        pass: Duration,
        /// The smallest step of the clock seen.
        tick: Duration,
    },
}

/// The smallest step between two readings that differ: the least of many, so an interruption cannot enlarge it.
pub fn tick() -> Duration {
    let step = || {
        let start = Instant::now();
        loop {
            let step = start.elapsed();
            if !step.is_zero() {
                return step;
            }
        }
    };
    (0..1000).map(|_| step()).min().unwrap_or_default()
}

/// One pass of a method over its input. The return value is what keeps the optimiser from dropping the work.
pub type Pass<'a> = Box<dyn FnMut() -> f64 + 'a>;

/// Times several methods on the same input, in turns: what disturbs one round disturbs all methods alike.
///
/// Each method is repeated within a round until a round is at least `round` long; `units` is how many results one
/// pass gives. A method whose round stays under 1000 ticks is refused.
pub fn compare(
    methods: &mut [Pass],
    units: usize,
    rounds: usize,
    round: Duration,
) -> Vec<Result<Timing, Refused>> {
    let tick = tick();
    let mut repeats = Vec::new();
    for pass in methods.iter_mut() {
        black_box(pass());
        let start = Instant::now();
        black_box(pass());
        let once = start.elapsed().max(Duration::from_nanos(1));
        repeats.push(((round.as_nanos() / once.as_nanos()) as usize).clamp(1, 1_000_000));
    }
    let mut samples = vec![Vec::new(); methods.len()];
    for _ in 0..rounds {
        for ((pass, &repeat), samples) in methods.iter_mut().zip(&repeats).zip(&mut samples) {
            let start = Instant::now();
            for _ in 0..repeat {
                black_box(pass());
            }
            samples.push(start.elapsed());
        }
    }
    samples
        .into_iter()
        .zip(repeats)
        .map(|(mut samples, repeat)| judge(&mut samples, repeat * units, tick))
        .collect()
}

/// The timing of one method from its rounds, or the refusal.
pub fn judge(samples: &mut [Duration], units: usize, tick: Duration) -> Result<Timing, Refused> {
    samples.sort();
    let per_unit = |d: Duration| d.as_nanos() as f64 / units as f64;
    let (low, median, high) = (samples[0], samples[samples.len() / 2], samples[samples.len() - 1]);
    if low < tick * 1000 {
        return Err(Refused::TooShort { pass: low, tick });
    }
    Ok(Timing { median: per_unit(median), low: per_unit(low), high: per_unit(high) })
}
