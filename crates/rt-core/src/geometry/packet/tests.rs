//! Beams: what they hold, and by how much they are too wide.

use super::super::query::Nearest;
use super::*;
use crate::kernel::PortableLanes;
use crate::testing::Random;
use alloc::vec::Vec;
use glam::DVec3;

/// Rays side by side about a direction, the largest component of each in `[1, 2)`, `spread` apart.
fn side(random: &mut Random, along: DVec3, spread: f64) -> Side {
    let mut side = Side::EMPTY;
    let origin = random.in_cube();
    for i in 0..PACKET {
        let o = origin + random.in_cube() * spread;
        let d = along + random.in_cube() * spread;
        let d = d * exp2i(-crate::math::exponent(d.abs().max_element()));
        for k in 0..3 {
            side.origin[i / 8][k][i % 8] = o[k] as f32;
            side.direction[i / 8][k][i % 8] = d[k] as f32;
        }
    }
    side.error = exp2i(-40);
    side
}

#[test]
fn beams_hold_their_rays_and_little_more() {
    let mut random = Random::new(1);
    for case in 0..1000 {
        let along = DVec3::AXES[case % 3] * random.sign() + random.in_cube() * 0.4;
        let spread = random.magnitude(-4.0, -1.0);
        let side = side(&mut random, along, spread);
        let groups = [0..GROUPS, 0..GROUPS / 2, GROUPS / 2..GROUPS][case % 3].clone();
        let bundle = bundle(PortableLanes, &side, groups.clone(), 0.5).expect("rays that go side by side");
        let BeamShape { axis, sign, plane, position, slope, error } = bundle.shape;
        assert_eq!((axis, sign), (case % 3, along[case % 3].signum()));
        let far = f64::from(bundle.far);
        // What a position errs, as derived at `bundle`; no more than twice that.
        assert!((exp2i(-20) * far + side.error..=exp2i(-19) * far + side.error).contains(&error));
        let mut ends = [[f64::INFINITY, f64::NEG_INFINITY]; 4];
        for i in 8 * groups.start..8 * groups.end {
            let of = |list: &[[[f32; 8]; 3]; GROUPS], k: usize| f64::from(list[i / 8][k][i % 8]);
            let (o, d) = (|k| of(&side.origin, k), |k| of(&side.direction, k));
            assert!((o(axis) - plane) * sign >= 0.0 && o(axis).abs() <= far);
            for n in 0..2 {
                let k = (axis + 1 + n) % 3;
                let s = d(k) / d(axis) * sign;
                let p = o(k) - s * (o(axis) - plane) * sign;
                assert!(p >= position[n][0] - error && p <= position[n][1] + error);
                let little = exp2i(-20) * s.abs();
                assert!(s >= slope[n][0] - little && s <= slope[n][1] + little);
                ends[n] = [ends[n][0].min(p), ends[n][1].max(p)];
                ends[2 + n] = [ends[2 + n][0].min(s), ends[2 + n][1].max(s)];
            }
            // Where a ray ends, as a depth of the beam.
            let limit = random.uniform(0.0, 2.0) as f32;
            let depth = (o(axis) - plane) * sign + f64::from(limit) * d(axis) * sign;
            let end = f64::from(bundle.ends(PortableLanes, i / 8, &[limit; 8])[i % 8]);
            assert!(end >= depth && end <= depth + exp2i(-18) * (depth.abs() + far + 1.0), "{end} {depth}");
        }
        for n in 0..2 {
            for (end, found) in ends[n].iter().zip(position[n]).chain(ends[2 + n].iter().zip(slope[n])) {
                assert!((end - found).abs() <= 2.0 * error);
            }
        }
    }
}

