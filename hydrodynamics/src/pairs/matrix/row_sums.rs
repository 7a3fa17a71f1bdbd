//! Sums over the pairs of several rows, one row per lane.

use crate::pairs::matrix::diagonal_block::DiagonalBlock;
use crate::pairs::matrix::lanes::{LANES, SimdLanes};
use crate::pairs::matrix::sparse::{add_tensor, scattered};
use crate::six_vector::SixVector;
use domain::Traceless;
use lubrication::{Arithmetic, SphereRow};
use simd::SimdVector as Width;

/// Sums of the diagonal blocks.
pub struct SphereRowSums<V> {
    force: [SimdLanes<V>; 6],
    torque: [SimdLanes<V>; 6],
    coupling: [SimdLanes<V>; 3],
}

/// Sums of the loads and first moments in the ambient flow.
pub struct InStrain<V> {
    force: [SimdLanes<V>; 3],
    torque: [SimdLanes<V>; 3],
    moment: [SimdLanes<V>; 5],
}

/// Rows and columns of the six components of a symmetric matrix.
const SYMMETRIC: [(usize, usize); 6] = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];

/// Both sums over the pairs of each row.
pub struct RowSums<V> {
    pub resistance: SphereRowSums<V>,
    pub in_strain: InStrain<V>,
}

impl<V: Width<f64>> RowSums<V> {
    #[inline(always)]
    pub fn zero() -> Self {
        Self { resistance: SphereRowSums::zero(), in_strain: InStrain::zero() }
    }
}

impl<V: Width<f64>> SphereRowSums<V> {
    /// Zero sums.
    #[inline(always)]
    pub fn zero() -> Self {
        let zero = SimdLanes::constant(0.0);
        Self { force: [zero; 6], torque: [zero; 6], coupling: [zero; 3] }
    }

    /// Adds one pair of each row, along the axes `z`.
    #[inline(always)]
    pub fn add(&mut self, side: &SphereRow<SimdLanes<V>>, z: [SimdLanes<V>; 3]) {
        let (across, roll, coupling) = (side.ya[0], side.yc[0], side.yb[0]);
        let (along, spin) = (side.xa[0] - across, side.xc[0] - roll);
        for (k, (i, j)) in SYMMETRIC.into_iter().enumerate() {
            self.force[k] = self.force[k].plus(along * z[i], z[j]);
            self.torque[k] = self.torque[k].plus(spin * z[i], z[j]);
            if i == j {
                self.force[k] = self.force[k] + across;
                self.torque[k] = self.torque[k] + roll;
            }
        }
        for k in 0..3 {
            self.coupling[k] = self.coupling[k].plus(coupling, z[k]);
        }
    }

    /// The diagonal block of each row.
    #[inline(always)]
    pub fn totals(&self) -> [DiagonalBlock<f64>; LANES] {
        let [force, torque, coupling] = [scattered(&self.force), scattered(&self.torque), scattered(&self.coupling)];
        let mut own = [DiagonalBlock::default(); LANES];
        for lane in 0..LANES {
            own[lane].force.copy_from_slice(&force[lane][..6]);
            own[lane].torque.copy_from_slice(&torque[lane][..6]);
            own[lane].coupling.copy_from_slice(&coupling[lane][..3]);
        }
        own
    }
}

impl<V: Width<f64>> InStrain<V> {
    /// Zero sums.
    #[inline(always)]
    pub fn zero() -> Self {
        let zero = SimdLanes::constant(0.0);
        Self { force: [zero; 3], torque: [zero; 3], moment: [zero; 5] }
    }

    /// Adds one pair of each row, along the axes `z`, in an ambient strain rate whose xz and yz components are
    /// increased by the given amounts.
    #[inline(always)]
    pub fn add(
        &mut self,
        side: &SphereRow<SimdLanes<V>>,
        z: [SimdLanes<V>; 3],
        ambient: Traceless,
        [sloping_x, sloping_y]: [SimdLanes<V>; 2],
    ) {
        let [xx, xy, xz, yy, yz] = ambient.0;
        let rows = [[xx, xy, xz], [xy, yy, yz], [xz, yz, -xx - yy]];
        let mut across = [sloping_x * z[2], sloping_y * z[2], (sloping_x * z[0]).plus(sloping_y, z[1])];
        for i in 0..3 {
            for j in 0..3 {
                across[i] = across[i].plus(SimdLanes::constant(rows[i][j]), z[j]);
            }
        }
        let along = (z[0] * across[0]).plus(z[1], across[1]).plus(z[2], across[2]);
        for i in 0..3 {
            across[i] = across[i] - along * z[i];
        }
        let (push, slide, twist, bend) = (side.xg_strain * along, side.yg_strain, side.yh_strain, side.ym_minus_zm);
        let mut shear = across;
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            self.force[i] = self.force[i].plus(push, z[i]).plus(slide, across[i]);
            self.torque[i] = self.torque[i].plus(twist, z[j] * across[k] - z[k] * across[j]);
            shear[i] = bend * across[i];
        }
        add_tensor(side.xm_minus_zm_half * along, shear, z, &mut self.moment);
        let bulk = side.zm;
        for (k, component) in ambient.0.into_iter().enumerate() {
            self.moment[k] = self.moment[k].plus(bulk, SimdLanes::constant(component));
        }
        self.moment[2] = self.moment[2].plus(bulk, sloping_x);
        self.moment[4] = self.moment[4].plus(bulk, sloping_y);
    }

    /// The load and the first moment of each row.
    #[inline(always)]
    pub fn totals(&self) -> ([SixVector; LANES], [Traceless; LANES]) {
        let [force, torque, moment] = [scattered(&self.force), scattered(&self.torque), scattered(&self.moment)];
        let (mut loads, mut moments) = ([SixVector::default(); LANES], [Traceless::ZERO; LANES]);
        for lane in 0..LANES {
            loads[lane].0[..3].copy_from_slice(&force[lane][..3]);
            loads[lane].0[3..].copy_from_slice(&torque[lane][..3]);
            moments[lane].0.copy_from_slice(&moment[lane][..5]);
        }
        (loads, moments)
    }
}
