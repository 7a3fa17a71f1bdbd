//! Growth of the cost of a step during a run.

use crate::model::{Model, Start};
use domain::{Boundaries, Vector, sphere};
use std::f64::consts::PI;

/// Relative increase of the cost once contacts have formed at a given rate; the strain in which they form; and the
/// volume fractions between which the increase grows from zero to its full value. Measured on `new dense` at 30 to 50%.
const TOUCHING: f64 = 0.6;
const FORMED: f64 = 1.0;
const CROWDED: [f64; 2] = [0.3, 0.4];

/// Relative increase of the cost once spheres are piled up at a wall, and the time until then, in units of the time in
/// which an isolated sphere settles through the box. Measured on `new sediment`.
const PILED: f64 = 2.5;
const FALLEN: f64 = 1.5;

/// Relative increase of the cost once a cloud has become a torus with a tail, and the distance until then, in cloud
/// radii. Measured on `new cloud`.
const TRAILING: f64 = 1.0;
const UNFOLDED: f64 = 10.0;

/// Ratio of the mean cost of a step to that of the first steps, from measured growth; accurate to about 10% at best.
pub fn cost_growth(model: &Model) -> f64 {
    let (end, strained) = (model.end(), model.contacts.is_some() && model.shear_rates().stress().is_none());
    let touching = if strained { crowded(volume_fraction(model)) } else { 0.0 };
    let formed = share_after(end * model.shear_rates().largest().abs(), FORMED);
    let fallen = |speed: f64| share_after(end * speed, FALLEN * model.cell.edges().z);
    let piled = to_walls(model).map_or(0.0, fallen);
    let unfolded = cloud(model).map_or(0.0, |(speed, radius)| share_after(end * speed, UNFOLDED * radius));
    1.0 + TOUCHING * touching * formed + PILED * piled + TRAILING * unfolded
}

/// Mean, over a path of length `way`, of a ramp that grows from 0 to 1 within the length `whole` and then stays at 1.
fn share_after(way: f64, whole: f64) -> f64 {
    if way < whole { 0.5 * way / whole } else { 1.0 - 0.5 * whole / way }
}

/// Fraction of the full increase by contacts at a volume fraction.
fn crowded(fraction: f64) -> f64 {
    let [from, to] = CROWDED;
    ((fraction - from) / (to - from)).clamp(0.0, 1.0)
}

fn volume_fraction(model: &Model) -> f64 {
    let volume = |radius: f64, count: f64| count * 4.0 / 3.0 * PI * radius.powi(3);
    let volumes = model.species.iter().map(|species| volume(species.radius, species.count.unwrap_or(0) as f64));
    volumes.sum::<f64>() / model.cell.volume()
}

/// Speed of an isolated sphere under a force.
fn speed(model: &Model, radius: f64, force: f64) -> f64 {
    force / sphere::drag(model.viscosity, radius)
}

/// Largest speed of isolated spheres of a species towards a wall, if any moves towards one.
fn to_walls(model: &Model) -> Option<f64> {
    let reaches = |speed: f64| match model.cell.boundaries() {
        Boundaries::Walls => Some(speed.abs()),
        Boundaries::Wall => Some(-speed),
        _ => None,
    };
    let speeds = model.species.iter().map(|s| speed(model, s.radius, s.force_on(s.radius, model.gravity).z));
    speeds.filter_map(reaches).filter(|speed| *speed > 0.0).reduce(f64::max)
}

/// Initial settling speed of a cloud, that of a drop with the viscosity of the fluid under the total force, and its
/// radius; `None` for other starts.
fn cloud(model: &Model) -> Option<(f64, f64)> {
    let Start::Cloud { radius, .. } = model.start else { return None };
    let forces = model.species.iter().map(|s| s.force_on(s.radius, model.gravity) * s.count.unwrap_or(0) as f64);
    Some((6.0 / 5.0 * speed(model, radius, forces.sum::<Vector>().length()), radius))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Adaptive, Contacts, Flow, Integrator, Parameters, Species};
    use domain::PeriodicBox;

    fn with(change: impl FnOnce(Parameters) -> Parameters) -> f64 {
        let cell = PeriodicBox::new(Vector::splat(20.0)).unwrap();
        cost_growth(
            &Model::new(change(Parameters::new(cell, 1.0, vec![Species::new("one", 1.0, 100)], 0.01, 1000))).unwrap(),
        )
    }

    #[test]
    fn steps_cost_the_same_unless_a_suspension_changes() {
        assert!((with(|scene| scene) - 1.0).abs() < 1e-15);
        let falls = |mut scene: Parameters| {
            scene.species[0].force = -Vector::Z;
            scene
        };
        assert!((with(falls) - 1.0).abs() < 1e-15, "there is no wall to fall to");
    }

    /// A cloud of 100 spheres with unit forces moves at 6/5 of 100/(6 pi 40), or 0.159, and unfolds over a distance of
    /// 400, or 10 of its radii.
    #[test]
    fn a_cloud_unfolds_on_its_way() {
        let cloud = |steps: u64| {
            with(|scene| {
                let mut species = scene.species;
                species[0].force = Vector::X;
                let cell = scene.cell.with_boundaries(Boundaries::Open).unwrap();
                let start = Start::Cloud { radius: 40.0, minimum_gap: 0.1 };
                Parameters { cell, species, start, steps, ..scene }
            })
        };
        let speed = 1.2 * 100.0 / (6.0 * PI * 40.0);
        assert!((cloud(1000) - (1.0 + 0.5 * speed * 10.0 / 400.0)).abs() < 1e-12);
        let far = 1e6 * speed;
        assert!((cloud(100_000_000) - (2.0 - 0.5 * 400.0 / far)).abs() < 1e-12);
    }

    #[test]
    fn contacts_form_where_spheres_are_crowded_and_sheared() {
        let touching = |count: u64, rate: f64| {
            with(|scene| {
                let mut species = scene.species;
                species[0].count = Some(count);
                let mut hydrodynamics = scene.hydrodynamics.clone();
                hydrodynamics.lubrication = true;
                let flow = Flow::Shear { rate, lees_edwards: true };
                let contacts = Some(Contacts::new(0.5));
                let integrator = Integrator::Implicit(Adaptive::UNLIMITED);
                Parameters { species, flow, contacts, hydrodynamics, integrator, ..scene }
            })
        };
        assert!((touching(100, 1.0) - 1.0).abs() < 1e-15, "5% are not crowded");
        assert!((touching(859, 1.0) - (1.0 + 0.6 * 0.95)).abs() < 1e-12, "45% are, in a strain of 10");
        assert!((touching(859, 0.05) - (1.0 + 0.6 * 0.25)).abs() < 1e-12, "in a strain of 0.5");
    }
}
