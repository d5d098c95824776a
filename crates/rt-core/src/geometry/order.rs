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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Random;
    use alloc::vec::Vec;
    use glam::DVec3;

    /// Every ray stays, and the directions of a packet are as near as those of so many neighbours can be.
    #[test]
    fn packets_of_like_directions() {
        let mut random = Random::new(1);
        for count in [0, 1, 31, 32, 33, 100, 4096] {
            let rays: Vec<Ray> = (0..count)
                .map(|_| Ray::new(DVec3::ZERO, random.direction() * random.magnitude(-200.0, 200.0)))
                .collect();
            let mut places: Vec<Place> = rays.iter().enumerate().map(|(n, ray)| Place::new(ray, n)).collect();
            put_together(&mut places);
            let mut numbers: Vec<u32> = places.iter().map(|place| place.number).collect();
            for packet in numbers.chunks(PACKET).filter(|_| count == 4096) {
                // A fifth of the cube's edge is the square root of PACKET / 4096 of its six sides.
                let of =
                    |n: &u32| rays[*n as usize].direction / rays[*n as usize].direction.abs().max_element();
                let all = packet.iter().map(of);
                let (min, max) =
                    all.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(a, b), d| (a.min(d), b.max(d)));
                assert!((max - min).max_element() < 4.0 * 0.2 * 2.0, "{min} {max}");
            }
            numbers.sort_unstable();
            assert!(numbers.into_iter().eq(0..count));
        }
        // A ray without a direction has a place too.
        Place::new(&Ray::new(DVec3::ZERO, DVec3::ZERO), 0);
        Place::new(&Ray::new(DVec3::ZERO, DVec3::NAN), 0);
    }
}
