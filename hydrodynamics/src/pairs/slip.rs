//! Lubrication loads of near pairs by the slip of squirmers.

use crate::bodies::present::PresentBodies;
use crate::pairs::lubrication::PairLubrication;
use crate::pairs::matrix::lanes::SimdLanes;
use domain::{Neighbour, Neighbours, PeriodicBox, Vector};
use lubrication::{Arithmetic, SlipForce, SphereLoads, SurfaceSlip};
use simd::{SimdVector as Width, VectorKernel};
use solver::Real;

/// Particles with their slip, ghosts included, and the pairs that are lubricated.
pub struct SlippingPairs<'a> {
    pub lubrication: &'a PairLubrication,
    pub slip: &'a SlipForce,
    pub cell: &'a PeriodicBox,
    pub positions: &'a [Vector],
    pub species: &'a [u32],
    pub bodies: Option<&'a PresentBodies>,
    pub neighbours: &'a Neighbours,
    pub slips: &'a [SurfaceSlip],
}

impl SlippingPairs<'_> {
    /// Loads of a sphere on the fluid by the slip of its near pairs, in the order of its neighbours. Within a body they
    /// are as much less as lubrication is.
    pub fn loads(&self, row: usize) -> SphereLoads {
        f64::dispatch(RowLoads { pairs: self, row })
    }

    /// [`Self::loads`] with numbers of any width.
    #[inline(always)]
    fn loads_by<X: Arithmetic>(&self, row: usize) -> SphereLoads {
        let force = &self.lubrication.force;
        let mut sum = SphereLoads::default();
        for neighbour in self.neighbours.of(row).iter() {
            let other = neighbour.row as usize;
            let (separation, species) = (self.separation(row, neighbour), [row, other].map(|i| self.species[i]));
            let slips = [self.slips[row], self.slips[other]];
            let Some(loads) = self.slip.loads::<X>(force, separation, species, &slips) else { continue };
            let radii = species.map(|s| force.radii()[s as usize]);
            let share = self.bodies.and_then(|bodies| bodies.share([row, other], separation, radii)).unwrap_or(1.0);
            sum = sum + loads * share;
        }
        sum
    }

    /// Separation of a sphere and a neighbour of its list.
    fn separation(&self, row: usize, neighbour: Neighbour) -> Vector {
        let apart = self.positions[neighbour.row as usize] - self.positions[row];
        if neighbour.steps == [0; 3] { apart } else { apart + self.cell.lattice(neighbour.steps.map(i32::from)) }
    }
}

/// Loads of the sphere in a row, see [`SlippingPairs::loads`].
struct RowLoads<'a> {
    pairs: &'a SlippingPairs<'a>,
    row: usize,
}

impl VectorKernel<f64> for RowLoads<'_> {
    type Output = SphereLoads;

    #[inline(always)]
    fn run<V: Width<f64>>(self) -> SphereLoads {
        self.pairs.loads_by::<SimdLanes<V>>(self.row)
    }
}
