//! Lubrication loads of near pairs by the slip of squirmers.

use crate::bodies::present::PresentBodies;
use crate::pairs::lubrication::PairLubrication;
use crate::pairs::matrix::lanes::{LANES, SimdLanes, transpose};
use crate::pairs::search::{NearField, NearPairs};
use crate::pairs::walls;
use crate::six_vector::SixVector;
use crate::squirming::Squirming;
use domain::parallel::{change, in_blocks, of_rows};
use domain::{Neighbour, Neighbours, PeriodicBox, Vector};
use lubrication::{Arithmetic, LOADS, SLIP_NUMBERS, SLIP_ROW, SlipForce, SlipRow, SphereLoads, SurfaceSlip};
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

/// Number of particles whose loads one thread computes at a time.
const ROWS: usize = 64;

impl SlippingPairs<'_> {
    /// Loads of the first `count` spheres on the fluid by the slip of their near pairs. Within a body they are as much
    /// less as lubrication is.
    pub fn loads(&self, count: usize) -> Vec<SphereLoads> {
        let of_rows = |first: usize, loads: &mut [SphereLoads]| f64::dispatch(RowLoads { pairs: self, first, loads });
        in_blocks(count, ROWS, of_rows).0
    }

    /// Loads of a sphere, summed over its neighbours in lanes.
    #[inline(always)]
    fn loads_of<V: Width<f64>>(&self, row: usize) -> SphereLoads {
        let mut own = [SimdLanes::<V>::constant(0.0); SLIP_NUMBERS];
        for (lanes, number) in own.iter_mut().zip(self.slips[row].numbers()) {
            *lanes = SimdLanes::constant(number);
        }
        let (mut packed, mut sums) = (PackedSlips::empty(), [SimdLanes::<V>::constant(0.0); LOADS]);
        for neighbour in self.neighbours.of(row).iter() {
            self.pack::<V>(row, neighbour, &mut packed);
            if packed.count == LANES {
                packed.add_loads(&own, &mut sums);
            }
        }
        if packed.count > 0 {
            packed.add_loads(&own, &mut sums);
        }
        let mut totals = [0.0; LOADS];
        for (total, lanes) in totals.iter_mut().zip(&sums) {
            let mut numbers = [0.0; LANES];
            lanes.write(&mut numbers);
            *total = numbers.iter().sum();
        }
        SphereLoads::from_numbers(&totals)
    }

    /// Packs the pair of a sphere and a neighbour of its list, if they are within the cutoff.
    #[inline(always)]
    fn pack<V: Width<f64>>(&self, row: usize, neighbour: Neighbour, packed: &mut PackedSlips) {
        let (other, force, lane) = (neighbour.row as usize, &self.lubrication.force, packed.count);
        let (separation, species) = (self.separation(row, neighbour), [self.species[row], self.species[other]]);
        let distance = separation.length();
        let record = &mut packed.records[lane];
        if !self.slip.write::<SimdLanes<V>>(force, distance, species, record) {
            return;
        }
        if let Some(bodies) = self.bodies {
            let radii = species.map(|s| force.radii()[s as usize]);
            let share = bodies.share([row, other], separation, radii).unwrap_or(1.0);
            record[SlipRow::<f64>::FACTORS].iter_mut().for_each(|factor| *factor *= share);
        }
        for (lanes, component) in packed.axis.iter_mut().zip((separation / distance).to_array()) {
            lanes[lane] = component;
        }
        packed.slips[lane] = self.slips[other].numbers();
        packed.count += 1;
    }

    /// Separation of a sphere and a neighbour of its list.
    #[inline(always)]
    fn separation(&self, row: usize, neighbour: Neighbour) -> Vector {
        let apart = self.positions[neighbour.row as usize] - self.positions[row];
        if neighbour.steps == [0; 3] { apart } else { apart + self.cell.lattice(neighbour.steps.map(i32::from)) }
    }
}

