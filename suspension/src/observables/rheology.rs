//! Stress of a sheared or stretched suspension in the time series.

use super::observable::{Observable, ObservedState, measure};
use crate::evaluation::stress::ParticleStress;
use crate::forces::force::StressName;
use crate::model::box_axes::UserAxes;
use crate::model::{BrownianScheme, Flow, Integrator, Model, MultipoleOrder};
use domain::{Boundaries, Tensor};
use simulation::Quantity;

/// Stress in the time series, in a shear flow `u = rate y e_x`, or `u = rate z e_x` between walls, or in an extension.
#[derive(Clone)]
pub struct Rheology {
    species: Vec<String>,
    viscosity: f64,
    flow: Flow,
    /// Whether the rate of the flow changes.
    changes: bool,
    /// Gradient axis.
    gradient: usize,
    axes: UserAxes,
}

/// Total particle stress, with the rate and the strain of the flow.
struct StressedFlow {
    stress: Tensor,
    rate: f64,
    strain: f64,
}

/// Name and unit of a quantity that follows from the total stress, and its number.
type Derived = (&'static str, &'static str, fn(&Rheology, &StressedFlow) -> f64);

const UNIT: &str = "force/length^2";

/// Components of a stress, as names, columns and rows: `ab` is the force along `a` across faces normal to `b`. A
/// symmetric tensor has the first six.
const COMPONENTS: [(&str, usize, usize); 9] = [
    ("xx", 0, 0),
    ("xy", 1, 0),
    ("xz", 2, 0),
    ("yy", 1, 1),
    ("yz", 2, 1),
    ("zz", 2, 2),
    ("yx", 0, 1),
    ("zx", 0, 2),
    ("zy", 1, 2),
];

/// Number of independent components of a symmetric tensor.
const OF_SYMMETRIC: usize = 6;

impl Rheology {
    /// The quantities for a model; `None` without a flow, or in unbounded fluid, which has no volume to average over.
    pub fn of(model: &Model) -> Option<Self> {
        let rates = model.shear_rates();
        if rates.largest() == 0.0 || model.cell.boundaries() == Boundaries::Open {
            return None;
        }
        Some(Self {
            species: model.species.iter().map(|s| s.name.clone()).collect(),
            viscosity: model.viscosity,
            flow: model.flow,
            changes: !rates.is_constant(),
            gradient: model.cell.gradient_axis(),
            axes: model.user_axes(),
        })
    }

    /// A contribution to the stress, for each species.
    pub fn part(&self, part: StressName) -> Box<dyn Observable> {
        let components = components_of(part);
        let columns = components.iter().map(|&(name, ..)| name.to_owned()).collect();
        let (name, table) = (format!("stress_{}", part.name).into(), Some((self.species.clone(), columns)));
        let axes = self.axes;
        measure(Quantity { name, unit: UNIT, table }, move |present| {
            let of_species = |stress: &ParticleStress| {
                let tensor = axes.tensor(&stress.of(part.name));
                components.iter().map(move |&(_, column, row)| tensor.col(column)[row])
            };
            present.stress().iter().flat_map(of_species).collect()
        })
    }

