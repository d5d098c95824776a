//! The media that a ray is in.
//!
//! A list, latest last, keyed by medium (the material), not by object: glass made of loose polygons is one medium, and
//! media that nest, touch or overlap are entered and left in any order. Where several overlap, the one entered last
//! is the one that bends light; outside all of them is vacuum, index 1.

/// The media around a point of a ray's path, the one entered last at the end.
#[derive(Clone, Debug, Default)]
pub(crate) struct Media {
    entered: Vec<Medium>,
}

/// A medium: its key and its index of refraction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Medium {
    pub key: u32,
    pub ior: f64,
}

/// What crossing a boundary did to the list, to be undone when the path is traced back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Change {
    Entered,
    Left { at: usize, medium: Medium },
    Nothing,
}

/// The indices on both sides of a boundary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Boundary {
    pub from: f64,
    pub to: f64,
}

impl Media {
    /// Forgets all, and starts inside these.
    pub fn reset(&mut self, around: &[Medium]) {
        self.entered.clear();
        self.entered.extend_from_slice(around);
    }

    /// The index of refraction here.
    pub fn current(&self) -> f64 {
        self.entered.last().map_or(1.0, |m| m.ior)
    }

    /// The indices before and after entering or leaving this medium.
    ///
    /// Leaving one that is not the latest changes nothing for the light; leaving one that was never entered (the eye
    /// is in it) leads from it to what is around.
    pub fn boundary(&self, medium: Medium, entering: bool) -> Boundary {
        if entering {
            return Boundary { from: self.current(), to: medium.ior };
        }
        match self.position(medium.key) {
            None => Boundary { from: medium.ior, to: self.current() },
            Some(at) if at + 1 == self.entered.len() => {
                let around = if at == 0 { 1.0 } else { self.entered[at - 1].ior };
                Boundary { from: medium.ior, to: around }
            }
            Some(_) => Boundary { from: self.current(), to: self.current() },
        }
    }

    /// Enters or leaves.
    pub fn cross(&mut self, medium: Medium, entering: bool) -> Change {
        if entering {
            self.entered.push(medium);
            return Change::Entered;
        }
        match self.position(medium.key) {
            None => Change::Nothing,
            Some(at) => Change::Left { at, medium: self.entered.remove(at) },
        }
    }

    /// Takes back the change made last.
    pub fn undo(&mut self, change: Change) {
        match change {
            Change::Entered => {
                self.entered.pop();
            }
            Change::Left { at, medium } => self.entered.insert(at, medium),
            Change::Nothing => {}
        }
    }

    fn position(&self, key: u32) -> Option<usize> {
        self.entered.iter().rposition(|m| m.key == key)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GLASS: Medium = Medium { key: 3, ior: 1.5 };
    const WATER: Medium = Medium { key: 7, ior: 1.33 };

    #[test]
    fn nested_media_come_back() {
        let mut media = Media::default();
        assert_eq!(media.boundary(GLASS, true), Boundary { from: 1.0, to: 1.5 });
        let glass = media.cross(GLASS, true);
        assert_eq!(media.boundary(WATER, true), Boundary { from: 1.5, to: 1.33 });
        let water = media.cross(WATER, true);
        assert_eq!(media.boundary(WATER, false), Boundary { from: 1.33, to: 1.5 });
        media.undo(water);
        assert_eq!(media.current(), 1.5);
        assert_eq!(media.boundary(GLASS, false), Boundary { from: 1.5, to: 1.0 });
        media.undo(glass);
        assert_eq!(media.current(), 1.0);
    }

    #[test]
    fn leaving_what_is_not_latest_does_not_bend() {
        let mut media = Media::default();
        media.cross(GLASS, true);
        media.cross(WATER, true);
        assert_eq!(media.boundary(GLASS, false), Boundary { from: 1.33, to: 1.33 });
        let change = media.cross(GLASS, false);
        assert_eq!(media.boundary(WATER, false), Boundary { from: 1.33, to: 1.0 });
        media.undo(change);
        assert_eq!(media.boundary(WATER, false), Boundary { from: 1.33, to: 1.5 });
    }

    #[test]
    fn leaving_what_was_never_entered_leads_out_of_it() {
        let mut media = Media::default();
        assert_eq!(media.boundary(GLASS, false), Boundary { from: 1.5, to: 1.0 });
        let change = media.cross(GLASS, false);
        media.undo(change);
        assert_eq!(media.current(), 1.0);
    }
}
