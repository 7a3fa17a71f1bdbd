//! Warnings of steps in which spheres move farther than the range of the forces between them.

use crate::forces::surface;
use crate::forecast::warnings::diffusive_step;
use crate::model::radii::Radii;
use crate::model::{Integrator, Model, Species, Swimming};
use domain::Number;

/// Largest Brownian displacement in a step of an isolated sphere along one axis, over the range of the repulsion.
/// Spheres near each other move less.
const LONGEST_NOISE: f64 = 1.5;

/// Largest relative displacement of neighbours in a step by the flow, over the range of the repulsion.
const LONGEST_SHEAR: f64 = 0.5;

/// All warnings of this kind, one sentence each.
pub fn cautions(model: &Model, radii: &Radii) -> Vec<String> {
    [noise(model, radii), shear(model, radii), forces(model, radii), swimming(model), reorientation(model)]
        .into_iter()
        .flatten()
        .collect()
}

/// Whether steps have a fixed length.
fn is_fixed(model: &Model) -> bool {
    matches!(model.integrator, Integrator::AdamsBashforth { .. } | Integrator::Brownian(_))
}

/// Name of the parameter that determines the range of the repulsion, and this range for the two smallest spheres.
fn reach(model: &Model, radii: &Radii) -> Option<(&'static str, f64)> {
    let pair = radii.smallest_two()?;
    let repulsion = model.repulsion.filter(|repulsion| repulsion.strength > 0.0)?;
    if let Some(length) = repulsion.screening_length {
        return Some(("repulsion.screening_length", length));
    }
    let force = surface::repulsion(model).ok()??;
    Some(("the range of [repulsion]", force.reach(pair) - pair[0] - pair[1]))
}

/// Warns of Brownian motion through the range of the repulsion.
fn noise(model: &Model, radii: &Radii) -> Option<String> {
    let (key, reach) = reach(model, radii)?;
    let moved = (2.0 * diffusive_step(model, radii)?).sqrt() * radii.smallest();
    (moved > LONGEST_NOISE * reach).then(|| {
        let longest = model.time_step * (LONGEST_NOISE * reach / moved).powi(2);
        format!(
            "time.step = {} lets the smallest sphere diffuse by {:.3} in a step, and {key} is {:.3}: spheres jump \
             into each other, and forces may then throw them anywhere; take {longest:.2} or less, or a repulsion that \
             reaches farther",
            Number(model.time_step),
            Number(moved),
            Number(reach),
            longest = Number(longest),
        )
    })
}

/// Warns of a flow that moves spheres through the range of the repulsion in a fixed step.
fn shear(model: &Model, radii: &Radii) -> Option<String> {
    if !is_fixed(model) || model.shear_rates().stress().is_some() {
        return None;
    }
    let ((key, reach), [a, b]) = (reach(model, radii)?, radii.smallest_two()?);
    let moved = model.flow.as_shear(model.shear_rates().largest()) * (a + b) * model.time_step;
    (moved > LONGEST_SHEAR * reach).then(|| {
        let longest = model.time_step * LONGEST_SHEAR * reach / moved;
        format!(
            "time.step = {} lets the flow move neighbours by {:.3} against each other in a step, and {key} is {:.3}: \
             spheres jump into each other, and forces may then throw them anywhere; take {longest:.2} or less, or a \
             repulsion that reaches farther",
            Number(model.time_step),
            Number(moved),
            Number(reach),
            longest = Number(longest),
        )
    })
}