    /// Quantities derived from the sum of all contributions: with `s` this sum,
    ///
    /// ```text
    /// shear stress = mu rate + s_xy,  relative viscosity = 1 + s_xy / (mu rate),
    /// N1 = s_xx - s_yy,  N2 = s_yy - s_zz,  particle pressure = -tr(s) / 3
    /// ```
    ///
    /// Between walls, where the gradient is along z, y and z are exchanged. In an extension, [`Flow::driving_stress`]
    /// takes the place of `s_xy`. The rate, the strain and the stress along the flow are written for shear flows whose
    /// rate changes and for extensions.
    pub fn derived(&self) -> impl Iterator<Item = Box<dyn Observable>> {
        let along_flow: &[Derived] = match self.flow {
            Flow::Extension { .. } => &[
                ("extension_rate", "1/time", |_, flow| flow.rate),
                ("strain", "", |_, flow| flow.strain),
                ("extensional_stress", UNIT, Self::stress_along_flow),
            ],
            _ if self.changes => &[
                ("shear_rate", "1/time", |_, flow| flow.rate),
                ("strain", "", |_, flow| flow.strain),
                ("shear_stress", UNIT, Self::stress_along_flow),
            ],
            _ => &[],
        };
        let always: &[Derived] = &[
            ("relative_viscosity", "", Self::relative_viscosity),
            ("first_normal_stress_difference", UNIT, |rheology, flow| {
                let [along, across, _] = rheology.normal_stresses(&flow.stress);
                along - across
            }),
            ("second_normal_stress_difference", UNIT, |rheology, flow| {
                let [_, gradient, vorticity] = rheology.normal_stresses(&flow.stress);
                gradient - vorticity
            }),
            ("particle_pressure", UNIT, |_, flow| ParticleStress::pressure(&flow.stress)),
        ];
        let rheology = self.clone();
        along_flow.iter().chain(always).map(move |&(name, unit, number)| {
            let rheology = rheology.clone();
            measure(Quantity::number(name, unit), move |present| vec![number(&rheology, &StressedFlow::of(present))])
        })
    }

    /// Stress of the whole suspension along the flow at the present rate. Collective.
    pub fn driving_stress(&self, present: &mut ObservedState) -> f64 {
        self.stress_along_flow(&StressedFlow::of(present))
    }

    fn stress_along_flow(&self, flow: &StressedFlow) -> f64 {
        self.viscosity * flow.rate + self.flow.driving_stress(&flow.stress, self.gradient)
    }

    fn relative_viscosity(&self, flow: &StressedFlow) -> f64 {
        let (fluid, driving) = (self.viscosity * flow.rate, self.flow.driving_stress(&flow.stress, self.gradient));
        if flow.rate == 0.0 { f64::NAN } else { 1.0 + driving / fluid }
    }

    /// Normal stresses along the flow, its gradient and its vorticity.
    fn normal_stresses(&self, stress: &Tensor) -> [f64; 3] {
        let [xx, yy, zz] = [0, 1, 2].map(|axis| stress.col(axis)[axis]);
        if self.gradient == 2 { [xx, zz, yy] } else { [xx, yy, zz] }
    }
}

impl StressedFlow {
    fn of(present: &mut ObservedState) -> Self {
        let (stress, [rate, strain]) = (present.total_stress(), present.suspension().shear());
        Self { stress, rate, strain }
    }
}

/// Contributions to the stress of a model: those of the fluid, the model's forces, random motions and the user's
/// forces.
pub fn parts(model: &Model, [of_model, of_user]: &[Vec<StressName>; 2]) -> Vec<StressName> {
    let is_rigid = model.hydrodynamics.multipoles == MultipoleOrder::Dipole;
    let is_brownian = is_rigid && model.integrator == Integrator::Brownian(BrownianScheme::TwoEvaluations);
    let of_fluid = |is_present: bool, name| is_present.then_some(StressName::symmetric(name));
    let first = [
        of_fluid(is_rigid, ParticleStress::STRESSLET),
        of_fluid(model.hydrodynamics.lubrication, ParticleStress::LUBRICATION),
        of_fluid(model.has_slip(), ParticleStress::ACTIVE),
        of_fluid(!model.bodies.is_empty(), ParticleStress::CONSTRAINT),
    ];
    let brownian = of_fluid(is_brownian, ParticleStress::BROWNIAN);
    let of_forces = of_model.iter().copied().chain(brownian).chain(of_user.iter().copied());
    first.into_iter().flatten().chain(of_forces).collect()
}

/// Components of a contribution to the stress.
fn components_of(part: StressName) -> &'static [(&'static str, usize, usize)] {
    if part.is_symmetric { &COMPONENTS[..OF_SYMMETRIC] } else { &COMPONENTS }
}
