//! The progress of a run, as numbers for a checkpoint.

use super::{Measurement, Stage, Tally};

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
    pub tally: Tally,
    /// Rows of the pairs in contact at the last computation of forces.
    pub touching: Vec<[u32; 2]>,
}

const STAGES: [Stage; 3] = [Stage::RemoveOverlaps, Stage::Equilibrate, Stage::Flow];

/// Called with each number of a state in turn: it reads the number or sets it.
type Visitor<'a> = &'a mut dyn FnMut(&mut f64);

impl Progress {
    /// All values, exact to the last bit.
    pub fn to_numbers(&self) -> Vec<f64> {
        let stage = STAGES.iter().position(|&stage| stage == self.stage).unwrap_or_default();
        let mut numbers = vec![stage as f64];
        self.clone().visit(&mut |number| numbers.push(*number));
        numbers.extend(self.touching.as_flattened().iter().map(|&row| f64::from(row)));
        numbers
    }

    /// Progress from these numbers, or `None` if their count is wrong.
    pub fn from_numbers(numbers: &[f64]) -> Option<Self> {
        let (&stage, mut rest) = numbers.split_first()?;
        let (stage, tally) = (*STAGES.get(stage as usize)?, Tally::default());
        let mut progress = Self { stage, step: 0, list_built: 0, tally, touching: Vec::new() };
        let mut is_whole = true;
        progress.visit(&mut |number| match rest.split_first() {
            Some((&first, others)) => (*number, rest) = (first, others),
            None => is_whole = false,
        });
        let (pairs, &[]) = rest.as_chunks::<2>() else { return None };
        progress.touching = pairs.iter().map(|pair| pair.map(|row| row as u32)).collect();
        is_whole.then_some(progress)
    }

    /// The numbers between the stage and the pairs in contact.
    fn visit(&mut self, visitor: Visitor) {
        let Tally { first, latest, input, drag, damping, path, stress, collisions } = &mut self.tally;
        visit_count(&mut self.step, visitor);
        visit_count(&mut self.list_built, visitor);
        [input, drag, damping, path].into_iter().for_each(&mut *visitor);
        stress.as_mut().iter_mut().for_each(&mut *visitor);
        for count in collisions {
            visit_count(count, visitor);
        }
        first.visit(visitor);
        latest.visit(visitor);
    }
}

impl Measurement {
    fn visit(&mut self, visitor: Visitor) {
        [&mut self.time, &mut self.kinetic, &mut self.elastic].into_iter().for_each(&mut *visitor);
        let stresses = [&mut self.kinetic_stress, &mut self.contact_stress];
        stresses.into_iter().flat_map(AsMut::as_mut).for_each(&mut *visitor);
        visitor(&mut self.mean_speed);
        visit_count(&mut self.contacts, visitor);
        [&mut self.input, &mut self.drag, &mut self.damping].into_iter().for_each(&mut *visitor);
    }
}

/// Visits an integer, exact below 2^53.
fn visit_count(count: &mut u64, visitor: Visitor) {
    let mut number = *count as f64;
    visitor(&mut number);
    *count = number as u64;
}
