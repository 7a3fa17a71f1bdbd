//! Particle stress.

use crate::columns::STRESSLET_FAR;
use crate::columns::{BROWNIAN, STRESSLET};
use bytemuck::cast_slice;
use domain::{Comm, Particles, Tensor, Traceless};

/// Stress of the particles of one species, averaged over the box, by contribution. With `S_n` the far-field stresslet
/// of a particle, `L_n` the stresslet added by lubrication, `F_ij` the repulsion on particle `i` due to `j`, and `V`
/// the volume of the box (Batchelor, J. Fluid Mech. 41, 545, 1970; Brady & Bossis, Annu. Rev. Fluid Mech. 20, 111,
/// 1988),
///
/// ```text
/// stresslet  = sum_n S_n / V
/// lubrication = sum_n L_n / V
/// repulsion  = -sum_n sum_j (x_n - x_j) F_nj / (2 V)
/// ```
///
/// The stresses of attraction and bonds are defined like that of repulsion, and so is that of contacts, friction
/// included, by its symmetric part; each sphere of a pair has a share in proportion to its radius. The Brownian stress
/// is defined like that of stresslets, and the stress of user-defined forces like that of repulsion, as far as the user
/// provides their moments.
///
/// The stress of the suspension is that of the fluid without particles, `-p I + 2 mu E_inf`, plus all of these.
/// Stresslets are traceless: only the non-hydrodynamic part of the particle pressure is defined. External forces such
/// as weight do not contribute.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ParticleStress {
    /// Far-field stresslets.
    pub stresslet: Tensor,
    /// Lubrication stresslets.
    pub lubrication: Tensor,
    /// Repulsion.
    pub repulsion: Tensor,
    /// Attraction.
    pub attraction: Tensor,
    /// Contacts.
    pub contact: Tensor,
    /// Bonds.
    pub bond: Tensor,
    /// Brownian stress, the mean of the stresslets caused by random motions, if it is separated from these.
    pub brownian: Tensor,
    /// User-defined forces between particles.
    pub applied: Tensor,
}

impl ParticleStress {
    /// Sum of all contributions.
    pub fn total(&self) -> Tensor {
        let of_surfaces = self.stresslet + self.lubrication + self.repulsion + self.attraction;
        of_surfaces + self.contact + self.bond + self.brownian + self.applied
    }

    /// Sum of all species and contributions.
    pub fn sum(of_each: &[Self]) -> Tensor {
        of_each.iter().fold(Tensor::ZERO, |sum, stress| sum + stress.total())
    }

    /// Pressure `-tr(s) / 3` of a stress.
    pub fn pressure(stress: &Tensor) -> f64 {
        -(stress.x_axis.x + stress.y_axis.y + stress.z_axis.z) / 3.0
    }

    /// The stresses of each species, for particles whose columns hold their stresslets, in a box of a volume; `pairs`
    /// has each particle's shares of the first moments of repulsion, attraction, contacts, bonds and the user's forces,
    /// or nothing. Collective.
    pub fn by_species(
        particles: &Particles,
        pairs: [&[Tensor]; 5],
        (species, volume): (usize, f64),
        comm: &Comm,
    ) -> Vec<Self> {
        let column = |name: &str| particles.columns.iter().find(|c| c.name == name).map(|c| cast_slice(&c.values));
        let whole: &[Traceless] = column(STRESSLET).unwrap_or_default();
        let far: &[Traceless] = column(STRESSLET_FAR).unwrap_or(whole);
        let by_heat: &[Traceless] = column(BROWNIAN).unwrap_or_default();
        let mut sums = vec![[Tensor::ZERO; 8]; species];
        for (row, &kind) in particles.species.iter().enumerate() {
            let [stresslet, lubrication, brownian, of_pairs @ ..] = &mut sums[kind as usize];
            *brownian += by_heat.get(row).map_or(Tensor::ZERO, |s| s.tensor());
            if let (Some(&whole), Some(&far)) = (whole.get(row), far.get(row)) {
                *stresslet += far.tensor();
                *lubrication += (whole - far).tensor();
            }
            for (sum, moments) in of_pairs.iter_mut().zip(pairs) {
                *sum += moments.get(row).copied().unwrap_or(Tensor::ZERO);
            }
        }
        comm.sum(bytemuck::cast_slice_mut(&mut sums));
        let stress = |[stresslet, lubrication, brownian, repulsion, attraction, contact, bond, applied]: [Tensor;
                          8]| Self {
            stresslet,
            lubrication,
            repulsion,
            attraction,
            contact,
            bond,
            brownian,
            applied,
        };
        sums.into_iter().map(|sums| stress(sums.map(|sum| sum * (1.0 / volume)))).collect()
    }
}
