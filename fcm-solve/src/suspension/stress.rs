//! The stress that particles add to that of the fluid.

use super::dynamics::STRESSLET;
use super::warm_start::STRESSLET_FAR;
use bytemuck::cast_slice;
use domain::{Comm, Particles, Tensor, Traceless};

/// The stress of the particles of one species, averaged over the box, by origin. With `S_n` the stresslet of a particle
/// in the far field, `L_n` what lubrication adds to it, `F_ij` the repulsion that particle `i` feels from `j`, and `V`
/// the volume of the box (Batchelor, J. Fluid Mech. 41, 545, 1970; Brady & Bossis, Annu. Rev. Fluid Mech. 20, 111,
/// 1988),
///
/// ```text
/// stresslet  = sum_n S_n / V
/// lubrication = sum_n L_n / V
/// repulsion  = -sum_n sum_j (x_n - x_j) F_nj / (2 V)
/// ```
///
/// The stress of the suspension is that of the fluid without particles, `-p I + 2 mu E_inf`, plus all of these.
/// Stresslets have no trace: of the pressure of the particles only the part of repulsion is defined. Forces from
/// outside, such as weight, have no part in it.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ParticleStress {
    /// Of the far field's stresslets.
    pub stresslet: Tensor,
    /// Of lubrication's stresslets.
    pub lubrication: Tensor,
    /// Of the repulsion barrier.
    pub repulsion: Tensor,
}

impl ParticleStress {
    /// All origins together.
    pub fn total(&self) -> Tensor {
        self.stresslet + self.lubrication + self.repulsion
    }

    /// The stresses of each species, for particles whose columns hold their stresslets, in a box of a volume;
    /// `repulsion` has each particle's share of the first moments of repulsion, or nothing. Collective.
    pub fn by_species(
        particles: &Particles,
        repulsion: &[Tensor],
        (species, volume): (usize, f64),
        comm: &Comm,
    ) -> Vec<Self> {
        let column = |name: &str| particles.columns.iter().find(|c| c.name == name).map(|c| cast_slice(&c.values));
        let whole: &[Traceless] = column(STRESSLET).unwrap_or_default();
        let far: &[Traceless] = column(STRESSLET_FAR).unwrap_or(whole);
        let mut sums = vec![[Tensor::ZERO; 3]; species];
        for (row, &kind) in particles.species.iter().enumerate() {
            let [stresslet, lubrication, barrier] = &mut sums[kind as usize];
            if let (Some(&whole), Some(&far)) = (whole.get(row), far.get(row)) {
                *stresslet += far.tensor();
                *lubrication += (whole - far).tensor();
            }
            *barrier += repulsion.get(row).copied().unwrap_or(Tensor::ZERO);
        }
        comm.sum(bytemuck::cast_slice_mut(&mut sums));
        let stress = |[stresslet, lubrication, repulsion]: [Tensor; 3]| Self { stresslet, lubrication, repulsion };
        sums.into_iter().map(|sums| stress(sums.map(|sum| sum * (1.0 / volume)))).collect()
    }
}

#[cfg(test)]
mod tests {
    use crate::suspension::{ParticleStress, Suspension};
    use domain::{Comm, Tensor, Vector};
    use io::{Kind, Scene};
    use std::f64::consts::PI;

    const SCENE: &str = r#"
box.edges = [12.0, 12.0, 12.0]
fluid.viscosity = 2.0
flow = { kind = "shear", rate = 0.5, lees_edwards = true }
hydrodynamics = { tolerance = 1e-5 }
time = { step = 0.1, steps = 1 }
[[species]]
name = "one"
radius = 1.0
count = 1
[[species]]
name = "other"
radius = 1.5
count = 1
"#;

    fn stress(overrides: &[&str], ranks: usize) -> Vec<ParticleStress> {
        let overrides: Vec<String> = overrides.iter().map(|&o| o.to_owned()).collect();
        let scene = Scene::parse(SCENE, "scene.toml", &overrides).unwrap();
        let Kind::Suspension(scene) = scene.kind() else { panic!("a suspension") };
        let all = Comm::threads(ranks, |comm| Suspension::start(scene, &comm).unwrap().stress(scene.species.len()));
        all.into_iter().next().unwrap()
    }

    fn places(separation: Vector) -> String {
        let [x, y, z] = separation.to_array();
        // The pair lies across two sides of the box.
        let second = (Vector::new(11.8, 11.9, 6.0) + separation).to_array();
        assert!(x * y * z != 0.0);
        format!("particles={{ initial = 'positions', positions = [[11.8, 11.9, 6.0], {second:?}] }}")
    }

    #[test]
    fn one_sphere_gives_einsteins_viscosity() {
        let alone = "species=[{ radius = 1.0, count = 1 }]";
        let total = stress(&[alone, "box.edges=[40, 40, 40]"], 1)[0].total();
        let fraction = 4.0 / 3.0 * PI / 40.0_f64.powi(3);
        let intrinsic = total.col(0)[1] / (2.0 * 0.5 * fraction);
        // Images in the lattice change it by a multiple of the volume fraction, 6.5e-5.
        assert!((intrinsic - 2.5).abs() < 1e-3, "{intrinsic}");
        assert!((total.col(0)[0] + total.col(1)[1] + total.col(2)[2]).abs() < 1e-12 * total.col(0)[1]);
    }

    #[test]
    fn repulsion_is_minus_the_pair_moment_over_the_volume_on_any_ranks() {
        let separation = 2.55 * Vector::new(0.48, 0.6, 0.64);
        let (reach, contact) = (2.5_f64 * 1.05, 2.5_f64);
        let depth = (reach.powi(2) - 2.55_f64.powi(2)) / (reach.powi(2) - contact.powi(2));
        let force = 7.0 / contact * depth * depth;
        let expected =
            Tensor::from_cols(separation * separation.x, separation * separation.y, separation * separation.z);
        let expected = expected * (-force / 12.0_f64.powi(3));
        for ranks in [1, 2, 3, 13] {
            let found = stress(&[&places(separation), "repulsion={ strength = 7.0, range = 0.1 }"], ranks);
            for one in &found {
                let difference = one.repulsion * 2.0 - expected;
                assert!(difference.abs_diff_eq(Tensor::ZERO, 1e-12), "{:?} is not {expected:?}", one.repulsion);
            }
        }
    }

    #[test]
    fn lubrication_adds_its_part_on_any_ranks() {
        let near = places(2.51 * Vector::new(0.48, 0.6, 0.64));
        let alone = stress(&[&near, "hydrodynamics.lubrication=true"], 1);
        let without = stress(&[&near], 1);
        assert!(without.iter().all(|s| s.lubrication == Tensor::ZERO && s.repulsion == Tensor::ZERO));
        let viscous = |all: &[ParticleStress]| all.iter().map(|s| s.total().col(0)[1]).sum::<f64>();
        let added: f64 = alone.iter().map(|s| s.lubrication.col(0)[1]).sum();
        assert!(added > 0.02 * viscous(&without) && viscous(&alone) > viscous(&without), "{added}");
        for ranks in [2, 3] {
            for (here, there) in alone.iter().zip(&stress(&[&near, "hydrodynamics.lubrication=true"], ranks)) {
                assert!((here.total() - there.total()).abs_diff_eq(Tensor::ZERO, 1e-6 * viscous(&alone)));
            }
        }
    }
}
