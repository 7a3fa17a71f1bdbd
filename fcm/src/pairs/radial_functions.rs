//! Pair functions of particles of several radii: tables for few radii, closed forms for many.

use crate::envelope::{Common, Envelope};
use crate::pairs::table::{PairFunctions, PairTable, PairValues};
use solver::Real;

/// Number of radii above which tables for all pairs of them cost more than they save.
pub(crate) const MOST_TABULATED: usize = 8;

/// Envelopes by class of radius, and the pair functions between two of them.
pub(crate) struct Envelopes {
    pub all: Vec<Envelope>,
    pub common: Common,
    /// [`PairFunctions::new`], or those of other loads.
    pub functions: fn(Envelope, Envelope, Common) -> PairFunctions,
}

impl Envelopes {
    fn pair(&self, i: usize, j: usize) -> PairFunctions {
        (self.functions)(self.all[i], self.all[j], self.common)
    }
}

/// Pair functions by classes of radii.
pub(crate) enum RadialFunctions<T> {
    Tabulated { classes: usize, tables: Vec<PairTable<T>>, alone: Vec<PairValues> },
    Exact(Envelopes),
}

impl<T: Real> RadialFunctions<T> {
    /// For distances up to a cutoff; tables are exact to `tolerance`.
    pub fn new(envelopes: Envelopes, cutoff: f64, tolerance: f64) -> Self {
        let classes = envelopes.all.len();
        let table = |at: usize| PairTable::new(&envelopes.pair(at / classes, at % classes), cutoff, tolerance);
        let tables: Option<Vec<_>> =
            if classes > MOST_TABULATED { None } else { (0..classes * classes).map(table).collect() };
        let Some(tables) = tables else { return Self::Exact(envelopes) };
        let alone = (0..classes).map(|class| envelopes.pair(class, class).exact(0.0)).collect();
        Self::Tabulated { classes, tables, alone }
    }

    /// Functions of two classes at a squared distance.
    #[inline(always)]
    pub fn of_pair(&self, i: u32, j: u32, square: f64) -> [T; 9] {
        match self {
            Self::Tabulated { classes, tables, .. } => tables[i as usize * classes + j as usize].evaluate(square),
            Self::Exact(envelopes) => {
                let (mut values, exact) = ([T::default(); 9], exact(envelopes, [i, j], square));
                for f in 0..9 {
                    values[f] = T::from_f64(exact[f]);
                }
                values
            }
        }
    }

    /// Functions of a particle and itself.
    pub fn of_one(&self, i: u32) -> PairValues {
        match self {
            Self::Tabulated { alone, .. } => alone[i as usize],
            Self::Exact(envelopes) => exact(envelopes, [i, i], 0.0),
        }
    }
}

#[inline(never)]
fn exact(envelopes: &Envelopes, [i, j]: [u32; 2], square: f64) -> PairValues {
    envelopes.pair(i as usize, j as usize).exact(square)
}
