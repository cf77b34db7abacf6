//! What the machine takes from a thread that works: interrupts, and what a hypervisor does meanwhile.

use std::time::{Duration, Instant};

use cpu_time::ThreadTime;

/// A frame that works until its clock is over may be late by a pause once in so many frames.
const LATE_ONE_IN: f64 = 1e5;

/// What lies between two looks at a clock that nothing came between, in nanoseconds: no pause.
const LOOK_NS: u64 = 2000;

/// Pauses longer than this are as long as a deadline, in nanoseconds: they make frames late whatever is kept for them.
const LONGEST_NS: u64 = 100_000;

/// Looks at the thread's clock for so long; how long before a deadline a clock is to be over, in nanoseconds, so that
/// pauses like those that were seen make one frame in a hundred thousand late that works until then. Pauses longer than
/// a tenth of a millisecond are left out.
#[must_use]
pub fn margin_ns(watched: Duration) -> u32 {
    let begun = Instant::now();
    let mut pauses_ns = Vec::new();
    let mut last = ThreadTime::now();
    while begun.elapsed() < watched {
        let now = ThreadTime::now();
        let gap_ns = now.duration_since(last).as_nanos() as u64;
        if (LOOK_NS..LONGEST_NS).contains(&gap_ns) {
            pauses_ns.push(gap_ns);
        }
        last = now;
    }
    margin_for(pauses_ns, watched)
}

/// The least m for which the pauses of a time have no more than its hundred-thousandth part above m: a frame whose
/// clock is over at m before its deadline is late if a pause of length g begins within the g - m before that.
fn margin_for(mut pauses_ns: Vec<u64>, watched: Duration) -> u32 {
    pauses_ns.sort_unstable_by(|a, b| b.cmp(a));
    let may_be_above = watched.as_nanos() as f64 / LATE_ONE_IN;
    let mut sum = 0.0;
    let mut margin: f64 = 0.0;
    // What k pauses have above m is most for the k longest: m is right when it is for every k.
    for (k, pause) in (1..).zip(pauses_ns) {
        sum += pause as f64;
        margin = margin.max((sum - may_be_above) / f64::from(k));
    }
    margin.ceil() as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECOND: Duration = Duration::from_secs(1);

    #[test]
    fn margins_leave_a_hundred_thousandth_part_of_the_time_above_them() {
        assert_eq!(margin_for(vec![], SECOND), 0);
        // 10 us a second may be above: one pause, a few alike, and a long one among many short ones.
        assert_eq!(margin_for(vec![9_000], SECOND), 0);
        assert_eq!(margin_for(vec![70_000], SECOND), 60_000);
        assert_eq!(margin_for(vec![30_000; 4], SECOND), 27_500);
        let mut mixed = vec![15_000; 250];
        mixed.push(45_000);
        assert_eq!(margin_for(mixed.clone(), SECOND), 35_000);
        mixed.push(45_000);
        assert_eq!(margin_for(mixed.clone(), SECOND), 40_000);
        assert_eq!(margin_for(mixed, 10 * SECOND), 14_842);
    }
}
