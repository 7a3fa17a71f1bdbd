//! Forces of near polarisable spheres that dipoles alone leave out.

use crate::model::SphereMoment;
use crate::neighbourhood::{PairsWithHalo, SeparatedPair};
use domain::parallel::in_blocks;
use domain::{Tensor, Vector};
use lubrication::{PairPolarisation, PolarisablePair, PolarisedPairTable};
use simd::vectorised;

/// Polarisation of near pairs by the exact solution for two spheres minus that by dipoles. With its polarisabilities
/// `A` along the line of centres and `B` across it, the sums of those of both spheres, a pair adds to the energy, over
/// the constant of the field,
///
/// ```text
/// W = -1/2 [A(r) (n.H)^2 + B(r) (H^2 - (n.H)^2)]
/// ```
///
/// in the applied field `H`, and its forces are the derivatives (as Bonnecaze & Brady, J. Chem. Phys. 96, 2183, 1992,
/// correct dipoles for near contact). So two spheres alone have the exact forces. If moments saturate, the energy has
/// a factor of [`SphereMoment::unsaturated`] for each sphere, which vanishes relative to that of dipoles.
pub struct NearPolarisation {
    /// Moments and radii by species.
    species: Vec<(SphereMoment, f64)>,
    /// By pair of species; none if one of them is not polarisable.
    tables: Vec<Option<PolarisedPairTable>>,
}

/// Number of pairs that one thread polarises at a time.
const PAIRS: usize = 256;

/// Additional force and moments of a pair, over the constant of the field.
#[derive(Debug, Clone, Copy, Default)]
struct PolarisedPair {
    separation: Vector,
    /// Force on the first sphere.
    force: Vector,
    moments: [Vector; 2],
}

impl PolarisedPair {
    #[inline(always)]
    fn scaled(self, factor: f64) -> Self {
        let moments = self.moments.map(|moment| moment * factor);
        Self { force: self.force * factor, moments, ..self }
    }
}

/// All near pairs in a field.
pub struct PolarisedPairs<'a> {
    near: &'a PairsWithHalo,
    pairs: Vec<PolarisedPair>,
}

impl NearPolarisation {
    /// For species with these moments and radii.
    pub fn new(moments: &[SphereMoment], radii: &[f64]) -> Self {
        let table = |i: usize, j: usize| {
            let susceptibilities = [i, j].map(|s| moments[s].susceptibility);
            let pair = PolarisablePair { radii: [radii[i], radii[j]], susceptibilities };
            susceptibilities.iter().all(|chi| *chi != 0.0).then(|| PolarisedPairTable::new(&pair))
        };
        let count = moments.len();
        let tables = (0..count * count).map(|pair| table(pair / count, pair % count)).collect();
        Self { species: moments.iter().copied().zip(radii.iter().copied()).collect(), tables }
    }

    /// Largest distance of two centres at which it acts; `None` if no sphere is polarisable.
    pub fn reach(&self) -> Option<f64> {
        self.tables.iter().flatten().map(PolarisedPairTable::reach).reduce(f64::max)
    }

    /// The pairs in a field, for this rank's particles of these species. Collective.
    pub fn in_field<'a>(&self, near: &'a PairsWithHalo, species: &[u32], field: Vector) -> PolarisedPairs<'a> {
        let unsaturated: Vec<f64> =
            self.species.iter().map(|(moment, radius)| moment.unsaturated(*radius, field)).collect();
        let separated = near.with_values(species, |pair, species| (pair, species));
        let of_block = |first: usize, pairs: &mut [PolarisedPair]| {
            vectorised(
                #[inline(always)]
                || {
                    for (pair, &(separated, [i, j])) in pairs.iter_mut().zip(&separated[first..]) {
                        let [i, j] = [i as usize, j as usize];
                        *pair = self.of_pair(separated, [i, j], field).scaled(unsaturated[i] * unsaturated[j]);
                    }
                },
            );
        };
        let pairs = in_blocks(separated.len(), PAIRS, of_block).0;
        PolarisedPairs { near, pairs }
    }

    #[inline(always)]
    fn of_pair(&self, pair: SeparatedPair, [i, j]: [usize; 2], field: Vector) -> PolarisedPair {
        let (separation, distance) = (pair.separation, pair.separation.length());
        let Some(table) = &self.tables[i * self.species.len() + j] else { return PolarisedPair::default() };
        let Some(PairPolarisation { moments, slopes }) = table.at(distance) else { return PolarisedPair::default() };
        let axis = separation / distance;
        let along = axis.dot(field);
        let across = field - axis * along;
        let sum = |both: [f64; 2]| both[0] + both[1];
        let pull = sum(slopes.along) * along * along + sum(slopes.across) * across.length_squared();
        let turn = (sum(moments.along) - sum(moments.across)) * along / distance;
        let moment = |sphere: usize| axis * (moments.along[sphere] * along) + across * moments.across[sphere];
        PolarisedPair { separation, force: axis * (-0.5 * pull) - across * turn, moments: [moment(0), moment(1)] }
    }
}

impl PolarisedPairs<'_> {
    /// Forces on this rank's particles. Collective.
    pub fn forces(&self) -> Vec<Vector> {
        self.near.summed(self.pairs.iter().map(|pair| [pair.force, -pair.force]))
    }

    /// Additional moments of this rank's particles. Collective.
    pub fn moments(&self) -> Vec<Vector> {
        self.near.summed(self.pairs.iter().map(|pair| pair.moments))
    }

    /// First moments of the forces, half of a pair's for each particle. Collective.
    pub fn first_moments(&self) -> Vec<Tensor> {
        let of_pair = |PolarisedPair { separation, force, .. }: &PolarisedPair| {
            let force = *force * 0.5;
            [Tensor::from_cols(force * separation.x, force * separation.y, force * separation.z); 2]
        };
        self.near.summed(self.pairs.iter().map(of_pair))
    }
}
