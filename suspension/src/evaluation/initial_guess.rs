//! Initial guess of the iterative solve: stresslets and lubrication extrapolated from previous steps.

use crate::columns::STRESSLET;
use crate::columns::STRESSLET_FAR;
use crate::evaluation::extrapolation;
use crate::scalars::BLEND;
use domain::parallel::{FusedLoops, MeasuredLoop, copied, stage};
use domain::{ColumnValues, Comm, Particles, Vector};
use fcm::{GUESSED, Loads, Motion, PAST, PastSolutions, SolutionColumns};
use hydrodynamics::{Guess, Solution};
use rayon::prelude::*;

/// Columns of a coupled solve: stresslets of the far field, forces and torques on the fluid, motions that the loads of
/// all other spheres induce at each sphere, and motions relative to the background flow.
const FORCE: &str = "far force";
const TORQUE: &str = "far torque";
const INDUCED: [&str; 2] = ["induced velocity", "induced angular velocity"];
pub const MOTION: [&str; 2] = ["velocity in flow", "angular velocity in flow"];

/// Number of values that one thread processes at a time; the sums of these batches are added in their order.
const BATCH: usize = 4096;

/// Weight of the latest value in the running mean of the parabola's weight.
const NEWEST: f64 = 0.5;

/// History of the solutions, stored in columns of the particles.
pub struct WarmStart {
    coupled: bool,
}

impl WarmStart {
    /// The history for a solve with or without coupled forces between near spheres.
    pub fn new(coupled: bool) -> Self {
        Self { coupled }
    }

