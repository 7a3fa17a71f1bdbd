//! Warnings of steps that are too long for contacts.

use crate::model::Model;
use crate::model::radii::Radii;
use domain::Number;

/// All warnings of this kind, one sentence each.
pub fn warnings(model: &Model, radii: &Radii) -> Vec<String> {
    [long_steps(model), stiff_contacts(model, radii)].into_iter().flatten().collect()
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
            "contacts.stiffness = {} is {:.2} times what keeps overlaps at contacts.target_overlap here, and steps \
             have to be as much shorter: viscosities may come out tens of percent too high with time.step = {}; take \
             {:.3} or less, or a smaller stiffness",
            Number(stiffness),
            Number(excess),
            Number(model.time_step),
            Number(limit)
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Flow, Parameters, Species};
    use domain::{PeriodicBox, Vector};

    #[test]
    fn steps_too_long_for_contacts_are_warned_of() {
        use crate::model::{Adaptive, Contacts, Hydrodynamics, Integrator};
        let cell = PeriodicBox::new(Vector::splat(9.0)).unwrap();
        for (step, warned) in [(0.005, false), (0.006, true)] {
            let usual = Parameters::new(cell, 1.0, vec![Species::new("one", 1.0, 1)], step, 1);
            let model = Model::new(Parameters {
                flow: Flow::Shear { rate: -2.0, lees_edwards: true },
                contacts: Some(Contacts::new(0.5)),
                hydrodynamics: Hydrodynamics { lubrication: true, ..Hydrodynamics::default() },
                integrator: Integrator::Implicit(Adaptive::UNLIMITED),
                ..usual
            });
            let model = model.unwrap();
            let said = warnings(&model, &Radii::of_model(&model).unwrap());
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
            let usual = Parameters::new(cell, 1.0, vec![Species::new("one", 1.0, count)], step, 1);
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
            warnings(&model, &Radii::of_model(&model).unwrap())
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
}
