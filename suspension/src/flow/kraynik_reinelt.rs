//! Lattices in unbounded extension.

use crate::model::{CubicField, Extension};
use domain::{PeriodicBox, Tensor, Vector};
use std::f64::consts::TAU;

/// Integer matrix, row by row.
pub type Matrix = [[i32; 3]; 3];

const IDENTITY: Matrix = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];

/// Relative decrease of the square of a vector below which it is not replaced by another.
const ROUND_OFF: f64 = 1e-12;

/// The lattice of a box in an extension, `H(strain) = D(strain) H`, with `D` the stretch and `H` the matrix whose
/// columns are the vectors at zero strain. After a period `p` of the strain it repeats up to a rotation `R` about the
/// axis of the flow, with other vectors by an integer matrix `M`,
///
/// ```text
/// D(p) H = R H M,        H(strain) M^-n = D(strain - n p) R^n H
/// ```
///
/// so it is known at any strain from one with `|strain| <= p/2`. There, the shortest vectors in planar extension, where
/// `R = 1` and `p = ln((3 + sqrt(5)) / 2)`, are found by reduction: the box has these, the shortest first. The vectors
/// of a [`CubicField`] change little in its short period and are kept.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StretchingLattice {
    kind: Extension,
    vectors: [Vector; 3],
}

/// Identifies the vectors of a box: those of `H(strain) M^-periods` times these columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Named {
    periods: i64,
    columns: Matrix,
}

impl StretchingLattice {
    /// The lattice of a box made by an extension, at zero strain.
    pub fn new(kind: Extension, start: &PeriodicBox) -> Self {
        Self { kind, vectors: start.lattice_vectors() }
    }

    /// Kind of extension.
    pub fn kind(&self) -> Extension {
        self.kind
    }

    /// The box at a strain, and its vectors.
    pub fn at(&self, strain: f64) -> (PeriodicBox, Named) {
        let period = self.period();
        let periods = (strain / period + 0.5).floor();
        let stretch = self.kind.stretch(strain - periods * period);
        let vectors = self.turned(periods).map(|vector| stretch * vector);
        let rows = if self.kind == Extension::Planar { reduced(&vectors) } else { IDENTITY };
        let cell = PeriodicBox::of_lattice(rows.map(|row| combined(&vectors, row)));
        let columns = std::array::from_fn(|i| std::array::from_fn(|j| rows[j][i]));
        (cell.expect("a lattice keeps its volume"), Named { periods: periods as i64, columns })
    }

    /// Matrix that converts lattice steps when the vectors of the box change: with `B s = B' s'`,
    /// `s' = columns'^-1 M^(periods' - periods) columns s`.
    pub fn renamed(&self, before: &Named, now: &Named) -> Matrix {
        let periods = now.periods - before.periods;
        let once = if periods < 0 { inverse(&self.automorphism()) } else { self.automorphism() };
        let passed = (0..periods.abs()).fold(IDENTITY, |product, _| times(&once, &product));
        times(&inverse(&now.columns), &times(&passed, &before.columns))
    }

    /// The strain `p`; negative if the lattice is followed backwards, as in biaxial extension, which contracts along
    /// its axis.
    fn period(&self) -> f64 {
        match self.kind {
            Extension::Planar => (0.5 * (3.0 + 5.0_f64.sqrt())).ln(),
            Extension::Uniaxial | Extension::Biaxial => CubicField::get().period() / along_axis(self.kind),
        }
    }

    /// `M`
    fn automorphism(&self) -> Matrix {
        match self.kind {
            Extension::Planar => [[2, -1, 0], [-1, 1, 0], [0, 0, 1]],
            // b_0, b_1 and b_-1 become b_1, b_2 = b_0 + b_-1 and b_0.
            Extension::Uniaxial | Extension::Biaxial => [[0, 1, 1], [1, 0, 0], [0, 1, 0]],
        }
    }

    /// `R^n H`, where `R` undoes the rotation by the argument of the complex root, which `D` lacks.
    fn turned(&self, periods: f64) -> [Vector; 3] {
        let axis = match self.kind {
            Extension::Planar => return self.vectors,
            Extension::Uniaxial => Vector::X,
            Extension::Biaxial => Vector::Z,
        };
        let turns = (periods * (CubicField::get().angle() / TAU)).fract();
        let turn = Tensor::from_axis_angle(axis, -turns * TAU);
        self.vectors.map(|vector| turn * vector)
    }
}

/// Rate along the axis of symmetry of a flow.
fn along_axis(kind: Extension) -> f64 {
    kind.axis().map_or(0.0, |axis| kind.rates()[axis as usize])
}

/// Integer combination of vectors.
fn combined(vectors: &[Vector; 3], numbers: [i32; 3]) -> Vector {
    vectors.iter().zip(numbers).map(|(&vector, number)| vector * f64::from(number)).sum()
}

/// Coefficients of the two shortest vectors of the lattice spanned by the first two, the shorter first (Gauss
/// reduction): no other vector in their plane is shorter. They are in right-handed order, and the third vector is
/// unchanged.
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
        // A rotation by a right angle keeps the orientation.
        (short, long) = (long, short.map(|number| -number));
    }
}

/// Matrix product, modulo `2^32`.
fn times(a: &Matrix, b: &Matrix) -> Matrix {
    let entry = |i: usize, j: usize| (0..3).fold(0, |sum: i32, k| sum.wrapping_add(a[i][k].wrapping_mul(b[k][j])));
    std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
}

