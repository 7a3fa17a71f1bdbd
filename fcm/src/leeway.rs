//! Shares of the tolerance: of the hardest part of an evaluation, of walls, and of the iteration.
//!
//! Errors of an evaluation are relative to what the loads would do to single spheres. Answers may be much smaller: weights
//! move dense suspensions and lattices by a tenth to a seventieth of that. Shares are measured over random cases of every kind
//! (`scripts/validate tolerance`).

use crate::problem::{Loading, Multipoles, Problem};
use domain::Boundaries;
use std::f64::consts::PI;

/// So that 300 random cases of up to 48 particles (`fcm/tests`) and `fcm-solve bench` at 600 and 3,200 come out
/// below the tolerance: 1.3 times below in the worst of them, about six times in a typical one.
const MONOPOLE_LEEWAY: f64 = 0.8;
const GIVEN_LEEWAY: f64 = 0.5;
const RIGID_LEEWAY: f64 = 0.22;

/// At walls, of given loads; and at walls and in layers of rigid spheres, where forces and torques alone make stresslets, smaller
/// beside the loads than those of a flow.
const GIVEN_LEEWAY_WALLS: f64 = 0.15;
const RIGID_LEEWAY_WALLS: f64 = 0.15;
const RIGID_LEEWAY_LAYER: f64 = 0.04;

/// Shares of the tolerance that walls may have with rigid spheres, whose stresslets come out worse than gradients: under loads that
/// vary, under weights, and in lattices. The share with given loads, and that of the cut of wavenumbers then.
const RIGID_SHARE: f64 = 0.25;
const WEIGHT_SHARE: f64 = 0.08;
const LATTICE_SHARE: f64 = 0.025;
const GIVEN_SHARE: f64 = 0.3;
const GIVEN_CUT_SHARE: f64 = 0.25;

/// The same in a flow along walls, where angular velocities are small beside the rate of strain: with lubrication, which makes them
/// larger, and without. That of suspensions whose errors average out is [`RIGID_SHARE`].
const LUBRICATED_FLOW_SHARE: f64 = 0.12;
const FLOW_SHARE: f64 = 0.05;

/// The tolerance above which cuts leave so few wavenumbers that shares in a flow fall, and the power with which they do.
const COARSE: f64 = 1e-3;
const COARSE_POWER: f64 = 1.0 / 3.0;

/// Part of the tolerance below which an image of a sphere in a wall is left out; and where that shows in the small velocities that a
/// flow along walls leaves.
const IMAGE_SHARE: f64 = 0.3;
const FINE_IMAGE_SHARE: f64 = 0.1;

/// Spheres below which errors do not average out, and volume fraction from which lubrication decides the motions in a flow along
/// walls.
const AVERAGING: usize = 20;
const LEAST_AVERAGING_FRACTION: f64 = 0.05;

/// Share of the tolerance that the iteration for stresslets and lubrication may leave.
pub(crate) const ITERATION_SHARE: f64 = 0.25;

/// Ratio of radii above which stresslets are those of the large spheres, whose share of the iteration's norm is small, and the
/// factor by which the iteration goes on.
const WIDE_RATIO: f64 = 3.0;
const WIDE_FACTOR: f64 = 2.5;

/// The factor by which the iteration goes on with lubrication between few spheres.
const FEW_FACTOR: f64 = 2.0;

/// A quantity by volume fraction, linear in its logarithm between entries and constant beyond them.
type Table = [(f64, f64)];

/// Factors by which errors of the evaluation and of the iteration exceed, in dense disordered suspensions, those up to 45%; and
/// of the evaluation where lubrication decides the motions that differ between neighbours.
const DENSE: &Table = &[(0.45, 1.0), (0.5, 2.5), (0.56, 5.0), (0.62, 8.0)];
const DENSE_ITERATION: &Table = &[(0.45, 1.0), (0.5, 1.5), (0.56, 2.5), (0.62, 4.0)];
const DENSE_LUBRICATED: &Table = &[(0.45, 1.0), (0.5, 1.5), (0.56, 2.5), (0.62, 3.0)];

/// Factors for the evaluation in lattices under equal forces, of rigid spheres and of others: errors of all neighbours have one
/// sign.
const LATTICE: &Table = &[(0.14, 1.0), (0.2, 2.0), (0.28, 3.0), (0.36, 4.0), (0.52, 6.0), (0.6, 40.0), (0.7, 60.0)];
const LATTICE_GIVEN: &Table = &[(0.05, 1.0), (0.1, 2.0), (0.2, 6.0), (0.3, 12.0), (0.5, 15.0), (0.7, 30.0)];

/// Factors for the iteration in lattices.
const LATTICE_ITERATION: &Table = &[(0.3, 1.0), (0.4, 2.0), (0.56, 2.5), (0.62, 4.0)];

/// Spheres in a box up to which the periodic images of a disordered suspension count as a lattice.
const FEW: usize = 64;

