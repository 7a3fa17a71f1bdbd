//! Warnings of `check` and `run` before a run.

use crate::columns::BOND_NUMBERS;
use crate::forecast::stable_step;
use crate::forecast::step_lengths;
use crate::integrators::adams_bashforth::AdamsBashforth;
use crate::model::radii::Radii;
use crate::model::{Flow, Integrator, Model};
use crate::start::plan::problem;
use domain::{Boundaries, Number, sphere};
use fcm::Plan;
use std::f64::consts::PI;

/// All warnings of a scene, one sentence each.
pub fn cautions(model: &Model, radii: &Radii) -> Vec<String> {
    let all = [
        straight_box(model),
        stable_step::caution(model, radii),
        long_steps(model),
        stiff_contacts(model, radii),
        far_diffusion(model, radii),
        quick_tethers(model, radii),
        infeasible(model, radii),
        model.statistics.and_then(|wanted| wanted.caution(model.time_step, model.steps)),
    ];
    all.into_iter().flatten().chain(step_lengths::cautions(model, radii)).collect()
}

/// A warning if the plan of the scene is infeasible.
fn infeasible(model: &Model, radii: &Radii) -> Option<String> {
    let problem = problem(model, radii);
    Plan::choose(&problem).ok()?.infeasible(&problem)
}

/// Strain per step up to which the viscosity of spheres in contact changes by less than a tenth.
const LONGEST_STRAIN: f64 = 0.01;

/// Stiffness, over the estimate, up to which contacts need no shorter steps.
const STIFF: f64 = 1.5;

/// Volume fraction above which contacts bear much of the stress.
const DENSE: f64 = 0.3;

/// Warns of long steps with contacts, which stick or slide for a whole step.
fn long_steps(model: &Model) -> Option<String> {
    let rate = model.flow.as_shear(model.shear_rates().largest());
    let strain = rate * model.time_step;
    let (step, limit) = (Number(model.time_step), Number(LONGEST_STRAIN / rate));
    let is_given = model.shear_rates().stress().is_none();
    (is_given && model.contacts.is_some() && strain > LONGEST_STRAIN * 1.001).then(|| {
        format!(
            "time.step = {step} is a strain of {:.3}, and contacts stick or slide for a whole step; take {limit:.3} \
             or less",
            Number(strain)
        )
    })
}

/// Warns of long steps with stiff contacts in dense suspensions: the longest accurate step is inversely proportional to
/// the stiffness.
fn stiff_contacts(model: &Model, radii: &Radii) -> Option<String> {
    let (contacts, rates) = (model.contacts?, model.shear_rates());
    let (stiffness, rate) = (contacts.stiffness?, model.flow.as_shear(rates.largest()));
    let excess = stiffness / contacts.sufficient_stiffness(model);
    let limit = LONGEST_STRAIN / rate / excess;
    let is_dense = radii.volume() / model.cell.volume() > DENSE;
    (rates.stress().is_none() && is_dense && excess > STIFF && model.time_step > limit * 1.001).then(|| {
        format!(
            "contacts.stiffness = {} is {:.2} times what keeps overlaps at contacts.overlap here, and steps have to \
             be as much shorter: viscosities may come out tens of percent too high with time.step = {}; take {:.3} or \
             less, or a smaller stiffness",
            Number(stiffness),
            Number(excess),
            Number(model.time_step),
            Number(limit)
        )
    })
}

/// Longest Brownian step, in units of the time in which the smallest sphere diffuses over its radius. Errors are
/// proportional to the step; at this step the equilibrium distribution is off by a few per cent, for a repulsion with a
/// range of tenths of a radius.
const LONGEST_DIFFUSION: f64 = 0.0025;

/// The step in units of the time `a^2 / D_0` in which the smallest sphere diffuses over its radius; `None` without
/// Brownian motion.
pub fn diffusive_step(model: &Model, radii: &Radii) -> Option<f64> {
    let energy = model.thermal_energy?;
    Some(model.time_step * energy / (6.0 * PI * model.viscosity * radii.smallest().powi(3)))
}

