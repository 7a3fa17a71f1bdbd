//! Shares of the tolerance: for the dominant error of an evaluation, for walls, and for the iteration.
//!
//! Errors of an evaluation are relative to the motions of single spheres under the loads. Answers may be much
//! smaller: in dense suspensions and lattices, weights cause motions of a tenth to a seventieth of that. The shares
//! are calibrated on random cases of every kind (`scripts/validate tolerance`).

use crate::plan::problem::{Loading, Multipoles, Problem};
use domain::{Boundaries, sphere};

/// Calibrated so that 300 random cases of up to 48 particles (`fcm/tests`) and `fcm-solve bench` at 600 and 3,200
/// particles stay below the tolerance: by a factor of 1.3 in the worst of them, of about six in a typical one.
const MONOPOLE_LEEWAY: f64 = 0.8;
const GIVEN_LEEWAY: f64 = 0.5;
const RIGID_LEEWAY: f64 = 0.22;

/// The same for moments: the bounds are those of gradients (`fcm/tests/dipoles.rs`).
const MOMENTS_LEEWAY: f64 = 0.8;

/// The same at walls, for given loads and for rigid spheres, and for rigid spheres in open layers, where forces and
/// torques alone cause stresslets that are smaller relative to the loads than those of a flow.
const GIVEN_LEEWAY_WALLS: f64 = 0.15;
const RIGID_LEEWAY_WALLS: f64 = 0.15;
const RIGID_LEEWAY_LAYER: f64 = 0.04;

/// Shares of the tolerance for the walls' flow with rigid spheres, whose stresslets have larger errors than
/// gradients: under loads that vary, under weights, and in lattices. Then the share with given loads, and the share
/// of the wavenumber split with given loads.
const RIGID_SHARE: f64 = 0.25;
const WEIGHT_SHARE: f64 = 0.08;
const LATTICE_SHARE: f64 = 0.025;
const GIVEN_SHARE: f64 = 0.3;
const GIVEN_CUT_SHARE: f64 = 0.25;

/// The same in a flow along walls, where angular velocities are small relative to the rate of strain: with
/// lubrication, which makes them larger, and without. Suspensions whose errors average out have [`RIGID_SHARE`].
const LUBRICATED_FLOW_SHARE: f64 = 0.12;
const FLOW_SHARE: f64 = 0.05;

/// Tolerance above which the split leaves so few wavenumbers that shares in a flow have to fall, and the exponent
/// with which they do.
const COARSE: f64 = 1e-3;
const COARSE_POWER: f64 = 1.0 / 3.0;

/// Fraction of the tolerance below which an image of a sphere in a wall is left out; and the fraction if the error
/// shows in the small relative velocities of a flow along walls.
const IMAGE_SHARE: f64 = 0.3;
const FINE_IMAGE_SHARE: f64 = 0.1;

/// Number of spheres below which errors do not average out, and volume fraction from which lubrication dominates the
/// motions in a flow along walls.
const AVERAGING: usize = 20;
const LEAST_AVERAGING_FRACTION: f64 = 0.05;

/// Share of the tolerance for the iteration for stresslets and lubrication.
pub(crate) const ITERATION_SHARE: f64 = 0.25;

/// Ratio of radii above which the large spheres dominate the stresslets but have a small share in the norm of the
/// iteration, and the factor by which its tolerance is tightened.
const WIDE_RATIO: f64 = 3.0;
const WIDE_FACTOR: f64 = 2.5;

/// Factor by which the tolerance of the iteration is tightened with lubrication between few spheres.
const FEW_FACTOR: f64 = 2.0;

/// Factor by which errors of few swimmers exceed those of spheres under forces: with a quadrupole, the difference of
/// two Gaussians, a sphere at a point of the grid has up to four times the error of a force.
const SWIMMING_FACTOR: f64 = 4.0;

/// A quantity by volume fraction: log-linear between entries, constant beyond them.
type FractionTable = [(f64, f64)];

