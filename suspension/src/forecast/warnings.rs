//! Warnings of `check` and `run` before a run.

use crate::forces::Forces;
use crate::forecast::stable_step;
use crate::forecast::step_lengths;
use crate::integrators::adams_bashforth::AdamsBashforth;
use crate::model::radii::Radii;
use crate::model::{Bonds, Flow, Integrator, Model};
use crate::start::plan::problem;
use domain::{Boundaries, Number, sphere};
use fcm::Plan;
use std::f64::consts::PI;

/// All warnings of a scene, one sentence each.
pub fn cautions(model: &Model, radii: &Radii) -> Vec<String> {
    let first = [straight_box(model), stable_step::caution(model, radii)];
    let of_forces = Forces::of(model).map(|forces| forces.warnings(model, radii)).unwrap_or_default();
    let others = [
        far_diffusion(model, radii),
        quick_tethers(model, radii),
        infeasible(model, radii),
        model.statistics.and_then(|wanted| wanted.caution(model.time_step, model.steps)),
    ];
    let all = first.into_iter().flatten().chain(of_forces).chain(others.into_iter().flatten());
    all.chain(step_lengths::cautions(model, radii)).collect()
}

/// A warning if the plan of the scene is infeasible.
fn infeasible(model: &Model, radii: &Radii) -> Option<String> {
    let problem = problem(model, radii);
    Plan::choose(&problem).ok()?.infeasible(&problem)
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

/// Number of substeps of an adaptive step by which tethers make it slow.
const MOST_SUBSTEPS: f64 = 20.0;

/// Warns of explicit steps that are too long for the relaxation of bonds and traps, and of adaptive ones that these
/// divide into many.
fn quick_tethers(model: &Model, radii: &Radii) -> Option<String> {
    let rate = tether_rate(model, radii);
    let (step, time) = (Number(model.time_step), Number(1.0 / rate));
    let (limit, remedy) = match model.integrator {
        Integrator::AdamsBashforth { order } => {
            (AdamsBashforth::of_order(order).stable(), ", or time.integrator = \"implicit\"")
        }
        Integrator::Brownian(_) => (LONGEST_TETHERED, ""),
        Integrator::Adaptive(_) => {
            let substeps = rate * model.time_step / AdamsBashforth::of_order(3).stable();
            return (substeps > MOST_SUBSTEPS).then(|| {
                format!(
                    "[[bonds]] and [[traps]] as stiff as these relax within {time:.3}, which divides each step of \
                     time.step = {step} into {:.0} substeps or more; take time.integrator = \"implicit\"",
                    substeps.ceil()
                )
            });
        }
        Integrator::Implicit(_) => return None,
    };
    (rate * model.time_step > limit * 1.001).then(|| {
        format!(
            "time.step = {step} is long for [[bonds]] and [[traps]] as stiff as these, which relax within {time:.3}; \
             take {:.3} or less{remedy}",
            Number(limit / rate)
        )
    })
}

/// Fastest rate at which bonds and traps relax; 0 without.
fn tether_rate(model: &Model, radii: &Radii) -> f64 {
    let most = |list: &mut dyn Iterator<Item = f64>| list.fold(0.0, f64::max);
    let [bond, trap] = [
        most(&mut model.bonds.iter().map(|bonds| bonds.stiffness)),
        most(&mut model.traps.iter().map(|traps| traps.stiffness)),
    ];
    // Both ends of each bond move: twice the rate of one sphere.
    let ends = 2.0 * model.most_bonds() as f64;
    let rate = (trap + ends * bond) / sphere::drag(model.viscosity, radii.smallest());
    rate.max(bending_rate(model, radii))
}

/// Warns of shear in a straight box, where the flow `u = rate y` jumps by `rate Ly` across the faces along y. The
/// observed stress is then that of spheres next to images that do not move with the flow. With walls and in unbounded
/// fluid there are no such faces.
fn straight_box(model: &Model) -> Option<String> {
    let Flow::Shear { rate, lees_edwards: false } = model.flow else { return None };
    let message = "flow.lees_edwards = false: the box stays rectangular, so that spheres near its faces along y meet \
        images that do not move with the flow; relative_viscosity and stresses in the time series are not those of a \
        sheared suspension. Leave the key out unless this is what you want";
    (rate != 0.0 && model.cell.boundaries() == Boundaries::Periodic).then(|| message.to_owned())
}

/// Fastest rate at which bonds that resist bending relax: that of the shear of a beam between isolated spheres, or of
/// its twist, times the number of bonds of a sphere. 0 without such bonds.
fn bending_rate(model: &Model, radii: &Radii) -> f64 {
    let radius = radii.smallest();
    let moving = 1.0 / sphere::drag(model.viscosity, radius);
    let turning = 1.0 / sphere::rotational_drag(model.viscosity, radius);
    let of_one = |bonds: &Bonds| {
        let (Some(beam), length) = (bonds.beam, bonds.length.unwrap_or(2.0 * radius)) else { return 0.0 };
        let bent = 6.0 * beam.bending / length * (4.0 * moving / (length * length) + turning);
        bent.max(2.0 * beam.twisting / length * turning)
    };
    model.most_bonds() as f64 * model.bonds.iter().map(of_one).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Parameters, Species};
    use domain::{PeriodicBox, Vector};

    fn cautions_of(flow: Flow, boundaries: Boundaries) -> Vec<String> {
        let cell = PeriodicBox::new(Vector::splat(9.0)).unwrap().with_boundaries(boundaries).unwrap();
        let usual = Parameters::new(cell, 1.0, vec![Species::new("one", 1.0, 1)], 0.1, 1);
        let model = Model::new(Parameters { flow, ..usual }).unwrap();
        cautions(&model, &Radii::of_model(&model).unwrap())
    }

    /// A bond of two spheres relaxes at the rate `2 k / (6 pi mu a)`, at which order 4 is stable up to 0.3 per step;
    /// a beam of touching ones at the rates `3 EI (1/6 pi + 1/8 pi) / mu a^4` in shear and `GJ / 8 pi mu a^4` in twist.
    #[test]
    fn steps_too_long_for_bonds_are_warned_of() {
        use crate::model::{Beam, Orientation, RestShape};
        let cell = PeriodicBox::new(Vector::splat(9.0)).unwrap();
        let spring =
            Bonds { pairs: vec![[0, 1]], length: Some(2.0), stiffness: 3.0 * PI, breaking_force: None, beam: None };
        let beam = |bending: f64, twisting: f64| Bonds {
            stiffness: 0.1,
            beam: Some(Beam { bending, twisting, rest: RestShape::Start }),
            ..spring.clone()
        };
        for bonds in [spring.clone(), beam(8.0 * PI / 7.0, 0.0), beam(0.1, 8.0 * PI)] {
            for (step, warned) in [(0.29, false), (0.31, true)] {
                let spheres = Species { orientation: Some(Orientation::Random), ..Species::new("one", 1.0, 2) };
                let usual = Parameters::new(cell, 1.0, vec![spheres], step, 1);
                let model = Model::new(Parameters { bonds: vec![bonds.clone()], ..usual }).unwrap();
                let said = cautions(&model, &Radii::of_model(&model).unwrap());
                let is_warned = said.iter().any(|s| s.contains("relax within 1; take 0.3 or less, or"));
                assert_eq!(is_warned, warned, "{said:?}");
            }
        }
    }

    /// A trap relaxes at the rate `k / (6 pi mu a)`, and adaptive steps are stable up to 6/11 of its inverse.
    #[test]
    fn adaptive_steps_that_stiff_traps_divide_are_warned_of() {
        use crate::model::{Adaptive, Centres, Trapped, Traps};
        let cell = PeriodicBox::new(Vector::splat(9.0)).unwrap();
        for (substeps, warned) in [(19.0, false), (20.5, true)] {
            let stiffness = 6.0 * PI * substeps * 6.0 / 11.0;
            let traps = vec![Traps { of: Trapped::All, centres: Centres::AtStart, stiffness }];
            let usual = Parameters::new(cell, 1.0, vec![Species::new("one", 1.0, 1)], 1.0, 1);
            let integrator = Integrator::Adaptive(Adaptive::default());
            let model = Model::new(Parameters { traps, integrator, ..usual }).unwrap();
            let said = cautions(&model, &Radii::of_model(&model).unwrap());
            assert_eq!(said.iter().any(|s| s.contains("into 21 substeps or more; take")), warned, "{said:?}");
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
