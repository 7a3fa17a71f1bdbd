//! Particle stress.

use crate::columns::{BROWNIAN, CONSTRAINT_MOMENT, STRESSLET, STRESSLET_FAR};
use crate::forces::NamedMoments;
use crate::forces::force::StressName;
use bytemuck::cast_slice;
use domain::parallel::MeasuredLoop;
use domain::{Comm, Particles, Tensor, Traceless};
use rayon::prelude::*;

/// Stress of the particles of one species, averaged over the box, by contribution. With `S_n` the far-field stresslet
/// of a particle, `G_n` the part of it that a swimmer has alone, `L_n` the stresslet added by lubrication, `C_n` the
/// force on a sphere at the arm `s_n` that keeps its body rigid, `F_ij` the repulsion on particle `i` due to `j`, and
/// `V` the volume of the box (Batchelor, J. Fluid Mech. 41, 545, 1970; Brady & Bossis, Annu. Rev. Fluid Mech. 20, 111,
/// 1988),
///
/// ```text
/// stresslet  = sum_n (S_n - G_n) / V
/// lubrication = sum_n L_n / V
/// active     = sum_n G_n / V
/// constraint = -sum_n sym(s_n C_n) / V
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
///
/// Contributions have names: [`Self::STRESSLET`], [`Self::LUBRICATION`], [`Self::ACTIVE`], [`Self::CONSTRAINT`],
/// those of the model's forces (`repulsion`, `attraction`, `contact`, `bond`, `magnetic`, `electric`),
/// [`Self::BROWNIAN`], and those of the
/// user's forces (`applied`, and the names of registered ones).
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ParticleStress {
    parts: Vec<StressPart>,
}

/// A contribution to the stress.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StressPart {
    /// Name.
    pub name: StressName,
    /// Stress; its column `b` belongs to faces normal to `b` and its entry `a` to forces along `a`.
    pub tensor: Tensor,
}

/// Contributions of this rank's particles.
enum Summands<'a> {
    Stresslets(&'a [Traceless]),
    /// Differences of stresslets.
    Rest(&'a [Traceless], &'a [Traceless]),
    Moments(Vec<Tensor>),
}

impl Summands<'_> {
    /// The contribution of a particle.
    fn of(&self, row: usize) -> Option<Tensor> {
        match self {
            Self::Stresslets(list) => list.get(row).map(|stresslet| stresslet.tensor()),
            Self::Rest(whole, part) => whole.get(row).zip(part.get(row)).map(|(&whole, &part)| (whole - part).tensor()),
            Self::Moments(list) => list.get(row).copied(),
        }
    }
}

impl ParticleStress {
    /// Name of the far-field stresslets.
    pub const STRESSLET: &str = "stresslet";
    /// Name of lubrication.
    pub const LUBRICATION: &str = "lubrication";
    /// Name of the stresslets of swimmers by their activity, see [`crate::Swimming`], which the far-field stresslets
    /// are without.
    pub const ACTIVE: &str = "active";
    /// Name of the contribution of the forces that keep bodies rigid.
    pub const CONSTRAINT: &str = "constraint";
    /// Name of the mean of the stresslets caused by random motions, if it is separated from these.
    pub const BROWNIAN: &str = "brownian";

    /// All contributions.
    pub fn parts(&self) -> &[StressPart] {
        &self.parts
    }

    /// The contribution of a name; zero if there is none.
    pub fn of(&self, name: &str) -> Tensor {
        self.parts.iter().find(|part| part.name.name == name).map_or(Tensor::ZERO, |part| part.tensor)
    }

    /// Sum of all contributions.
    pub fn total(&self) -> Tensor {
        self.parts.iter().fold(Tensor::ZERO, |sum, part| sum + part.tensor)
    }

    /// Sum of all species and contributions.
    pub fn sum(of_each: &[Self]) -> Tensor {
        of_each.iter().fold(Tensor::ZERO, |sum, stress| sum + stress.total())
    }

    /// Pressure `-tr(s) / 3` of a stress.
    pub fn pressure(stress: &Tensor) -> f64 {
        -(stress.x_axis.x + stress.y_axis.y + stress.z_axis.z) / 3.0
    }

    /// The stresses of `species` species in a box of a volume, for particles whose columns hold their stresslets, with
    /// the first moments of the forces of the model and of the user, and the active part of the stresslets if there are
    /// swimmers. Collective.
    pub fn by_species(
        particles: &Particles,
        moments: [Vec<NamedMoments>; 2],
        active: Option<&[Traceless]>,
        species: usize,
        volume: f64,
        comm: &Comm,
    ) -> Vec<Self> {
        let summands = summands(particles, moments, active);
        // Contributions in parallel: sums over particles have an order.
        let of_part = |(_, summands): &(StressName, Summands)| {
            let mut sums = vec![Tensor::ZERO; species];
            for (row, &kind) in particles.species.iter().enumerate() {
                sums[kind as usize] += summands.of(row).unwrap_or(Tensor::ZERO);
            }
            sums
        };
        let of_parts: Vec<Vec<Tensor>> = summands.par_iter().map(of_part).measured().collect();
        let of_species = |kind: usize| of_parts.iter().map(move |sums| sums[kind]);
        let mut sums: Vec<Tensor> = (0..species).flat_map(of_species).collect();
        comm.sum(bytemuck::cast_slice_mut(&mut sums));
        let part = |(name, &sum): (StressName, &Tensor)| StressPart { name, tensor: sum * (1.0 / volume) };
        let names = || summands.iter().map(|(name, _)| *name);
        let stress = |sums: &[Tensor]| Self { parts: names().zip(sums).map(part).collect() };
        sums.chunks_exact(summands.len()).map(stress).collect()
    }
}

/// Contributions of this rank's particles with their names, in the order of a stress.
fn summands<'a>(
    particles: &'a Particles,
    moments: [Vec<NamedMoments>; 2],
    active: Option<&'a [Traceless]>,
) -> Vec<(StressName, Summands<'a>)> {
    let values = |name: &str| particles.columns.iter().find(|c| c.name == name).map(|c| c.values.as_slice());
    let column = |name: &str| values(name).map(cast_slice);
    let whole: &[Traceless] = column(STRESSLET).unwrap_or_default();
    let far: &[Traceless] = column(STRESSLET_FAR).unwrap_or(whole);
    let by_heat: &[Traceless] = column(BROWNIAN).unwrap_or_default();
    let far_known = &far[..far.len().min(whole.len())];
    let passive = active.map_or(Summands::Stresslets(far_known), |active| Summands::Rest(far_known, active));
    let fluid = [
        (StressName::symmetric(ParticleStress::STRESSLET), passive),
        (StressName::symmetric(ParticleStress::LUBRICATION), Summands::Rest(whole, far)),
    ];
    let active = active.map(|active| (StressName::symmetric(ParticleStress::ACTIVE), Summands::Stresslets(active)));
    let constraint = values(CONSTRAINT_MOMENT).map(|moments| {
        (StressName::symmetric(ParticleStress::CONSTRAINT), Summands::Moments(cast_slice(moments).to_vec()))
    });
    let brownian = (StressName::symmetric(ParticleStress::BROWNIAN), Summands::Stresslets(by_heat));
    let of_force = |NamedMoments { name, of_particles }| (name, Summands::Moments(of_particles));
    let [of_model, of_user] = moments.map(|moments| moments.into_iter().map(of_force));
    fluid.into_iter().chain(active).chain(constraint).chain(of_model).chain([brownian]).chain(of_user).collect()
}
