//! Lattices that are stretched for ever.

use crate::model::Extension;
use domain::{PeriodicBox, Vector};

/// Whole numbers, row by row.
pub type Matrix = [[i32; 3]; 3];

const IDENTITY: Matrix = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];

/// A vector is exchanged for one whose square is less by more than this part of it.
const ROUND_OFF: f64 = 1e-12;

/// The lattice of a box in an extension, `H(strain) = D(strain) H`, with `D` the stretch and `H` as columns the vectors
/// without strain. After a period `p` of the strain it is the first one again, and its vectors are other ones by whole
/// numbers `M`,
///
/// ```text
/// D(p) H = H M,        H(strain) M^-n = D(strain - n p) H
/// ```
///
/// so that it is known at any strain from one of `|strain| <= p/2`, where its shortest vectors are easily found. Its box has
/// these, the shortest first. The period of planar extension is `ln((3 + sqrt(5)) / 2)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StretchingLattice {
    kind: Extension,
    vectors: [Vector; 3],
}

/// Which vectors of the lattice the box has: those of `H(strain) M^-periods` times these columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Named {
    periods: i64,
    columns: Matrix,
}

impl StretchingLattice {
    /// The largest strain of its box, in its own axes: half a vector along the first over the second edge, which is no less than
    /// the first.
    pub const LARGEST_STRAIN: f64 = 0.5;

    /// The lattice of a box that an extension makes without strain.
    pub fn new(kind: Extension, start: &PeriodicBox) -> Self {
        Self { kind, vectors: start.lattice_vectors() }
    }

    /// The extension.
    pub fn kind(&self) -> Extension {
        self.kind
    }

    /// The box at a strain, and which vectors it has.
    pub fn at(&self, strain: f64) -> (PeriodicBox, Named) {
        let period = self.period();
        let periods = (strain / period + 0.5).floor();
        let stretch = self.kind.stretch(strain - periods * period);
        let vectors = self.vectors.map(|vector| stretch * vector);
        let rows = reduced(&vectors);
        let cell = PeriodicBox::of_lattice(rows.map(|row| combined(&vectors, row)));
        let columns = std::array::from_fn(|i| std::array::from_fn(|j| rows[j][i]));
        (cell.expect("a lattice keeps its volume"), Named { periods: periods as i64, columns })
    }

    /// By what lattice steps along the vectors of a box are to be multiplied where other vectors take their place: with `B s =
    /// B' s'`, `s' = columns'^-1 M^(periods' - periods) columns s`.
    pub fn renamed(&self, before: &Named, now: &Named) -> Matrix {
        let periods = now.periods - before.periods;
        let once = if periods < 0 { inverse(&self.automorphism()) } else { self.automorphism() };
        let passed = (0..periods.abs()).fold(IDENTITY, |product, _| times(&once, &product));
        times(&inverse(&now.columns), &times(&passed, &before.columns))
    }

    /// The strain `p`.
    fn period(&self) -> f64 {
        match self.kind {
            Extension::Planar => (0.5 * (3.0 + 5.0_f64.sqrt())).ln(),
        }
    }

    /// `M`
    fn automorphism(&self) -> Matrix {
        match self.kind {
            Extension::Planar => [[2, -1, 0], [-1, 1, 0], [0, 0, 1]],
        }
    }
}

/// Sum of vectors by whole numbers.
fn combined(vectors: &[Vector; 3], numbers: [i32; 3]) -> Vector {
    vectors.iter().zip(numbers).map(|(&vector, number)| vector * f64::from(number)).sum()
}

/// Numbers, vector by vector, of the two shortest vectors of the lattice of the first two, the shorter first (Gauss): of all
/// others in their plane none is shorter. They are in right-handed order, and the third stays.
fn reduced(vectors: &[Vector; 3]) -> Matrix {
    let [mut short, mut long, third] = IDENTITY;
    loop {
        let [by, vector] = [short, long].map(|row| combined(vectors, row));
        let times = (by.dot(vector) / by.length_squared()).round() as i32;
        let rest = std::array::from_fn(|d| long[d] - times * short[d]);
        if combined(vectors, rest).length_squared() < vector.length_squared() * (1.0 - ROUND_OFF) {
            long = rest;
        }
        if combined(vectors, long).length_squared() >= by.length_squared() * (1.0 - ROUND_OFF) {
            return [short, long, third];
        }
        // A quarter of a turn keeps the order.
        (short, long) = (long, short.map(|number| -number));
    }
}

