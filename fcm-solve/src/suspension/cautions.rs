//! What `check` and `run` warn of before a run.

use super::plan::{Radii, problem};
use super::steadiness;
use fcm::Plan;
use io::{Flow, SuspensionScene};

/// All warnings of a scene, a sentence each.
pub fn cautions(scene: &SuspensionScene, radii: &Radii) -> Vec<String> {
    let all = [straight_box(scene), steadiness::caution(scene, radii), burden(scene, radii)];
    all.into_iter().flatten().collect()
}

/// What makes the plan of a scene hopeless, if it is.
fn burden(scene: &SuspensionScene, radii: &Radii) -> Option<String> {
    let problem = problem(scene, radii);
    Plan::choose(&problem).ok()?.burden(&problem)
}

/// In a straight box the flow `u = rate y` jumps by `rate Ly` across the faces along y. The stress that is observed is
/// that of spheres beside images that stand still, over `mu rate`.
fn straight_box(scene: &SuspensionScene) -> Option<String> {
    let Flow::Shear { rate, lees_edwards: false } = scene.flow else { return None };
    let message = "flow.lees_edwards = false: the box stays straight, so that spheres near its faces along y meet images \
                   that do not move with the flow; relative_viscosity and stresses in the time series are not those of a \
                   sheared suspension. Leave the key out unless this is what you want";
    (rate != 0.0).then(|| message.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use domain::{Comm, Particles};
    use io::{Kind, Scene};

    fn cautions_of(flow: &str) -> Vec<String> {
        let rest = "box.edges = [9.0, 9.0, 9.0]\nfluid.viscosity = 1.0\ntime = { step = 0.1, steps = 1 }\n\
                    [[species]]\nradius = 1.0\ncount = 1\n";
        let scene = Scene::parse(&format!("flow = {flow}\n{rest}"), "scene.toml", &[]).unwrap();
        let Kind::Suspension(scene) = scene.kind() else { panic!("a suspension") };
        cautions(scene, &Radii::shared(&Particles::default(), &Comm::alone()))
    }

    #[test]
    fn a_sheared_suspension_in_a_straight_box_is_warned_of() {
        assert!(cautions_of("{ kind = 'shear', rate = 0.5, lees_edwards = false }")[0].contains("relative_viscosity"));
        for flow in ["{ kind = 'shear', rate = 0.5 }", "{ kind = 'shear', rate = 0.0, lees_edwards = false }"] {
            assert!(cautions_of(flow).is_empty(), "{flow}");
        }
        assert!(cautions_of("{ kind = 'none' }").is_empty());
    }
}
