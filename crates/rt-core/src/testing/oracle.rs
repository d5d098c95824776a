//! How far a point is from a surface: the implicit equations in double-double, for points relative to the anchor.
//!
//! Each function gives a signed distance (to first order near the surface), certain to about 2^-100 of the lengths that
//! enter. They know nothing of rays: an oracle that shares no formula with the code it judges.

use crate::double::Double;
use crate::double_vector::DoubleVector;
use crate::kernel::{Product, Task, run};
use glam::DVec3;

/// From the plane through the anchor across `normal`, of any length: positive on its side.
pub fn plane(local: DVec3, normal: DVec3) -> f64 {
    distance(local, normal, Kind::Plane)
}

/// From the sphere of `radius` about the anchor.
pub fn sphere(local: DVec3, radius: f64) -> f64 {
    distance(local, DVec3::X, Kind::Sphere { radius })
}

/// From the endless cylinder of `radius` about the line through the anchor along `axis`.
pub fn cylinder(local: DVec3, axis: DVec3, radius: f64) -> f64 {
    cone(local, axis, radius, radius)
}

/// From the endless cone about `axis`, of `base` radius at the anchor and `top` radius at the end of the axis.
pub fn cone(local: DVec3, axis: DVec3, base: f64, top: f64) -> f64 {
    distance(local, axis, Kind::Cone { base, top })
}

/// From the torus about the anchor around `axis`; with `minor >= major` from its nearer sheet.
pub fn torus(local: DVec3, axis: DVec3, major: f64, minor: f64) -> f64 {
    let outer = distance(local, axis, Kind::Torus { major, minor });
    let inner = distance(local, axis, Kind::Torus { major: -major, minor });
    if inner.abs() < outer.abs() { inner } else { outer }
}

fn distance(local: DVec3, axis: DVec3, kind: Kind) -> f64 {
    run(Distance { local: DoubleVector::from(local), axis: DoubleVector::from(axis), kind })
}

/// A surface about the anchor and an axis.
#[derive(Clone, Copy, Debug)]
pub(super) enum Kind {
    Plane,
    Sphere { radius: f64 },
    Cone { base: f64, top: f64 },
    Torus { major: f64, minor: f64 },
}

/// The signed distance of a point from a surface.
pub(super) struct Distance {
    pub local: DoubleVector,
    pub axis: DoubleVector,
    pub kind: Kind,
}

impl Task for Distance {
    type Output = f64;
    #[inline(always)]
    fn run<P: Product>(self) -> f64 {
        let (l, a) = (self.local, self.axis);
        let axis = a.dot::<P>(a).sqrt::<P>();
        let height = l.dot::<P>(a).div::<P>(axis);
        let across = l.dot::<P>(l) - height.square::<P>();
        let across = if across.high > 0.0 { across.sqrt::<P>() } else { Double::ZERO };
        match self.kind {
            Kind::Plane => height,
            Kind::Sphere { radius } => l.dot::<P>(l).sqrt::<P>() - radius,
            Kind::Cone { base, top } => {
                let rise = Double::difference(top, base);
                let wall = rise.mul::<P>(height).div::<P>(axis) + base;
                let slant = (rise.square::<P>() + axis.square::<P>()).sqrt::<P>();
                (across - wall).mul::<P>(axis).div::<P>(slant)
            }
            Kind::Torus { major, minor } => {
                let out = across - major;
                (out.square::<P>() + height.square::<P>()).sqrt::<P>() - minor
            }
        }
        .to_f64()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances() {
        let axis = DVec3::new(0.0, 0.0, 2.0);
        assert_eq!(plane(DVec3::new(5.0, 6.0, -3.0), axis), -3.0);
        assert_eq!(sphere(DVec3::new(3.0, 0.0, 4.0), 4.5), 0.5);
        assert_eq!(cylinder(DVec3::new(3.0, 4.0, 9.0), axis, 5.25), -0.25);
        // At height 1 the radius is 2.5; the wall leans by 3 over 2.
        let lean = 2.0 / 13.0_f64.sqrt();
        assert!((cone(DVec3::new(3.0, 0.0, 1.0), axis, 1.0, 4.0) - 0.5 * lean).abs() < 1e-15);
        assert_eq!(torus(DVec3::new(8.0, 0.0, 4.0), axis, 5.0, 4.0), 1.0);
        assert_eq!(torus(DVec3::new(1.0, 0.0, 0.0), axis, 2.0, 3.0), 0.0);
    }
}
