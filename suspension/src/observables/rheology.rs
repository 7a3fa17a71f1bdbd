//! Stress of a sheared or stretched suspension in the time series.

use crate::evaluation::stress::ParticleStress;
use crate::model::box_axes::UserAxes;
use crate::model::{BrownianScheme, Flow, Integrator, Model, Multipoles};
use domain::{Boundaries, Tensor};
use simulation::Quantity;

/// Stress in the time series, in a shear flow `u = rate y e_x`, or `u = rate z e_x` between walls, or in an extension.
pub struct Rheology {
    species: Vec<String>,
    viscosity: f64,
    flow: Flow,
    /// Whether the rate of the flow changes.
    changes: bool,
    /// Gradient axis.
    gradient: usize,
    origins: Vec<Origin>,
    axes: UserAxes,
}

/// Name of a contribution to the stress, and its tensor.
type Origin = (&'static str, fn(&ParticleStress) -> Tensor);

/// The stress of the user's forces.
const APPLIED: &str = "stress_applied";

const COMPONENTS: [&str; 6] = ["xx", "xy", "xz", "yy", "yz", "zz"];

impl Rheology {
    /// The quantities for a model; `None` without a flow, or in open fluid, which has no volume over which to average.
    pub fn of(model: &Model) -> Option<Self> {
        let rates = model.shear_rates();
        if rates.largest() == 0.0 || model.cell.boundaries() == Boundaries::Open {
            return None;
        }
        let is_rigid = model.hydrodynamics.multipoles == Multipoles::Dipole;
        let has_heat = is_rigid && model.integrator == Integrator::Brownian(BrownianScheme::TwoEvaluations);
        let all: [(bool, Origin); 7] = [
            (is_rigid, ("stress_stresslet", |s| s.stresslet)),
            (model.hydrodynamics.lubrication, ("stress_lubrication", |s| s.lubrication)),
            (model.repulsion.is_some(), ("stress_repulsion", |s| s.repulsion)),
            (model.attraction.is_some(), ("stress_attraction", |s| s.attraction)),
            (model.contacts.is_some(), ("stress_contact", |s| s.contact)),
            (!model.bonds.is_empty(), ("stress_bond", |s| s.bond)),
            (has_heat, ("stress_brownian", |s| s.brownian)),
        ];
        let species = model.species.iter().map(|s| s.name.clone()).collect();
        let origins = all.into_iter().filter(|(present, _)| *present).map(|(_, origin)| origin).collect();
        Some(Self {
            species,
            viscosity: model.viscosity,
            flow: model.flow,
            changes: !rates.is_constant(),
            gradient: model.cell.gradient_axis(),
            origins,
            axes: model.user_axes(),
        })
    }

    /// Includes the stress of the user's forces.
    pub fn tell_of_applied(&mut self) {
        if !self.origins.iter().any(|(name, _)| *name == APPLIED) {
            self.origins.push((APPLIED, |s| s.applied));
        }
    }

    /// Stress by contribution and species, and the quantities derived from it: with `s` the sum of all contributions,
    ///
    /// ```text
    /// shear stress = mu rate + s_xy,  relative viscosity = 1 + s_xy / (mu rate),
    /// N1 = s_xx - s_yy,  N2 = s_yy - s_zz,  particle pressure = -tr(s) / 3
    /// ```
    ///
    /// Between walls, where the gradient is along z, y and z are exchanged. In an extension, [`Flow::driving_stress`]
    /// takes the place of `s_xy`.
    pub fn quantities(&self) -> Vec<Quantity> {
        let unit = "force/length^2";
        let table = |&(name, _): &Origin| {
            let columns = COMPONENTS.map(String::from).to_vec();
            Quantity { name, unit, table: Some((self.species.clone(), columns)) }
        };
        let mut quantities: Vec<Quantity> = self.origins.iter().map(table).collect();
        if let Some(names) = self.names() {
            let all = names.into_iter().zip(["1/time", "", unit]);
            quantities.extend(all.map(|(name, unit)| Quantity::number(name, unit)));
        }
        quantities.push(Quantity::number("relative_viscosity", ""));
        for name in ["first_normal_stress_difference", "second_normal_stress_difference", "particle_pressure"] {
            quantities.push(Quantity::number(name, unit));
        }
        quantities
    }

    /// Names of the rate, the strain and the stress along the flow. These are written for shear flows whose rate
    /// changes and for extensions.
    fn names(&self) -> Option<[&'static str; 3]> {
        match self.flow {
            Flow::Extension { .. } => Some(["extension_rate", "strain", "extensional_stress"]),
            _ => self.changes.then_some(["shear_rate", "strain", "shear_stress"]),
        }
    }

    /// Stress of the whole suspension along the flow at a rate.
    pub fn driving_stress(&self, stress: &[ParticleStress], rate: f64) -> f64 {
        self.viscosity * rate + self.flow.driving_stress(&ParticleStress::sum(stress), self.gradient)
    }

    /// A row of the quantities at a rate and a strain of the flow.
    pub fn row(&self, stress: &[ParticleStress], [rate, strain]: [f64; 2]) -> Vec<Vec<f64>> {
        let of_all =
            |&(_, part): &Origin| stress.iter().flat_map(|s| components(&self.axes.tensor(&part(s)))).collect();
        let mut row: Vec<Vec<f64>> = self.origins.iter().map(of_all).collect();
        let total = ParticleStress::sum(stress);
        let [xx, _, _, yy, _, zz] = components(&total);
        let [yy, zz] = if self.gradient == 2 { [zz, yy] } else { [yy, zz] };
        let (fluid, driving) = (self.viscosity * rate, self.flow.driving_stress(&total, self.gradient));
        if self.names().is_some() {
            row.extend([rate, strain, self.driving_stress(stress, rate)].map(|number| vec![number]));
        }
        let viscosity = if rate == 0.0 { f64::NAN } else { 1.0 + driving / fluid };
        row.extend([viscosity, xx - yy, yy - zz, ParticleStress::pressure(&total)].map(|number| vec![number]));
        row
    }
}

fn components(tensor: &Tensor) -> [f64; 6] {
    [(0, 0), (1, 0), (2, 0), (1, 1), (2, 1), (2, 2)].map(|(i, j)| tensor.col(i)[j])
}
