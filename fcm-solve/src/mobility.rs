//! `fcm-solve mobility`: one evaluation at positions given by the user.

use crate::causes::in_full;
use crate::number::tolerance;
use crate::part_progress::PartProgress;
use crate::streams;
use anyhow::{Context, ensure};
use domain::{AxisRotation, Bytes, Comm, Tensor, Traceless, Vector};
use fcm::{Costs, DrawDiagnostics, Loads, Motion, Multipoles, Plan};
use files::{CaseAnswer, FileError, parse_case, read_case};
use lubrication::LubricationRange;
use scene::{Case, CaseNoise, CaseTerms, NOISE_NUMBERS};
use solver::BackgroundFlow;
use std::path::{Path, PathBuf};
use std::time::Instant;
use suspension::{Drift, Mobility, MobilityParameters, Motions, Overlaps};

/// Case to evaluate, file of the answer, and tolerance.
#[derive(clap::Args)]
#[command(after_help = NAMES)]
pub struct MobilityArgs {
    /// The case: JSON, or HDF5 with the same names if it ends in .h5 or .hdf5; - reads JSON from the standard input
    case: PathBuf,
    /// File of the answer, HDF5 if it ends in .h5 or .hdf5, else JSON [default: the standard output]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Relative error allowed, from 1e-12 to 0.5
    #[arg(long, value_name = "T", default_value = "1e-3", value_parser = tolerance, allow_hyphen_values = true)]
    tolerance: f64,
}

