//! Elements of H5MD: fixed values, or one value for each frame with its step and time.

use super::array::{Array, words};
use crate::claimed_size;
use hdf5::{Container, Dataset, Group};

/// An element of H5MD.
pub(super) struct H5mdElement {
    values: Dataset,
    clock: Option<FrameTimes>,
}

/// Steps and times of the frames.
pub(super) struct FrameTimes {
    steps: FrameSeries,
    times: Option<FrameSeries>,
}

/// One number per frame, listed or at a fixed interval.
enum FrameSeries {
    Listed(Vec<f64>),
    Fixed { interval: f64, offset: f64 },
}

impl H5mdElement {
    /// The element of this name, if the group has it.
    pub(super) fn open(group: &Group, name: &str) -> Result<Option<Self>, String> {
        if !group.link_exists(name) {
            return Ok(None);
        }
        if let Ok(values) = group.dataset(name) {
            return Ok(Some(Self { values, clock: None }));
        }
        let of = |e: hdf5::Error| format!("{}/{name}: {e}", group.name().trim_start_matches('/'));
        let element = group.group(name).map_err(of)?;
        let values = element.dataset("value").map_err(of)?;
        let steps = FrameSeries::open(&element, "step")?
            .ok_or_else(|| format!("{} has values for frames, but no step", element.name().trim_start_matches('/')))?;
        let times = FrameSeries::open(&element, "time")?;
        Ok(Some(Self { values, clock: Some(FrameTimes { steps, times }) }))
    }

    /// Number of frames, if the element has frames.
    pub(super) fn frames(&self) -> Result<Option<usize>, String> {
        let Some(clock) = &self.clock else { return Ok(None) };
        let stored = self.values.shape().first().copied().unwrap_or(0);
        match &clock.steps {
            FrameSeries::Fixed { .. } => Ok(Some(stored)),
            // The step is written last.
            FrameSeries::Listed(steps) if steps.len() <= stored => Ok(Some(steps.len())),
            FrameSeries::Listed(steps) => {
                let name = self.values.name();
                Err(format!("{} has {stored} frames for {} steps", name.trim_start_matches('/'), steps.len()))
            }
        }
    }

    /// Step and time of a frame.
    pub(super) fn clock(&self, frame: usize) -> (Option<f64>, Option<f64>) {
        let Some(clock) = &self.clock else { return (None, None) };
        (clock.steps.at(frame), clock.times.as_ref().and_then(|times| times.at(frame)))
    }

    /// Value of a frame by its number, or the fixed value.
    pub(super) fn value(self, frame: usize) -> Result<Array, String> {
        if self.clock.is_some() { Array::of_frame(self.values, frame) } else { Array::fixed(self.values) }
    }

    /// Value that holds at a step: that of the last frame up to this step.
    pub(super) fn at_step(self, step: Option<f64>) -> Result<Array, String> {
        let Some(count) = self.frames()? else { return Array::fixed(self.values) };
        let holds = |frame: &usize| match (self.clock(*frame).0, step) {
            (Some(own), Some(step)) => own <= step,
            _ => true,
        };
        let name = self.values.name();
        let frame = (0..count).rev().find(holds);
        let none = || format!("{} has no value until the step of the frame", name.trim_start_matches('/'));
        Array::of_frame(self.values, frame.ok_or_else(none)?)
    }
}

impl FrameSeries {
    fn open(group: &Group, name: &str) -> Result<Option<Self>, String> {
        if !group.link_exists(name) {
            return Ok(None);
        }
        let dataset = claimed_size::dataset(group, name).map_err(words)?;
        let numbers = |container: &Container| container.read_raw::<f64>().map_err(words);
        if dataset.ndim() > 0 {
            return numbers(&dataset).map(|list| Some(Self::Listed(list)));
        }
        let has_offset = dataset.attr_names().map_err(words)?.iter().any(|attribute| attribute == "offset");
        let attribute = has_offset.then(|| dataset.attr("offset")).transpose().map_err(words)?;
        let offset = attribute.map_or(Ok(vec![]), |attribute| numbers(&attribute))?;
        let interval = numbers(&dataset)?.first().copied().unwrap_or_default();
        Ok(Some(Self::Fixed { interval, offset: offset.first().copied().unwrap_or(0.0) }))
    }

    fn at(&self, frame: usize) -> Option<f64> {
        match self {
            Self::Listed(list) => list.get(frame).copied(),
            Self::Fixed { interval, offset } => Some(offset + interval * frame as f64),
        }
    }
}