/// The product of two matrices, modulo `2^32`.
fn times(a: &Matrix, b: &Matrix) -> Matrix {
    let entry = |i: usize, j: usize| (0..3).fold(0, |sum: i32, k| sum.wrapping_add(a[i][k].wrapping_mul(b[k][j])));
    std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
}

/// The inverse of a matrix of determinant 1, modulo `2^32`.
fn inverse(m: &Matrix) -> Matrix {
    let product = |a: [usize; 2], b: [usize; 2]| m[a[0]][a[1]].wrapping_mul(m[b[0]][b[1]]);
    let cofactor = |i: usize, j: usize| {
        let [a, b, c, d] = [(i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3];
        product([a, c], [b, d]).wrapping_sub(product([a, d], [b, c]))
    };
    std::array::from_fn(|i| std::array::from_fn(|j| cofactor(j, i)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use domain::Tensor;

    fn lattice() -> StretchingLattice {
        StretchingLattice::new(Extension::Planar, &Extension::Planar.cell(Vector::new(1.0, 1.0, 2.0)).unwrap())
    }

    /// Up to strains where round-off, which the flow stretches too, reaches a thousandth.
    #[test]
    fn the_lattice_is_the_stretched_one() {
        let lattice = lattice();
        for k in -300..=300 {
            let strain = 0.04 * f64::from(k) + 0.001;
            let stretch = Extension::Planar.stretch(strain);
            let basis = Tensor::from_cols_array_2d(&lattice.vectors.map(|v| (stretch * v).to_array()));
            for vector in lattice.at(strain).0.lattice_vectors() {
                let numbers = basis.inverse() * vector;
                let off = (numbers - numbers.round()).abs().max_element();
                assert!(off < 1e-14 * stretch.max_element().powi(2) && off < 1e-3, "at {strain}: {numbers}");
            }
        }
    }

    /// Whatever the strain: the box has the edges that are planned for, and all of their range.
    #[test]
    fn the_box_never_degenerates() {
        let (lattice, (longest, contraction)) = (lattice(), Extension::Planar.extremes());
        let longest = longest * Vector::new(1.0, 1.0, 2.0);
        let (mut most, mut least, mut largest) = (Vector::ZERO, Vector::splat(9.0), 0.0_f64);
        for k in 0..60_000 {
            let (cell, _) = lattice.at(0.007 * f64::from(k) - 170.0);
            (most, least) = (most.max(cell.edges()), least.min(cell.edges()));
            largest = largest.max(cell.strain().abs());
            assert!(cell.is_upright() && (cell.volume() - 2.0).abs() < 1e-13);
        }
        assert!((most - longest).abs().max_element() < 1e-3 && most.cmple(longest + 1e-12).all(), "{most}");
        let shortest = Vector::new(contraction, 1.0, 2.0);
        assert!((least - shortest).abs().max_element() < 1e-3 && least.cmpge(shortest - 1e-12).all(), "{least}");
        assert!(largest <= StretchingLattice::LARGEST_STRAIN + 1e-9, "{largest}");
    }

    #[test]
    fn steps_lead_to_the_same_places_by_other_vectors() {
        let lattice = lattice();
        let (mut before, mut steps, mut renamed) = (lattice.at(-3.0), [2, -1, 3], 0);
        for k in 1..400 {
            let strain = -3.0 + 0.015 * f64::from(k);
            let now = lattice.at(strain);
            let there = Extension::Planar.stretch(0.015) * before.0.lattice(steps);
            renamed += i32::from(before.1 != now.1);
            let matrix = lattice.renamed(&before.1, &now.1);
            steps = matrix.map(|row| row.iter().zip(steps).map(|(m, s)| m * s).sum());
            let off = (now.0.lattice(steps) - there).length();
            assert!(off < 1e-12 * there.length().max(1.0), "at {strain}: {steps:?}");
            before = now;
        }
        assert!(renamed > 10, "{renamed}");
        assert_eq!(times(&lattice.automorphism(), &inverse(&lattice.automorphism())), IDENTITY);
    }
}