/// Inverse of a matrix of determinant 1, modulo `2^32`.
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
    use crate::model::Extremes;
    use domain::Random;

    const ALL: [Extension; 3] = [Extension::Planar, Extension::Uniaxial, Extension::Biaxial];

    fn lattice(kind: Extension) -> StretchingLattice {
        let height = if kind == Extension::Planar { 2.0 } else { 1.0 };
        StretchingLattice::new(kind, &kind.cell(Vector::new(1.0, 1.0, height)).unwrap())
    }

    /// Up to strains at which round-off, amplified by the flow, reaches a thousandth.
    #[test]
    fn the_lattice_is_the_stretched_one() {
        for kind in ALL {
            let lattice = lattice(kind);
            for k in -300..=300 {
                let strain = 0.04 * f64::from(k) + 0.001;
                let stretch = kind.stretch(strain);
                let basis = Tensor::from_cols_array_2d(&lattice.vectors.map(|v| (stretch * v).to_array()));
                let allowed = 1e-14 * stretch.max_element() / stretch.min_element();
                for vector in lattice.at(strain).0.lattice_vectors().into_iter().filter(|_| allowed < 1e-3) {
                    let numbers = basis.inverse() * vector;
                    let off = (numbers - numbers.round()).abs().max_element();
                    assert!(off < allowed, "{kind:?} at {strain}: {numbers}");
                }
            }
        }
    }

    /// At any strain: the box stays within the planned edges and tilts, and covers their range.
    #[test]
    fn the_box_never_degenerates() {
        for kind in ALL {
            let (lattice, Extremes { longest, contraction, strain, tilts }) = (lattice(kind), kind.extremes());
            let (start, volume) = (lattice.at(0.0).0.edges(), lattice.at(0.0).0.volume());
            let (mut most, mut least, mut largest) = (Vector::ZERO, Vector::splat(9.0), [0.0_f64; 3]);
            let mut shortest = f64::INFINITY;
            for k in 0..60_000 {
                let (cell, _) = lattice.at(0.007 * f64::from(k) - 170.0);
                (most, least) = (most.max(cell.edges()), least.min(cell.edges()));
                let [t, r] = cell.tilts();
                largest = std::array::from_fn(|i| [cell.strain(), t, r][i].abs().max(largest[i]));
                shortest = cell.lattice_vectors().into_iter().map(Vector::length).fold(shortest, f64::min);
                assert!((cell.volume() - volume).abs() < 1e-13);
            }
            let planned = longest * start;
            assert!(
                (most - planned).abs().max_element() < 1e-3 && most.cmple(planned + 1e-12).all(),
                "{kind:?}: {most}"
            );
            let parts = (least / most).min_element();
            assert!((parts / contraction - 1.0).abs() < 1e-3 && parts > contraction - 1e-12, "{kind:?}: {parts}");
            for (largest, planned) in largest.into_iter().zip([strain, tilts[0], tilts[1]]) {
                // The bound for the square would be reached with two equal edges, which do not occur.
                assert!(largest < planned + 1e-9 && largest >= 0.89 * planned, "{kind:?}: {largest} of {planned}");
            }
            let expected = kind.shortest_vector(&lattice.at(0.0).0);
            assert!((shortest - expected).abs() < 1e-3 && shortest > expected - 1e-12, "{kind:?}: {shortest}");
        }
    }

    #[test]
    fn steps_lead_to_the_same_places_by_other_vectors() {
        for kind in ALL {
            let lattice = lattice(kind);
            let (mut before, mut steps, mut renamed) = (lattice.at(-3.0), [2, -1, 3], 0);
            for k in 1..400 {
                let strain = -3.0 + 0.015 * f64::from(k);
                let now = lattice.at(strain);
                let there = kind.stretch(0.015) * before.0.lattice(steps);
                renamed += i32::from(before.1 != now.1);
                let matrix = lattice.renamed(&before.1, &now.1);
                steps = matrix.map(|row| row.iter().zip(steps).map(|(m, s)| m * s).sum());
                let off = (now.0.lattice(steps) - there).length();
                assert!(off < 1e-12 * there.length().max(1.0), "{kind:?} at {strain}: {steps:?}");
                before = now;
            }
            assert!(renamed > 10, "{kind:?}: {renamed}");
            assert_eq!(times(&lattice.automorphism(), &inverse(&lattice.automorphism())), IDENTITY);
        }
    }

    /// The nearest image of any position is the nearest of all, also at the ends of a period.
    #[test]
    fn nearest_images_are_the_nearest() {
        for kind in ALL {
            for strain in [-0.14, -0.07, 0.0, 0.0702, 0.48] {
                let cell = lattice(kind).at(strain).0;
                for k in 0..200 {
                    let place = cell.position(Random::new(1, k).point() * cell.edges());
                    let range = || -3..=3;
                    let images = range().flat_map(|x| range().flat_map(move |y| range().map(move |z| [x, y, z])));
                    let nearest = images.map(|steps| (place + cell.lattice(steps)).length()).fold(9.0, f64::min);
                    assert!((cell.nearest_image(place).length() - nearest).abs() < 1e-14, "{kind:?} at {strain}");
                }
            }
        }
    }
}
