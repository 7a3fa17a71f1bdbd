//! The least repulsion that keeps spheres apart.

use crate::suspension::{StepError, Suspension};
use anyhow::{Context, ensure};
use domain::{Comm, Number};
use io::{Kind, Scene, SuspensionScene};

/// Steps of a trial, if the scene has as many.
const TRIAL: u64 = 200;
/// The search ends when a strength that is too small and one that suffices differ by this factor.
const CLOSE: f64 = 1.1;
/// The search leaves the strength that it starts from by this factor at most.
const FARTHEST: f64 = 1e6;

/// The scene with the least `repulsion.strength`, to 10%, with which no spheres overlap in the first 200 steps, if it
/// asks for that by `repulsion.calibrate`. The strength is doubled or halved until one fails and one suffices, then
/// their geometric mean is tried again and again. Collective.
pub fn with_least_repulsion(scene: Scene, comm: &Comm) -> anyhow::Result<Scene> {
    let Kind::Suspension(checked) = scene.kind() else { return Ok(scene) };
    let Some(repulsion) = checked.repulsion.filter(|repulsion| repulsion.calibrate) else { return Ok(scene) };
    let with = |strength: f64| {
        let overrides = [format!("repulsion.strength={strength:e}"), "repulsion.calibrate=false".to_owned()];
        Scene::parse(scene.text(), "the scene to calibrate", &overrides)
    };
    let suffices = |strength: f64| -> anyhow::Result<bool> {
        let trial = with(strength)?;
        let Kind::Suspension(trial) = trial.kind() else { unreachable!("the same kind as before") };
        keeps_apart(trial, comm).with_context(|| format!("in a trial with repulsion.strength = {}", Number(strength)))
    };
    let strength = least(repulsion.strength, suffices)?;
    if comm.is_first() {
        let strength = Number(strength);
        crate::streams::log(format_args!("repulsion  strength {strength:.5} keeps the spheres apart in a trial"));
    }
    Ok(with(strength)?)
}

/// The least strength that suffices, nearly.
fn least(start: f64, suffices: impl Fn(f64) -> anyhow::Result<bool>) -> anyhow::Result<f64> {
    let (mut enough, mut less) = (start, start);
    while !suffices(enough)? {
        (less, enough) = (enough, 2.0 * enough);
        ensure!(
            enough < FARTHEST * start,
            "no repulsion.strength up to {:.2} keeps the spheres apart; try a smaller time.step, or time.integrator = \
             \"adaptive\"",
            Number(enough)
        );
    }
    while less >= enough && enough > start / FARTHEST {
        less = 0.5 * enough;
        if suffices(less)? {
            enough = less;
        }
    }
    while enough > CLOSE * less {
        let between = (less * enough).sqrt();
        if suffices(between)? {
            enough = between;
        } else {
            less = between;
        }
    }
    Ok(enough)
}

/// Whether no spheres overlap in a trial. Collective.
fn keeps_apart(scene: &SuspensionScene, comm: &Comm) -> anyhow::Result<bool> {
    let mut suspension = Suspension::start(scene, comm)?;
    for _ in 0..scene.time.steps.min(TRIAL) {
        match suspension.step() {
            Ok(()) if suspension.report().smallest_gap > 0.0 => {}
            Ok(()) | Err(StepError::Collision { .. } | StepError::NotFinite(_)) => return Ok(false),
            Err(error) => return Err(error.into()),
        }
    }
    Ok(true)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two spheres pushed together by forces of 10 need a force of 10 at contact.
    #[test]
    fn two_spheres_need_as_much_as_pushes_them() {
        let text = r#"
box.edges = [12.0, 12.0, 12.0]
fluid.viscosity = 1.0
particles = { initial = "positions", positions = [[4.9, 6.0, 6.0], [7.0, 6.0, 6.0]] }
hydrodynamics.tolerance = 1e-2
repulsion = { strength = 2.0, calibrate = true }
time = { step = 0.04, steps = 150 }
[[species]]
name = "right"
radius = 1.0
count = 1
force = [10.0, 0.0, 0.0]
[[species]]
name = "left"
radius = 1.0
count = 1
force = [-10.0, 0.0, 0.0]
"#;
        let comm = Comm::alone();
        let scene = with_least_repulsion(Scene::parse(text, "scene.toml", &[]).unwrap(), &comm).unwrap();
        let Kind::Suspension(scene) = scene.kind() else { panic!("a suspension") };
        let repulsion = scene.repulsion.unwrap();
        assert!(!repulsion.calibrate && (9.9..11.1).contains(&repulsion.strength), "{}", repulsion.strength);
    }

    #[test]
    fn the_search_meets_in_the_middle_from_either_side() {
        for start in [0.01, 7.0, 4e3] {
            let found = least(start, |strength| Ok(strength >= 5.0)).unwrap();
            assert!((5.0..5.0 * CLOSE).contains(&found), "from {start}: {found}");
        }
        assert!(least(1.0, |_| Ok(false)).unwrap_err().to_string().contains("smaller time.step"));
    }
}
