//! Cuts a polygon, concave or not, into triangles by clipping ears (Meisters 1975, doi:10.2307/2319703).
//!
//! The polygon is laid flat by dropping the coordinate in which its normal is longest, which moves no vertex across an
//! edge. Which side of a line a vertex lies on is then decided from exact differences and products, so the cut does not
//! depend on rounding. No vertex is added, moved or left out, a vertex in the middle of a straight edge neither: the
//! outline stays the same as the neighbours', and no crack opens between them.

use rt_core::double::Double;
use rt_core::glam::{DVec2, DVec3};
use rt_core::kernel::Dekker;

/// The most vertices of one polygon. The time grows with their square: at this number it is a fraction of a second.
pub(super) const MOST_VERTICES: usize = 10_000;

/// Why there are no triangles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct NoArea;

/// The triangles as indices of vertices, in the order of rotation of the polygon.
///
/// The outline of a polygon that crosses or touches itself is cut as far as it goes; what is drawn then is near the
/// outline, but nothing is promised.
pub(super) fn triangulate(vertices: &[DVec3]) -> Result<Vec<[usize; 3]>, NoArea> {
    let flat = flatten(vertices).ok_or(NoArea)?;
    let mut ring: Vec<usize> = (0..flat.len()).collect();
    let mut triangles = Vec::with_capacity(flat.len().saturating_sub(2));
    // Where to look for the next ear: going on from the last one keeps the triangles of a long strip stout.
    let mut at = 0;
    while ring.len() > 3 {
        let ear = (0..ring.len())
            .map(|step| (at + step) % ring.len())
            .find(|&corner| is_ear(&flat, &ring, corner))
            // Only an outline that crosses itself has no ear left: any convex corner, then any corner at all.
            .or_else(|| (0..ring.len()).find(|&corner| turn(&flat, around(&ring, corner)) == Turn::Left))
            .unwrap_or(0);
        let corners = around(&ring, ear);
        if turn(&flat, corners) == Turn::Left {
            triangles.push(corners);
        }
        ring.remove(ear);
        at = if ear >= ring.len() { 0 } else { ear };
    }
    if ring.len() == 3 && turn(&flat, [ring[0], ring[1], ring[2]]) == Turn::Left {
        triangles.push([ring[0], ring[1], ring[2]]);
    }
    if triangles.is_empty() { Err(NoArea) } else { Ok(triangles) }
}

/// The vertices in a plane in which they run counter-clockwise; `None` without an area.
fn flatten(vertices: &[DVec3]) -> Option<Vec<DVec2>> {
    let first = *vertices.first()?;
    // Scaled to about 1 by a power of two, so that no product leaves the range in which it is exact.
    let size = vertices.iter().map(|v| (*v - first).abs().max_element()).fold(0.0, f64::max);
    let furthest = vertices.iter().map(|v| v.abs().max_element()).fold(0.0, f64::max);
    if !(size > 0.0 && furthest < f64::MAX / 4.0) {
        return None;
    }
    let power = libm::exp2(-f64::from(libm::ilogb(furthest)).clamp(-1000.0, 1000.0));
    // Newell's formula: twice the area's projections on the three coordinate planes.
    let mut normal = DVec3::ZERO;
    for (a, b) in vertices.iter().zip(vertices.iter().cycle().skip(1)) {
        normal += ((*a - first) / size).cross((*b - first) / size);
    }
    let longest = normal.abs();
    let project: fn(DVec3) -> DVec2 = if longest.x >= longest.y && longest.x >= longest.z {
        if normal.x > 0.0 { |v| DVec2::new(v.y, v.z) } else { |v| DVec2::new(v.z, v.y) }
    } else if longest.y >= longest.z {
        if normal.y > 0.0 { |v| DVec2::new(v.z, v.x) } else { |v| DVec2::new(v.x, v.z) }
    } else if normal.z > 0.0 {
        |v| DVec2::new(v.x, v.y)
    } else {
        |v| DVec2::new(v.y, v.x)
    };
    Some(vertices.iter().map(|v| project(*v * power)).collect())
}

/// The corner and its neighbours.
fn around(ring: &[usize], corner: usize) -> [usize; 3] {
    let n = ring.len();
    [ring[(corner + n - 1) % n], ring[corner], ring[(corner + 1) % n]]
}

