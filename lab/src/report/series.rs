//! Curves of a run, ready to be drawn: pairs of frame number and value.

use super::{FrameSample, Run};

pub(super) type Curve = Vec<(f64, f64)>;

/// The running median has about this many independent windows over the whole run.
const WINDOWS: usize = 150;
const WINDOW_FRAMES_MIN: usize = 5;

/// Frame numbers from the first to one past the last, over samples and phases.
pub(super) fn frame_range(run: &Run) -> (f64, f64) {
    let sampled = run
        .samples
        .iter()
        .map(|sample| (sample.frame, sample.frame + 1));
    let planned = run
        .phases
        .iter()
        .map(|phase| (phase.first_frame, phase.first_frame + phase.frames));
    let hull = sampled
        .chain(planned)
        .reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
    let (first, end) = hull.unwrap_or((0, 1));
    (f64::from(first), f64::from(end.max(first + 1)))
}

/// Whole decades that hold every frame time, and at least 1 to 1000 microseconds so that runs can
/// be compared by eye.
pub(super) fn time_range_us(run: &Run) -> (f64, f64) {
    decades_around(run.samples.iter().map(|sample| sample.time_us))
}

/// The same for any times.
pub(super) fn decades_around(times: impl Iterator<Item = f64>) -> (f64, f64) {
    let times = times.filter(|time| time.is_finite() && *time > 0.0);
    let (least, most) = times.fold((1.0_f64, 1000.0_f64), |(least, most), time| {
        (least.min(time), most.max(time))
    });
    (
        10f64.powf(least.log10().floor()).max(0.001),
        10f64.powf(most.log10().ceil()).min(1e9),
    )
}

pub(super) fn slowest(run: &Run) -> Option<&FrameSample> {
    run.samples
        .iter()
        .max_by(|a, b| a.time_us.total_cmp(&b.time_us))
}

pub(super) fn curve(run: &Run, value: impl Fn(&FrameSample) -> f64) -> Curve {
    run.samples
        .iter()
        .map(|sample| (f64::from(sample.frame), value(sample)))
        .collect()
}

/// Odd number of frames over which the median runs; `None` if the run is too short to need one.
pub(super) fn window_frames(run: &Run) -> Option<usize> {
    window_over(run.samples.len())
}

/// The same for a number of frames.
pub(super) fn window_over(frames: usize) -> Option<usize> {
    let window = (frames / WINDOWS) | 1;
    (window >= WINDOW_FRAMES_MIN).then_some(window)
}

/// Median over the frames around each frame; windows at the ends are cut short.
pub(super) fn running_median(points: &[(f64, f64)], window: usize) -> Curve {
    let reach = window / 2;
    let median_around = |index: usize| {
        let end = (index + reach + 1).min(points.len());
        let mut values: Vec<f64> = points[index.saturating_sub(reach)..end]
            .iter()
            .map(|point| point.1)
            .collect();
        let middle = values.len() / 2;
        *values.select_nth_unstable_by(middle, f64::total_cmp).1
    };
    points
        .iter()
        .enumerate()
        .map(|(index, point)| (point.0, median_around(index)))
        .collect()
}

/// The curve without the inner points of its horizontal stretches.
pub(super) fn without_flat_points(points: &[(f64, f64)]) -> Curve {
    let is_corner = |index: usize| {
        let neighbours = points.get(index.wrapping_sub(1)).zip(points.get(index + 1));
        neighbours
            .is_none_or(|(before, after)| before.1 != points[index].1 || after.1 != points[index].1)
    };
    (0..points.len())
        .filter(|&index| is_corner(index))
        .map(|index| points[index])
        .collect()
}

/// Multiples of 1, 2 or 5 times a power of ten within a range: as many as fit into `ticks_max`, at
/// least 1 apart.
pub(super) fn round_ticks(first: f64, last: f64, ticks_max: f64) -> Vec<f64> {
    let step_min = ((last - first) / ticks_max).max(1.0);
    let power = 10f64.powf(step_min.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0]
        .map(|factor| factor * power)
        .into_iter()
        .find(|step| *step >= step_min);
    let step = step.unwrap_or(10.0 * power);
    let ticks = ((first / step).ceil() as i64)..=((last / step).floor() as i64);
    ticks.map(|tick| tick as f64 * step).collect()
}

#[cfg(test)]
mod tests {
    use super::{round_ticks, running_median, without_flat_points};

    #[test]
    fn ticks_are_round_and_inside() {
        assert_eq!(
            round_ticks(0.0, 3653.0, 10.0),
            [0.0, 500.0, 1000.0, 1500.0, 2000.0, 2500.0, 3000.0, 3500.0]
        );
        assert_eq!(round_ticks(0.0, 3.0, 4.0), [0.0, 1.0, 2.0, 3.0]);
        assert_eq!(
            round_ticks(901.0, 1400.0, 5.0),
            [1000.0, 1100.0, 1200.0, 1300.0, 1400.0]
        );
    }

    #[test]
    fn running_median_drops_a_spike_and_keeps_a_step() {
        let points: Vec<(f64, f64)> = [1.0, 1.0, 9.0, 1.0, 1.0, 5.0, 5.0, 5.0]
            .into_iter()
            .enumerate()
            .map(|(i, y)| (i as f64, y))
            .collect();
        let medians: Vec<f64> = running_median(&points, 3)
            .into_iter()
            .map(|point| point.1)
            .collect();
        assert_eq!(medians, [1.0, 1.0, 1.0, 1.0, 1.0, 5.0, 5.0, 5.0]);
    }

    #[test]
    fn flat_stretches_keep_their_ends() {
        let points = [(0.0, 2.0), (1.0, 2.0), (2.0, 2.0), (3.0, 4.0), (4.0, 4.0)];
        assert_eq!(
            without_flat_points(&points),
            [(0.0, 2.0), (2.0, 2.0), (3.0, 4.0), (4.0, 4.0)]
        );
        assert_eq!(without_flat_points(&points[..1]), points[..1]);
        assert_eq!(without_flat_points(&[]), []);
    }
}
