//! Sweeps of sheared disks: which runs there are, what is recorded of them when, and their averages.

use drivers::ParameterError;
use drivers::disks::{Case, Disks, Estimate, Flow, Parameters, Preparation, Record, Sweep, SweepStore, viscous_length};
use std::collections::HashMap;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// What ends a sweep.
#[derive(Debug, PartialEq)]
enum End {
    Refused(String),
    Asked,
}

impl From<ParameterError> for End {
    fn from(error: ParameterError) -> Self {
        Self::Refused(error.to_string())
    }
}

/// Keeps records in memory, and asks for an end after some of them.
struct Shelf {
    kept: Mutex<HashMap<usize, Vec<Record>>>,
    /// The parts of each run that were told to be done.
    told: Mutex<HashMap<usize, Vec<f64>>>,
    asked: AtomicUsize,
    most: usize,
}

impl Shelf {
    fn until(most: usize) -> Self {
        Self { kept: Mutex::default(), told: Mutex::default(), asked: AtomicUsize::new(0), most }
    }

    fn len(&self) -> usize {
        self.kept.lock().unwrap().len()
    }
}

impl SweepStore for Shelf {
    type Error = End;

    fn stored(&self, case: &Case) -> Result<Option<Vec<Record>>, End> {
        Ok(self.kept.lock().unwrap().get(&case.index).cloned())
    }

    fn store(&self, case: &Case, records: &[Record]) -> Result<(), End> {
        assert!(self.kept.lock().unwrap().insert(case.index, records.to_vec()).is_none(), "a run was made twice");
        Ok(())
    }

    fn tell(&self, case: &Case, part: f64) {
        self.told.lock().unwrap().entry(case.index).or_default().push(part);
    }

    fn go_on(&self) -> Result<(), End> {
        if self.asked.fetch_add(1, Ordering::Relaxed) < self.most { Ok(()) } else { Err(End::Asked) }
    }
}

fn sweep() -> Sweep {
    let preparation = Preparation { settled: 3.0, mixed: 6.0, ..Parameters::default().preparation };
    Sweep {
        base: Parameters { edges: [30.0; 2], time_step: 0.1, preparation, ..Parameters::default() },
        seeds: vec![4, 7],
        viscosities: vec![0.01],
        rates: vec![0.05, -0.1],
        area_fractions: vec![0.3, 0.4],
        strain: 0.9,
        record_every: 0.25,
    }
}

#[test]
fn a_sweep_has_every_combination_seeds_together() {
    let sweep = Sweep { viscosities: vec![0.01, 0.02], ..sweep() };
    let cases = sweep.cases();
    assert_eq!(cases.len(), 16);
    for (k, case) in cases.iter().enumerate() {
        let expected = Case {
            index: k,
            seed: sweep.seeds[k % 2],
            rate: sweep.rates[k / 2 % 2],
            viscosity: sweep.viscosities[k / 4 % 2],
            area_fraction: sweep.area_fractions[k / 8],
        };
        assert_eq!(*case, expected);
        let model = sweep.model(case).unwrap();
        let Parameters { seed, viscosity, flow, area_fraction, .. } = *model.parameters();
        assert_eq!((seed, viscosity, area_fraction), (case.seed, case.viscosity, case.area_fraction));
        assert_eq!(flow, Flow::Shear { rate: case.rate });
    }
}

/// A record at the start and at every `record_every` of strain, and the last at the strain asked for.
#[test]
fn runs_are_recorded_at_the_strains_asked_for() {
    let (sweep, shelf) = (sweep(), Shelf::until(usize::MAX));
    let runs = sweep.run(&shelf).unwrap();
    assert_eq!(runs.iter().map(|(case, _)| *case).collect::<Vec<_>>(), sweep.cases());
    for (case, records) in &runs {
        let strains: Vec<f64> = records.iter().map(|record| record.strain * case.rate.signum()).collect();
        let expected = [0.0, 0.25, 0.5, 0.75, 0.9];
        assert_eq!([strains.len(), sweep.records_each() as usize], [expected.len(); 2]);
        for (strain, expected) in strains.iter().zip(expected) {
            assert!((strain - expected).abs() < 1e-12, "{strain} for {expected}");
        }
        assert_eq!(shelf.kept.lock().unwrap()[&case.index], *records);
    }
    // Of each run's steps, those before the flow too, ever more is told to be done, until all are.
    for parts in shelf.told.lock().unwrap().values() {
        assert!(parts.is_sorted() && parts[0] > 0.0 && parts[0] < parts[1] && parts.last() == Some(&1.0), "{parts:?}");
        assert!(parts.len() > 4, "{parts:?}");
    }
    assert_eq!(shelf.told.lock().unwrap().len(), runs.len());
    // One of them by hand: what is counted begins anew at each record.
    let (case, records) = &runs[1];
    let mut disks = Disks::prepared(&sweep.model(case).unwrap()).unwrap();
    for (steps, record) in [0, 50, 50, 50, 30].into_iter().zip(records) {
        if steps > 0 {
            disks.restart_tally();
        }
        disks.advance(steps);
        assert_eq!(disks.record(), *record);
    }
}

