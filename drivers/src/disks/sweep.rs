//! Many runs: seeds, viscosities, rates of shear and area fractions, on all cores, and their averages over the seeds.

use super::{Disks, Flow, Model, Parameters, Record, viscous_length};
use crate::ParameterError;
use rayon::prelude::*;

/// The runs to make: every combination of what is listed, from one set of parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Sweep {
    /// What all runs share.
    pub base: Parameters,
    /// Names of the random starts.
    pub seeds: Vec<u64>,
    /// Viscosities.
    pub viscosities: Vec<f64>,
    /// Rates of shear.
    pub rates: Vec<f64>,
    /// Area fractions.
    pub area_fractions: Vec<f64>,
    /// Strain at which a run ends.
    pub strain: f64,
    /// Strain from one record to the next.
    pub record_every: f64,
}

/// One run of a sweep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Case {
    /// Its place among all of them.
    pub index: usize,
    /// Name of the random start.
    pub seed: u64,
    /// Viscosity.
    pub viscosity: f64,
    /// Rate of shear.
    pub rate: f64,
    /// Area fraction.
    pub area_fraction: f64,
}

/// The store of the records of a sweep's runs, so that no run is repeated. Its methods are called from any thread.
pub trait SweepStore: Sync {
    /// Why a sweep ends early.
    type Error: From<ParameterError> + Send;

    /// The records of a run, if it was made before.
    fn stored(&self, case: &Case) -> Result<Option<Vec<Record>>, Self::Error>;

    /// Stores the records of a run that has ended.
    fn store(&self, case: &Case, records: &[Record]) -> Result<(), Self::Error>;

    /// Called now and then with the part of a run's steps that is done.
    fn tell(&self, case: &Case, part: f64);

    /// Called at each record; an error ends the sweep.
    fn go_on(&self) -> Result<(), Self::Error> {
        Ok(())
    }
}

/// A mean over seeds.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Estimate {
    /// The mean.
    pub mean: f64,
    /// Its standard error; not a number from one value.
    pub error: f64,
}

impl Estimate {
    /// Of independent values.
    pub fn of(values: &[f64]) -> Self {
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
        Self { mean, error: (squares / (count - 1.0) / count).sqrt() }
    }
}

/// The average over seeds at one viscosity, rate and area fraction.
#[derive(Debug, Clone, PartialEq)]
pub struct Branch {
    /// One of its runs.
    pub case: Case,
    /// The viscous length.
    pub viscous_length: f64,
    /// Each number of [`Record::COLUMNS`] at each record.
    pub averages: Vec<Vec<Estimate>>,
    /// Segregation averaged over the last tenth of each run.
    pub last: Estimate,
}

impl Sweep {
    /// All runs: those that differ in the seed alone follow each other.
    pub fn cases(&self) -> Vec<Case> {
        let mut cases = Vec::new();
        for &area_fraction in &self.area_fractions {
            for &viscosity in &self.viscosities {
                for &rate in &self.rates {
                    for &seed in &self.seeds {
                        cases.push(Case { index: cases.len(), seed, viscosity, rate, area_fraction });
                    }
                }
            }
        }
        cases
    }

    /// The system of a run.
    pub fn model(&self, case: &Case) -> Result<Model, ParameterError> {
        let &Case { seed, viscosity, rate, area_fraction, .. } = case;
        let flow = Flow::Shear { rate };
        Model::new(Parameters { area_fraction, viscosity, flow, seed, ..self.base.clone() })
    }

    /// Makes all runs that the store has no records of, several at a time, each on one core if it is small. Ends at the
    /// first failure.
    pub fn run<K: SweepStore>(&self, store: &K) -> Result<Vec<(Case, Vec<Record>)>, K::Error> {
        let run = |case: Case| {
            if let Some(records) = store.stored(&case)? {
                return Ok((case, records));
            }
            let records = self.records(&case, store)?;
            store.store(&case, &records)?;
            Ok((case, records))
        };
        self.cases().into_par_iter().with_max_len(1).map(run).collect()
    }

    /// Prepares a system, runs it and keeps records of it.
    fn records<K: SweepStore>(&self, case: &Case, store: &K) -> Result<Vec<Record>, K::Error> {
        let model = self.model(case)?;
        let p = model.parameters();
        let strain_per_step = p.flow.rate(p.edges[1]).abs() * p.time_step;
        let steps_in = |strain: f64| (strain / strain_per_step).round() as u64;
        let (end, every) = (steps_in(self.strain), steps_in(self.record_every).max(1));
        let before = model.preparing_steps() as f64;
        let part = |steps: f64| steps / (before + end as f64);
        let mut disks = Disks::prepare_and_tell(&model, &mut |done| store.tell(case, part(done * before)))?;
        let mut records = vec![disks.record()];
        while disks.steps() < end {
            store.go_on()?;
            disks.restart_tally();
            disks.advance(every.min(end - disks.steps()));
            disks.check()?;
            records.push(disks.record());
            store.tell(case, part(before + disks.steps() as f64));
        }
        Ok(records)
    }

    /// The averages over seeds of the runs made.
    pub fn branches(&self, runs: &[(Case, Vec<Record>)]) -> Result<Vec<Branch>, ParameterError> {
        runs.chunks(self.seeds.len().max(1)).map(|runs| self.branch(runs)).collect()
    }

    fn branch(&self, runs: &[(Case, Vec<Record>)]) -> Result<Branch, ParameterError> {
        let case = runs[0].0;
        let at = |k: usize| {
            let rows: Vec<_> = runs.iter().map(|(_, records)| records[k].values()).collect();
            let estimate = |column: usize| Estimate::of(&rows.iter().map(|row| row[column]).collect::<Vec<_>>());
            (0..Record::COLUMNS.len()).map(estimate).collect()
        };
        let shortest = runs.iter().map(|(_, records)| records.len()).min().unwrap_or(0);
        let last: Vec<f64> = runs.iter().map(|(_, records)| mean_of_last_tenth(records)).collect();
        Ok(Branch {
            case,
            viscous_length: viscous_length(&self.model(&case)?),
            averages: (0..shortest).map(at).collect(),
            last: Estimate::of(&last),
        })
    }
}

fn mean_of_last_tenth(records: &[Record]) -> f64 {
    let last = &records[records.len() - records.len().div_ceil(10)..];
    last.iter().map(|r| r.segregation).sum::<f64>() / last.len() as f64
}
