//! The progress of a run, as numbers for a checkpoint.

use super::{Measurement, Stage, Tally};
use domain::Vector;

/// State of a run apart from its particles.
#[derive(Debug, Clone, PartialEq)]
pub struct Progress {
    /// The stage.
    pub stage: Stage,
    /// Steps completed in this stage.
    pub step: u64,
    /// Step at which the neighbour list was built.
    pub list_made: u64,
    /// Sums over time so far.
    pub tally: Tally,
    /// Rows of the pairs in contact at the last computation of forces.
    pub touching: Vec<[u32; 2]>,
}

const STAGES: [Stage; 3] = [Stage::Settle, Stage::Mix, Stage::Flow];

impl Progress {
    /// All values, exact to the last bit.
    pub fn to_numbers(&self) -> Vec<f64> {
        let Tally { first, latest, input, drag, damping, path, stress, collisions } = self.tally;
        let stage = STAGES.iter().position(|&s| s == self.stage).unwrap_or_default();
        let mut numbers = vec![stage as f64, self.step as f64, self.list_made as f64, input, drag, damping, path];
        numbers.extend(stress.to_array());
        numbers.extend(collisions.map(|n| n as f64));
        numbers.extend(first.to_numbers());
        numbers.extend(latest.to_numbers());
        numbers.extend(self.touching.as_flattened().iter().map(|&row| f64::from(row)));
        numbers
    }

    /// Progress from these numbers, or `None` if their count is wrong.
    pub fn from_numbers(numbers: &[f64]) -> Option<Self> {
        let (&[stage, step, list_made, input, drag, damping, path], rest) = numbers.split_first_chunk::<7>()?;
        let (&stress, rest) = rest.split_first_chunk::<3>()?;
        let (&collisions, rest) = rest.split_first_chunk::<3>()?;
        let (&first, rest) = rest.split_first_chunk()?;
        let (&latest, rest) = rest.split_first_chunk()?;
        let (pairs, &[]) = rest.as_chunks::<2>() else { return None };
        let tally = Tally {
            first: Measurement::from_numbers(first),
            latest: Measurement::from_numbers(latest),
            input,
            drag,
            damping,
            path,
            stress: Vector::from_array(stress),
            collisions: collisions.map(|n| n as u64),
        };
        let stage = *STAGES.get(stage as usize)?;
        let touching = pairs.iter().map(|pair| pair.map(|row| row as u32)).collect();
        Some(Self { stage, step: step as u64, list_made: list_made as u64, tally, touching })
    }
}

/// Number of values of a measurement.
const MEASURED: usize = 14;

impl Measurement {
    fn to_numbers(self) -> [f64; MEASURED] {
        let Self { time, kinetic, elastic, mean_speed, contacts, input, drag, damping, .. } = self;
        let [a, b, c] = self.kinetic_stress.to_array();
        let [d, e, f] = self.contact_stress.to_array();
        [time, kinetic, elastic, a, b, c, d, e, f, mean_speed, contacts as f64, input, drag, damping]
    }

    fn from_numbers(numbers: [f64; MEASURED]) -> Self {
        let [time, kinetic, elastic, a, b, c, d, e, f, mean_speed, contacts, input, drag, damping] = numbers;
        Self {
            time,
            kinetic,
            elastic,
            kinetic_stress: Vector::new(a, b, c),
            contact_stress: Vector::new(d, e, f),
            mean_speed,
            contacts: contacts as u64,
            input,
            drag,
            damping,
        }
    }
}