#[test]
fn a_stopped_sweep_goes_on_with_the_runs_that_are_left() {
    let sweep = sweep();
    let whole = sweep.run(&Shelf::until(usize::MAX)).unwrap();
    let mut shelf = Shelf::until(14);
    assert_eq!(sweep.run(&shelf), Err(End::Asked));
    let made = shelf.len();
    assert!((1..8).contains(&made), "{made} of 8 runs, of four records after the first each");
    (shelf.most, shelf.asked) = (usize::MAX, AtomicUsize::new(0));
    assert_eq!(sweep.run(&shelf).unwrap(), whole);
    assert_eq!(shelf.asked.load(Ordering::Relaxed), 4 * (8 - made), "nothing is made twice");
}

#[test]
fn records_closer_than_a_step_are_one_a_step() {
    let sweep = Sweep { seeds: vec![1], rates: vec![0.1], area_fractions: vec![0.3], strain: 0.05, ..sweep() };
    let sweep = Sweep { record_every: 1e-9, ..sweep };
    assert_eq!(sweep.run(&Shelf::until(usize::MAX)).unwrap()[0].1.len(), 1 + 5);
}

#[test]
fn a_case_that_cannot_be_ends_the_sweep_with_its_reason() {
    let sweep = Sweep { area_fractions: vec![0.3, 0.9], ..sweep() };
    let Err(End::Refused(message)) = sweep.run(&Shelf::until(usize::MAX)) else { panic!("0.9 can't be") };
    assert!(message.contains("particles.area_fraction is 0.9"), "{message}");
}

#[test]
fn estimates_are_mean_and_standard_error() {
    let estimate = Estimate::of(&[1.0, 2.0, 6.0]);
    // Squares of deviations 4 + 1 + 9, over 2 for the variance, over 3 for that of the mean.
    assert_eq!((estimate.mean, estimate.error), (3.0, (14.0_f64 / 6.0).sqrt()));
    let one = Estimate::of(&[5.0]);
    assert!((one.mean - 5.0).abs() < 1e-15 && one.error.is_nan());
}

/// Made-up records: in run `r` at record `k` the number in column `c` is `100 r + 10 c + k^2`.
fn records(run: usize, count: usize) -> Vec<Record> {
    let number = |c: usize, k: usize| (100 * run + 10 * c + k * k) as f64;
    (0..count).map(|k| Record::of(std::array::from_fn(|c| number(c, k)))).collect()
}

#[test]
fn branches_average_over_seeds() {
    let sweep = Sweep { rates: vec![0.05], ..sweep() };
    let cases = sweep.cases();
    // Ten records have one in their last tenth, and eleven two.
    let lengths = [10, 11, 11, 11];
    let runs: Vec<_> = cases.iter().enumerate().map(|(r, case)| (*case, records(r, lengths[r]))).collect();
    let branches = sweep.branches(&runs).unwrap();
    assert_eq!(branches.len(), 2);
    for (b, branch) in branches.iter().enumerate() {
        assert_eq!(branch.case, cases[2 * b]);
        let length = viscous_length(&sweep.model(&cases[2 * b]).unwrap());
        assert!((branch.viscous_length / length - 1.0).abs() < 1e-15);
        assert_eq!(branch.averages.len(), lengths[2 * b], "as many as the shortest run has");
        for (k, averages) in branch.averages.iter().enumerate() {
            for (c, found) in averages.iter().enumerate() {
                let first = (200 * b + 10 * c + k * k) as f64;
                assert_eq!(*found, Estimate::of(&[first, first + 100.0]));
            }
        }
    }
    // Column 1 is the segregation: its squares of 9, of 9 and 10.
    assert_eq!(branches[0].last, Estimate::of(&[10.0 + 81.0, 110.0 + 90.5]));
    assert_eq!(branches[1].last, Estimate::of(&[210.0 + 90.5, 310.0 + 90.5]));
}
