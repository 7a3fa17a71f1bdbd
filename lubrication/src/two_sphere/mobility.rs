//! Mobility functions from resistance functions.

use std::f64::consts::PI;

use super::functions::{Function, MobilityFunctions, Pairwise, ResistanceFunctions};
use crate::dense::{Square, inverse, product, transpose};
use crate::two_sphere::blocks::{ResistanceBlocks, change, from_gap_coordinates, part};

/// Mobility functions for radii 1 and `ratio`.
///
/// Loads are given, and `E` is the ambient strain: with `R` the resistance of motions `(U, Omega)` and `G`, `M` those
/// of the stresslets, `U = R^-1 F + (G R^-1)^T E` and `S = G R^-1 F - (M - G R^-1 G^T) E`, where `S` is the moment of
/// the loads on the fluid.
pub fn mobility(resistance: &ResistanceFunctions, ratio: f64) -> MobilityFunctions {
    let blocks = ResistanceBlocks::exact(resistance, [1.0, ratio]);
    let hat = |part: Square<2>, power: i32, factor: f64| -> Pairwise {
        let radii = [1.0, ratio];
        [0, 1].map(|i| [0, 1].map(|j| part[i][j] * factor * (radii[i] + radii[j]).powi(power)))
    };
    let (xa, xg, xm) = axial(&blocks.axial, [1.0, ratio]);
    let (motions, stresslets, ym) = transverse(&blocks.transverse);
    let mut functions = [Pairwise::default(); 11];
    let mut set = |function: Function, value: Pairwise| functions[function as usize] = value;
    set(Function::XA, hat(xa, 1, 3.0 * PI));
    set(Function::XG, hat(xg, -1, 2.0 * 1.5_f64.sqrt()));
    set(Function::XM, hat(xm, -3, 1.2 / PI));
    set(Function::XC, hat(inverse(blocks.spin), 3, PI));
    set(Function::YA, hat(part(&motions, 0, 0), 1, 3.0 * PI));
    set(Function::YB, hat(part(&motions, 2, 0), 2, -PI));
    set(Function::YC, hat(part(&motions, 2, 2), 3, PI));
    set(Function::YG, hat([0, 1].map(|i| [stresslets[i][0], stresslets[i][1]]), -1, 2.0_f64.sqrt()));
    set(Function::YH, hat([0, 1].map(|i| [stresslets[i][2], stresslets[i][3]]), 0, 0.5_f64.sqrt()));
    set(Function::YM, hat(ym, -3, 1.2 / PI));
    set(Function::ZM, hat(blocks.planar, -3, 1.2 / PI));
    MobilityFunctions(functions)
}

/// Velocities from forces, stresslets from forces, and stresslets from strains, by elimination in gap coordinates.
fn axial(block: &Square<4>, radii: [f64; 2]) -> (Square<2>, Square<2>, Square<2>) {
    let from = from_gap_coordinates(radii);
    let block = change(block, &from);
    let (velocities, strains) = (part(&from, 0, 0), part(&from, 0, 2));
    let motions = inverse(part(&block, 0, 0));
    let coupling = part(&block, 2, 0);
    let stresslets = product(&coupling, &motions);
    let reduced = product(&stresslets, &transpose(&coupling));
    (
        product(&velocities, &product(&motions, &transpose(&velocities))),
        difference(product(&stresslets, &transpose(&velocities)), transpose(&strains)),
        difference(part(&block, 2, 2), reduced),
    )
}

fn transverse(block: &Square<6>) -> (Square<4>, [[f64; 4]; 2], Square<2>) {
    let motions: Square<4> = inverse(std::array::from_fn(|i| std::array::from_fn(|j| block[i][j])));
    let coupling: [[f64; 4]; 2] = [4, 5].map(|i| std::array::from_fn(|j| block[i][j]));
    let stresslets = product(&coupling, &motions);
    let reduced = product(&stresslets, &transpose(&coupling));
    (motions, stresslets, difference(part(block, 4, 4), reduced))
}

fn difference(a: Square<2>, b: Square<2>) -> Square<2> {
    [0, 1].map(|i| [0, 1].map(|j| a[i][j] - b[i][j]))
}