/// Warns of steady forces that move spheres past each other in a fixed step, or through the box in an adaptive one.
fn forces(model: &Model, radii: &Radii) -> Option<String> {
    if radii.count() < 2 {
        return None;
    }
    let fastest = model
        .species
        .iter()
        .max_by(|a, b| model.displacement_per_step(a).total_cmp(&model.displacement_per_step(b)))?;
    let (travel, edges) = (model.displacement_per_step(fastest), model.cell.edges());
    let (least, than, remedy) = if is_fixed(model) {
        (fastest.radius, "its radius", "spheres may jump into and past each other")
    } else {
        (edges.min_element(), "the shortest edge of the box", "steps are divided into very many parts, and take long")
    };
    (travel > least).then(|| {
        format!(
            "time.step = {} lets the steady forces on a sphere of species \"{}\" move it by {:.3} in a step where it \
             is alone, more than {than}, {:.3}: {remedy}; take {:.2} or less",
            Number(model.time_step),
            fastest.name,
            Number(travel),
            Number(least),
            Number(model.time_step * least / travel),
        )
    })
}

/// Largest distance that a swimmer alone may swim in a fixed step, over its radius.
const LONGEST_STROKE: f64 = 0.1;

/// Warns of fixed steps in which swimmers swim too far to turn away from each other.
fn swimming(model: &Model) -> Option<String> {
    let swimming = model.species.iter().filter_map(|species| Some((species, species.swimming.as_ref()?)));
    let travel = |(species, swimming): (&Species, &Swimming)| swimming.speed * model.time_step / species.radius;
    let (species, far) = swimming.map(|one| (one.0, travel(one))).max_by(|a, b| a.1.total_cmp(&b.1))?;
    (is_fixed(model) && far > LONGEST_STROKE * 1.001).then(|| {
        format!(
            "time.step = {} lets a swimmer of species \"{}\" swim {:.3} of its radius in a step: spheres may meet \
             before they turn; take {:.2} or less",
            Number(model.time_step),
            species.name,
            Number(far),
            Number(model.time_step * LONGEST_STROKE / far),
        )
    })
}

/// Largest number of radians, or of reorientations, in a step.
const LONGEST_TURN: f64 = 0.2;

/// Warns of steps in which swimmers turn too far by themselves.
fn reorientation(model: &Model) -> Option<String> {
    let swimming = || model.species.iter().filter_map(|species| Some((species, species.swimming.as_ref()?)));
    let rates = [
        ("rotational_diffusion", swimming().map(|(_, s)| 2.0 * s.rotational_diffusion).fold(0.0, f64::max)),
        ("tumbling_rate", swimming().map(|(_, s)| s.tumbling_rate).fold(0.0, f64::max)),
        ("gyrotactic_time", swimming().filter_map(|(species, _)| species.reorientation_rate()).fold(0.0, f64::max)),
    ];
    let (key, rate) = rates.into_iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    (rate * model.time_step > LONGEST_TURN * 1.001).then(|| {
        format!(
            "time.step = {} is long for species.swimming.{key}, by which directions change within {:.3}; take {:.2} or \
             less",
            Number(model.time_step),
            Number(1.0 / rate),
            Number(LONGEST_TURN / rate),
        )
    })
}

#[cfg(test)]
mod tests {
    use crate::forecast::warnings::cautions;
    use crate::model::radii::Radii;
    use crate::model::{Flow, Integrator, Model, Orientation, Parameters, Repulsion, Species, Swimming};
    use domain::{PeriodicBox, Vector};
    use std::f64::consts::PI;

    fn usual(step: f64) -> Parameters {
        let cell = PeriodicBox::new(Vector::splat(9.0)).unwrap();
        Parameters::new(cell, 1.0, vec![Species::new("one", 1.0, 2)], step, 1)
    }

    fn said(parameters: Parameters) -> Vec<String> {
        let model = Model::new(parameters).unwrap();
        cautions(&model, &Radii::of_model(&model).unwrap())
    }

    fn screened(length: f64) -> Repulsion {
        Repulsion { screening_length: Some(length), ..Repulsion::new(1e-3) }
    }

