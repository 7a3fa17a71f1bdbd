//! Flow between walls whose flux is given.

use crate::ambient::Poiseuille;
use crate::ambient::StrainRate;
use crate::coupled_solver::{Hydrodynamics, Solved};
use crate::pairs::search::{NearPairs, Pairs};
use crate::six_vector::Screws;
use crate::units;
use domain::{Comm, Particles, PeriodicBox, Traceless, Units, Vector};
use fcm::{Constraint, Evaluation, Linear, Loads, Mobility, Motion, Multipoles};

/// The pressure gradient that keeps the flux between walls, as a flow of the curvature `c` besides that of the fluid alone.
///
/// With `m` the motions `(U, Omega, E)` of free spheres in the flow `z (H - z) / 2`, the reciprocal theorem gives the flux through
/// walls of the area `A` that forces and torques `F` that are not the fluid's, and the whole stresslets `S`, add to that of a
/// pressure gradient: `m . (F, S) / (mu A) = sum (F . U + T . Omega - S : E) / (mu A)`. So
///
/// ```text
/// c = -kappa m . (F, S),        kappa = 12 / (mu A H^3)
/// ```
///
/// leaves the flux as it is. Lubrication, of a resistance `R`, acts on motions relative to the flow that there is, `(U, Omega, -E)` less
/// `c n` with `n = (U, Omega, E)` of `m`: spheres that the flow passes by feel `w = R n`, and with the mobility `M` move by
/// `c m'`, `m' = m + M w`, of the flow. By loads `f` of the far field without `c w`,
///
/// ```text
/// c = (w_E : E_inf - m' . f) / alpha,        alpha = 1/kappa + 2 m . w + w . M w - n . w
/// ```
///
/// and the mobility is `M - m' m'^T / alpha`: the system stays symmetric, and the solution is that with the pressure gradient
/// given, of whatever comes out here.
pub struct ConstantFlux {
    /// The rate of strain of the unit flow, and `m`.
    flow: StrainRate,
    unit: Motion,
    /// `w`, with stresslets `w_E`.
    resisted: Loads,
    /// `m'` and `1 / alpha`.
    constraint: Constraint,
    /// `(w_E : E_inf + ...) / alpha`, with what lubrication at walls feels of a curved flow.
    ambient: f64,
}

impl Hydrodynamics {
    /// What keeps the flux in an ambient flow of a rate of strain; particles are in place in the mobility then. Collective.
    pub(super) fn flux(&mut self, cell: &PeriodicBox, particles: &Particles, strain_rate: StrainRate) -> ConstantFlux {
        let mobility = self.far.mobility();
        mobility.constrain(None);
        mobility.arrange(cell, particles);
        let flux = ConstantFlux::new(cell, particles, (mobility.plan().viscosity, mobility.plan().multipoles));
        let Some(field) = self.near.as_mut().filter(|field| field.lubrication.is_some()) else { return flux };
        let (units, own) = (self.units, units::particles(particles, &self.units));
        // The unit flow has a curvature of one over time and length.
        let height = cell.edges().z / units.length;
        let flow = Poiseuille { curvature: units.length / units.rate(), height }.strain_rate();
        let near = NearPairs::find((field, None), &own, (&cell.scaled(1.0 / units.length), flow), &self.partition);
        flux.lubricated(mobility, (&near, &units), (strain_rate, &particles.positions), self.partition.comm())
    }
}

impl ConstantFlux {
    /// That of spheres without lubrication, between the walls of a box.
    fn new(cell: &PeriodicBox, particles: &Particles, (viscosity, multipoles): (f64, Multipoles)) -> Self {
        let [x, y, height] = cell.edges().to_array();
        let flow = Poiseuille { curvature: 1.0, height };
        let unit = flow.motion(particles, multipoles);
        let compliance = 12.0 / (viscosity * x * y * height.powi(3));
        let constraint = Constraint { response: unit.clone(), compliance };
        Self { flow: flow.strain_rate(), unit, resisted: Loads::default(), constraint, ambient: 0.0 }
    }

    /// The same with lubrication in the unit flow, in units of its own and without springs, of spheres in place in a mobility that
    /// has no constraint, in an ambient flow of a rate of strain. Collective.
    fn lubricated(
        mut self,
        mobility: &mut Mobility,
        (near, units): (&NearPairs, &Units),
        (strain_rate, positions): (StrainRate, &[Vector]),
        comm: &Comm,
    ) -> Self {
        let unit = units::motion(&self.unit, units);
        let passed = Screws::new(unit.velocities.len(), &unit.velocities, &unit.angular_velocities);
        let mut loads = near.times(&[Pairs::Stiff, Pairs::Soft], &passed);
        loads.add(1.0, near.ambient_loads());
        let stresslets = near.stresslets(&passed.negative());
        let found = Loads { forces: loads.linear(), torques: loads.angular(), stresslets };
        self.resisted = units::times(&found, units.torque());
        let mut moved = Loads { stresslets: Vec::new(), ..self.resisted.clone() };
        let wanted = match mobility.plan().multipoles {
            Multipoles::Dipole => Evaluation::All,
            Multipoles::Monopole => {
                moved.torques.clear();
                Evaluation::Velocities
            }
        };
        let by_loads = mobility.apply(&moved, wanted);
        let strained: f64 =
            self.resisted.stresslets.iter().zip(positions).map(|(&s, place)| s.contract(strain_rate.at(place.z))).sum();
        // Lubrication at walls is relative to flows that rest there.
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

    /// What is added to the motions by loads.
    pub fn constraint(&self) -> Constraint {
        self.constraint.clone()
    }

    /// How the fluid moves at the particles besides, with what the ambient flow makes of the pressure gradient.
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

    /// Adds the loads of lubrication in the flow of the pressure gradient to a solution, and says its curvature. Collective.
    pub fn complete(&self, solved: &mut Solved, comm: &Comm) {
        let curvature = self.ambient + self.constraint.amplitude(&solved.far, comm);
        let Loads { forces, torques, .. } = &mut solved.far;
        let own = forces.iter_mut().chain(torques).zip(self.resisted.forces.iter().chain(&self.resisted.torques));
        own.for_each(|(load, &more)| *load += more * curvature);
        solved.stresslets.iter_mut().zip(&self.resisted.stresslets).for_each(|(s, &more)| *s += more * curvature);
        solved.curvature = curvature;
    }
}
