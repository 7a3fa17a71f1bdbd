//! Lubrication between spheres, divided into stiff pairs, which the preconditioner includes, and soft pairs.

use crate::six_vector::SixVector;
use lubrication::{PairForce, SlipForce, SphereRowTables};
use std::sync::OnceLock;

/// Lubrication between spheres.
pub struct PairLubrication {
    /// Lubrication of all pairs.
    pub force: PairForce,
    /// Tables for soft pairs.
    pub soft: SphereRowTables,
    stiffness: Stiffness,
    slip: OnceLock<SlipForce>,
}

impl PairLubrication {
    /// Lubrication between species with the single-sphere resistances `single`.
    pub fn new(force: PairForce, single: &[SixVector]) -> Self {
        let stiffness = Stiffness::new(&force, single);
        let soft = SphereRowTables::new(&force, |species| stiffness.gap(species));
        Self { force, soft, stiffness, slip: OnceLock::new() }
    }

    /// Loads by slip, whose tables are made at the first call. Must not be called from a rayon task.
    pub fn slip(&self) -> &SlipForce {
        let of_radii = || SlipForce::new(&self.force).expect("the ratios of radii are those of the pair force");
        self.slip.get_or_init(of_radii)
    }

    /// Largest gap at which a pair of two species is stiff.
    pub fn stiff_gap(&self, species: [u32; 2]) -> f64 {
        self.stiffness.gap(species)
    }

    /// Whether a pair of two species is stiff at a gap.
    #[inline(always)]
    pub fn is_stiff(&self, species: [u32; 2], gap: f64) -> bool {
        gap < self.stiffness.gap(species)
    }
}

/// Largest gaps at which pairs of species are stiff.
struct Stiffness {
    species: usize,
    gaps: Vec<f64>,
}

/// A pair is stiff if one of its resistances exceeds this fraction of the single-sphere resistance: at gaps below about
/// half a radius. Most pairs within reach are soft.
const STIFF: f64 = 0.1;

/// Bisection steps for the largest stiff gap.
const HALVINGS: usize = 30;

impl Stiffness {
    fn new(force: &PairForce, single: &[SixVector]) -> Self {
        let gap = |k: usize| largest_gap(force, [k / single.len(), k % single.len()], single);
        Self { species: single.len(), gaps: (0..single.len() * single.len()).map(gap).collect() }
    }

    #[inline(always)]
    fn gap(&self, species: [u32; 2]) -> f64 {
        self.gaps[species[0] as usize * self.species + species[1] as usize]
    }
}

/// Largest gap at which a pair is stiff; the resistance decreases with the gap.
fn largest_gap(force: &PairForce, species: [usize; 2], single: &[SixVector]) -> f64 {
    let radii = species.map(|s| force.radii()[s]);
    let order = if radii[0] > radii[1] { [species[1], species[0]] } else { species };
    let is_stiff = |gap: f64| {
        let Some(resistance) = force.coefficients(radii[0] + radii[1] + gap, order.map(|s| s as u32)) else {
            return false;
        };
        let exceeds = |k: usize| {
            let (alone, [u, v]) = (single[order[k]].0, [resistance.xa[k][k], resistance.ya[k][k]]);
            let [o, p] = [resistance.xc[k][k], resistance.yc[k][k]];
            u.max(v) > STIFF * alone[0] || o.max(p) > STIFF * alone[3]
        };
        exceeds(0) || exceeds(1)
    };
    let (mut stiff, mut soft) = (0.0, force.range().cutoff() * radii[0].max(radii[1]));
    for _ in 0..HALVINGS {
        let middle = 0.5 * (stiff + soft);
        if is_stiff(middle) {
            stiff = middle;
        } else {
            soft = middle;
        }
    }
    soft
}