    /// A sphere of radius 1 diffuses by `sqrt(2 kT dt / (6 pi mu))` along an axis.
    #[test]
    fn noise_beyond_the_repulsion_is_warned_of() {
        for (length, warned) in [(0.021, false), (0.0199, true)] {
            // A displacement of 0.03.
            let thermal_energy = Some(3.0 * PI * 0.0009);
            let integrator = Integrator::Brownian(crate::model::BrownianScheme::default());
            let all = said(Parameters { thermal_energy, integrator, repulsion: Some(screened(length)), ..usual(1.0) });
            let is_said =
                all.iter().any(|s| s.contains("diffuse by 0.03 in a step, and repulsion.screening_length is"));
            assert_eq!(is_said, warned, "{all:?}");
        }
    }

    #[test]
    fn a_flow_beyond_the_repulsion_is_warned_of_in_fixed_steps() {
        let flow = Flow::Shear { rate: -0.5, lees_edwards: true };
        let fixed = Integrator::AdamsBashforth { order: 2 };
        let implicit = Integrator::Implicit(crate::model::Adaptive::default());
        for (integrator, length, warned) in [(fixed, 0.021, false), (fixed, 0.019, true), (implicit, 0.019, false)] {
            let all = said(Parameters { flow, integrator, repulsion: Some(screened(length)), ..usual(0.01) });
            assert_eq!(all.iter().any(|s| s.contains("neighbours by 0.01 against each other")), warned, "{all:?}");
        }
    }

    #[test]
    fn swimmers_that_go_or_turn_far_are_warned_of() {
        let swimming = |swimming: Swimming| {
            let oriented = Species { orientation: Some(Orientation::Random), ..Species::new("one", 1.0, 2) };
            said(Parameters { species: vec![Species { swimming: Some(swimming), ..oriented }], ..usual(0.1) })
        };
        for (speed, warned) in [(0.99, false), (1.1, true)] {
            let all = swimming(Swimming::new(speed));
            assert_eq!(all.iter().any(|s| s.contains("swim 0.11 of its radius")), warned, "{all:?}");
        }
        for (rate, warned) in [(1.9, false), (2.1, true)] {
            let tumbling = swimming(Swimming { tumbling_rate: rate, ..Swimming::new(0.0) });
            assert_eq!(tumbling.iter().any(|s| s.contains("tumbling_rate")), warned, "{tumbling:?}");
            let diffusing = swimming(Swimming { rotational_diffusion: 0.5 * rate, ..Swimming::new(0.0) });
            assert_eq!(diffusing.iter().any(|s| s.contains("rotational_diffusion")), warned, "{diffusing:?}");
        }
    }

    /// A force of `6 pi mu a v` moves a sphere by `v` in a unit of time.
    #[test]
    fn forces_beyond_a_radius_are_warned_of_and_beyond_the_box_refused() {
        let pulled = |travel: f64| {
            let force = Vector::X * (6.0 * PI * travel / 0.1);
            Parameters { species: vec![Species { force, ..Species::new("one", 1.0, 2) }], ..usual(0.1) }
        };
        for (travel, warned) in [(0.9, false), (1.1, true), (899.0, true)] {
            let all = said(Parameters { integrator: Integrator::AdamsBashforth { order: 2 }, ..pulled(travel) });
            assert_eq!(all.iter().any(|s| s.contains("more than its radius")), warned, "{travel}: {all:?}");
        }
        let divided = Integrator::Implicit(crate::model::Adaptive::default());
        for (travel, warned) in [(8.9, false), (9.1, true)] {
            let all = said(Parameters { integrator: divided, ..pulled(travel) });
            assert_eq!(all.iter().any(|s| s.contains("more than the shortest edge")), warned, "{travel}: {all:?}");
        }
        let refused = Model::new(pulled(901.0)).unwrap_err().to_string();
        assert!(refused.contains("time.step is 0.1, too large for species[0].force"), "{refused}");
        let heavy = vec![Species { density_difference: 1.0, ..Species::new("one", 1.0, 2) }];
        let sinking = Parameters { species: heavy, gravity: Vector::Z * 2e9, ..usual(0.1) };
        let refused = Model::new(sinking).unwrap_err().to_string();
        assert!(refused.contains("time.step is 0.1, too large for gravity.acceleration"), "{refused}");
    }
}
