//! Pressure-driven flow between walls at a given flux.

use crate::ambient::Poiseuille;
use crate::ambient::StrainRate;
use crate::coupled_solver::CoupledSolver;
use crate::pairs::search::{Connections, NearPairs, Pairs};
use crate::six_vector::SixVectors;
use crate::solution::Solution;
use crate::units;
use domain::{Comm, DomainView, Particles, PeriodicBox, Traceless, Units, Vector};
use fcm::{Constraint, Linear, Loads, Mobility, Motion, Multipoles, Output};

/// Pressure gradient that keeps the flux between walls: a parabolic flow of curvature `c` added to the flow of the
/// fluid alone.
///
/// Let `m` be the motions `(U, Omega, E)` of free spheres in the unit flow `z (H - z) / 2`. By the reciprocal theorem,
/// external forces and torques `F` and total stresslets `S` add a flux through the cross-section between walls of the
/// area `A` as large as that of a pressure gradient `m . (F, S) / (mu A) = sum (F . U + T . Omega - S : E) / (mu A)`.
/// Hence
///
/// ```text
/// c = -kappa m . (F, S),        kappa = 12 / (mu A H^3)
/// ```
///
/// keeps the flux. Lubrication, with the resistance `R`, acts on motions relative to the actual flow, that is on `(U,
/// Omega, -E)` minus `c n`, where `n = (U, Omega, E)` of `m`. The loads on spheres at rest in the unit flow are `w = R
/// n`; with the mobility `M`, the flow of curvature `c` moves spheres by `c m'`, `m' = m + M w`. With the far-field
/// loads `f` without `c w`,
///
/// ```text
/// c = (w_E : E_inf - m' . f) / alpha,        alpha = 1/kappa + 2 m . w + w . M w - n . w
/// ```
///
/// and the mobility at constant flux is `M - m' m'^T / alpha`. The system stays symmetric, and its solution equals the
/// solution for the pressure gradient that results.
pub struct ConstantFlux {
    /// Strain rate of the unit flow, and `m`.
    flow: StrainRate,
    unit: Motion,
    /// `w`, with stresslets `w_E`.
    resisted: Loads,
    /// `m'` and `1 / alpha`.
    constraint: Constraint,
    /// `w_E : E_inf / alpha`, with a term for lubrication at walls in a curved flow.
    ambient: f64,
}

/// Near pairs in the unit flow, in scaled units and without springs, and the strain rate of the ambient flow.
struct PairsInFlow<'a> {
    near: &'a NearPairs,
    units: &'a Units,
    strain_rate: StrainRate,
    positions: &'a [Vector],
}

impl CoupledSolver {
    /// The constant-flux constraint in an ambient flow with a strain rate. Arranges the particles in the mobility.
    /// Collective.
    pub(super) fn flux(&mut self, cell: &PeriodicBox, particles: &Particles, strain_rate: StrainRate) -> ConstantFlux {
        let mobility = self.far.mobility();
        mobility.constrain(None);
        mobility.follow(cell, particles);
        let flux = ConstantFlux::new(cell, particles, mobility.plan().viscosity, mobility.plan().multipoles);
        let Some(field) = self.near.as_mut().filter(|field| field.lubrication.is_some()) else { return flux };
        let (units, own) = (self.units, units::particles(particles, &self.units));
        // The unit flow has a curvature of one over time and length.
        let height = cell.edges().z / units.length;
        let flow = Poiseuille { curvature: units.length / units.rate(), height }.strain_rate();
        let view = DomainView { cell: &cell.scaled(1.0 / units.length), partition: &self.partition };
        let near = NearPairs::find(field, Connections::default(), &own, view, flow);
        let pairs = PairsInFlow { near: &near, units: &units, strain_rate, positions: &particles.positions };
        flux.lubricated(mobility, &pairs, self.partition.comm())
    }
}