/// Whether the corner is convex and its triangle, the diagonal included, is free of the other vertices.
fn is_ear(flat: &[DVec2], ring: &[usize], corner: usize) -> bool {
    let corners = around(ring, corner);
    if turn(flat, corners) != Turn::Left {
        return false;
    }
    let [a, b, c] = corners.map(|index| flat[index]);
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    ring.iter().all(|&index| {
        let p = flat[index];
        let outside = p.x < low.x || p.x > high.x || p.y < low.y || p.y > high.y;
        // A vertex in the same place as a corner: the corner itself, or the seam of a cut to a hole.
        outside || p == a || p == b || p == c || !inside(p, [a, b, c])
    })
}

/// Whether the point lies in the triangle or on its rim.
fn inside(p: DVec2, [a, b, c]: [DVec2; 3]) -> bool {
    side(a, b, p) != Turn::Right && side(b, c, p) != Turn::Right && side(c, a, p) != Turn::Right
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Turn {
    Left,
    Straight,
    Right,
}

fn turn(flat: &[DVec2], [a, b, c]: [usize; 3]) -> Turn {
    side(flat[a], flat[b], flat[c])
}

/// On which side of the line from `a` to `b` the point `c` lies: the sign of a determinant.
fn side(a: DVec2, b: DVec2, c: DVec2) -> Turn {
    let (left, right) = ((a.x - c.x) * (b.y - c.y), (a.y - c.y) * (b.x - c.x));
    let rough = left - right;
    // Shewchuk 1997 (doi:10.1007/PL00009321), bound A of orient2d: (3 + 16 u) u, u = 2^-53.
    const BOUND: f64 = (3.0 + 8.0 * f64::EPSILON) * 0.5 * f64::EPSILON;
    let sum = left.abs() + right.abs();
    if rough.abs() > BOUND * sum {
        return sign(rough);
    }
    let difference = |p: f64, q: f64| Double::difference(p, q);
    let left = difference(a.x, c.x).mul::<Dekker>(difference(b.y, c.y));
    let right = difference(a.y, c.y).mul::<Dekker>(difference(b.x, c.x));
    let exact = (left - right).high;
    // The differences are exact, each product is off by at most 5 u^2 of itself and their difference by 3 u^2 (see
    // `rt_core::double`): within 8 u^2 of the products the three points count as one line.
    let doubt = 8.0 * (0.5 * f64::EPSILON) * (0.5 * f64::EPSILON) * sum;
    if exact.abs() > doubt { sign(exact) } else { Turn::Straight }
}

fn sign(x: f64) -> Turn {
    if x > 0.0 {
        Turn::Left
    } else if x < 0.0 {
        Turn::Right
    } else {
        Turn::Straight
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn area(vertices: &[DVec3], triangles: &[[usize; 3]]) -> DVec3 {
        triangles
            .iter()
            .map(|&[a, b, c]| (vertices[b] - vertices[a]).cross(vertices[c] - vertices[a]) * 0.5)
            .sum()
    }

    fn outline_area(vertices: &[DVec3]) -> DVec3 {
        let next = vertices.iter().cycle().skip(1);
        vertices.iter().zip(next).map(|(a, b)| a.cross(*b) * 0.5).sum()
    }

    /// Every triangle turns with the polygon, their areas add up, every vertex is used.
    fn check(vertices: &[DVec3]) {
        let triangles = triangulate(vertices).unwrap();
        assert_eq!(triangles.len(), vertices.len() - 2);
        let whole = outline_area(vertices);
        let scale = whole.length();
        assert!((area(vertices, &triangles) - whole).length() < 1e-9 * scale);
        let sum: f64 = triangles.iter().map(|t| area(vertices, &[*t]).length()).sum();
        assert!((sum - scale).abs() < 1e-9 * scale, "triangles overlap: {sum} {scale}");
        assert!((0..vertices.len()).all(|v| triangles.iter().any(|t| t.contains(&v))));
    }

    fn flat(points: &[(f64, f64)]) -> Vec<DVec3> {
        points.iter().map(|p| DVec3::new(p.0, p.1, 0.0)).collect()
    }

    #[test]
    fn square_arrow_and_comb() {
        check(&flat(&[(0., 0.), (1., 0.), (1., 1.), (0., 1.)]));
        check(&flat(&[(0., 0.), (2., -1.), (0.5, 0.), (2., 1.)]));
        let mut comb = vec![(0., 10.), (0., 0.)];
        for tooth in 0..20 {
            let x = tooth as f64;
            comb.extend([(x + 0.5, 9.), (x + 1., 0.)]);
        }
        comb.push((20., 10.));
        check(&flat(&comb));
    }

    #[test]
    fn vertices_on_straight_edges_stay() {
        check(&flat(&[(0., 0.), (1., 0.), (2., 0.), (2., 2.), (0., 2.)]));
        check(&flat(&[(0., 0.), (1., 0.), (2., 0.), (3., 0.), (1., 1.)]));
        check(&flat(&[(0., 0.), (1., 0.), (2., 0.), (2., 1.), (2., 2.), (1., 2.), (0., 2.), (0., 1.)]));
    }

    #[test]
    fn hole_by_a_seam() {
        let square = [(0., 0.), (3., 0.), (3., 3.), (0., 3.)];
        let hole = [(1., 1.), (1., 2.), (2., 2.), (2., 1.)];
        let mut points: Vec<(f64, f64)> = square.to_vec();
        points.push(square[0]);
        points.extend(hole);
        points.push(hole[0]);
        check(&flat(&points));
    }

    #[test]
    fn no_area() {
        assert_eq!(triangulate(&[]), Err(NoArea));
        assert_eq!(triangulate(&flat(&[(0., 0.), (1., 1.)])), Err(NoArea));
        assert_eq!(triangulate(&flat(&[(0., 0.), (1., 1.), (2., 2.), (3., 3.)])), Err(NoArea));
        assert_eq!(triangulate(&[DVec3::ONE; 5]), Err(NoArea));
    }

    #[test]
    fn crossing_itself_ends() {
        assert!(triangulate(&flat(&[(0., 0.), (1., 1.), (1., 0.), (0., 1.)])).is_err());
        assert!(triangulate(&flat(&[(0., 0.), (2., 2.), (2., 0.), (0., 1.)])).is_ok());
    }

    #[test]
    fn sides_are_exact() {
        // Points on the line y = x, one moved by the last bit.
        let p = |x: f64, y: f64| DVec2::new(x, y);
        let (a, b) = (p(0.1, 0.1), p(0.7, 0.7));
        for x in [0.3, 1e-9, 0.4999999, 123.456] {
            assert_eq!(side(a, b, p(x, x)), Turn::Straight);
            assert_eq!(side(a, b, p(x, x.next_up())), Turn::Left);
            assert_eq!(side(a, b, p(x, x.next_down())), Turn::Right);
        }
    }

    proptest! {
        /// Star-shaped polygons in any plane, of any size.
        #[test]
        fn stars(radii in prop::collection::vec(0.1f64..1.0, 3..60), turn in any::<[i8; 3]>(), power in -300i32..300) {
            let axis = DVec3::new(f64::from(turn[0]), f64::from(turn[1]), f64::from(turn[2])).normalize_or(DVec3::Z);
            let (u, v) = axis.any_orthonormal_pair();
            let vertices: Vec<DVec3> = radii.iter().enumerate().map(|(i, r)| {
                let (sin, cos) = libm::sincos(i as f64 / radii.len() as f64 * core::f64::consts::TAU);
                (u * (r * cos) + v * (r * sin)) * libm::exp2(f64::from(power))
            }).collect();
            // Three vertices or so may leave the centre outside: still simple, as the angles ascend by less than pi.
            check_star(&vertices, libm::exp2(-f64::from(power)));
        }
    }

    fn check_star(vertices: &[DVec3], unscale: f64) {
        let triangles = triangulate(vertices).unwrap();
        let vertices: Vec<DVec3> = vertices.iter().map(|v| *v * unscale).collect();
        let whole = outline_area(&vertices);
        assert!((area(&vertices, &triangles) - whole).length() < 1e-12 * whole.length());
        let sum: f64 = triangles.iter().map(|t| area(&vertices, &[*t]).length()).sum();
        assert!((sum - whole.length()).abs() < 1e-12 * sum);
    }
}
