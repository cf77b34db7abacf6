//! The nearest point to the origin on a simplex of up to four corners.
//!
//! Source: Ericson 2005, "Real-time collision detection", sections 5.1.2, 5.1.5 and 5.1.6.

use glam::DVec3;

/// One weight per corner; weights beyond the simplex are zero.
pub(super) type Weighted = [f64; 4];

/// Weights of the nearest point to the origin, or none if four corners enclose it.
pub(super) fn simplex(corners: &[DVec3]) -> Option<Weighted> {
    match *corners {
        [a, b] => Some(spread(segment(a, b), [0, 1])),
        [a, b, c] => Some(spread(triangle(a, b, c), [0, 1, 2])),
        [a, b, c, d] => tetrahedron([a, b, c, d]),
        _ => Some([1.0, 0.0, 0.0, 0.0]),
    }
}

fn spread<const N: usize>(weights: [f64; N], places: [usize; N]) -> Weighted {
    let mut result = [0.0; 4];
    for (weight, place) in weights.into_iter().zip(places) {
        result[place] = weight;
    }
    result
}

/// Weights of the nearest point to the origin on the segment `a b`.
pub(super) fn segment(a: DVec3, b: DVec3) -> [f64; 2] {
    let along = b - a;
    let squared = along.length_squared();
    if squared <= 0.0 {
        return [1.0, 0.0];
    }
    let t = (-a.dot(along) / squared).clamp(0.0, 1.0);
    [1.0 - t, t]
}

/// Weights of the nearest point to the origin on the triangle `a b c`.
pub(super) fn triangle(a: DVec3, b: DVec3, c: DVec3) -> [f64; 3] {
    let normal = (b - a).cross(c - a);
    let inside = [b.cross(c), c.cross(a), a.cross(b)].map(|area| area.dot(normal));
    let whole = inside[0] + inside[1] + inside[2];
    if inside.iter().all(|&part| part >= 0.0) && whole > 0.0 {
        return inside.map(|part| part / whole);
    }
    let [ab, bc, ca] = [segment(a, b), segment(b, c), segment(c, a)];
    let choices = [
        [ab[0], ab[1], 0.0],
        [0.0, bc[0], bc[1]],
        [ca[1], 0.0, ca[0]],
    ];
    let squared = |w: &[f64; 3]| (a * w[0] + b * w[1] + c * w[2]).length_squared();
    let nearer = |x: [f64; 3], y: [f64; 3]| if squared(&y) < squared(&x) { y } else { x };
    nearer(nearer(choices[0], choices[1]), choices[2])
}

/// The direction of the part of `vector` square to the unit vector `axis`, if they are not parallel.
///
/// Square to the last digit however small the part is, unlike a cross product.
pub(super) fn square_part(axis: DVec3, vector: DVec3) -> Option<DVec3> {
    const PARALLEL: f64 = 1e-14;
    let part = vector - axis * axis.dot(vector);
    let length = part.length();
    let part = part / length;
    (length > PARALLEL).then(|| (part - axis * axis.dot(part)).normalize())
}

fn tetrahedron(corners: [DVec3; 4]) -> Option<Weighted> {
    const SIDES: [[usize; 4]; 4] = [[0, 1, 2, 3], [0, 3, 1, 2], [0, 2, 3, 1], [1, 3, 2, 0]];
    let mut best: Option<(f64, Weighted)> = None;
    for [i, j, k, opposite] in SIDES {
        let [a, b, c, d] = [corners[i], corners[j], corners[k], corners[opposite]];
        let normal = (b - a).cross(c - a);
        if (-a).dot(normal) * (d - a).dot(normal) > 0.0 {
            continue;
        }
        let weights = triangle(a, b, c);
        let squared = (a * weights[0] + b * weights[1] + c * weights[2]).length_squared();
        if best.is_none_or(|(least, _)| squared < least) {
            best = Some((squared, spread(weights, [i, j, k])));
        }
    }
    best.map(|(_, weights)| weights)
}
