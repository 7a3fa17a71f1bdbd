//! The 22 x 22 resistance matrix of a pair, in blocks by azimuthal order about the line of centres.

use std::f64::consts::PI;

use crate::dense::{Square, product, transpose};
use crate::two_sphere::{Function, ResistanceFunctions};

/// Resistance of a pair over viscosity: loads of both spheres on the fluid against their motions.
///
/// With `d = e_z` from sphere 1 to sphere 2, the motions are, by block: `(U_z, e)`, `Omega_z`, `(U_x, Omega_y, e)`
/// and `e`, each for sphere 1 then sphere 2, and loads are their conjugates. Rates of strain are components along
/// unit tensors, `sqrt(3/2) (dd - 1/3)`, `(dx + xd)/sqrt 2` and `(xx - yy)/sqrt 2`, so that power is the plain
/// product of loads and motions and every block is symmetric.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ResistanceBlocks {
    /// `(U1, U2, e1, e2)` along the line of centres.
    pub axial: Square<4>,
    /// `(Omega1, Omega2)` along the line of centres.
    pub spin: Square<2>,
    /// `(U1, U2, Omega1, Omega2, e1, e2)` normal to the line of centres; twice, for `x` and for `y`.
    pub transverse: Square<6>,
    /// `(e1, e2)` in the normal plane; twice.
    pub planar: Square<2>,
}

impl ResistanceBlocks {
    /// Exact resistance from its scalar functions.
    pub fn exact(functions: &ResistanceFunctions, radii: [f64; 2]) -> Self {
        let part = |function: Function, power: i32, factor: f64| -> Square<2> {
            let value =
                |i: usize, j: usize| factor * PI * (radii[i] + radii[j]).powi(power) * functions[function][i][j];
            [0, 1].map(|i| [0, 1].map(|j| value(i, j)))
        };
        let mut axial = [[0.0; 4]; 4];
        place(&mut axial, 0, 0, part(Function::XA, 1, 3.0));
        place(&mut axial, 2, 0, part(Function::XG, 2, (2.0_f64 / 3.0).sqrt()));
        place(&mut axial, 2, 2, part(Function::XM, 3, 5.0 / 6.0));
        let mut transverse = [[0.0; 6]; 6];
        place(&mut transverse, 0, 0, part(Function::YA, 1, 3.0));
        place(&mut transverse, 2, 0, part(Function::YB, 2, -1.0));
        place(&mut transverse, 2, 2, part(Function::YC, 3, 1.0));
        place(&mut transverse, 4, 0, part(Function::YG, 2, 2.0_f64.sqrt()));
        place(&mut transverse, 4, 2, part(Function::YH, 3, 2.0_f64.sqrt()));
        place(&mut transverse, 4, 4, part(Function::YM, 3, 5.0 / 6.0));
        Self { axial, spin: part(Function::XC, 3, 1.0), transverse, planar: part(Function::ZM, 3, 5.0 / 6.0) }
    }
}

/// Writes a 2 x 2 part, and its transpose across the diagonal, into a symmetric block.
pub fn place<const N: usize>(block: &mut Square<N>, row: usize, column: usize, part: Square<2>) {
    for i in 0..2 {
        for j in 0..2 {
            block[row + i][column + j] = part[i][j];
            block[column + j][row + i] = part[i][j];
        }
    }
}

/// A 2 x 2 part of a block.
pub fn part<const N: usize>(block: &Square<N>, row: usize, column: usize) -> Square<2> {
    [0, 1].map(|i| [0, 1].map(|j| block[row + i][column + j]))
}

/// Transformation to the axial motions `(U1, U2, e1, e2)` from `(c, w, e1, e2)`: `c = (a1 U1 + a2 U2)/(a1 + a2)` is
/// the mean velocity and `-w` the approach velocity of the facing surfaces,
/// `w = U2 - U1 - sqrt(2/3) (a1 e1 + a2 e2)`.
///
/// In these coordinates only the entry of `w` diverges with the inverse gap, and nothing cancels.
pub fn from_gap_coordinates(radii: [f64; 2]) -> Square<4> {
    let [first, second] = radii.map(|a| a / (radii[0] + radii[1]));
    let [p, q] = radii.map(|a| a * (2.0_f64 / 3.0).sqrt());
    [
        [1.0, -second, -second * p, -second * q],
        [1.0, first, first * p, first * q],
        [0.0, 0.0, 1.0, 0.0],
        [0.0, 0.0, 0.0, 1.0],
    ]
}

/// Transformation to the axial motions `(U, e)` of a sphere of radius 1 at a fixed wall from `(w, e)`:
/// `w = -U - sqrt(2/3) e` is the separation velocity of the facing surfaces, as in [`from_gap_coordinates`].
pub fn from_pole_coordinates() -> Square<2> {
    [[-1.0, -(2.0_f64 / 3.0).sqrt()], [0.0, 1.0]]
}

/// Resistance in other coordinates, `T^T R T` if the motions are `T` times the new ones.
pub fn change<const N: usize>(block: &Square<N>, from: &Square<N>) -> Square<N> {
    product(&transpose(from), &product(block, from))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dense::eigen;
    use crate::two_sphere::TwoSphere;

    #[test]
    fn exact_resistance_is_positive_definite() {
        for ratio in [1.0, 2.5, 4.0, 10.0] {
            let table = TwoSphere::with_ratio(ratio).unwrap();
            for gap in [1e-5, 1e-3, 0.1, 1.0, 10.0, 1e3] {
                let exact = ResistanceBlocks::exact(&table.at(gap), [1.0, ratio]);
                let axial = change(&exact.axial, &from_gap_coordinates([1.0, ratio]));
                let smallest = |values: &[f64]| values.iter().copied().fold(f64::INFINITY, f64::min);
                let axial = smallest(&eigen(axial).0).min(smallest(&eigen(exact.spin).0));
                let other = smallest(&eigen(exact.transverse).0).min(smallest(&eigen(exact.planar).0));
                // Apart from collective motions, the smallest drag is that of the small sphere alone, at least 6 pi.
                assert!(axial > 1.0 && other > 1.0, "ratio {ratio} gap {gap}: {axial} {other}");
            }
        }
    }
}
