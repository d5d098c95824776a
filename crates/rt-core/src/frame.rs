//! Two axes perpendicular to a third: the frame that texture coordinates are measured in.

use glam::DVec3;

/// Two unit vectors `(first, second)` perpendicular to the unit vector `axis` and to each other, with
/// `first x second = axis`.
///
/// `first` is the part of one world axis that is perpendicular to `axis`: of the world axis that makes the largest
/// angle with it, the earlier in the order x, y, z where two are equal. An axis along y gives (x, -z), along z
/// (x, y), along x (y, z).
pub(crate) fn frame(axis: DVec3) -> (DVec3, DVec3) {
    let size = axis.abs();
    let world = if size.x <= size.y && size.x <= size.z {
        DVec3::X
    } else if size.y <= size.z {
        DVec3::Y
    } else {
        DVec3::Z
    };
    // The smallest component of a unit vector is at most 3^-0.5, so the length is at least (2/3)^0.5.
    let first = (world - axis * world.dot(axis)).normalize();
    (first, axis.cross(first))
}

/// The angle of the point `(x, y)` in turns, in `[0, 1)`; zero at the origin.
pub(crate) fn turns(x: f64, y: f64) -> f64 {
    let turns = libm::atan2(y, x) * (0.5 * core::f64::consts::FRAC_1_PI);
    // `turns + 1` rounds to 1 for the smallest negative angles: the same place as 0.
    let turns = if turns < 0.0 { turns + 1.0 } else { turns };
    if turns < 1.0 { turns + 0.0 } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn world_axes() {
        assert_eq!(frame(DVec3::Y), (DVec3::X, -DVec3::Z));
        assert_eq!(frame(DVec3::Z), (DVec3::X, DVec3::Y));
        assert_eq!(frame(DVec3::X), (DVec3::Y, DVec3::Z));
    }

    #[test]
    fn turns_stay_below_one() {
        assert_eq!(turns(1.0, -1e-300), 0.0);
        assert_eq!(turns(0.0, 1.0), 0.25);
        assert_eq!(turns(-1.0, 0.0), 0.5);
        assert_eq!(turns(0.0, -1.0), 0.75);
        assert!(turns(0.0, 0.0) == 0.0 && turns(1.0, -0.0).is_sign_positive());
    }
}
