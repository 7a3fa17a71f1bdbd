//! Stability of fixed steps with repulsion.

use crate::forces::surface::repulsion;
use crate::integrators::adams_bashforth::AdamsBashforth;
use crate::model::radii::Radii;
use crate::model::{Integrator, Model, MultipoleOrder};
use domain::Number;
use lubrication::{PairModel, relative_axial_mobility};

/// Number of gaps within the range of the repulsion at which the stability is evaluated.
const GAPS: u32 = 16;

/// A warning if the time step is too long for the repulsion.
pub fn caution(model: &Model, radii: &Radii) -> Option<String> {
    let (step, longest) = (model.time_step, longest_for(model, radii)?);
    let lower = match model.integrator {
        Integrator::Brownian(_) | Integrator::AdamsBashforth { order: 2 } => "",
        _ => " time.order = 2,",
    };
    let is_brownian = matches!(model.integrator, Integrator::Brownian(_));
    let instead = if is_brownian { "" } else { ", or time.integrator = \"implicit\"" };
    (step > longest).then(|| {
        format!(
            "time.step = {} is longer than the {:.2} with which pairs are steady that repulsion holds \
             apart: near spheres may jitter; take a shorter time.step,{lower} a weaker or wider [repulsion]{instead}",
            Number(step),
            Number(longest),
        )
    })
}

/// Longest stable fixed step with repulsion; `None` if there is no such limit, or if the spheres are provided from
/// elsewhere.
pub fn longest_step(model: &Model) -> Option<f64> {
    longest_for(model, &Radii::of_model(model)?)
}

/// Longest fixed step with which two spheres that are pushed together against their repulsion come to rest. A small
/// perturbation of their gap decays at the rate `-dF/dr m`, with the stiffness `-dF/dr` of the repulsion and the
/// mobility `m` of the pair along the line of centres; the method is stable up to a product of that rate and the step.
/// The worst gap counts, and the two smallest spheres, which are the stiffest pair. `None` if steps are adaptive, or
/// without repulsion.
fn longest_for(model: &Model, radii: &Radii) -> Option<f64> {
    let stable = match model.integrator {
        Integrator::AdamsBashforth { order } => AdamsBashforth::of_order(order).stable(),
        Integrator::Brownian(_) => 1.0,
        Integrator::Adaptive(_) | Integrator::Implicit(_) => return None,
    };
    let repulsion = repulsion(model).ok()??;
    let pair = radii.smallest_two()?;
    let range = repulsion.reach(pair) - pair[0] - pair[1];
    let rate = |k: u32| {
        let gap = range * (f64::from(k) + 0.5) / f64::from(GAPS);
        let mobility = relative_axial_mobility(pair, gap, pair_model(model)).ok()?;
        Some(repulsion.stiffness(gap, pair) * mobility / model.viscosity)
    };
    let fastest = (0..GAPS).map(rate).try_fold(0.0, |fastest: f64, rate| Some(fastest.max(rate?)))?;
    (fastest > 0.0).then(|| stable / fastest)
}

fn pair_model(model: &Model) -> PairModel {
    match model.hydrodynamics.multipoles {
        MultipoleOrder::Monopole => PairModel::Forces,
        MultipoleOrder::Dipole if model.hydrodynamics.lubrication => PairModel::Exact,
        MultipoleOrder::Dipole => PairModel::Rigid,
    }
}
