//! Pairs of several rows, packed into SIMD lanes.

use crate::pairs::beams::BeamResistances;
use crate::pairs::contacts::ContactResistances;
use crate::pairs::lubrication::PairLubrication;
use crate::pairs::matrix::lanes::{LANES, SimdLanes, StoredLanes, transpose};
use crate::pairs::matrix::row_sums::RowSums;
use crate::pairs::matrix::sparse::{GroupOfPairs, LaneGroup, MomentGroup};
use crate::springs::PairSprings;
use domain::{Traceless, Vector};
use lubrication::{Arithmetic, Coefficients, RECORD, SPHERE_ROW, SphereRow};
use simd::SimdVector as Width;

/// A pair of a row, with the separation from its particle to the other.
pub struct NearPair {
    pub separation: Vector,
    pub distance: f64,
    /// Height of the midpoint.
    pub height: f64,
    pub other: u32,
    pub species: [u32; 2],
    pub is_lubricated: bool,
    /// Factor of the resistance of spheres of one rigid body; `None` for others.
    pub within_body: Option<f64>,
}

/// A pair, and the radii of its two spheres.
#[derive(Clone, Copy)]
pub struct SizedPair<'a> {
    pub pair: &'a NearPair,
    pub radii: [f64; 2],
}

/// Source of the resistance coefficients of pairs, with `N` numbers per pair.
pub trait PackedKind<const N: usize> {
    /// Writes the numbers of a pair of spheres with two radii. `spring` has its spring resistances.
    fn write<V: Width<f64>>(
        &mut self,
        lane: usize,
        pair: SizedPair,
        spring: Option<&PairSprings>,
        numbers: &mut [f64; N],
    );

    /// Resistance coefficients of the rows' spheres, one pair per lane, from these numbers.
    fn sides<V: Width<f64>>(&self, numbers: &[[f64; LANES]; N]) -> SphereRow<SimdLanes<V>>;
}

/// Pairs of one kind from several rows, one pair per lane.
pub struct PackedPairs<K, const N: usize> {
    kind: K,
    records: [[f64; N]; LANES],
    /// Unit vectors from the smaller to the larger sphere.
    axis: [[f64; LANES]; 3],
    /// Increase of the xz and yz components of the ambient strain rate from `z = 0` to the pair.
    sloping: [[f64; LANES]; 2],
    others: [u32; LANES],
    /// Factors of the resistance, and whether any differs from 1.
    factors: [f64; LANES],
    has_factors: bool,
}

impl<K: PackedKind<N>, const N: usize> PackedPairs<K, N> {
    /// Empty lanes, with a placeholder row.
    #[inline(always)]
    pub fn empty(kind: K, row: u32) -> Self {
        Self {
            kind,
            records: [[0.0; N]; LANES],
            axis: [[0.0; LANES]; 3],
            sloping: [[0.0; LANES]; 2],
            others: [row; LANES],
            factors: [1.0; LANES],
            has_factors: false,
        }
    }

    /// Sets the pair of a lane, for spheres with two radii, in a flow whose strain rate varies with z at the rate
    /// `slope`.
    #[inline(always)]
    pub fn set<V: Width<f64>>(&mut self, lane: usize, sized: SizedPair, spring: Option<&PairSprings>, slope: [f64; 2]) {
        self.kind.write::<V>(lane, sized, spring, &mut self.records[lane]);
        let SizedPair { pair, radii } = sized;
        self.others[lane] = pair.other;
        if let Some(factor) = pair.within_body {
            self.factors[lane] = factor;
            self.has_factors = true;
        }
        for k in 0..2 {
            self.sloping[k][lane] = slope[k] * pair.height;
        }
        let axis = pair.separation * (if radii[0] > radii[1] { -1.0 } else { 1.0 } / pair.distance);
        for k in 0..3 {
            self.axis[k][lane] = axis[k];
        }
    }

    /// Assembles the pairs into a group.
    #[inline(always)]
    pub fn assemble<V: Width<f64>, T: StoredLanes>(
        &self,
        GroupOfPairs { group, moments }: GroupOfPairs<T>,
        sums: &mut RowSums<V>,
        ambient: Traceless,
    ) {
        let mut numbers = [[0.0; LANES]; N];
        for (k, lanes) in numbers.as_chunks_mut::<LANES>().0.iter_mut().enumerate() {
            transpose::<V, N>(&self.records, k * LANES, lanes);
        }
        let mut side = self.kind.sides::<V>(&numbers);
        if self.has_factors {
            side = side.times(SimdLanes::read(&self.factors));
        }
        let mut z = [SimdLanes::constant(0.0); 3];
        for k in 0..3 {
            z[k] = SimdLanes::read(&self.axis[k]);
        }
        sums.resistance.add(&side, z);
        let sloping = [SimdLanes::read(&self.sloping[0]), SimdLanes::read(&self.sloping[1])];
        sums.in_strain.add(&side, z, ambient, sloping);
        group.others = self.others;
        for k in 0..3 {
            T::store(z[k], &mut group.axis[k]);
        }
        group.set(&side);
        moments.set(&side);
    }
}

