//! Rays put in an order in which neighbours go side by side.

use super::frame::PACKET;
use crate::Ray;

/// The number of a ray, and where its direction, from the centre, meets the cube [-1, 1]^3: by axis, in units of 2^-30.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    at: [i32; 3],
    pub number: u32,
}

impl Place {
    #[inline(always)]
    pub fn new(ray: &Ray, number: usize) -> Self {
        let scale = f64::from(1 << 30) / ray.direction.abs().max_element();
        // Any number will do for a ray without a direction.
        let at = (ray.direction * scale).to_array().map(|x| x as i32);
        Place { at, number: number as u32 }
    }
}

/// Puts rays of like direction together, so that each [`PACKET`] of them takes a small part of the cube, and its neighbours
/// lie near: halves it where it is widest until a packet is left. Of use where rays meet in one point, as at a lamp: like
/// directions are then like ways. Only time depends on it.
pub(super) fn put_together(places: &mut [Place]) {
    if places.len() <= PACKET {
        return;
    }
    let (mut least, mut most) = ([i32::MAX; 3], [i32::MIN; 3]);
    for place in &*places {
        for axis in 0..3 {
            least[axis] = least[axis].min(place.at[axis]);
            most[axis] = most[axis].max(place.at[axis]);
        }
    }
    let width = |axis: usize| i64::from(most[axis]) - i64::from(least[axis]);
    let axis = if width(0) >= width(1) && width(0) >= width(2) {
        0
    } else if width(1) >= width(2) {
        1
    } else {
        2
    };
    let middle = (places.len() / 2).next_multiple_of(PACKET);
    places.select_nth_unstable_by_key(middle, |place| place.at[axis]);
    let (low, high) = places.split_at_mut(middle);
    put_together(low);
    put_together(high);
}
