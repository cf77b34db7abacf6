//! Signs and products without rounding error, by floating-point expansions.
//!
//! Source: Shewchuk 1997, "Adaptive precision floating-point arithmetic and fast robust geometric
//! predicates": two-sum, two-product, scale-expansion and the error bound of the orientation test.

use glam::DVec3;

/// Shewchuk's bound A for the orientation test in space, (7 + 56 u) u with u = 2^-53.
const ORIENT_ERROR_BOUND: f64 = 7.771_561_172_376_103e-16;

/// A sum of doubles that do not overlap, smallest first.
#[derive(Clone, Debug, Default)]
struct Expansion(Vec<f64>);

fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let b_part = sum - a;
    let a_part = sum - b_part;
    (sum, (a - a_part) + (b - b_part))
}

fn two_product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    let (a_high, a_low) = split(a);
    let (b_high, b_low) = split(b);
    let error = ((product - a_high * b_high) - a_low * b_high) - a_high * b_low;
    (product, a_low * b_low - error)
}

fn split(a: f64) -> (f64, f64) {
    let shifted = 134_217_729.0 * a;
    let high = shifted - (shifted - a);
    (high, a - high)
}

impl Expansion {
    fn difference(a: f64, b: f64) -> Self {
        let (high, low) = two_sum(a, -b);
        let mut result = Self::default();
        result.push(low);
        result.push(high);
        result
    }

    fn push(&mut self, term: f64) {
        if term != 0.0 {
            self.0.push(term);
        }
    }

    fn grow(&self, term: f64) -> Self {
        let mut result = Self::default();
        let mut carry = term;
        for &part in &self.0 {
            let (sum, error) = two_sum(carry, part);
            result.push(error);
            carry = sum;
        }
        result.push(carry);
        result
    }

    fn plus(&self, other: &Self) -> Self {
        other
            .0
            .iter()
            .fold(self.clone(), |sum, &term| sum.grow(term))
    }

    fn minus(&self, other: &Self) -> Self {
        other
            .0
            .iter()
            .fold(self.clone(), |sum, &term| sum.grow(-term))
    }

    fn scaled(&self, factor: f64) -> Self {
        self.0.iter().fold(Self::default(), |sum, &term| {
            let (high, low) = two_product(term, factor);
            sum.grow(low).grow(high)
        })
    }

    fn times(&self, other: &Self) -> Self {
        other
            .0
            .iter()
            .fold(Self::default(), |sum, &term| sum.plus(&self.scaled(term)))
    }

    fn value(&self) -> f64 {
        self.0.iter().sum()
    }

    fn sign(&self) -> f64 {
        self.0.last().map_or(0.0, |term| term.signum())
    }
}

fn exact_difference(a: DVec3, b: DVec3) -> [Expansion; 3] {
    [
        Expansion::difference(a.x, b.x),
        Expansion::difference(a.y, b.y),
        Expansion::difference(a.z, b.z),
    ]
}

fn exact_cross(u: &[Expansion; 3], v: &[Expansion; 3]) -> [Expansion; 3] {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| u[i].times(&v[j]).minus(&u[j].times(&v[i])))
}

/// The cross product `(b - a) x (c - a)`, each component rounded once.
pub(super) fn cross(a: DVec3, b: DVec3, c: DVec3) -> DVec3 {
    let parts = exact_cross(&exact_difference(b, a), &exact_difference(c, a));
    DVec3::from_array(parts.map(|part| part.value()))
}

/// A number with the sign of `((b - a) x (c - a)) . (d - a)`: positive where `d` lies on the side
/// from which `a b c` turns counter-clockwise, zero exactly where the four points are coplanar.
pub(super) fn side(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> f64 {
    let (u, v, w) = (b - a, c - a, d - a);
    let estimate = u.cross(v).dot(w);
    let permanent = magnitude(u, v).dot(w.abs());
    if estimate.abs() > ORIENT_ERROR_BOUND * permanent {
        return estimate;
    }
    exact_side(a, b, c, d)
}

fn magnitude(u: DVec3, v: DVec3) -> DVec3 {
    let (u, v) = (u.abs(), v.abs());
    DVec3::new(
        u.y * v.z + u.z * v.y,
        u.z * v.x + u.x * v.z,
        u.x * v.y + u.y * v.x,
    )
}

fn exact_side(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> f64 {
    let normal = exact_cross(&exact_difference(b, a), &exact_difference(c, a));
    let w = exact_difference(d, a);
    (0..3)
        .map(|i| normal[i].times(&w[i]))
        .fold(Expansion::default(), |sum, term| sum.plus(&term))
        .sign()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn side_sees_the_last_bit() {
        let (a, b, c) = (
            DVec3::new(0.1, 0.1, 0.1),
            DVec3::new(0.2, 0.2, 0.2),
            DVec3::new(0.3, 0.1, 0.7),
        );
        assert_eq!(side(a, b, c, a), 0.0);
        let on = DVec3::new(0.4, 0.4, 0.4);
        let up = DVec3::new(0.4, 0.4_f64.next_up(), 0.4);
        assert_eq!(side(a, DVec3::ONE, DVec3::X, DVec3::ONE), 0.0);
        assert!(
            side(a, on, c, up) * side(a, on, c, DVec3::new(0.4, 0.4_f64.next_down(), 0.4)) < 0.0
        );
        assert_eq!(side(a, b, c, up), -side(b, a, c, up));
    }

    #[test]
    fn cross_of_nearly_parallel_edges_keeps_its_digits() {
        let a = DVec3::ZERO;
        let b = DVec3::new(1.0, 1.0, 0.0);
        let c = DVec3::new(1.0 + f64::EPSILON, 1.0, 0.0);
        assert_eq!(cross(a, b, c), DVec3::new(0.0, 0.0, -f64::EPSILON));
    }
}