/// Numbers of a stiff pair: its resistance coefficients, 1 if the row's particle is the larger one, and the resistance
/// of its spring along the axis.
pub const STIFF: usize = 48;
const IS_LARGER: usize = RECORD;
const SPRING: usize = RECORD + 1;

/// Stiff pairs, with lubrication or springs.
pub struct Stiff<'a> {
    lubrication: Option<&'a PairLubrication>,
    touching: ContactResistances,
    /// Whether any of the pairs is in contact.
    touch: bool,
    beams: BeamResistances,
    /// Whether any of the pairs is a beam.
    bend: bool,
}

impl<'a> Stiff<'a> {
    #[inline(always)]
    pub fn new(lubrication: Option<&'a PairLubrication>) -> Self {
        Self {
            lubrication,
            touching: ContactResistances::default(),
            touch: false,
            beams: BeamResistances::default(),
            bend: false,
        }
    }
}

impl PackedKind<STIFF> for Stiff<'_> {
    #[inline(always)]
    fn write<V: Width<f64>>(
        &mut self,
        lane: usize,
        SizedPair { pair, radii }: SizedPair,
        spring: Option<&PairSprings>,
        numbers: &mut [f64; STIFF],
    ) {
        if let Some(lubrication) = self.lubrication.filter(|_| pair.is_lubricated) {
            let record = numbers.first_chunk_mut().expect("numbers begin with a record");
            lubrication.force.record::<SimdLanes<V>>(pair.distance, pair.species, record);
        }
        numbers[IS_LARGER] = f64::from(u8::from(radii[0] > radii[1]));
        if let Some(&PairSprings { along, slip, rolling, bending, twisting }) = spring {
            numbers[SPRING] = along;
            self.touching.set(lane, [slip, rolling], pair.distance, radii);
            self.touch |= slip + rolling > 0.0;
            self.beams.set(lane, [bending, twisting], pair.distance);
            self.bend |= bending + twisting > 0.0;
        }
    }

    #[inline(always)]
    fn sides<V: Width<f64>>(&self, numbers: &[[f64; LANES]; STIFF]) -> SphereRow<SimdLanes<V>> {
        let mut record = [SimdLanes::<V>::constant(0.0); RECORD];
        for k in 0..RECORD {
            record[k] = SimdLanes::read(&numbers[k]);
        }
        let mut coefficients = Coefficients::of(&record);
        let spring = SimdLanes::read(&numbers[SPRING]);
        for k in 0..2 {
            coefficients.xa[k][k] = coefficients.xa[k][k] + spring;
            coefficients.xa[k][1 - k] = coefficients.xa[k][1 - k] - spring;
        }
        if self.touch {
            self.touching.add_to(&mut coefficients);
        }
        if self.bend {
            self.beams.add_to(&mut coefficients);
        }
        SphereRow::of(&coefficients, SimdLanes::read(&numbers[IS_LARGER]))
    }
}

/// Soft pairs, with weak lubrication alone.
pub struct Soft<'a>(pub Option<&'a PairLubrication>);

impl PackedKind<SPHERE_ROW> for Soft<'_> {
    #[inline(always)]
    fn write<V: Width<f64>>(
        &mut self,
        _lane: usize,
        SizedPair { pair, .. }: SizedPair,
        _spring: Option<&PairSprings>,
        numbers: &mut [f64; SPHERE_ROW],
    ) {
        if let Some(lubrication) = self.0 {
            lubrication.soft.record::<SimdLanes<V>>(pair.distance, pair.species, numbers);
        }
    }

    #[inline(always)]
    fn sides<V: Width<f64>>(&self, numbers: &[[f64; LANES]; SPHERE_ROW]) -> SphereRow<SimdLanes<V>> {
        let mut lanes = [SimdLanes::<V>::constant(0.0); SPHERE_ROW];
        for k in 0..SPHERE_ROW {
            lanes[k] = SimdLanes::read(&numbers[k]);
        }
        SphereRow::from_numbers(&lanes)
    }
}

impl<T: StoredLanes> LaneGroup<T> {
    /// Sets the coefficients of loads due to the motion of the other particle.
    #[inline(always)]
    fn set<V: Width<f64>>(&mut self, side: &SphereRow<SimdLanes<V>>) {
        T::store(side.ya[1], &mut self.ya);
        T::store(side.xa[1] - side.ya[1], &mut self.axial_excess);
        T::store(side.yc[1], &mut self.yc);
        T::store(side.xc[1] - side.yc[1], &mut self.spin_excess);
        T::store(side.yb[1], &mut self.yb[0]);
        T::store(side.yb_other, &mut self.yb[1]);
    }
}

impl<T: StoredLanes> MomentGroup<T> {
    /// Sets the coefficients of the first moments.
    #[inline(always)]
    fn set<V: Width<f64>>(&mut self, side: &SphereRow<SimdLanes<V>>) {
        for (both, to) in [(side.xg, &mut self.xg), (side.yg, &mut self.yg), (side.yh, &mut self.yh)] {
            T::store(both[0], &mut to[0]);
            T::store(both[1], &mut to[1]);
        }
    }
}
