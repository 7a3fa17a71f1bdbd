//! Time and error of one benchmark case.

use super::BenchmarkError;
use super::spheres::{BenchmarkKind, Spheres, loads};
use domain::parallel::{self, ParallelProfile, TaskClock};
use domain::{Bytes, Comm, Particles, Partition, Vector};
use fcm::{Costs, Fixed, Loading, Method, Mobility, Motion, Multipoles, Output, Plan, Precision, Problem, Seconds};
use hydrodynamics::SingleEvaluation;
use serde::Serialize;
use std::time::Instant;

/// Advice for a case that needs too much memory.
const REMEDY: &str = "fewer --particles, a larger --tolerance or a smaller --grid";

/// Parameters of a measurement.
#[derive(Debug, Clone, Copy)]
pub struct Task {
    /// Relative error allowed.
    pub tolerance: f64,
    /// Kind of loads and motions.
    pub kind: BenchmarkKind,
    /// Number of evaluations that are timed.
    pub repeats: u32,
    /// Whether to measure the error.
    pub with_error: bool,
    /// Choices fixed by the user.
    pub fixed: Fixed,
    /// Costs on this machine.
    pub costs: Costs,
}

/// Measured stages of an evaluation.
#[derive(Debug)]
pub struct Stages {
    /// Plan of the evaluation.
    pub plan: Plan,
    /// Of an evaluation that rebuilds neighbour lists.
    pub with_lists: ParallelProfile,
    /// Of one that follows them.
    pub repeated: ParallelProfile,
}

/// Bytes and messages sent.
type Sent = [u64; 2];

/// Result of a measurement.
#[derive(Debug, Serialize)]
pub struct CostMeasurement {
    tolerance: f64,
    method: &'static str,
    device: &'static str,
    precision: &'static str,
    grid: [usize; 3],
    support: usize,
    ranks: usize,
    threads: usize,
    bytes_sent: u64,
    messages_sent: u64,
    seconds: Times,
    predicted_seconds: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<f64>,
}

#[derive(Debug, Serialize)]
struct Times {
    spread: f64,
    fft: f64,
    solve: f64,
    interpolate: f64,
    near: f64,
    exchange: f64,
    total: f64,
}

impl Task {
    /// Times repeated evaluations of the mobility of the spheres. Collective.
    pub fn measure(&self, spheres: &Spheres, comm: &Comm) -> Result<CostMeasurement, BenchmarkError> {
        let plan = self.plan(spheres, comm)?;
        let (times, sent, found) = self.evaluate(&plan, spheres, comm, 0..=self.repeats);
        let error = if self.with_error { Some(self.error(&found, spheres, comm)?) } else { None };
        Ok(CostMeasurement {
            tolerance: self.tolerance,
            method: plan.method.name(),
            device: plan.device.name(),
            precision: if plan.precision == Precision::Single { "f32" } else { "f64" },
            grid: plan.grid,
            support: plan.support.support,
            ranks: comm.size(),
            threads: rayon::current_num_threads(),
            bytes_sent: sent[0],
            messages_sent: sent[1],
            seconds: medians(&times[1..]),
            predicted_seconds: plan.predicted_seconds,
            error,
        })
    }

    /// The plan, and the median time of each part of an evaluation in seconds. Collective.
    pub fn times(&self, spheres: &Spheres, comm: &Comm) -> Result<(Plan, Seconds), BenchmarkError> {
        let plan = self.plan(spheres, comm)?;
        let (times, ..) = self.evaluate(&plan, spheres, comm, 0..=self.repeats);
        let Times { spread, fft, interpolate, near, exchange, .. } = medians(&times[1..]);
        Ok((plan, Seconds { spread, fft, interpolate, near, exchange }))
    }

    fn plan(&self, spheres: &Spheres, comm: &Comm) -> Result<Plan, BenchmarkError> {
        let problem = Problem {
            boundaries: spheres.cell.boundaries(),
            edges: spheres.cell.edges(),
            volume: spheres.cell.edges().element_product(),
            shortest_vector: Problem::shortest_vector_of(&spheres.cell),
            smallest_edge_ratio: 1.0,
            largest_strain: 0.0,
            largest_tilts: [0.0; 2],
            radii: spheres.radii.iter().map(|&radius| (radius, 1)).collect(),
            viscosity: 1.0,
            multipoles: if self.kind == BenchmarkKind::Forces { Multipoles::Monopole } else { Multipoles::Dipole },
            rigid: false,
            lubricated: false,
            loading: Loading::Varied,
            tolerance: self.tolerance,
            threads: rayon::current_num_threads(),
            ranks: comm.size(),
            costs: self.costs,
            network: None,
            fixed: self.fixed,
        };
        let plan = Plan::choose(&problem).map_err(BenchmarkError::Plan)?;
        let besides = Bytes::list::<(Vector, [f64; 3])>(spheres.radii.len() as f64);
        let single = SingleEvaluation {
            plan: &plan,
            radii: problem.radii,
            lubrication: None,
            numbers: 11,
            besides,
            remedy: REMEDY,
        };
        single.check_memory(comm)?;
        Ok(plan)
    }