/// Warns of Brownian steps that are too long.
fn far_diffusion(model: &Model, radii: &Radii) -> Option<String> {
    let step = diffusive_step(model, radii).filter(|step| *step > LONGEST_DIFFUSION * 1.001)?;
    let (longest, limit) = (Number(model.time_step * LONGEST_DIFFUSION / step), Number(LONGEST_DIFFUSION));
    let (now, step) = (Number(model.time_step), Number(step));
    Some(format!(
        "time.step = {now} is {step:.3} of the time in which the smallest sphere diffuses over its radius; places at \
         equilibrium are off in proportion to it, by many hundredths: take {longest:.3} or less, which is {limit} of it"
    ))
}

/// Brownian step over the relaxation time of a trap up to which the variance of trapped spheres is accurate to a tenth.
const LONGEST_TETHERED: f64 = 0.2;

/// Warns of explicit steps that are too long for the relaxation of bonds and traps.
fn quick_tethers(model: &Model, radii: &Radii) -> Option<String> {
    let (limit, remedy) = match model.integrator {
        Integrator::AdamsBashforth { order } => {
            (AdamsBashforth::of_order(order).stable(), ", or time.integrator = \"implicit\"")
        }
        Integrator::Brownian(_) => (LONGEST_TETHERED, ""),
        Integrator::Adaptive(_) | Integrator::Implicit(_) => return None,
    };
    let most = |list: &mut dyn Iterator<Item = f64>| list.fold(0.0, f64::max);
    let [bond, trap] = [
        most(&mut model.bonds.iter().map(|bonds| bonds.stiffness)),
        most(&mut model.traps.iter().map(|traps| traps.stiffness)),
    ];
    // Both ends of each bond move: twice the rate of one sphere.
    let ends = 2.0 * (model.bond_numbers() / BOND_NUMBERS) as f64;
    let rate = (trap + ends * bond) / sphere::drag(model.viscosity, radii.smallest());
    (rate * model.time_step > limit * 1.001).then(|| {
        format!(
            "time.step = {} is long for [[bonds]] and [[traps]] as stiff as these, which relax within {:.3}; take \
             {:.3} or less{remedy}",
            Number(model.time_step),
            Number(1.0 / rate),
            Number(limit / rate)
        )
    })
}

