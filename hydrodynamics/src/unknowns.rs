//! Unknowns and residual of the coupled system.

use crate::pairs::search::{NearPairs, Pairs};
use crate::six_vector::{SixVector, SixVectors, dot};
use domain::Traceless;
use domain::parallel::FusedLoops;
use fcm::Linear;

/// Motions of a rank's particles, and the loads of a set of near pairs in these motions.
#[derive(Debug, Clone, Default)]
pub struct MotionsWithLoads {
    /// `y`
    pub motions: SixVectors,
    /// `R y`
    pub loads: SixVectors,
}

/// Unknowns of the system: minus the motions in the loads of stiff pairs and of soft pairs, and the first moments
/// `D = -S`. Only the sum of the pair loads of the solution and of its start matters; it may be kept in either.
#[derive(Debug, Default)]
pub struct Unknowns {
    /// `y_s`
    pub stiff: MotionsWithLoads,
    /// `y_f`
    pub soft: MotionsWithLoads,
    /// `D`
    pub moments: Vec<Traceless>,
}

/// Residual: mismatch between the motions of the particles and of the fluid, and strain rates within the particles.
#[derive(Debug, Clone, Default)]
pub struct Residual {
    pub stiff: SixVectors,
    pub soft: SixVectors,
    pub strain_rates: Vec<Traceless>,
}

impl Clone for Unknowns {
    fn clone(&self) -> Self {
        let mut copy = Self::default();
        let mut loops = FusedLoops::default();
        loops.copied(&mut copy.stiff.motions.0, &self.stiff.motions.0);
        loops.copied(&mut copy.stiff.loads.0, &self.stiff.loads.0);
        loops.copied(&mut copy.soft.motions.0, &self.soft.motions.0);
        loops.copied(&mut copy.soft.loads.0, &self.soft.loads.0);
        loops.copied(&mut copy.moments, &self.moments);
        loops.run();
        copy
    }
}

impl Linear for Unknowns {
    fn add(&mut self, factor: f64, other: &Self) {
        let mut loops = FusedLoops::default();
        self.change_in(&mut loops, other, move |a, b| *a += factor * b);
        loops.run();
    }

    fn scale_add(&mut self, factor: f64, other: &Self) {
        let mut loops = FusedLoops::default();
        self.change_in(&mut loops, other, move |a, b| *a = b + factor * *a);
        loops.run();
    }
}

impl Linear for Residual {
    fn add(&mut self, factor: f64, other: &Self) {
        self.stiff.add(factor, &other.stiff);
        self.soft.add(factor, &other.soft);
        self.strain_rates.add(factor, &other.strain_rates);
    }

    fn scale_add(&mut self, factor: f64, other: &Self) {
        self.stiff.scale_add(factor, &other.stiff);
        self.soft.scale_add(factor, &other.soft);
        self.strain_rates.scale_add(factor, &other.strain_rates);
    }
}

impl Unknowns {
    /// The unknowns for motions and the loads of all near pairs in these motions.
    pub fn of(motions: &SixVectors, resisted: &SixVectors, moments: Vec<Traceless>) -> Self {
        let mut made = Self { moments, ..Self::default() };
        let mut loops = FusedLoops::default();
        loops.mapped(&mut made.stiff.motions.0, &motions.0, |&motion| -motion);
        loops.mapped(&mut made.stiff.loads.0, &resisted.0, |&load| -load);
        loops.mapped(&mut made.soft.motions.0, &motions.0, |&motion| -motion);
        loops.mapped(&mut made.soft.loads.0, &motions.0, |_| SixVector::default());
        loops.run();
        made
    }

    /// Lubrication load on the far field of a particle.
    pub fn load(&self, row: usize) -> SixVector {
        self.stiff.loads.0[row] + self.soft.loads.0[row]
    }

    /// Changes each number by that of other unknowns, as one of several loops.
    pub fn change_in<'a>(
        &'a mut self,
        loops: &mut FusedLoops<'a>,
        other: &'a Self,
        change: impl Fn(&mut f64, &f64) + Copy + Sync + 'a,
    ) {
        let Self { stiff, soft, moments } = self;
        loops.change(stiff.motions.components_mut(), other.stiff.motions.components(), change);
        loops.change(stiff.loads.components_mut(), other.stiff.loads.components(), change);
        loops.change(soft.motions.components_mut(), other.soft.motions.components(), change);
        loops.change(soft.loads.components_mut(), other.soft.loads.components(), change);
        loops.change(bytemuck::cast_slice_mut(moments), bytemuck::cast_slice(&other.moments), change);
    }
}

impl Residual {
    /// This rank's part of the inner product with unknowns, as three of several loops, whose sum it is.
    pub fn product_in<'a>(
        &'a self,
        loops: &mut FusedLoops<'a>,
        x: &'a Unknowns,
        [stiff, soft, strained]: [&'a mut f64; 3],
    ) {
        self.stiff.dot_in(loops, &x.stiff.loads, stiff);
        self.soft.dot_in(loops, &x.soft.loads, soft);
        let of_sphere = move |k: usize| self.strain_rates[k].contract(x.moments[k]);
        loops.sum(strained, x.moments.len(), move |rows| rows.map(of_sphere).sum());
    }
}

/// Adds a multiple of six-vectors, and returns the inner product with others.
pub fn add_and_dot(rows: &mut [SixVector], factor: f64, added: &[SixVector], others: &[SixVector]) -> f64 {
    for (row, by) in rows.iter_mut().zip(added) {
        (0..6).for_each(|k| row.0[k] += factor * by.0[k]);
    }
    dot(rows, others)
}

/// Motions with the loads of a set of near pairs. Collective.
pub fn resisted(near: &NearPairs, pairs: Pairs, motions: &SixVectors) -> MotionsWithLoads {
    MotionsWithLoads { loads: near.times(&[pairs], motions), motions: motions.clone() }
}
