//! The coefficients of pairs as their rows see them.

use super::lanes::Lanes;
use super::pair_matrix::{Group, MomentGroup};
use lubrication::{Arithmetic, Coefficients};
use solver::simd::Vector as Width;

/// Which of the two spheres of each pair is the row's, by 1 and 0.
pub struct RowView<V> {
    is_larger: Lanes<V>,
    is_smaller: Lanes<V>,
}

impl<V: Width<f64>> RowView<V> {
    /// From 1 where the row's sphere is the larger one, and 0.
    #[inline(always)]
    pub fn new(is_larger: Lanes<V>) -> Self {
        Self { is_larger, is_smaller: Lanes::constant(1.0) - is_larger }
    }

    /// That of the row's sphere.
    #[inline(always)]
    pub fn own(&self, [smaller, larger]: [Lanes<V>; 2]) -> Lanes<V> {
        self.is_smaller * smaller + self.is_larger * larger
    }

    /// The row's sphere feels its own motion.
    #[inline(always)]
    pub fn on_itself(&self, both: [[Lanes<V>; 2]; 2]) -> Lanes<V> {
        self.own([both[0][0], both[1][1]])
    }

    /// The row's sphere feels the motion of the other.
    #[inline(always)]
    pub fn by_other(&self, both: [[Lanes<V>; 2]; 2]) -> Lanes<V> {
        self.own([both[0][1], both[1][0]])
    }

    /// The other sphere feels the motion of the row's.
    #[inline(always)]
    pub fn on_other(&self, both: [[Lanes<V>; 2]; 2]) -> Lanes<V> {
        self.own([both[1][0], both[0][1]])
    }
}

impl Group {
    /// Sets what the motion of the others makes of loads.
    #[inline(always)]
    pub fn set<V: Width<f64>>(&mut self, c: &Coefficients<Lanes<V>>, view: &RowView<V>) {
        c.across[0][1].write(&mut self.across);
        (c.along[0][1] - c.across[0][1]).write(&mut self.along);
        c.roll[0][1].write(&mut self.roll);
        (c.spin[0][1] - c.roll[0][1]).write(&mut self.spin);
        view.by_other(c.coupling).write(&mut self.coupling[0]);
        view.on_other(c.coupling).write(&mut self.coupling[1]);
    }
}

impl MomentGroup {
    /// Sets the first moments.
    #[inline(always)]
    pub fn set<V: Width<f64>>(&mut self, c: &Coefficients<Lanes<V>>, view: &RowView<V>) {
        for (both, to) in [(c.pull, &mut self.pull), (c.drag, &mut self.drag), (c.turn, &mut self.turn)] {
            view.on_itself(both).write(&mut to[0]);
            view.by_other(both).write(&mut to[1]);
        }
    }
}