    /// Column of the far-field stresslets.
    fn stresslet(&self) -> &'static str {
        if self.coupled { STRESSLET_FAR } else { STRESSLET }
    }

    /// Columns that make up a guess, with their widths.
    fn columns(&self) -> Vec<(&'static str, usize)> {
        let motions = INDUCED.iter().chain(&MOTION).filter(|_| self.coupled).map(|&name| (name, 3));
        std::iter::once((self.stresslet(), 5)).chain(motions).collect()
    }

    /// Numbers per particle in all columns of the history, without those of the results.
    pub fn numbers(&self) -> usize {
        let present = if self.coupled { 5 + 3 * (2 + INDUCED.len() + MOTION.len()) } else { 0 };
        self.past_numbers() + present + self.columns().len()
    }

    /// Numbers per particle of past solutions.
    pub fn past_numbers(&self) -> usize {
        self.columns().iter().map(|(_, width)| PAST * width).sum()
    }

    /// All columns of the history, with their widths.
    pub fn kept(&self) -> impl Iterator<Item = (String, usize)> {
        let past = self.columns().into_iter().flat_map(|(name, width)| (1..=PAST).map(move |k| (past(name, k), width)));
        let torques = [FORCE, TORQUE].map(|name| (name.to_owned(), 3));
        let learnt = std::iter::once((BLEND.to_owned(), self.columns().len()));
        past.chain(self.columns().into_iter().map(|(name, width)| (name.to_owned(), width)))
            .chain(torques)
            .chain(learnt)
    }

    /// Stores the present values, at the start of a step after `steps` previous ones, as the latest past values; if
    /// there are no past values of previous steps, as all past values.
    pub fn remember(&self, particles: &mut Particles, steps: u64) {
        let is_known = particles.columns.iter().any(|column| column.name == past(self.stresslet(), 1));
        let times = if steps > 0 && !is_known { PAST } else { 1 };
        for _ in 0..times {
            for ((name, width), mut newest) in self.columns().into_iter().zip(self.present_values(particles)) {
                for k in 1..=PAST {
                    std::mem::swap(&mut particles.column(&past(name, k), width).values, &mut newest);
                }
            }
        }
    }

    /// The present values of all columns of the history, whose memory they share.
    fn present_values(&self, particles: &mut Particles) -> Vec<ColumnValues> {
        self.columns().into_iter().map(|(name, width)| particles.column(name, width).values.clone()).collect()
    }

    /// Removes all solutions except the last one.
    pub fn clear_history(&self, particles: &mut Particles) {
        let past: Vec<String> =
            self.columns().iter().flat_map(|(name, _)| (1..=PAST).map(move |k| past(name, k))).collect();
        particles.columns.retain(|column| !past.contains(&column.name));
    }

    /// Removes all solutions, with or without forces between near spheres in the solve.
    pub fn clear_all(particles: &mut Particles) {
        for coupled in [false, true] {
            let known = Self::new(coupled);
            known.clear_history(particles);
            let kept: Vec<String> = known.kept().map(|(name, _)| name).collect();
            particles.remove(|name| kept.iter().any(|kept| kept == name));
        }
    }

    /// Stores with the particles the parts of a solution that later solutions start from and that are not outputs: the
    /// loads on the fluid, the far-field stresslets and the induced motion.
    pub fn record(&self, particles: &mut Particles, solved: &Solution) {
        if !self.coupled {
            return;
        }
        if let Some(kept) = &solved.kept {
            let SolutionColumns { guessed, forces, torques, .. } = &kept.columns;
            for ((name, width), values) in self.columns().into_iter().zip(guessed) {
                particles.column(name, width).values = values.clone();
            }
            particles.column(FORCE, 3).values = forces.clone();
            particles.column(TORQUE, 3).values = torques.clone();
            return;
        }
        let names = [STRESSLET_FAR, FORCE, TORQUE, INDUCED[0], INDUCED[1], MOTION[0], MOTION[1]];
        let [stresslets, forces, torques, motions @ ..] = particles.columns_of(names, [5, 3, 3, 3, 3, 3, 3]);
        let Solution { far, induced, motion, .. } = solved;
        let moved = [induced, motion].map(|motion| [&motion.velocities, &motion.angular_velocities]);
        let mut loops = FusedLoops::default();
        loops.copied(stresslets, bytemuck::cast_slice(&far.stresslets));
        for (column, far) in [(forces, &far.forces), (torques, &far.torques)] {
            let known = |row: usize| far.get(row).copied().unwrap_or_default();
            loops.change_rows(bytemuck::cast_slice_mut(column), move |row, value: &mut Vector| *value = known(row));
        }
        for (column, list) in motions.into_iter().zip(moved.as_flattened()) {
            loops.change(bytemuck::cast_slice_mut(column), list, |value: &mut Vector, &known| *value = known);
        }
        loops.run();
    }

    /// Loads on the fluid in the last solution. Without coupled forces these are the given `loads`, and the stresslets.
    pub fn loads_on_fluid(&self, loads: Loads, particles: &Particles) -> Loads {
        let values = |name: &str| particles.columns.iter().find(|c| c.name == name).map(|c| &c.values[..]);
        // Particles may have these columns from a run with another integrator.
        let vectors = |name| values(name).filter(|_| self.coupled).map(|v| bytemuck::cast_slice(v).to_vec());
        Loads {
            forces: vectors(FORCE).unwrap_or(loads.forces),
            torques: vectors(TORQUE).unwrap_or(loads.torques),
            stresslets: values(self.stresslet()).map(|v| bytemuck::cast_slice(v).to_vec()).unwrap_or_default(),
        }
    }

    /// Guess of the solution at the time `ahead` after the last stored values, extrapolated by a mix of two
    /// least-squares fits, a line and a parabola; `ages` are those of the stored values, the last of which have age 0.
    /// Empty if nothing is stored: zero motion would be a bad guess with lubrication, since spheres at rest in a strain
    /// exert large forces on their neighbours.
    ///
    /// The parabola follows smooth changes, but amplifies the errors of previous solves about four times. Its weight in
    /// the mix is the one with which the mix would have come closest to the previous solutions, see
    /// [`Self::update_blend`].
    pub fn guess(&self, particles: &mut Particles, ages: &[f64], ahead: f64) -> Guess {
        let _stage = stage("initial guess");
        if !particles.columns.iter().any(|column| column.name == past(self.stresslet(), 1)) {
            return Guess::default();
        }
        let names = self.columns();
        let blend = Self::blend(particles, names.len());
        particles.scalars.set(BLEND, &blend);
        Guess { past: Some(past_solutions(particles, &names, ages, ahead, &blend)), ..Guess::default() }
    }

    /// Weights of the parabola, one for each of a number of columns; zeros before the first are known.
    fn blend(particles: &Particles, columns: usize) -> Vec<f64> {
        particles.scalars.get(BLEND).filter(|known| known.len() == columns).map_or(vec![0.0; columns], <[f64]>::to_vec)
    }

    /// The last solution, as a guess.
    pub fn found(&self, particles: &mut Particles) -> Guess {
        let mut last: [ColumnValues; GUESSED] = Default::default();
        last.iter_mut().zip(self.present_values(particles)).for_each(|(last, values)| *last = values);
        Guess { past: Some(PastSolutions::last(last)), ..Guess::default() }
    }

    /// Motions relative to the background flow in the last solution.
    pub fn motion(particles: &mut Particles) -> Motion {
        let [velocities, angular_velocities] = MOTION.map(|name| {
            particles.column(name, 3);
            copied(bytemuck::cast_slice(values(particles, name)))
        });
        Motion { velocities, angular_velocities, strain_rates: Vec::new() }
    }

    /// Updates the weight of the parabola from a new solution: the weight with which the guess, made with `ages` and
    /// `ahead`, would have come closest to it. The solution may have been `compared` with this guess already.
    /// Collective.
    pub fn update_blend(
        &self,
        particles: &mut Particles,
        ages: &[f64],
        ahead: f64,
        compared: Option<[[f64; 2]; GUESSED]>,
        comm: &Comm,
    ) {
        let _stage = stage("initial guess");
        let names = self.columns();
        let is_known = particles.columns.iter().any(|column| column.name == past(self.stresslet(), PAST));
        if comm.any(!is_known && !particles.is_empty()) || ages.len() < PAST {
            return;
        }
        let mut shares = Self::blend(particles, names.len());
        let sums = compared.map_or_else(
            || {
                let past = past_solutions(particles, &names, ages, ahead, &shares);
                let found: Vec<&[f64]> = names.iter().map(|(name, _)| values(particles, name)).collect();
                compare(&past, &found, comm)
            },
            |sums| sums.to_vec(),
        );
        for (share, [along, square]) in shares.iter_mut().zip(&sums).filter(|(_, sums)| sums[1] > 0.0) {
            *share += NEWEST * ((along / square).clamp(0.0, 1.0) - *share);
        }
        particles.scalars.set(BLEND, &shares);
    }
}