    /// Evaluates the mobility at the displaced positions of each repetition. Returns the times in seconds, the largest
    /// numbers of bytes and messages that a rank sends in the last evaluation, and its motions, on the first rank.
    fn evaluate(
        &self,
        plan: &Plan,
        spheres: &Spheres,
        comm: &Comm,
        turns: std::ops::RangeInclusive<u32>,
    ) -> (Vec<(Seconds, f64)>, Sent, [Vec<f64>; 3]) {
        let partition = Partition::new(comm, [plan.grid[1], plan.grid[2]]);
        let mut mobility = Mobility::new(plan, &partition);
        let (mut times, mut sent) = (Vec::new(), [0; 2]);
        let mut last = (Particles::default(), Motion::default());
        for turn in turns {
            let particles = spheres.displaced(turn, &partition);
            let loads = loads(&particles, self.kind);
            let before = mobility.work().seconds;
            comm.barrier();
            let (start, before_sending) = (Instant::now(), [comm.bytes_sent(), comm.messages_sent()]);
            mobility.arrange(&spheres.cell, &particles);
            let motion = mobility.apply(&loads, self.output());
            sent = [comm.bytes_sent() - before_sending[0], comm.messages_sent() - before_sending[1]];
            comm.barrier();
            times.push((mobility.work().seconds - before, start.elapsed().as_secs_f64()));
            last = (particles, motion);
        }
        let mut most = sent.map(|count| count as f64);
        comm.max(&mut most);
        (times, most.map(|count| count as u64), gathered(last.0, &last.1, &partition))
    }

    /// Largest relative error against an evaluation on the host with a tolerance 100 times smaller.
    fn error(&self, found: &[Vec<f64>; 3], spheres: &Spheres, comm: &Comm) -> Result<f64, BenchmarkError> {
        let fixed = Fixed { method: Some(Method::Split), ..Fixed::default() };
        let tighter = Self { tolerance: (self.tolerance * 1e-2).max(1e-12), fixed, ..*self };
        let plan = tighter.plan(spheres, comm)?;
        let (_, _, exact) = tighter.evaluate(&plan, spheres, comm, self.repeats..=self.repeats);
        let errors = found.iter().zip(&exact).map(|(found, exact)| relative(found, exact));
        Ok(errors.fold(0.0, f64::max))
    }
}

impl Task {
    /// Stages of evaluations that rebuild neighbour lists and of those that do not, the least of the repeats part by
    /// part. Collective.
    pub fn stages(&self, spheres: &Spheres, clock: TaskClock, comm: &Comm) -> Result<Stages, BenchmarkError> {
        let plan = self.plan(spheres, comm)?;
        let partition = Partition::new(comm, [plan.grid[1], plan.grid[2]]);
        let mut fastest: [Option<ParallelProfile>; 2] = [None, None];
        for _ in 0..self.repeats {
            let mut mobility = Mobility::new(&plan, &partition);
            for turn in 0..3 {
                let particles = spheres.displaced(turn, &partition);
                let loads = loads(&particles, self.kind);
                comm.barrier();
                let (_, profile) = parallel::measure(clock, || {
                    mobility.arrange(&spheres.cell, &particles);
                    mobility.apply(&loads, self.output())
                });
                // The first lists have no skin.
                let Some(kept) = (turn as usize).checked_sub(1).map(|kind| &mut fastest[kind]) else { continue };
                *kept = Some(kept.take().map_or_else(|| profile.clone(), |kept| kept.least(&profile)));
            }
        }
        let [with_lists, repeated] = fastest.map(Option::unwrap_or_default);
        Ok(Stages { plan, with_lists, repeated })
    }

    fn output(&self) -> Output {
        match self.kind {
            BenchmarkKind::All => Output::All,
            BenchmarkKind::Forces => Output::Velocities,
            BenchmarkKind::Stresslets => Output::Gradients,
        }
    }
}

/// Velocities, angular velocities and strain rates in the order of the ids, on the first rank.
fn gathered(mut particles: Particles, motion: &Motion, partition: &Partition) -> [Vec<f64>; 3] {
    let kinds: [(&str, usize, &[f64]); 3] = [
        ("velocity", 3, bytemuck::cast_slice(&motion.velocities)),
        ("angular_velocity", 3, bytemuck::cast_slice(&motion.angular_velocities)),
        ("strain_rate", 5, bytemuck::cast_slice(&motion.strain_rates)),
    ];
    for (name, width, values) in kinds {
        particles.column(name, width).values[..values.len()].copy_from_slice(values);
    }
    let mut all = particles.gathered(partition);
    kinds.map(|(name, width, _)| std::mem::take(&mut *all.column(name, width).values))
}

fn relative(found: &[f64], exact: &[f64]) -> f64 {
    let difference: f64 = found.iter().zip(exact).map(|(a, b)| (a - b) * (a - b)).sum();
    let square: f64 = exact.iter().map(|b| b * b).sum();
    if square > 0.0 { (difference / square).sqrt() } else { 0.0 }
}