/// Factors by which errors of the evaluation and of the iteration in dense disordered suspensions exceed those up to
/// 45%; and of the evaluation if lubrication dominates the relative motions of neighbours.
const DENSE: &FractionTable = &[(0.45, 1.0), (0.5, 2.5), (0.56, 5.0), (0.62, 8.0)];
const DENSE_ITERATION: &FractionTable = &[(0.45, 1.0), (0.5, 1.5), (0.56, 2.5), (0.62, 4.0)];
const DENSE_LUBRICATED: &FractionTable = &[(0.45, 1.0), (0.5, 1.5), (0.56, 2.5), (0.62, 3.0)];

/// Factors for the evaluation in lattices under equal forces, with rigid spheres and without: the errors from all
/// neighbours have the same sign.
const LATTICE: &FractionTable =
    &[(0.14, 1.0), (0.2, 2.0), (0.28, 3.0), (0.36, 4.0), (0.52, 6.0), (0.6, 40.0), (0.7, 60.0)];
const LATTICE_GIVEN: &FractionTable = &[(0.05, 1.0), (0.1, 2.0), (0.2, 6.0), (0.3, 12.0), (0.5, 15.0), (0.7, 30.0)];

/// Factors for the iteration in lattices.
const LATTICE_ITERATION: &FractionTable = &[(0.3, 1.0), (0.4, 2.0), (0.56, 2.5), (0.62, 4.0)];

/// Largest number of spheres in a box for which the periodic images of a disordered suspension count as a lattice.
const FEW: usize = 64;

impl Problem {
    /// Error allowed for the dominant part of an evaluation, over the tolerance. The bounds are those of gradients;
    /// with forces alone, velocities are more accurate. The stresslets of rigid spheres balance rates of strain that
    /// may be small relative to those of the loads themselves, and are less accurate.
    pub(crate) fn tolerance_share(&self) -> f64 {
        let usual = match (self.multipoles, self.rigid) {
            (Multipoles::Monopole, _) => MONOPOLE_LEEWAY,
            (Multipoles::Moments, _) => MOMENTS_LEEWAY,
            (Multipoles::Dipole, false) if self.boundaries.walls() > 0 => GIVEN_LEEWAY_WALLS,
            (Multipoles::Dipole, false) => GIVEN_LEEWAY,
            (Multipoles::Dipole, true) if matches!(self.boundaries, Boundaries::Periodic | Boundaries::Open) => {
                RIGID_LEEWAY
            }
            (Multipoles::Dipole, true) if self.boundaries == Boundaries::OpenAlongZ => RIGID_LEEWAY_LAYER,
            (Multipoles::Dipole, true) => RIGID_LEEWAY_WALLS,
        };
        usual / self.error_amplification()
    }

    /// Factor by which errors, relative to the answer, exceed those of dilute and moderately dense suspensions.
    pub(crate) fn error_amplification(&self) -> f64 {
        let fraction = self.volume_fraction();
        let is_eased = self.lubricated && !self.is_uniform();
        let disordered = at(if is_eased { DENSE_LUBRICATED } else { DENSE }, fraction);
        let of_lattice = if self.rigid { LATTICE } else { LATTICE_GIVEN };
        let swimming = if self.loading == Loading::Swimming && self.is_few() { SWIMMING_FACTOR } else { 1.0 };
        swimming * if self.is_lattice() { disordered.max(at(of_lattice, fraction)) } else { disordered }
    }

    /// Whether equal forces act on the spheres.
    fn is_uniform(&self) -> bool {
        matches!(self.loading, Loading::Uniform | Loading::UniformOnLattice)
    }

    /// Whether equal forces may act on a lattice, or on so few spheres that their periodic images form one.
    fn is_lattice(&self) -> bool {
        match self.loading {
            Loading::Varied | Loading::Flow | Loading::Swimming => false,
            Loading::Uniform => self.particles() <= FEW,
            Loading::UniformOnLattice => true,
        }
    }