/// Warns of shear in a straight box, where the flow `u = rate y` jumps by `rate Ly` across the faces along y. The
/// observed stress is then that of spheres next to images that do not move with the flow. With walls and in open fluid
/// there are no such faces.
fn straight_box(model: &Model) -> Option<String> {
    let Flow::Shear { rate, lees_edwards: false } = model.flow else { return None };
    let message = "flow.lees_edwards = false: the box stays straight, so that spheres near its faces along y meet \
        images that do not move with the flow; relative_viscosity and stresses in the time series are not those of a \
        sheared suspension. Leave the key out unless this is what you want";
    (rate != 0.0 && model.cell.boundaries() == Boundaries::Periodic).then(|| message.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Parameters, Species};
    use domain::{PeriodicBox, Vector};

    fn cautions_of(flow: Flow, boundaries: Boundaries) -> Vec<String> {
        let cell = PeriodicBox::new(Vector::splat(9.0)).unwrap().with_boundaries(boundaries).unwrap();
        let usual = Parameters::new(cell, 1.0, vec![Species::new("one", 1.0, 1)], (0.1, 1));
        let model = Model::new(Parameters { flow, ..usual }).unwrap();
        cautions(&model, &Radii::of_model(&model).unwrap())
    }

    #[test]
    fn steps_too_long_for_contacts_are_warned_of() {
        use crate::model::{Adaptive, Contacts, Hydrodynamics, Integrator};
        let cell = PeriodicBox::new(Vector::splat(9.0)).unwrap();
        for (step, warned) in [(0.005, false), (0.006, true)] {
            let usual = Parameters::new(cell, 1.0, vec![Species::new("one", 1.0, 1)], (step, 1));
            let model = Model::new(Parameters {
                flow: Flow::Shear { rate: -2.0, lees_edwards: true },
                contacts: Some(Contacts::new(0.5)),
                hydrodynamics: Hydrodynamics { lubrication: true, ..Hydrodynamics::default() },
                integrator: Integrator::Implicit(Adaptive::UNLIMITED),
                ..usual
            });
            let model = model.unwrap();
            let said = cautions(&model, &Radii::of_model(&model).unwrap());
            assert_eq!(said.iter().any(|s| s.contains("take 0.005 or less")), warned, "{said:?}");
        }
    }

    /// At the estimated stiffness steps may be as long as contacts allow; at four times the stiffness, a quarter of
    /// that.
    #[test]
    fn steps_too_long_for_stiff_contacts_are_warned_of() {
        use crate::model::{Adaptive, Contacts, Hydrodynamics, Integrator};
        let cell = PeriodicBox::new(Vector::splat(9.0)).unwrap();
        let said = |count, times: Option<f64>, step| {
            let usual = Parameters::new(cell, 1.0, vec![Species::new("one", 1.0, count)], (step, 1));
            let sheared = Parameters {
                flow: Flow::Shear { rate: 2.0, lees_edwards: true },
                hydrodynamics: Hydrodynamics { lubrication: true, ..Hydrodynamics::default() },
                integrator: Integrator::Implicit(Adaptive::UNLIMITED),
                ..usual
            };
            let contacts = Contacts::new(0.5);
            let stiffness = times.map(|times| times * contacts.sufficient_stiffness(&sheared));
            let model =
                Model::new(Parameters { contacts: Some(Contacts { stiffness, ..contacts }), ..sheared }).unwrap();
            cautions(&model, &Radii::of_model(&model).unwrap())
        };
        for (count, times, step) in
            [(60, None, 0.005), (60, Some(1.0), 0.005), (60, Some(4.0), 0.00125), (9, Some(4.0), 0.005)]
        {
            assert_eq!(
                said(count, times, step),
                Vec::<String>::new(),
                "{count}, {times:?} times as stiff, steps of {step}"
            );
        }
        let warned = said(60, Some(4.0), 0.0025);
        assert!(
            warned[0].contains("is 4 times what keeps overlaps") && warned[0].contains("take 0.00125 or less"),
            "{warned:?}"
        );
    }

    /// A bond of two spheres relaxes at the rate `2 k / (6 pi mu a)`, at which order 4 is stable up to 0.3 per step.
    #[test]
    fn steps_too_long_for_bonds_are_warned_of() {
        use crate::model::Bonds;
        let cell = PeriodicBox::new(Vector::splat(9.0)).unwrap();
        let bonds = vec![Bonds { pairs: vec![[0, 1]], length: Some(2.0), stiffness: 3.0 * PI, breaking_force: None }];
        for (step, warned) in [(0.29, false), (0.31, true)] {
            let usual = Parameters::new(cell, 1.0, vec![Species::new("one", 1.0, 2)], (step, 1));
            let model = Model::new(Parameters { bonds: bonds.clone(), ..usual }).unwrap();
            let said = cautions(&model, &Radii::of_model(&model).unwrap());
            assert_eq!(said.iter().any(|s| s.contains("relax within 1; take 0.3 or less, or")), warned, "{said:?}");
        }
    }

    #[test]
    fn a_sheared_suspension_in_a_straight_box_is_warned_of() {
        let straight = |rate| Flow::Shear { rate, lees_edwards: false };
        assert!(cautions_of(straight(0.5), Boundaries::Periodic)[0].contains("relative_viscosity"));
        for flow in [Flow::Shear { rate: 0.5, lees_edwards: true }, straight(0.0), Flow::None] {
            assert!(cautions_of(flow, Boundaries::Periodic).is_empty(), "{flow:?}");
        }
        for boundaries in [Boundaries::Walls, Boundaries::Open] {
            assert!(
                cautions_of(straight(0.5), boundaries).is_empty(),
                "{boundaries:?} have no images that stand still"
            );
        }
    }
}