fn medians(times: &[(Seconds, f64)]) -> Times {
    let median = |part: fn(&(Seconds, f64)) -> f64| {
        let mut values: Vec<f64> = times.iter().map(part).collect();
        values.sort_by(f64::total_cmp);
        0.5 * (values[(values.len() - 1) / 2] + values[values.len() / 2])
    };
    Times {
        spread: median(|t| t.0.spread),
        fft: median(|t| t.0.fft),
        solve: 0.0,
        interpolate: median(|t| t.0.interpolate),
        near: median(|t| t.0.near),
        exchange: median(|t| t.0.exchange),
        total: median(|t| t.1),
    }
}

#[cfg(test)]
mod tests {
    use super::super::BenchmarkCase;
    use super::*;

    #[test]
    fn relative_errors_are_those_of_the_two_norm() {
        let cases: [(&[f64], &[f64], f64); 6] = [
            (&[3.0, 4.0], &[3.0, 4.0], 0.0),
            (&[1.0, -2.0], &[4.0, 2.0], (25.0_f64 / 20.0).sqrt()),
            (&[0.0, 0.0], &[-3.0, 7.0], 1.0),
            (&[1.0], &[0.5], 1.0),
            (&[0.0], &[0.0], 0.0),
            (&[], &[], 0.0),
        ];
        for (found, exact, error) in cases {
            assert!((relative(found, exact) - error).abs() < 1e-15, "{found:?} for {exact:?}");
        }
    }

    #[test]
    fn medians_are_those_of_each_part() {
        let time = |seconds: f64| {
            let parts =
                Seconds { spread: seconds, fft: -seconds, interpolate: 1.0, near: 3.0 * seconds, exchange: 7.0 };
            (parts, 10.0 * seconds)
        };
        let of = |times: &[f64]| medians(&times.iter().copied().map(time).collect::<Vec<_>>());
        let odd = of(&[5.0, 1.0, 2.0]);
        let even = of(&[5.0, 1.0, 2.0, 4.0]);
        let parts = |t: &Times| [t.spread, t.fft, t.interpolate, t.near, t.exchange, t.total].map(|part| part as i64);
        assert_eq!(parts(&odd), [2, -2, 1, 6, 7, 20]);
        assert_eq!(parts(&even), [3, -3, 1, 9, 7, 30]);
    }

    fn task(kind: BenchmarkKind, tolerance: f64, method: Method) -> Task {
        let fixed = Fixed { method: Some(method), ..Fixed::default() };
        Task { tolerance, kind, repeats: 1, with_error: true, fixed, costs: Costs::default() }
    }

    const CASE: BenchmarkCase = BenchmarkCase { particles: 12, volume_fraction: 0.1, size_ratio: 1.5 };

    fn measured(task: Task, ranks: usize) -> Vec<CostMeasurement> {
        Comm::threads(ranks, |comm| task.measure(&Spheres::random(&CASE, &comm).unwrap(), &comm).unwrap())
    }

    /// The measured error of a plan is below the tolerance but not far below, on any number of ranks.
    #[test]
    fn the_measured_error_is_that_of_the_plan() {
        for (kind, tolerance) in
            [(BenchmarkKind::All, 1e-3), (BenchmarkKind::Forces, 1e-2), (BenchmarkKind::Stresslets, 1e-4)]
        {
            for (method, ranks) in [(Method::Direct, 1), (Method::Split, 1), (Method::Split, 2)] {
                let error = measured(task(kind, tolerance, method), ranks)[0].error.unwrap();
                let likely = 1e-3 * tolerance..=tolerance;
                assert!(likely.contains(&error), "{kind:?} at {tolerance:e} on {ranks} ranks: {error:e}");
            }
        }
    }

    /// Motions in the order of the ids, with values that a mix-up between two ranks would change.
    #[test]
    fn motions_are_gathered_by_id() {
        let gathered = Comm::threads(2, |comm| {
            let spheres = Spheres::random(&CASE, &comm).unwrap();
            let partition = Partition::new(&comm, [8, 8]);
            let particles = spheres.displaced(0, &partition);
            let of = |scale: f64| {
                particles.ids.iter().map(move |&id| domain::Vector::splat(scale * (1 + id) as f64)).collect()
            };
            let strain_rates = particles.ids.iter().map(|&id| domain::Traceless([-(1.0 + id as f64); 5])).collect();
            let motion = Motion { velocities: of(1.0), angular_velocities: of(10.0), strain_rates };
            gathered(particles, &motion, &partition)
        });
        let expected =
            |scale: f64, width: usize| (0..12 * width).map(|i| scale * (1 + i / width) as f64).collect::<Vec<_>>();
        assert_eq!(gathered[0], [expected(1.0, 3), expected(10.0, 3), expected(-1.0, 5)]);
        assert!(gathered[1].iter().all(Vec::is_empty));
    }
}
