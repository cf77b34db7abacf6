//! Lines and parabolas through samples: what lies between two frames.

/// A sample: time in seconds, value.
pub type Sample = (f64, f64);

/// The line of least squares through samples: value at time zero, and slope. Two samples at least.
pub fn line(samples: &[Sample]) -> (f64, f64) {
    let count = samples.len() as f64;
    let mean_t = samples.iter().map(|s| s.0).sum::<f64>() / count;
    let mean_v = samples.iter().map(|s| s.1).sum::<f64>() / count;
    let (mut above, mut below) = (0.0, 0.0);
    for (t, v) in samples {
        above += (t - mean_t) * (v - mean_v);
        below += (t - mean_t).powi(2);
    }
    let slope = above / below;
    (mean_v - slope * mean_t, slope)
}

/// When the line through samples reaches zero, in seconds.
pub fn zero(samples: &[Sample]) -> f64 {
    let (start, slope) = line(samples);
    -start / slope
}

/// The extreme value of the parabola through three evenly spaced values, the middle one the largest.
pub fn vertex([before, top, after]: [f64; 3]) -> f64 {
    let bend = before - 2.0 * top + after;
    let slope = 0.5 * (after - before);
    if bend == 0.0 {
        top
    } else {
        top - slope * slope / (2.0 * bend)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_and_parabolas_are_met_exactly() {
        let samples = [(0.5, 3.0), (1.0, 2.0), (2.0, 0.0)];
        let (start, slope) = line(&samples);
        assert!((start - 4.0).abs() < 1e-12 && (slope + 2.0).abs() < 1e-12);
        assert!((zero(&samples) - 2.0).abs() < 1e-12);
        // 5 - (t - 0.25)^2 at -1, 0 and 1.
        let parabola = |t: f64| 5.0 - (t - 0.25).powi(2);
        assert_eq!(vertex([-1.0, 0.0, 1.0].map(parabola)), 5.0);
    }
}
