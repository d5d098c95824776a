//! The contract of the library's own shapes: the properties that any shape must have, and those of exact ones.
//!
//! The number of rays a shape is tested with is `RT_HARD_RAYS` (default 2000 of each kind); a release run with
//! 1e7 takes minutes.
#![cfg(feature = "testing")]

use rt_core::glam::DVec3;
use rt_core::shape::*;
use rt_core::testing::{Effort, check_primitive};
use rt_core::{Primitive, Shape};

fn rays() -> u32 {
    std::env::var("RT_HARD_RAYS").ok().and_then(|n| n.parse().ok()).unwrap_or(2000)
}

fn check(shape: impl Into<Shape>, closed: bool) {
    let shape = shape.into();
    for seed in 1..=3 {
        let effort = Effort::new(seed, rays());
        let effort = if closed { effort.closed() } else { effort };
        check_primitive(&shape, &effort).unwrap_or_else(|failure| panic!("{shape:?}: {failure}"));
    }
}

#[test]
fn plane() {
    check(Plane::new([0.3, -0.2, 0.1], [0.0, 2.0, 0.0]).unwrap(), false);
    check(Plane::new([1e3, 5.0, -2e4], [1.0, -0.3, 1e-3]).unwrap(), false);
}

#[test]
fn disk() {
    check(Disk::new([0.0, 0.0, 0.0], [0.0, 0.0, 1.0], 1.0).unwrap(), false);
    check(Disk::new([1e6, -3e5, 2.0], [1.0, 0.2, -0.4], 1e-3).unwrap(), false);
}

#[test]
fn cuboid() {
    check(Cuboid::new([-1.0, -2.0, -0.5], [1.0, 2.0, 0.5]).unwrap(), true);
    check(Cuboid::new([1e6, 1e6, 1e6], [1e6 + 1.0, 1e6 + 1e-3, 1e6 + 7.0]).unwrap(), true);
    check(Cuboid::new([0.0, 0.0, 0.0], [1.0, 0.0, 1.0]).unwrap(), true);
}

#[test]
fn turned_cuboid() {
    let turn = rt_core::Similarity::IDENTITY.rotated([1.0, 2.0, -0.5], 33.0).unwrap();
    let turn = turn.translated([1e4, -3.0, 0.5]).unwrap();
    check(Cuboid::new([-1.0, -2.0, -0.5], [1.0, 2.0, 0.5]).unwrap().transformed(&turn).unwrap(), true);
    let quarter = rt_core::Similarity::IDENTITY.rotated(DVec3::Y, 90.0).unwrap();
    check(Cuboid::new([-1.0, -2.0, -0.5], [1.0, 2.0, 0.5]).unwrap().transformed(&quarter).unwrap(), true);
}

#[test]
fn triangle() {
    check(Triangle::new([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]).unwrap(), false);
    check(
        Triangle::new([1e5, 2.0, -3.0], [1e5 + 1.0, 2.5, -3.0], [1e5 + 0.5, 2.25, -3.0 + 1e-9]).unwrap(),
        false,
    );
}
