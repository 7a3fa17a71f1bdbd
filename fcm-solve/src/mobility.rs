//! `fcm-solve mobility`: one evaluation for positions that the user brings.

use crate::lubricated::{Guess, Hydrodynamics, Solved};
use crate::number::tolerance;
use crate::overlaps::Overlaps;
use crate::run::in_full;
use crate::suspension::Single;
use crate::{machine, streams};
use anyhow::{Context, bail, ensure};
use domain::{Bytes, Comm, Particles, Partition, PeriodicBox, Tensor, Traceless, Vector};
use fcm::{Costs, Evaluation, Fixed, Loads, Motion, Multipoles, Plan, Problem};
use io::{Answer, Case, Terms};
use lubrication::Range;
use solver::BackgroundFlow;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// What to evaluate.
#[derive(clap::Args)]
#[command(after_help = NAMES)]
pub struct Args {
    /// The case: JSON, or HDF5 with the same names if it ends in .h5 or .hdf5; - reads JSON from the standard input
    case: PathBuf,
    /// Where the answer goes, HDF5 if it ends in .h5 or .hdf5, else JSON [default: the standard output]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Relative error allowed, from 1e-12 to 0.5
    #[arg(long, value_name = "T", default_value = "1e-3", value_parser = tolerance, allow_hyphen_values = true)]
    tolerance: f64,
}

const NAMES: &str = "\
A case for N particles:
  box         [Lx, Ly, Lz]         viscosity    a number
  positions   N x 3                radii        N numbers, or one for all
  forces      N x 3                torques      N x 3
  stresslets  N x 5: xx, xy, xz, yy, yz, of particles that are not rigid
  rigid       whether to solve for the stresslets that keep the particles rigid (default: true)
  multipoles  \"monopole\" or \"dipole\" (default)
  lubrication whether near pairs of rigid particles feel lubrication (default: false)
  lubrication_cutoff  the gap where it ends, in radii of the pair's larger sphere (default: 2.5)
  background  {\"velocity_gradient\": 3 x 3, G[i][j] = du_i/dx_j}
  strain      the box's Lees-Edwards strain: its second lattice vector is (strain Ly, Ly, 0)
What is absent is zero. The answer has velocities and angular_velocities relative to the background
flow at the centres, strain_rates of the disturbance flow, stresslets (with lubrication the whole
hydrodynamic ones, and stresslets_far, the far field's part), iterations, residual, seconds and plan.";

/// Columns in which loads and motions travel with their particles.
mod column {
    pub const FORCE: &str = "force";
    pub const TORQUE: &str = "torque";
    pub const VELOCITY: &str = "velocity";
    pub const ANGULAR_VELOCITY: &str = "angular_velocity";
    pub const STRAIN_RATE: &str = "strain_rate";
    pub const STRESSLET: &str = "stresslet";
    pub const STRESSLET_FAR: &str = "far stresslet";
}

/// Evaluates the case. Collective.
pub fn run(args: &Args, comm: &Comm) -> anyhow::Result<()> {
    let read = if comm.is_first() { read(&args.case).map(Some) } else { Ok(None) };
    let read = comm.agree(read)?;
    let case = Case::from_json(&comm.broadcast_text(&read.map_or_else(String::new, |case| case.to_json())));
    answer_to(&case, args, comm).with_context(|| args.case.display().to_string())
}

/// Evaluates a case that was read, and writes the answer. Collective.
fn answer_to(case: &Case, args: &Args, comm: &Comm) -> anyhow::Result<()> {
    let cell = PeriodicBox::sheared(Vector::from_array(case.edges), case.strain)?;
    let problem = problem(case, &cell, (args.tolerance, machine::costs(comm)?));
    let plan = Plan::choose(&problem).context("this case can't be evaluated")?;
    for caution in cautions(case, &cell, plan.burden(&problem))?.iter().filter(|_| comm.is_first()) {
        streams::log(format_args!("warning: {caution}"));
    }
    let cutoff = case.lubrication_cutoff.unwrap_or(Range::WIDE);
    let range = case.lubrication.then(|| Range::new(cutoff, Range::CLOSEST)).transpose()?;
    single(case, &plan, range).check_room(comm)?;
    let partition = Partition::new(comm, [plan.grid[1], plan.grid[2]]);
    let mut particles = place(case, &cell, &partition);
    let mut hydrodynamics = comm.agree(Hydrodynamics::new(&plan, &partition, range))?;
    let start = Instant::now();
    let solved = evaluate(case, &cell, &mut particles, &mut hydrodynamics)?;
    let seconds = start.elapsed().as_secs_f64();
    record(&mut particles, &solved);
    let all = particles.gathered(&partition);
    let written = if comm.is_first() {
        let answer = answer(all, &solved, case, &plan, seconds);
        finite(&answer).and_then(|()| write(args, &answer))
    } else {
        Ok(())
    };
    Ok(comm.agree(written.map_err(|e| in_full(&e)))?)
}

fn read(path: &Path) -> Result<Case, io::FileError> {
    if path != Path::new("-") {
        return Case::read(path);
    }
    let name = Path::new("the standard input");
    let unreadable = |error: std::io::Error| io::FileError::Read { path: name.to_owned(), reason: error.to_string() };
    Case::parse(&std::io::read_to_string(std::io::stdin()).map_err(unreadable)?, name)
}

/// What to say of a case that can be evaluated but had better not; an error if it can't be.
fn cautions(case: &Case, cell: &PeriodicBox, burden: Option<String>) -> anyhow::Result<Vec<String>> {
    let positions: Vec<Vector> = case.positions.iter().map(|&p| cell.wrap(Vector::from_array(p)).0).collect();
    let overlaps = Overlaps::find(cell, &positions, &case.radii());
    if let Some(overlaps) = overlaps.filter(|_| case.lubrication) {
        bail!(
            "{overlaps}; lubrication acts between spheres that are apart: move these apart, or leave out lubrication"
        );
    }
    let caution = |overlaps| format!("{overlaps}; the answer is that of the method, but spheres can't be there");
    Ok(overlaps.map(caution).into_iter().chain(burden).collect())
}

/// What takes memory: of a particle 32 numbers in columns, and those of the case and of the answer, as they are and as
/// text of about 20 characters each.
fn single<'a>(case: &Case, plan: &'a Plan, lubrication: Option<Range>) -> Single<'a> {
    let numbers = 32;
    let text = (8 + 20) * numbers * case.positions.len();
    let radii = case.radii().into_iter().map(|radius| (radius, 1)).collect();
    Single {
        plan,
        radii,
        lubrication,
        numbers,
        besides: Bytes::keep(text as f64),
        remedy: "fewer positions, a larger --tolerance",
    }
}