    /// Relative error allowed for the iteration for stresslets and lubrication.
    pub(crate) fn iteration_tolerance(&self) -> f64 {
        let wide = if self.is_wide() { WIDE_FACTOR } else { 1.0 };
        let few = if self.lubricated && self.is_few() { FEW_FACTOR } else { 1.0 };
        let dense = match (self.is_lattice(), self.lubricated) {
            (true, _) => at(LATTICE_ITERATION, self.volume_fraction()),
            (false, true) => 1.0,
            (false, false) => at(DENSE_ITERATION, self.volume_fraction()),
        };
        let usual = ITERATION_SHARE * self.tolerance / (wide * dense * few);
        self.fixed.iteration_tolerance.unwrap_or(usual)
    }

    /// Whether the largest spheres are so much larger than others that their stresslets dominate.
    fn is_wide(&self) -> bool {
        self.largest_radius() > WIDE_RATIO * self.smallest_radius()
    }

    /// Whether there are too few spheres for errors to average out.
    fn is_few(&self) -> bool {
        self.particles() < AVERAGING
    }

    /// Whether the errors of a suspension in a flow along walls average out, and lubrication makes all its motions
    /// comparable with the rate of strain.
    fn is_averaged(&self) -> bool {
        self.lubricated && !self.is_few() && self.volume_fraction() >= LEAST_AVERAGING_FRACTION
    }

    /// Relative error allowed for the walls' flow.
    pub(crate) fn allowed_at_walls(&self) -> f64 {
        if self.rigid { self.wavenumber_split_tolerance() } else { GIVEN_SHARE * self.tolerance }
    }

    /// Relative error allowed for the split between wavenumbers on the grid and between spheres.
    pub(crate) fn wavenumber_split_tolerance(&self) -> f64 {
        let share = match (self.rigid, self.loading) {
            (false, _) => GIVEN_CUT_SHARE,
            (true, Loading::Varied | Loading::Swimming) => RIGID_SHARE,
            (true, Loading::Uniform) => WEIGHT_SHARE,
            (true, Loading::Flow) => self.share_in_flow(),
            (true, Loading::UniformOnLattice) => LATTICE_SHARE,
        };
        share * self.tolerance
    }

    /// Share of the walls in a flow along them.
    fn share_in_flow(&self) -> f64 {
        let share = match (self.is_averaged(), self.lubricated) {
            (true, _) => RIGID_SHARE,
            (false, true) => LUBRICATED_FLOW_SHARE,
            (false, false) => FLOW_SHARE,
        };
        share * (COARSE / self.tolerance).min(1.0).powf(COARSE_POWER)
    }

    /// Fraction of a sphere's mobility below which its images in walls are left out.
    pub(crate) fn image_cutoff(&self) -> f64 {
        let in_flow = matches!(self.loading, Loading::Flow | Loading::UniformOnLattice);
        let share = if self.rigid && in_flow && !self.is_averaged() { FINE_IMAGE_SHARE } else { IMAGE_SHARE };
        share * self.tolerance
    }

    /// Volume of the particles over that of the box.
    fn volume_fraction(&self) -> f64 {
        let volumes = self.radii.iter().map(|&(radius, count)| sphere::volume(radius) * count as f64);
        volumes.sum::<f64>() / self.volume
    }
}

/// Value of a table at a volume fraction.
fn at(table: &FractionTable, fraction: f64) -> f64 {
    let after = table.partition_point(|&(phi, _)| phi <= fraction);
    match (after.checked_sub(1).map(|before| table[before]), table.get(after)) {
        (Some((phi, value)), Some(&(next_phi, next))) => {
            value * (next / value).powf((fraction - phi) / (next_phi - phi))
        }
        (Some((_, value)), None) | (None, Some(&(_, value))) => value,
        (None, None) => 1.0,
    }
}