/// Pairs of one sphere, one per lane.
struct PackedSlips {
    /// Numbers of [`SlipRow`].
    records: [[f64; SLIP_ROW]; LANES],
    /// Slip of the others.
    slips: [[f64; SLIP_NUMBERS]; LANES],
    axis: [[f64; LANES]; 3],
    count: usize,
}

impl PackedSlips {
    #[inline(always)]
    fn empty() -> Self {
        Self {
            records: [[0.0; SLIP_ROW]; LANES],
            slips: [[0.0; SLIP_NUMBERS]; LANES],
            axis: [[0.0; LANES]; 3],
            count: 0,
        }
    }

    /// Adds the loads by the packed pairs, and removes these.
    #[inline(always)]
    fn add_loads<V: Width<f64>>(&mut self, own: &[SimdLanes<V>; SLIP_NUMBERS], sums: &mut [SimdLanes<V>; LOADS]) {
        for record in &mut self.records[self.count..] {
            record[SlipRow::<f64>::FACTORS].fill(0.0);
        }
        self.count = 0;
        let mut numbers = [[0.0; LANES]; SLIP_ROW];
        for (k, lanes) in numbers.as_chunks_mut::<LANES>().0.iter_mut().enumerate() {
            transpose::<V, SLIP_ROW>(&self.records, k * LANES, lanes);
        }
        let mut slips = [[0.0; LANES]; SLIP_NUMBERS];
        transpose::<V, SLIP_NUMBERS>(&self.slips, 0, &mut slips);
        let (mut record, mut others) = ([SimdLanes::<V>::constant(0.0); SLIP_ROW], *own);
        for k in 0..SLIP_ROW {
            record[k] = SimdLanes::read(&numbers[k]);
        }
        for k in 0..SLIP_NUMBERS {
            others[k] = SimdLanes::read(&slips[k]);
        }
        let axis = [SimdLanes::read(&self.axis[0]), SimdLanes::read(&self.axis[1]), SimdLanes::read(&self.axis[2])];
        let loads = SlipRow::from_numbers(&record).loads(axis, &[*own, others]);
        for k in 0..LOADS {
            sums[k] = sums[k] + loads[k];
        }
    }
}

impl NearPairs {
    /// Adds the lubrication loads by the slip of squirmers, in the units of the pairs. Collective.
    pub fn add_slip(&mut self, field: &NearField, squirming: &Squirming) {
        let Some(lubrication) = &field.lubrication else { return };
        let (owned, halo) = (self.moments.len(), &self.around.halo);
        let mut first = of_rows(owned, |row| squirming.first_of(row));
        let mut second = of_rows(owned, |row| squirming.second_of(row));
        halo.extend(&mut first);
        halo.extend(&mut second);
        let slips = of_rows(first.len(), |row| SurfaceSlip { first: first[row], second: second[row] });
        let pairs = SlippingPairs {
            lubrication,
            slip: lubrication.slip(),
            cell: &self.around.cell,
            positions: &self.around.positions,
            species: &self.around.species,
            bodies: self.bodies.as_ref(),
            neighbours: field.lists.neighbours(),
            slips: &slips,
        };
        let mut loads = pairs.loads(owned);
        if let Some(force) = &field.at_walls {
            let radius = |row: usize| field.radii[self.around.species[row] as usize];
            walls::add_slip_loads(&mut loads, &self.at_walls, force, radius, &slips);
        }
        // As those in the ambient strain, the loads are kept as known loads of the far field: with the opposite sign.
        change(&mut self.loads.0, &loads, |sum, by| *sum += SixVector::new(-by.force, -by.torque));
        change(&mut self.moments, &loads, |sum, by| *sum += -by.moment);
        self.has_slip = true;
    }
}

/// Loads of the spheres from `first` on, see [`SlippingPairs::loads`].
struct RowLoads<'a> {
    pairs: &'a SlippingPairs<'a>,
    first: usize,
    loads: &'a mut [SphereLoads],
}

impl VectorKernel<f64> for RowLoads<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Width<f64>>(self) {
        for (k, loads) in self.loads.iter_mut().enumerate() {
            *loads = self.pairs.loads_of::<V>(self.first + k);
        }
    }
}