fn problem(case: &Case, cell: &PeriodicBox, (tolerance, costs): (f64, Costs)) -> Problem {
    let multipoles = match case.multipoles {
        Terms::Monopole => Multipoles::Monopole,
        Terms::Dipole => Multipoles::Dipole,
    };
    Problem {
        edges: cell.edges(),
        largest_strain: cell.strain().abs(),
        radii: case.radii().into_iter().map(|radius| (radius, 1)).collect(),
        viscosity: case.viscosity,
        multipoles,
        rigid: case.rigid,
        tolerance,
        threads: 1,
        ranks: 1,
        costs,
        fixed: Fixed::default(),
    }
}

/// The particles, with their loads, on the ranks that own them.
fn place(case: &Case, cell: &PeriodicBox, partition: &Partition) -> Particles {
    let mut particles = Particles::default();
    if partition.comm().is_first() {
        for (id, (&position, radius)) in case.positions.iter().zip(case.radii()).enumerate() {
            particles.push(id as u64, Vector::from_array(position), radius, 0);
        }
    }
    for (name, list) in [(column::FORCE, &case.forces), (column::TORQUE, &case.torques)] {
        let values = particles.vectors(name);
        for (value, &given) in values.iter_mut().zip(list) {
            *value = Vector::from_array(given);
        }
    }
    let stresslets = traceless(&mut particles, column::STRESSLET);
    for (value, &given) in stresslets.iter_mut().zip(&case.stresslets) {
        *value = Traceless(given);
    }
    particles.wrap(cell);
    particles.migrate(partition, cell);
    particles
}