/// Products of what is beyond the line of a guess in columns that were found and by the parabola, and squares of the
/// latter, summed up over each column. Collective.
fn compare(past: &PastSolutions, found: &[&[f64]], comm: &Comm) -> Vec<[f64; 2]> {
    let past = past.numbers();
    let batches = |k: usize| (0..found[k].len().div_ceil(BATCH)).map(move |batch| [k, batch]);
    let batches: Vec<[usize; 2]> = (0..found.len()).flat_map(batches).collect();
    let of_batch = |&[k, batch]: &[usize; 2]| {
        let mut sums = [0.0; 2];
        for i in batch * BATCH..found[k].len().min((batch + 1) * BATCH) {
            let [line, parabola] = past.extrapolated(k, i);
            let curved = parabola - line;
            sums[0] += (found[k][i] - line) * curved;
            sums[1] += curved * curved;
        }
        sums
    };
    let of_batches: Vec<_> = batches.par_iter().map(of_batch).measured().collect();
    let mut sums = vec![[0.0; 2]; found.len()];
    for (&[k, _], [along, square]) in batches.iter().zip(of_batches) {
        sums[k][0] += along;
        sums[k][1] += square;
    }
    comm.sum(sums.as_flattened_mut());
    sums
}

/// Past solutions in columns with some names and widths, to be extrapolated to the time `ahead` after the last of them,
/// with the weight of the parabola for each.
fn past_solutions(
    particles: &mut Particles,
    names: &[(&str, usize)],
    ages: &[f64],
    ahead: f64,
    blend: &[f64],
) -> PastSolutions {
    let times: Vec<f64> = ages.iter().take(PAST).map(|age| -age).collect();
    let [line, parabola] = [1, 2].map(|degree| {
        let mut weights = [0.0; PAST];
        weights[..times.len()].copy_from_slice(&extrapolation::fitted(&times, degree, ahead));
        weights
    });
    let mut solutions = PastSolutions { line, parabola, ..PastSolutions::last(Default::default()) };
    for (k, &(name, width)) in names.iter().enumerate() {
        // Values without weight are arbitrary.
        let number = |age: usize| 1 + if age < times.len() { age } else { 0 };
        let column = |age: usize| particles.column(&past(name, number(age)), width).values.clone();
        solutions.columns[k] = [0, 1, 2].map(column);
        solutions.blend[k] = blend[k];
    }
    solutions
}

