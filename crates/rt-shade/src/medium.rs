//! The media that a ray is in.
//!
//! A list, latest last, keyed by medium (the material), not by object: glass made of loose polygons is one medium, and
//! media that nest, touch or overlap are entered and left in any order. Where several overlap, the one entered last
//! is the one that bends light; outside all of them is vacuum, index 1.

/// The media around many points of rays' paths: a list for each, one behind the other.
#[derive(Clone, Debug, Default)]
pub(crate) struct Media {
    lists: Vec<Medium>,
}

/// The media around a point of a ray's path, the one entered last at the end: a part of [`Media`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Around {
    start: u32,
    end: u32,
}

/// A medium: its key and its index of refraction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Medium {
    pub key: u32,
    pub ior: f64,
}

/// The indices on both sides of a boundary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Boundary {
    pub from: f64,
    pub to: f64,
}

impl Media {
    /// A list of these.
    pub fn add(&mut self, around: &[Medium]) -> Around {
        let start = self.lists.len() as u32;
        self.lists.extend_from_slice(around);
        Around { start, end: self.lists.len() as u32 }
    }

    /// How much is known, for [`forget`](Media::forget).
    pub fn mark(&self) -> usize {
        self.lists.len()
    }

    /// Forgets the lists made since the mark.
    pub fn forget(&mut self, mark: usize) {
        self.lists.truncate(mark);
    }

    fn list(&self, around: Around) -> &[Medium] {
        self.lists.get(around.start as usize..around.end as usize).unwrap_or(&[])
    }

    /// The indices before and after entering or leaving this medium.
    ///
    /// Leaving one that is not the latest changes nothing for the light; leaving one that was never entered (the eye
    /// is in it) leads from it to what is around.
    pub fn boundary(&self, around: Around, medium: Medium, entering: bool) -> Boundary {
        let list = self.list(around);
        let current = list.last().map_or(1.0, |m| m.ior);
        if entering {
            return Boundary { from: current, to: medium.ior };
        }
        match position(list, medium.key) {
            None => Boundary { from: medium.ior, to: current },
            Some(at) if at + 1 == list.len() => {
                let outside = if at == 0 { 1.0 } else { list[at - 1].ior };
                Boundary { from: medium.ior, to: outside }
            }
            Some(_) => Boundary { from: current, to: current },
        }
    }

    /// The media beyond the boundary.
    pub fn cross(&mut self, around: Around, medium: Medium, entering: bool) -> Around {
        let Around { start, end } = around;
        let (start, end) = (start as usize, end as usize);
        let at = match position(self.list(around), medium.key) {
            _ if entering => end,
            Some(at) => start + at,
            None => return around,
        };
        let first = self.lists.len() as u32;
        self.lists.extend_from_within(start..at);
        if entering {
            self.lists.push(medium);
        } else {
            self.lists.extend_from_within(at + 1..end);
        }
        Around { start: first, end: self.lists.len() as u32 }
    }
}

fn position(list: &[Medium], key: u32) -> Option<usize> {
    list.iter().rposition(|m| m.key == key)
}

#[cfg(test)]
mod tests {
    use super::*;

    const GLASS: Medium = Medium { key: 3, ior: 1.5 };
    const WATER: Medium = Medium { key: 7, ior: 1.33 };
    const NOWHERE: Around = Around { start: 0, end: 0 };

    #[test]
    fn nested_media_come_back() {
        let mut media = Media::default();
        assert_eq!(media.boundary(NOWHERE, GLASS, true), Boundary { from: 1.0, to: 1.5 });
        let in_glass = media.cross(NOWHERE, GLASS, true);
        assert_eq!(media.boundary(in_glass, WATER, true), Boundary { from: 1.5, to: 1.33 });
        let in_water = media.cross(in_glass, WATER, true);
        assert_eq!(media.boundary(in_water, WATER, false), Boundary { from: 1.33, to: 1.5 });
        let out = media.cross(in_water, WATER, false);
        assert_eq!(media.list(out), [GLASS]);
        assert_eq!(media.boundary(in_glass, GLASS, false), Boundary { from: 1.5, to: 1.0 });
        let out = media.cross(out, GLASS, false);
        assert_eq!(media.list(out), []);
        // Those made before are as they were, and come back when the others are forgotten.
        assert_eq!((media.list(in_glass), media.list(in_water)), (&[GLASS][..], &[GLASS, WATER][..]));
        let mark = media.mark();
        media.add(&[WATER]);
        media.forget(mark);
        assert_eq!(media.mark(), mark);
    }

    #[test]
    fn leaving_what_is_not_latest_does_not_bend() {
        let mut media = Media::default();
        let both = media.add(&[GLASS, WATER]);
        assert_eq!(media.boundary(both, GLASS, false), Boundary { from: 1.33, to: 1.33 });
        let water = media.cross(both, GLASS, false);
        assert_eq!(media.boundary(water, WATER, false), Boundary { from: 1.33, to: 1.0 });
        assert_eq!(media.boundary(both, WATER, false), Boundary { from: 1.33, to: 1.5 });
    }

    #[test]
    fn leaving_what_was_never_entered_leads_out_of_it() {
        let mut media = Media::default();
        assert_eq!(media.boundary(NOWHERE, GLASS, false), Boundary { from: 1.5, to: 1.0 });
        assert_eq!(media.cross(NOWHERE, GLASS, false), NOWHERE);
    }
}