impl ConstantFlux {
    /// The constraint for spheres without lubrication, between the walls of a box.
    fn new(cell: &PeriodicBox, particles: &Particles, viscosity: f64, multipoles: Multipoles) -> Self {
        let [x, y, height] = cell.edges().to_array();
        let flow = Poiseuille { curvature: 1.0, height };
        let unit = flow.motion(particles, multipoles);
        let compliance = 12.0 / (viscosity * x * y * height.powi(3));
        let constraint = Constraint { response: unit.clone(), compliance };
        Self { flow: flow.strain_rate(), unit, resisted: Loads::default(), constraint, ambient: 0.0 }
    }

    /// Adds the effect of lubrication. The particles are arranged in `mobility`, which has no constraint. Collective.
    fn lubricated(mut self, mobility: &mut Mobility, pairs: &PairsInFlow, comm: &Comm) -> Self {
        let &PairsInFlow { near, units, strain_rate, positions } = pairs;
        let unit = units::motion(&self.unit, units);
        let passed = SixVectors::new(unit.velocities.len(), &unit.velocities, &unit.angular_velocities);
        let mut loads = near.times(&[Pairs::Stiff, Pairs::Soft], &passed);
        loads.add(1.0, near.ambient_loads());
        let stresslets = near.stresslets(&passed.negative());
        let found = Loads { forces: loads.linear(), torques: loads.angular(), stresslets };
        self.resisted = units::times(&found, units.torque());
        let mut moved = Loads { stresslets: Vec::new(), ..self.resisted.clone() };
        let wanted = match mobility.plan().multipoles {
            Multipoles::Dipole => Output::All,
            Multipoles::Monopole | Multipoles::Moments => {
                moved.torques.clear();
                Output::Velocities
            }
        };
        let by_loads = mobility.apply(&moved, wanted);
        let strained: f64 =
            self.resisted.stresslets.iter().zip(positions).map(|(&s, place)| s.contract(strain_rate.at(place.z))).sum();
        // Lubrication at walls is computed relative to flows that vanish at the wall.
        let levers = near.levers(&passed) * units.length.powi(2);
        let [own, besides] = [self.flow, strain_rate].map(|flow| flow.half_curvature().dot(levers));
        let mut sums = [self.unit.power(&self.resisted) + by_loads.power(&moved) - own, strained + besides];
        comm.sum(&mut sums);
        let [more, strained] = sums;
        let Constraint { response, compliance } = &mut self.constraint;
        response.add(1.0, &by_loads);
        *compliance = 1.0 / (1.0 / *compliance + more);
        self.ambient = strained * *compliance;
        self
    }

    /// Rank-one correction of the mobility.
    pub fn constraint(&self) -> Constraint {
        self.constraint.clone()
    }

    /// Ambient motions, plus the motions due to the part of the pressure gradient that the ambient flow causes.
    pub fn ambient(&self, besides: &Motion) -> Motion {
        let Motion { velocities, angular_velocities, strain_rates } = &self.constraint.response;
        let mut ambient = Motion {
            velocities: vec![Vector::ZERO; velocities.len()],
            angular_velocities: vec![Vector::ZERO; angular_velocities.len()],
            strain_rates: vec![Traceless::ZERO; strain_rates.len()],
        };
        ambient.add(self.ambient, &self.constraint.response);
        ambient.add(1.0, besides);
        ambient
    }

    /// Adds the lubrication loads in the flow of the pressure gradient to a solution, and sets its curvature.
    /// Collective.
    pub fn complete(&self, solved: &mut Solution, comm: &Comm) {
        let curvature = self.ambient + self.constraint.amplitude(&solved.far, comm);
        let Loads { forces, torques, .. } = &mut solved.far;
        let own = forces.iter_mut().chain(torques).zip(self.resisted.forces.iter().chain(&self.resisted.torques));
        own.for_each(|(load, &more)| *load += more * curvature);
        solved.stresslets.iter_mut().zip(&self.resisted.stresslets).for_each(|(s, &more)| *s += more * curvature);
        solved.curvature = curvature;
    }
}
