//! Casts one ray at a torus.

use rt::rt_core::shape::Torus;
use rt::rt_core::{Interval, Primitive, Ray};

fn main() -> Result<(), rt::rt_core::Error> {
    let torus = Torus::new([0.0, 0.0, 0.0], [0.0, 1.0, 0.0], 2.0, 0.5)?;
    let ray = Ray::new([-5.0, 0.1, 0.3], [1.0, 0.0, 0.0]);
    torus.crossings(&ray, Interval::FORWARD, &mut |hit| {
        let surface = torus.surface(&ray, hit);
        println!("t = {}, point {}, normal {}", surface.t, surface.point, surface.normal);
    });
    Ok(())
}