/// Rays apart, with slopes beyond 4 or without a place make no beam.
#[test]
fn what_makes_no_beam() {
    let mut random = Random::new(2);
    let bundled = |side: &Side, box_size: f64| bundle(PortableLanes, side, 0..GROUPS, box_size).is_some();
    let near = side(&mut random, DVec3::Z, 0.01);
    assert!(bundled(&near, 0.5) && !bundled(&near, 1e-4));
    assert!(!bundled(&side(&mut random, DVec3::Z, 0.9), 0.01));
    for turned in 0..PACKET {
        let mut side = near.clone();
        side.direction[turned / 8][2][turned % 8] *= 0.25;
        assert!(!bundled(&side, 0.5), "{turned}");
    }
    let mut nowhere = near.clone();
    nowhere.error = f64::INFINITY;
    assert!(!bundled(&nowhere, 0.5));
}

/// Many small spheres.
fn spheres(random: &mut Random) -> Geometry {
    let mut builder = Geometry::builder();
    for _ in 0..500 {
        builder.push(crate::shape::Sphere::new(random.in_cube(), random.uniform(0.02, 0.1)).unwrap());
    }
    builder.build()
}

/// A packet that asks for the nearest hits of those of the rays that are active.
fn forward<'a>(geometry: &Geometry, rays: &'a [crate::Ray], active: u32) -> Packet<'a, Nearest> {
    let within = [crate::Interval::FORWARD; PACKET];
    let (mut side, tile) = (Side::EMPTY, super::Tile::line(0, rays.len()));
    assert!(geometry.frame.enter_together(PortableLanes, rays, &within, &tile, &mut side));
    let queries = core::array::from_fn(|i| Nearest::new(within[i], None));
    Packet { rays, tile, side, queries, active, rings: super::Rings::NONE }
}

/// Rays that go side by side are answered together, and as one by one.
#[test]
fn rays_side_by_side_are_answered_together() {
    use crate::{Interval, Ray};
    let mut random = Random::new(3);
    let geometry = spheres(&mut random);
    for case in 0..200 {
        // Up to a few shapes' sizes apart: 0.06 is that of a shape here, in the units of the world.
        let spread = random.magnitude(-4.0, -1.3);
        let origin = random.direction() * 3.0;
        let count = if case % 2 == 0 { PACKET } else { 4 + case % 29 };
        let rays: Vec<Ray> = (0..count)
            .map(|_| Ray::new(origin + random.in_cube() * spread, random.in_cube() * spread - origin))
            .collect();
        let active = ((1_u64 << count) - 1) as u32;
        let mut packet = forward(&geometry, &rays, active);
        assert_eq!(packet.search(PortableLanes, &geometry), active, "{spread}");
        for (ray, query) in rays.iter().zip(&packet.queries) {
            if query.contested(|| geometry.frame.window(ray)).is_none() {
                assert_eq!(query.best(), geometry.nearest(ray, Interval::FORWARD));
            }
        }
    }
}

/// A packet of which either half goes side by side, but not with the other, is answered by halves.
#[test]
fn halves_are_answered_together() {
    use crate::{Interval, Ray};
    let mut random = Random::new(4);
    let geometry = spheres(&mut random);
    for case in 0..60 {
        let spread = random.magnitude(-4.0, -1.5);
        let towards = [random.in_cube(), -random.in_cube()];
        let origins = [DVec3::new(3.0, 0.1, 0.2), DVec3::new(0.3, -3.0, 0.1)];
        // Of some only one half has enough rays.
        let few = if case % 3 == 0 { 3 } else { 16 };
        let rays: Vec<Ray> = (0..PACKET)
            .map(|i| {
                let origin = origins[i / 16];
                Ray::new(
                    origin + random.in_cube() * spread,
                    towards[i / 16] + random.in_cube() * spread - origin,
                )
            })
            .collect();
        let active = ((1_u64 << (16 + few)) - 1) as u32;
        let mut packet = forward(&geometry, &rays, active);
        let done = packet.search(PortableLanes, &geometry);
        assert_eq!(done, if few == 16 { active } else { 0xffff }, "{case}");
        for (i, (ray, query)) in rays.iter().zip(&packet.queries).enumerate() {
            if done >> i & 1 == 1 && query.contested(|| geometry.frame.window(ray)).is_none() {
                assert_eq!(query.best(), geometry.nearest(ray, Interval::FORWARD));
            }
        }
    }
}
