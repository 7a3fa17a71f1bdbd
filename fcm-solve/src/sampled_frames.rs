//! Choice of the frames of a trajectory for statistics, and the missing ones among them.

use crate::streams;
use files::{MissingSteps, TrajectoryReader};
use std::ops::RangeInclusive;
use std::path::Path;

/// Frames in order of time, at steps that differ by multiples of an interval.
pub struct SampledFrames {
    pub frames: Vec<usize>,
    /// Interval in steps.
    pub interval: u64,
    /// Number of intervals from the first frame to the last, plus one.
    pub samples: u64,
    /// Frames between the first and the last that the run should have written but that are absent.
    pub missing: MissingSteps,
}

impl SampledFrames {
    /// Chooses the frames in a span of time whose step and time are intact, each at a later step than the one before.
    /// Missing frames, and frames that are left out, are named in warnings.
    pub fn of(recorded: &TrajectoryReader, span: &RangeInclusive<f64>, path: &Path) -> Self {
        let frames = in_order(recorded, span, path);
        let interval = recorded.common_interval(&frames).max(1);
        let [first, last] =
            [frames.first(), frames.last()].map(|frame| frame.map_or(0, |&frame| recorded.steps()[frame]));
        let missing = recorded.missing_steps(&(first..=last));
        if !missing.is_empty() {
            let count = missing.count();
            streams::log(format_args!(
                "warning: {}: {count} frames that the run was to write are missing, of {missing}; the statistics are \
                 without them",
                path.display()
            ));
        }
        Self { frames, interval, samples: ((last - first) / interval).saturating_add(1), missing }
    }
}

fn in_order(recorded: &TrajectoryReader, span: &RangeInclusive<f64>, path: &Path) -> Vec<usize> {
    let leave_out = |frame: usize, why: &str| {
        streams::log(format_args!(
            "warning: {} is damaged: frame {frame} {why}; the statistics are without this frame",
            path.display()
        ));
    };
    let (mut frames, mut latest) = (Vec::new(), None);
    for (frame, (&step, time)) in recorded.steps().iter().zip(recorded.times()).enumerate() {
        if !recorded.has_clock(frame) {
            leave_out(frame, "does not fit its checksums: step and time");
        } else if latest.is_some_and(|latest| step <= latest) {
            leave_out(frame, &format!("is of step {step}, which does not come after the one before"));
        } else {
            latest = Some(step);
            frames.extend(span.contains(time).then_some(frame));
        }
    }
    frames
}
