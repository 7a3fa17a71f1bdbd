//! Many runs: seeds, viscosities and rates of shear, on all cores, and their averages over the seeds.

use super::{Disks, Flow, Model, Parameters, viscous_length};
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
    /// Strain at which a run ends.
    pub strain: f64,
    /// Strain from one record to the next.
    pub record_every: f64,
}

/// One run of a sweep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Case {
    /// Name of the random start.
    pub seed: u64,
    /// Viscosity.
    pub viscosity: f64,
    /// Rate of shear.
    pub rate: f64,
}

/// What a run looks like at a strain.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Record {
    /// The strain.
    pub strain: f64,
    /// The segregation parameter.
    pub segregation: f64,
    /// Kinetic energy of the excess velocities of a disk.
    pub kinetic: f64,
    /// The stress `-P_xy`, averaged over the time since the record before.
    pub shear_stress: f64,
    /// The pressure, averaged likewise.
    pub pressure: f64,
    /// Mean free path through the liquid in that time.
    pub free_path: f64,
    /// Height of the strongest lanes' peak.
    pub lanes: f64,
}

/// A mean over seeds.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Estimate {
    /// The mean.
    pub mean: f64,
    /// Its standard error; zero for one value.
    pub error: f64,
}

impl Estimate {
    /// Of independent values.
    pub fn of(values: &[f64]) -> Self {
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
        let error = if values.len() > 1 { (squares / (count - 1.0) / count).sqrt() } else { 0.0 };
        Self { mean, error }
    }
}

/// The average over seeds at one viscosity and rate.
#[derive(Debug, Clone, PartialEq)]
pub struct Branch {
    /// Viscosity.
    pub viscosity: f64,
    /// Rate of shear.
    pub rate: f64,
    /// The viscous length.
    pub viscous_length: f64,
    /// Strain and segregation at each record.
    pub segregation: Vec<(f64, Estimate)>,
    /// Segregation averaged over the last tenth of each run.
    pub last: Estimate,
}

impl Sweep {
    /// All runs, by viscosity, rate and seed.
    pub fn cases(&self) -> Vec<Case> {
        let of = |&viscosity: &f64, &rate: &f64| self.seeds.iter().map(move |&seed| Case { seed, viscosity, rate });
        self.viscosities.iter().flat_map(|v| self.rates.iter().flat_map(move |r| of(v, r))).collect()
    }

    /// The system of a run.
    pub fn model(&self, case: &Case) -> Result<Model, ParameterError> {
        let flow = Flow::Shear { rate: case.rate };
        Model::new(Parameters { seed: case.seed, viscosity: case.viscosity, flow, ..self.base.clone() })
    }

    /// Makes all runs, several at a time, each on one core as long as it is small. A run that `done` has the records of
    /// is not made again; `finished` is told of each run as it ends, from any thread. Ends at the first failure.
    pub fn run<E: From<ParameterError> + Send>(
        &self,
        done: impl Fn(&Case) -> Option<Vec<Record>> + Sync,
        finished: impl Fn(&Case, &[Record]) -> Result<(), E> + Sync,
    ) -> Result<Vec<(Case, Vec<Record>)>, E> {
        let cases = self.cases();
        for case in &cases {
            self.model(case)?;
        }
        let run = |case: Case| {
            if let Some(records) = done(&case) {
                return Ok((case, records));
            }
            let records = self.records(&mut Disks::prepared(&self.model(&case)?));
            finished(&case, &records)?;
            Ok((case, records))
        };
        cases.into_par_iter().with_max_len(1).map(run).collect()
    }

    /// Runs a system and keeps records of it.
    fn records(&self, disks: &mut Disks) -> Vec<Record> {
        let each = |strain: f64| (strain / (disks.strain_per_step())).round() as u64;
        let (end, every) = (each(self.strain), each(self.record_every).max(1));
        let mut records = vec![record(disks)];
        while disks.steps() < end {
            disks.restart_tally();
            disks.advance(every.min(end - disks.steps()));
            records.push(record(disks));
        }
        records
    }

    /// The averages over seeds of the runs made.
    pub fn branches(&self, runs: &[(Case, Vec<Record>)]) -> Result<Vec<Branch>, ParameterError> {
        let branch = |runs: &[(Case, Vec<Record>)]| {
            let Case { viscosity, rate, .. } = runs[0].0;
            let at = |k: usize| {
                let values: Vec<f64> = runs.iter().map(|(_, records)| records[k].segregation).collect();
                (runs[0].1[k].strain, Estimate::of(&values))
            };
            let shortest = runs.iter().map(|(_, records)| records.len()).min().unwrap_or(0);
            let last: Vec<f64> = runs.iter().map(|(_, records)| mean_of_last_tenth(records)).collect();
            let viscous_length = viscous_length(&self.model(&runs[0].0)?);
            let segregation = (0..shortest).map(at).collect();
            Ok(Branch { viscosity, rate, viscous_length, segregation, last: Estimate::of(&last) })
        };
        runs.chunks(self.seeds.len().max(1)).map(branch).collect()
    }
}

impl Disks {
    fn strain_per_step(&self) -> f64 {
        let p = self.model.parameters();
        p.flow.rate(p.edges[1]).abs() * p.time_step
    }
}

fn record(disks: &Disks) -> Record {
    let (snapshot, tally) = (disks.snapshot(), disks.tally());
    let stress = if tally.time() > 0.0 { tally.mean_stress() } else { tally.latest.stress() };
    Record {
        strain: disks.strain(),
        segregation: snapshot.segregation(),
        kinetic: tally.latest.kinetic / snapshot.disks.len() as f64,
        shear_stress: -stress.y,
        pressure: 0.5 * (stress.x + stress.z),
        free_path: tally.mean_free_path(snapshot.disks.len()),
        lanes: snapshot.lanes().peak,
    }
}

fn mean_of_last_tenth(records: &[Record]) -> f64 {
    let last = &records[records.len() - records.len().div_ceil(10)..];
    last.iter().map(|r| r.segregation).sum::<f64>() / last.len() as f64
}
