//! What an answer is worth: the judgements that stand behind every row, and the promises that ours must keep.

use crate::quantile::Errors;
use crate::truth::{QuarticCase, RayCase, UNIT};

/// Error of a first hit as a distance off the surface in units of the local scale; `None`: the count is wrong.
pub fn first_hit(case: &RayCase, answer: Option<f64>) -> Option<Option<f64>> {
    match (case.hits.first(), answer) {
        (None, None) => Some(None),
        (Some(t), Some(a)) => Some(Some(t.distance(a) * case.off_surface[0])),
        _ => None,
    }
}

/// The promise of `surface`: no wrong count, and within 4 units of the local scale.
pub fn surface_holds(errors: &Errors) -> bool {
    errors.wrong == 0 && (errors.count == 0 || errors.max <= 4.0)
}

/// The promise of the quartic: no wrong count, and each simple root within 2 units.
pub fn roots_hold(errors: &Errors) -> bool {
    errors.wrong == 0 && (errors.count == 0 || errors.max <= 2.0)
}

/// What the answers of one solver are worth.
#[derive(Default)]
pub struct Tally {
    /// How many quartics were solved.
    pub rows: usize,
    /// How many had a wrong count of roots.
    pub wrong: usize,
    /// How many of these had a count that no relative change of the coefficients by 64 units could alter.
    pub wrong_without_excuse: usize,
    /// The relative errors of simple roots, in units of 2^-53.
    pub errors: Vec<f64>,
}

impl Tally {
    /// Compares roots and multiplicities with the truth: the count as distinct roots or with multiplicity, then simple
    /// roots one by one.
    pub fn add(&mut self, case: &QuarticCase, found: &[(f64, u32)]) {
        self.rows += 1;
        let simple = case.roots.iter().all(|r| r.1 == 1);
        let distinct = found.len() == case.roots.len() && !(simple && found.iter().any(|r| r.1 != 1));
        let total: u32 = found.iter().map(|r| r.1).sum();
        let counted = !simple && total == case.roots.iter().map(|r| r.1).sum::<u32>();
        if !(distinct || counted) {
            self.wrong += 1;
            self.wrong_without_excuse += usize::from(case.margin > 64.0 * UNIT);
        } else if distinct {
            for ((x, _), (truth, multiplicity)) in found.iter().zip(&case.roots) {
                if *multiplicity == 1 {
                    let error = truth.distance(*x);
                    self.errors.push(if error == 0.0 { 0.0 } else { error / truth.nearest.abs() / UNIT });
                }
            }
        }
    }
}