impl Problem {
    /// The tolerance over the error that its hardest part may have. The bounds are those of gradients; with forces
    /// alone, velocities come out better. The stresslets of rigid spheres answer to rates of strain that may be small
    /// beside the loads' own, and come out worse.
    pub(crate) fn leeway(&self) -> f64 {
        let usual = match (self.multipoles, self.rigid) {
            (Multipoles::Monopole, _) => MONOPOLE_LEEWAY,
            (Multipoles::Dipole, false) if self.boundaries.walls() > 0 => GIVEN_LEEWAY_WALLS,
            (Multipoles::Dipole, false) => GIVEN_LEEWAY,
            (Multipoles::Dipole, true) if matches!(self.boundaries, Boundaries::Periodic | Boundaries::Open) => {
                RIGID_LEEWAY
            }
            (Multipoles::Dipole, true) if self.boundaries == Boundaries::OpenAlongZ => RIGID_LEEWAY_LAYER,
            (Multipoles::Dipole, true) => RIGID_LEEWAY_WALLS,
        };
        usual / self.hindrance()
    }

    /// The factor by which errors, relative to the answer, exceed those of dilute and moderately dense suspensions.
    pub(crate) fn hindrance(&self) -> f64 {
        let fraction = self.volume_fraction();
        let is_eased = self.lubricated && matches!(self.loading, Loading::Varied | Loading::Flow);
        let disordered = at(if is_eased { DENSE_LUBRICATED } else { DENSE }, fraction);
        let of_lattice = if self.rigid { LATTICE } else { LATTICE_GIVEN };
        if self.is_lattice() { disordered.max(at(of_lattice, fraction)) } else { disordered }
    }

    /// Whether equal forces may act on a lattice, or on so few spheres that their periodic images are one.
    fn is_lattice(&self) -> bool {
        match self.loading {
            Loading::Varied | Loading::Flow => false,
            Loading::Uniform => self.particles() <= FEW,
            Loading::UniformOnLattice => true,
        }
    }

    /// The relative error that the iteration for stresslets and lubrication may leave.
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

    /// Whether stresslets are those of spheres much larger than others.
    fn is_wide(&self) -> bool {
        self.largest_radius() > WIDE_RATIO * self.smallest_radius()
    }

    /// Whether errors of single spheres count.
    fn is_few(&self) -> bool {
        self.particles() < AVERAGING
    }

    /// Whether the errors of a suspension in a flow along walls average out, and lubrication makes all its motions so large that they
    /// count beside the rate of strain.
    fn is_averaged(&self) -> bool {
        self.lubricated && !self.is_few() && self.volume_fraction() >= LEAST_AVERAGING_FRACTION
    }

    /// The relative error that walls may have.
    pub(crate) fn allowed_at_walls(&self) -> f64 {
        if self.rigid { self.allowed_of_wall_cut() } else { GIVEN_SHARE * self.tolerance }
    }

    /// The same of the cut between wavenumbers on the grid and between spheres.
    pub(crate) fn allowed_of_wall_cut(&self) -> f64 {
        let share = match (self.rigid, self.loading) {
            (false, _) => GIVEN_CUT_SHARE,
            (true, Loading::Varied) => RIGID_SHARE,
            (true, Loading::Uniform) => WEIGHT_SHARE,
            (true, Loading::Flow) => self.share_in_flow(),
            (true, Loading::UniformOnLattice) => LATTICE_SHARE,
        };
        share * self.tolerance
    }

    /// The share of walls in a flow along them.
    fn share_in_flow(&self) -> f64 {
        let share = match (self.is_averaged(), self.lubricated) {
            (true, _) => RIGID_SHARE,
            (false, true) => LUBRICATED_FLOW_SHARE,
            (false, false) => FLOW_SHARE,
        };
        share * (COARSE / self.tolerance).min(1.0).powf(COARSE_POWER)
    }

    /// The part of a sphere's mobility below which its images in walls are left out.
    pub(crate) fn least_image(&self) -> f64 {
        let in_flow = matches!(self.loading, Loading::Flow | Loading::UniformOnLattice);
        let share = if self.rigid && in_flow && !self.is_averaged() { FINE_IMAGE_SHARE } else { IMAGE_SHARE };
        share * self.tolerance
    }

    /// The volume of the particles over that of the box.
    fn volume_fraction(&self) -> f64 {
        let volumes = self.radii.iter().map(|&(radius, count)| 4.0 / 3.0 * PI * radius.powi(3) * count as f64);
        volumes.sum::<f64>() / self.volume
    }
}

/// The value of a table at a volume fraction.
fn at(table: &Table, fraction: f64) -> f64 {
    let after = table.partition_point(|&(phi, _)| phi <= fraction);
    match (after.checked_sub(1).map(|before| table[before]), table.get(after)) {
        (Some((phi, value)), Some(&(next_phi, next))) => {
            value * (next / value).powf((fraction - phi) / (next_phi - phi))
        }
        (Some((_, value)), None) | (None, Some(&(_, value))) => value,
        (None, None) => 1.0,
    }
}