fn evaluate(
    case: &Case,
    cell: &PeriodicBox,
    particles: &mut Particles,
    hydrodynamics: &mut Hydrodynamics,
) -> anyhow::Result<Solved> {
    let mut loads = Loads::default();
    if !case.forces.is_empty() {
        loads.forces = particles.vectors(column::FORCE).to_vec();
    }
    if !case.torques.is_empty() && case.multipoles == Terms::Dipole {
        loads.torques = particles.vectors(column::TORQUE).to_vec();
    }
    let gradient = Tensor::from_cols_array_2d(&case.background.velocity_gradient).transpose();
    let background = BackgroundFlow::with_gradient(gradient).context("background.velocity_gradient")?;
    if case.rigid || case.multipoles == Terms::Monopole {
        return Ok(hydrodynamics.solve(cell, particles, &loads, background.strain_rate(), &Guess::default())?);
    }
    if !case.stresslets.is_empty() {
        loads.stresslets = traceless(particles, column::STRESSLET).to_vec();
    }
    let mobility = hydrodynamics.mobility();
    mobility.arrange(cell, particles);
    let motion = mobility.apply(&loads, Evaluation::All);
    let stresslets = traceless(particles, column::STRESSLET).to_vec();
    Ok(Solved { motion, stresslets, far: loads, iterations: 0, residual: 0.0 })
}

/// Writes the result into the particles' columns, which are put into the order of the ids when they are gathered.
fn record(particles: &mut Particles, solved: &Solved) {
    let Motion { velocities, angular_velocities, strain_rates } = &solved.motion;
    particles.vectors(column::VELOCITY).copy_from_slice(velocities);
    for (value, &found) in particles.vectors(column::ANGULAR_VELOCITY).iter_mut().zip(angular_velocities) {
        *value = found;
    }
    let stresslets = [(column::STRESSLET, &solved.stresslets), (column::STRESSLET_FAR, &solved.far.stresslets)];
    for (name, list) in [(column::STRAIN_RATE, strain_rates)].into_iter().chain(stresslets) {
        for (value, &found) in traceless(particles, name).iter_mut().zip(list) {
            *value = found;
        }
    }
}

fn traceless<'a>(particles: &'a mut Particles, name: &str) -> &'a mut [Traceless] {
    bytemuck::cast_slice_mut(&mut particles.column(name, 5).values)
}

fn answer(mut all: Particles, solved: &Solved, case: &Case, plan: &Plan, seconds: f64) -> Answer {
    let vectors = |all: &mut Particles, name: &str| all.vectors(name).iter().map(Vector::to_array).collect();
    let tensors = |all: &mut Particles, name: &str| traceless(all, name).iter().map(|t| t.0).collect();
    let dipoles = plan.multipoles == Multipoles::Dipole;
    Answer {
        velocities: vectors(&mut all, column::VELOCITY),
        angular_velocities: dipoles.then(|| vectors(&mut all, column::ANGULAR_VELOCITY)),
        strain_rates: dipoles.then(|| tensors(&mut all, column::STRAIN_RATE)),
        stresslets: dipoles.then(|| tensors(&mut all, column::STRESSLET)),
        stresslets_far: case.lubrication.then(|| tensors(&mut all, column::STRESSLET_FAR)),
        iterations: solved.iterations,
        residual: solved.residual,
        seconds,
        plan: plan.describe(),
    }
}

/// Refuses an answer that is beyond the numbers of the machine.
fn finite(answer: &Answer) -> anyhow::Result<()> {
    let vectors =
        [Some(&answer.velocities), answer.angular_velocities.as_ref()].into_iter().flatten().flatten().flatten();
    let tensors = [&answer.strain_rates, &answer.stresslets, &answer.stresslets_far];
    let tensors = tensors.into_iter().flatten().flatten().flatten();
    ensure!(
        vectors.chain(tensors).chain([&answer.residual]).all(|number| number.is_finite()),
        "the answer is not finite: forces, torques, stresslets or background are too large beside viscosity and radii; \
         choose units in which they are about 1"
    );
    Ok(())
}

fn write(args: &Args, answer: &Answer) -> anyhow::Result<()> {
    match &args.out {
        Some(path) => Ok(answer.write(path)?),
        None => streams::print_here(&answer.to_json()),
    }
}
