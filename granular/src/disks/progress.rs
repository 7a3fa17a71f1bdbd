//! The progress of a run, as numbers for a checkpoint.

use super::{DiskTally, Stage};

/// State of a run apart from its particles.
#[derive(Debug, Clone, PartialEq)]
pub struct Progress {
    /// The stage.
    pub stage: Stage,
    /// Steps completed in this stage.
    pub step: u64,
    /// Step at which the neighbour list was built.
    pub list_built: u64,
    /// Sums over time so far.
    pub tally: DiskTally,
    /// Rows of the pairs in contact at the last computation of forces.
    pub touching: Vec<[u32; 2]>,
}

/// Numbers of a tally.
const TALLY: usize = size_of::<DiskTally>() / size_of::<f64>();

impl Progress {
    /// All values, exact to the last bit; integers are exact below 2^53.
    pub fn to_numbers(&self) -> Vec<f64> {
        let head = [self.stage as u64, self.step, self.list_built].map(|count| count as f64);
        let tally: &[f64; TALLY] = bytemuck::cast_ref(&self.tally);
        let touching = self.touching.as_flattened().iter().map(|&row| f64::from(row));
        head.iter().chain(tally).copied().chain(touching).collect()
    }

    /// Progress from these numbers, or `None` if their count is wrong.
    pub fn from_numbers(numbers: &[f64]) -> Option<Self> {
        let (&[stage, step, list_built], rest) = numbers.split_first_chunk()?;
        let (tally, rest) = rest.split_first_chunk::<TALLY>()?;
        let (pairs, &[]) = rest.as_chunks() else { return None };
        Some(Self {
            stage: *Stage::ALL.get(stage as usize)?,
            step: step as u64,
            list_built: list_built as u64,
            tally: bytemuck::cast(*tally),
            touching: pairs.iter().map(|pair: &[f64; 2]| pair.map(|row| row as u32)).collect(),
        })
    }
}