const NAMES: &str = "\
A case for N particles:
  box         [Lx, Ly, Lz], or three lattice vectors in right-handed order
  viscosity   a number
  positions   N x 3                radii        N numbers, or one for all
  forces      N x 3                torques      N x 3
  stresslets  N x 5: xx, xy, xz, yy, yz, of particles that are not rigid
  rigid       whether to solve for the stresslets that keep the particles rigid (default: true)
  multipoles  \"monopole\" or \"dipole\" (default)
  lubrication whether near pairs of rigid particles feel lubrication (default: false)
  lubrication_cutoff  the gap where it ends, in radii of the pair's larger sphere (default: 2.5)
  method      \"direct\", the envelopes themselves on the grid, \"split\", or \"dense\", exact for few
              spheres; \"auto\" (default): the faster of the first two
  device      \"gpu\": the far field on an NVIDIA card; \"cpu\" (default)
  boundaries  [\"periodic\", \"periodic\", \"walls\"]: what the box is along x, y and z (default: periodic);
              one axis may have walls at 0 and its edge, a wall at 0, or be open, or all may be open
              (then box may be left out: spheres are where they are)
  background  {\"velocity_gradient\": 3 x 3, G[i][j] = du_i/dx_j, between walls a shear of both;
              \"pressure_gradient\": dp/dx, dp/dy, dp/dz, between two walls}
  noise       {\"draws\": n, \"seed\": s}: random motions whose covariance is the mobility, besides;
              with \"drift\": true also random parts of the Brownian drift
  strain      the box's Lees-Edwards strain: its second lattice vector is (strain Ly, Ly, 0)
What is absent is zero. The answer has velocities and angular_velocities relative to the background
flow at the centres, strain_rates of the disturbance flow, stresslets (with lubrication the whole
hydrodynamic ones, and stresslets_far, the far field's part), iterations, residual, seconds and plan;
noise_velocities and noise_angular_velocities, draws x N x 3, are the Brownian displacements over a
time dt at kT = dt/2, noise_strain_rates those of the fluid, of particles that are not rigid; the mean
of drift_velocities, drift_angular_velocities and drift_stresslets over many draws is the Brownian
drift, kT times the divergence of the mobility, at kT = 1.";

/// Evaluates the case. Collective.
pub fn run(args: &MobilityArgs, comm: &Comm) -> anyhow::Result<()> {
    let read = if comm.is_first() { read(&args.case).map(Some) } else { Ok(None) };
    let read = comm.agree(read)?;
    let case = Case::from_json(&comm.broadcast_text(&read.map_or_else(String::new, |case| case.to_json())));
    let evaluating = PartProgress::start_late(comm, "the case is evaluated");
    let answer = answer_to(&case, args.tolerance, comm).with_context(|| args.case.display().to_string())?;
    drop(evaluating);
    let written = answer.map_or(Ok(()), |answer| write(args, &answer));
    Ok(comm.agree(written.map_err(|e| in_full(&e)))?)
}

/// Evaluates a case; the first rank has the answer. Collective.
fn answer_to(case: &Case, tolerance: f64, comm: &Comm) -> anyhow::Result<Option<CaseAnswer>> {
    let (parameters, turn) = parameters(case, tolerance, run::kept_costs(case.device.into(), comm)?)?;
    case.noise.map_or(Ok(()), |_| parameters.check_noise())?;
    let mut mobility = Mobility::new(parameters, text_bytes(case), comm)?.turned(turn);
    mobility.join(case.rigid_bodies());
    let positions: Vec<Vector> = case.positions.iter().map(|&position| position.into()).collect();
    let overlaps = mobility.place(&positions)?;
    for caution in cautions(overlaps, &mobility).iter().filter(|_| comm.is_first()) {
        streams::log(format_args!("warning: {caution}"));
    }
    let gradient = Tensor::from_cols_array_2d(&case.background.velocity_gradient).transpose();
    let background = BackgroundFlow::with_gradient(gradient).context("background.velocity_gradient")?;
    mobility.drive(Vector::from_array(case.background.pressure_gradient)).context("background.pressure_gradient")?;
    let start = Instant::now();
    let motions = mobility.apply(&loads(case), &background)?;
    let seconds = start.elapsed().as_secs_f64();
    let noise = case.noise.map(|CaseNoise { draws, seed, .. }| mobility.noise(seed, 0..draws)).transpose()?;
    let drifting = case.noise.filter(|noise| noise.drift);
    let drift = drifting.map(|CaseNoise { draws, seed, .. }| mobility.drift(seed, 0..draws)).transpose()?;
    if let Some(clipped) =
        noise.as_ref().map(|(_, drawn)| drawn.clipped).filter(|&c| c > DrawDiagnostics::NEGLIGIBLE && comm.is_first())
    {
        streams::log(format_args!(
            "warning: {clipped:.1e} of the near field's weight is negative, which it is where spheres overlap; random \
             motions are without it"
        ));
    }
    let mut answer = comm.is_first().then(|| answer(&motions, case, mobility.plan(), mobility.turn(), seconds));
    if let (Some(answer), Some((motions, _))) = (&mut answer, noise) {
        add_noise(answer, &motions, case);
    }
    if let (Some(answer), Some(drift)) = (&mut answer, drift) {
        add_drift(answer, &drift);
    }
    comm.agree(answer.as_ref().map_or(Ok(()), finite).map_err(|e| in_full(&e)))?;
    Ok(answer)
}

fn read(path: &Path) -> Result<Case, FileError> {
    if path != Path::new("-") {
        return read_case(path);
    }
    let name = Path::new("the standard input");
    let unreadable = |error: std::io::Error| FileError::Read { path: name.to_owned(), reason: error.to_string() };
    parse_case(&std::io::read_to_string(std::io::stdin()).map_err(unreadable)?, name)
}

/// Warnings about a case that can be evaluated but whose answer is questionable.
fn cautions(overlaps: Option<Overlaps>, mobility: &Mobility) -> Vec<String> {
    let caution = |overlaps| format!("{overlaps}; the answer is that of the method, but spheres can't be there");
    overlaps.map(caution).into_iter().chain(mobility.infeasible()).collect()
}

/// Memory for the numbers of the case and the answer, 32 for each particle and those of random motions, in binary form
/// and as text of about 20 characters each.
fn text_bytes(case: &Case) -> Bytes {
    let kinds = |noise: CaseNoise| if noise.drift { 2.0 } else { 1.0 };
    let noise = case.noise.map_or(0.0, |noise| kinds(noise) * noise.draws as f64) * NOISE_NUMBERS as f64;
    Bytes::keep((8.0 + 20.0) * (32.0 + 2.0 * noise) * case.positions.len() as f64)
}

fn parameters(case: &Case, tolerance: f64, costs: Costs) -> anyhow::Result<(MobilityParameters, AxisRotation)> {
    let (cell, turn) = case.bounded_box()?;
    let cutoff = case.lubrication_cutoff.unwrap_or(LubricationRange::WIDE);
    let parameters = MobilityParameters {
        cell,
        radii: case.radii(),
        viscosity: case.viscosity,
        multipoles: match case.multipoles {
            CaseTerms::Monopole => Multipoles::Monopole,
            CaseTerms::Dipole => Multipoles::Dipole,
        },
        rigid: case.rigid,
        swimming: false,
        tolerance,
        lubrication: case
            .lubrication
            .then(|| LubricationRange::new(cutoff, LubricationRange::MINIMUM_GAP))
            .transpose()?,
        method: case.method.alone(),
        device: case.device.into(),
        costs,
    };
    Ok((parameters, turn))
}

fn loads(case: &Case) -> Loads {
    let vectors = |list: &[[f64; 3]]| list.iter().map(|&vector| vector.into()).collect();
    let stresslets = case.stresslets.iter().map(|&stresslet| Traceless(stresslet)).collect();
    Loads { forces: vectors(&case.forces), torques: vectors(&case.torques), stresslets }
}

fn answer(motions: &Motions, case: &Case, plan: &Plan, turn: AxisRotation, seconds: f64) -> CaseAnswer {
    let vectors = |list: &[Vector]| list.iter().map(Vector::to_array).collect();
    let tensors = |list: &[Traceless]| list.iter().map(|tensor| tensor.0).collect();
    let dipoles = plan.multipoles == Multipoles::Dipole;
    let Motions { motion, stresslets, stresslets_far, iterations, residual, bodies, .. } = motions;
    let has_bodies = !bodies.velocities.is_empty();
    CaseAnswer {
        velocities: vectors(&motion.velocities),
        angular_velocities: dipoles.then(|| vectors(&motion.angular_velocities)),
        strain_rates: dipoles.then(|| tensors(&motion.strain_rates)),
        stresslets: dipoles.then(|| tensors(stresslets)),
        stresslets_far: case.lubrication.then(|| tensors(stresslets_far)),
        body_velocities: has_bodies.then(|| vectors(&bodies.velocities)),
        body_angular_velocities: has_bodies.then(|| vectors(&bodies.angular_velocities)),
        iterations: *iterations,
        residual: *residual,
        seconds,
        plan: plan.describe_for(turn),
        ..CaseAnswer::default()
    }
}

fn add_noise(answer: &mut CaseAnswer, motions: &[Motion], case: &Case) {
    let dipoles = matches!(case.multipoles, CaseTerms::Dipole);
    let each = |of: &dyn Fn(&Motion) -> Vec<Vector>| {
        motions.iter().map(|motion| of(motion).iter().map(Vector::to_array).collect()).collect()
    };
    answer.noise_velocities = Some(each(&|motion| motion.velocities.clone()));
    answer.noise_angular_velocities = dipoles.then(|| each(&|motion| motion.angular_velocities.clone()));
    answer.noise_strain_rates = (dipoles && !case.rigid)
        .then(|| motions.iter().map(|motion| motion.strain_rates.iter().map(|tensor| tensor.0).collect()).collect());
}

fn add_drift(answer: &mut CaseAnswer, drift: &[Drift]) {
    let vectors = |of: &dyn Fn(&Drift) -> &[Vector]| {
        Some(drift.iter().map(|drift| of(drift).iter().map(Vector::to_array).collect()).collect())
    };
    answer.drift_velocities = vectors(&|drift| &drift.velocities);
    answer.drift_angular_velocities = vectors(&|drift| &drift.angular_velocities);
    let stresslets = |drift: &Drift| drift.stresslets.iter().map(|tensor| tensor.0).collect();
    answer.drift_stresslets = Some(drift.iter().map(stresslets).collect());
}

/// Refuses an answer with numbers that are not finite.
fn finite(answer: &CaseAnswer) -> anyhow::Result<()> {
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

fn write(args: &MobilityArgs, answer: &CaseAnswer) -> anyhow::Result<()> {
    match &args.out {
        Some(path) => Ok(answer.write(path)?),
        None => streams::print_here(&answer.to_json()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_has_room_for_the_text_of_a_case() {
        let list = ["[0.3333333333333333, 0.3333333333333333, 0.3333333333333333]"; 20].join(", ");
        let lists = ["positions", "forces", "torques"].map(|name| format!(r#""{name}": [{list}]"#)).join(", ");
        let text = format!(r#"{{"box": [9, 9, 9], "viscosity": 1, "radii": 1, {lists}}}"#);
        let room = text_bytes(&Case::from_json(&text)).kept / text.len() as f64;
        assert!((1.0..10.0).contains(&room), "{room} times the text");
    }
}