/// Values of a column; empty if it does not exist.
fn values<'a>(particles: &'a Particles, name: &str) -> &'a [f64] {
    particles.columns.iter().find(|column| column.name == name).map_or(&[], |column| &column.values)
}

/// Name of the column of another column's values at the start of the `k`th step back.
fn past(name: &str, k: usize) -> String {
    format!("past {name} {k}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use domain::Traceless;
    use std::f64::consts::PI;

    /// Error of the next guess for one particle with a given stresslet as a function of time, after a number of steps
    /// of length 1.
    fn error_of_guess(stresslet: impl Fn(f64) -> Traceless, steps: u32) -> f64 {
        let (warm_start, ages, comm) = (WarmStart::new(false), [0.0, 1.0, 2.0], Comm::alone());
        let mut particles = Particles::default();
        particles.push(0, Vector::ZERO, 1.0, 0);
        assert_eq!(warm_start.guess(&mut particles, &[0.0], 1.0), Guess::default(), "nothing is known");
        for step in 0..steps {
            particles.column(STRESSLET, 5).values.copy_from_slice(&stresslet(f64::from(step)).0);
            warm_start.update_blend(&mut particles, &ages[..3.min(step as usize)], 1.0, None, &comm);
            warm_start.remember(&mut particles, step.into());
        }
        let guessed = |particles: &mut Particles, ages: &[f64]| {
            let past = warm_start.guess(particles, ages, 1.0).past.unwrap();
            Traceless(std::array::from_fn(|axis| past.numbers().guess(0, axis)))
        };
        let first = guessed(&mut particles, &[0.0]);
        assert_eq!(first, stresslet(f64::from(steps) - 1.0), "with nothing known but the last value, that");
        let found = guessed(&mut particles, &ages);
        let difference = found - stresslet(f64::from(steps));
        difference.contract(difference).sqrt()
    }

    #[test]
    fn a_line_is_followed_exactly_and_a_parabola_once_it_is_known() {
        let line = |t: f64| Traceless([1.0 + t, 2.0 - t, 0.3 * t, 0.0, -1.0]);
        let parabola = |t: f64| Traceless([1.0 + t, 2.0 - t * t, 0.3 * t, t * (t - 1.0), -1.0]);
        assert!(error_of_guess(line, 4) < 1e-13);
        let errors = [4, 6, 30].map(|steps| error_of_guess(parabola, steps));
        assert!(errors[0] > 0.1 && errors[1] < 0.5 * errors[0] && errors[2] < 1e-6, "{errors:?}");
    }

    /// Errors of alternating sign would be amplified seven times by a parabola and three times by a line.
    #[test]
    fn errors_of_former_solves_are_not_multiplied() {
        let noisy = |t: f64| Traceless([1.0, 0.1 * (PI * t).cos(), 0.0, 0.0, 0.0]);
        let error = error_of_guess(noisy, 30);
        assert!(error < 0.1 * 2.0_f64.sqrt() * 2.5, "{error}");
    }

    /// The loads on the fluid are stored completely, and the induced motions as well.
    #[test]
    fn what_the_fluid_feels_is_kept() {
        let vector = |x: f64| vec![Vector::new(x, 2.0 * x, -x)];
        let given = Loads { forces: vector(1.0), ..Loads::default() };
        let far = Loads { forces: vector(5.0), torques: vector(3.0), stresslets: vec![Traceless([1.0; 5])] };
        let induced = Motion { velocities: vector(7.0), angular_velocities: vector(9.0), ..Motion::default() };
        let solved = Solution { far: far.clone(), induced, iterations: 1, ..Solution::default() };
        let mut particles = Particles::default();
        particles.push(0, Vector::ZERO, 1.0, 0);
        let warm_start = WarmStart::new(true);
        warm_start.record(&mut particles, &solved);
        let kept = [FORCE, TORQUE, INDUCED[0], INDUCED[1]].map(|name| particles.vectors(name).to_vec());
        assert_eq!(kept, [5.0, 3.0, 7.0, 9.0].map(vector));
        assert_eq!(warm_start.loads_on_fluid(given.clone(), &particles), far);
        let alone = WarmStart::new(false).loads_on_fluid(given.clone(), &particles);
        assert_eq!(alone, given, "without such forces those given, whatever was kept before");
    }
}
