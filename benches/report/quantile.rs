//! Quantiles of errors, and how they are printed.

/// Count, median, 99th percentile and maximum of a set of errors, in units of 2^-53.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// How many errors there are.
    pub count: usize,
    /// How many answers had a wrong count of hits or roots: these have no error.
    pub wrong: usize,
    /// The median.
    pub median: f64,
    /// The 99th percentile.
    pub p99: f64,
    /// The largest.
    pub max: f64,
}

impl Errors {
    /// From single errors, in any order; NaN counts as infinite.
    pub fn of(mut errors: Vec<f64>, wrong: usize) -> Errors {
        for e in &mut errors {
            if e.is_nan() {
                *e = f64::INFINITY;
            }
        }
        errors.sort_by(f64::total_cmp);
        let at = |q: f64| {
            let rank = (q * errors.len() as f64).ceil() as usize;
            errors.get(rank.max(1) - 1).copied().unwrap_or(f64::NAN)
        };
        Errors { count: errors.len(), wrong, median: at(0.5), p99: at(0.99), max: at(1.0) }
    }
}

/// A number at three significant digits, plain between 0.01 and 10 000; a dash for NaN, which says that there is none.
pub fn brief(x: f64) -> String {
    match x {
        0.0 => "0".into(),
        x if x.is_nan() => "-".into(),
        x if x.is_infinite() => "inf".into(),
        x if (1e-2..1e4).contains(&x.abs()) => {
            let digits = (2 - x.abs().log10().floor() as i32).max(0) as usize;
            format!("{x:.digits$}")
        }
        x => format!("{x:.1e}"),
    }
}
