//! Selection of frames of a trajectory.

use std::str::FromStr;

/// Frames selected by number like a slice in Python: `START:STOP:STEP` counts from 0 and excludes STOP, each part may
/// be missing, negative numbers count from the end, and a single number selects one frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FrameRange {
    start: i64,
    /// `None` selects up to the last frame.
    stop: Option<i64>,
    step: usize,
}

impl FrameRange {
    /// Numbers of the selected frames out of `count` frames.
    pub fn of(&self, count: usize) -> impl Iterator<Item = usize> + use<> {
        let place = |number: i64| {
            let from_end = if number < 0 { count as i64 } else { 0 };
            number.saturating_add(from_end).clamp(0, count as i64) as usize
        };
        (place(self.start)..self.stop.map_or(count, place)).step_by(self.step)
    }
}

impl FromStr for FrameRange {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number = |part: &str| {
            let number = if part.is_empty() { Ok(None) } else { part.parse::<i64>().map(Some) };
            number.map_err(|_| format!("needs to be START:STOP:STEP in whole numbers, but has '{part}'"))
        };
        let parts = text.split(':').map(number).collect::<Result<Vec<_>, _>>()?;
        let (start, stop, step) = match parts[..] {
            [Some(one)] => (Some(one), (one != -1).then_some(one.saturating_add(1)), None),
            [start, stop] => (start, stop, None),
            [start, stop, step] => (start, stop, step),
            _ => return Err("needs to be START:STOP:STEP, or a number".to_owned()),
        };
        let step = usize::try_from(step.unwrap_or(1)).ok().filter(|&step| step > 0);
        Ok(Self { start: start.unwrap_or(0), stop, step: step.ok_or("needs a STEP above 0")? })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_slices_of_python() {
        let of = |text: &str| text.parse::<FrameRange>().unwrap().of(6).collect::<Vec<_>>();
        assert_eq!((of(":"), of("2"), of("-1"), of("-2")), (vec![0, 1, 2, 3, 4, 5], vec![2], vec![5], vec![4]));
        assert_eq!(
            (of("1:3"), of("::4"), of("-3:"), of("1:-1:2")),
            (vec![1, 2], vec![0, 4], vec![3, 4, 5], vec![1, 3])
        );
        assert_eq!((of("9"), of("4:2"), of("-9:1"), of("9:")), (vec![], vec![], vec![0], vec![]));
    }

    #[test]
    fn what_is_no_range_is_refused() {
        for (text, words) in [
            ("a", "has 'a'"),
            ("", "or a number"),
            ("1:2:0", "STEP above 0"),
            ("::-1", "STEP above 0"),
            ("1:2:3:4", "or"),
        ] {
            let error = text.parse::<FrameRange>().unwrap_err();
            assert!(error.contains(words), "{text}: {error}");
        }
    }
}
