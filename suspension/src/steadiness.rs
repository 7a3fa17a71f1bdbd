//! How long fixed steps may be where repulsion holds spheres apart.

use crate::forces::SurfaceForces;
use crate::integrator::AdamsBashforth;
use crate::model::{Integrator, Model, Multipoles};
use crate::plan::Radii;
use domain::Number;
use lubrication::{Detail, opening_mobility};

/// Gaps within the range of repulsion at which a pair is looked at.
const GAPS: u32 = 16;

/// What to say of a time step that is too long for the repulsion of the scene, if it is.
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

/// The longest fixed step with which pairs are steady that repulsion holds apart; none if there is no such limit, or
/// somebody brings the spheres.
pub fn longest_step(model: &Model) -> Option<f64> {
    longest_for(model, &Radii::of_model(model)?)
}

/// The longest fixed step with which two spheres come to rest that are pushed together and held apart by repulsion: a
/// small change of their gap decays with the rate `-dF/dr m` at the stiffness `-dF/dr` of the repulsion and the mobility
/// `m` of the pair along its line of centres, and the method is stable up to a product of that and the step. The worst
/// gap counts, and the two smallest spheres, which are the stiffest pair. None if steps are divided as need be, or
/// there is no repulsion.
fn longest_for(model: &Model, radii: &Radii) -> Option<f64> {
    let stable = match model.integrator {
        Integrator::AdamsBashforth { order } => AdamsBashforth::of_order(order).stable(),
        Integrator::Brownian(_) => 1.0,
        Integrator::Adaptive(_) | Integrator::Implicit(_) => return None,
    };
    let repulsion = SurfaceForces::of(model).ok()?.repulsion?;
    let pair = radii.smallest_two()?;
    let range = repulsion.reach(pair) - pair[0] - pair[1];
    let rate = |k: u32| {
        let gap = range * (f64::from(k) + 0.5) / f64::from(GAPS);
        let mobility = opening_mobility(pair, gap, detail(model)).ok()?;
        Some(repulsion.stiffness(gap, pair) * mobility / model.viscosity)
    };
    let fastest = (0..GAPS).map(rate).try_fold(0.0, |fastest: f64, rate| Some(fastest.max(rate?)))?;
    (fastest > 0.0).then(|| stable / fastest)
}

fn detail(model: &Model) -> Detail {
    match model.hydrodynamics.multipoles {
        Multipoles::Monopole => Detail::Forces,
        Multipoles::Dipole if model.hydrodynamics.lubrication => Detail::Exact,
        Multipoles::Dipole => Detail::Rigid,
    }
}
