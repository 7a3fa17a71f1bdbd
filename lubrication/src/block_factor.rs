//! Factors of one pair's lubrication resistance, `R_exact - R_FCM`, with the resistance to motions positive
//! semi-definite.

use std::f64::consts::PI;

use crate::dense::{Square, eigen};
use crate::two_sphere::blocks::{ResistanceBlocks, change, from_gap_coordinates};

/// Negative eigenvalues are smoothed to zero over this fraction of the sum of all eigenvalues of a block.
const SOFTNESS: f64 = 1e-5;
/// Resistance over that of single spheres that is too small to divide by.
const FAINT: f64 = 1e-5;
/// Numbers of a pair in flat form, padded with zeros to whole vectors.
pub const LANES: usize = 40;

/// One block of the resistance: `N` velocities `u` and the rates of strain `e` of the two spheres, or of one, cause
/// the loads
///
/// ```text
/// f = L L^T u + C e,        m = C^T u + M e.
/// ```
///
/// Spheres are rigid, so `e` is known: minus the ambient rate of strain. Only `L L^T` is part of a system of
/// equations, and it is positive semi-definite for any `L`. `C` and `M` are exact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BlockFactor<const N: usize, const K: usize = 2> {
    /// `L`; rows are velocities, columns modes.
    pub factor: Square<N>,
    /// `C`
    pub coupling: [[f64; K]; N],
    /// `M`
    pub strain: Square<K>,
}

/// Blocks of a pair's resistance.
///
/// The axial one is in gap coordinates (see [`from_gap_coordinates`]), with the velocities `(w, c)`. Its first mode
/// is the approach of the surfaces, the only one that diverges with the inverse gap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairFactors {
    /// `(w, c)` and `(e1, e2)` along the line of centres.
    pub axial: BlockFactor<2>,
    /// `L` for `(Omega1, Omega2)` along the line of centres.
    pub spin: Square<2>,
    /// `(U1, U2, Omega1, Omega2)` and `(e1, e2)` normal to it.
    pub transverse: BlockFactor<4>,
    /// `M` for `(e1, e2)` in the normal plane.
    pub planar: Square<2>,
}

/// Square roots of the resistances of single spheres of radii 1 and `ratio`, by which the blocks are made
/// dimensionless.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FactorScales {
    axial: [f64; 2],
    spin: [f64; 2],
    transverse: [f64; 4],
    strain: [f64; 2],
}

impl FactorScales {
    /// For radii 1 and `ratio`, viscosity 1.
    pub fn new(ratio: f64) -> Self {
        let root = |factor: f64, power: i32| [1.0, ratio].map(|a| (factor * PI * a.powi(power)).sqrt());
        let ([u, v], [o, p]) = (root(6.0, 1), root(8.0, 3));
        Self { axial: [u, u.hypot(v)], spin: [o, p], transverse: [u, v, o, p], strain: root(20.0 / 3.0, 3) }
    }
}

/// Dimensionless numbers of a pair, lower triangles one after another.
pub fn flat_factors(exact: &ResistanceBlocks, known: &ResistanceBlocks, ratio: f64) -> [f64; LANES] {
    let scales = FactorScales::new(ratio);
    let gap = from_gap_coordinates([1.0, ratio]);
    let axial = difference(&change(&exact.axial, &gap), &change(&known.axial, &gap));
    // Reordered from (c, w, e1, e2).
    let order = [1, 0, 2, 3];
    let axial: Square<4> = std::array::from_fn(|i| std::array::from_fn(|j| axial[order[i]][order[j]]));
    let axial = part(&axial, &scales.axial, &scales.strain, bordered_factor);
    let spin = symmetric_root(&reduced(&difference(&exact.spin, &known.spin), &scales.spin));
    let transverse = difference(&exact.transverse, &known.transverse);
    let transverse = part(&transverse, &scales.transverse, &scales.strain, symmetric_root);
    let planar = reduced(&difference(&exact.planar, &known.planar), &scales.strain);
    let mut lanes = [0.0; LANES];
    let values = axial.into_iter().chain(lower(&spin)).chain(transverse).chain(lower(&planar));
    lanes.iter_mut().zip(values).for_each(|(lane, value)| *lane = value);
    lanes
}

impl PairFactors {
    /// From the lanes of `flat_factors`, for a resistance larger by `factor` squared.
    pub fn from_flat(lanes: &[f64; LANES], factor: f64, scales: &FactorScales) -> Self {
        let lanes = &mut lanes.iter().copied();
        let mut axial = BlockFactor::from_lanes(lanes, &scales.axial, &scales.strain, factor);
        axial.factor[0][1] = 0.0;
        Self {
            axial,
            spin: scaled(symmetric(lanes), &scales.spin, [factor; 2]),
            transverse: BlockFactor::from_lanes(lanes, &scales.transverse, &scales.strain, factor),
            planar: scaled(symmetric(lanes), &scales.strain, scales.strain.map(|s| factor * factor * s)),
        }
    }
}

impl<const N: usize, const K: usize> BlockFactor<N, K> {
    /// From the next lanes, for a resistance larger by `factor` squared.
    pub fn from_lanes(
        lanes: &mut impl Iterator<Item = f64>,
        scales: &[f64; N],
        strain: &[f64; K],
        factor: f64,
    ) -> Self {
        let columns = strain.map(|s| factor * factor * s);
        Self {
            factor: scaled(symmetric(lanes), scales, [factor; N]),
            coupling: scaled(rows(lanes), scales, columns),
            strain: scaled(symmetric(lanes), strain, columns),
        }
    }
}

/// Lanes of a block of `N` velocities and `K` rates of strain, `M` in total.
pub fn part<const N: usize, const K: usize, const M: usize>(
    block: &Square<M>,
    scales: &[f64; N],
    strain: &[f64; K],
    root: impl Fn(&Square<N>) -> Square<N>,
) -> Vec<f64> {
    let velocities = std::array::from_fn(|i| std::array::from_fn(|j| block[i][j]));
    let strains: Square<K> = std::array::from_fn(|i| std::array::from_fn(|j| block[N + i][N + j]));
    let coupling = (0..N).flat_map(|i| (0..K).map(move |j| block[i][N + j] / (scales[i] * strain[j])));
    let root = root(&reduced(&velocities, scales));
    lower(&root).chain(coupling).chain(lower(&reduced(&strains, strain))).collect()
}

fn reduced<const N: usize>(matrix: &Square<N>, scales: &[f64; N]) -> Square<N> {
    std::array::from_fn(|i| std::array::from_fn(|j| matrix[i][j] / (scales[i] * scales[j])))
}

fn scaled<const N: usize, const M: usize>(matrix: [[f64; M]; N], rows: &[f64; N], columns: [f64; M]) -> [[f64; M]; N] {
    std::array::from_fn(|i| std::array::from_fn(|j| matrix[i][j] * rows[i] * columns[j]))
}

fn lower<const N: usize>(matrix: &Square<N>) -> impl Iterator<Item = f64> {
    matrix.iter().enumerate().flat_map(|(i, row)| row[..=i].iter().copied())
}

fn symmetric<const N: usize>(lanes: &mut impl Iterator<Item = f64>) -> Square<N> {
    let mut matrix = [[0.0; N]; N];
    for (i, j) in (0..N).flat_map(|i| (0..=i).map(move |j| (i, j))) {
        let value = lanes.next().unwrap_or_default();
        matrix[i][j] = value;
        matrix[j][i] = value;
    }
    matrix
}

fn rows<const N: usize, const M: usize>(lanes: &mut impl Iterator<Item = f64>) -> [[f64; M]; N] {
    std::array::from_fn(|_| std::array::from_fn(|_| lanes.next().unwrap_or_default()))
}

/// Cholesky factor, so that the first column alone is singular. If no `L` reproduces both entries of the last row,
/// the diagonal one is changed: the drag of the pair as a whole.
fn bordered_factor(matrix: &Square<2>) -> Square<2> {
    let pivot = matrix[0][0].max(0.0).sqrt();
    // A vanishing pivot, as of spheres far apart, must not amplify the entries below.
    let below = matrix[1][0] * pivot / (pivot * pivot + FAINT);
    let rest = matrix[1][1] - below * below;
    [[pivot, 0.0], [below, positive_part(rest, SOFTNESS * matrix[1][1].abs()).sqrt()]]
}

/// Symmetric square root of the positive part: eigenvalues `v` become `(v + sqrt(v² + 4 d²))/2` with a small `d`,
/// which is smooth where one changes sign.
pub fn symmetric_root<const N: usize>(matrix: &Square<N>) -> Square<N> {
    let (values, vectors) = eigen(*matrix);
    let softness = SOFTNESS * values.iter().map(|v| v.abs()).sum::<f64>();
    let roots = values.map(|v| positive_part(v, softness).sqrt());
    std::array::from_fn(|i| std::array::from_fn(|j| (0..N).map(|k| vectors[i][k] * roots[k] * vectors[j][k]).sum()))
}

fn positive_part(value: f64, softness: f64) -> f64 {
    let size = value.hypot(2.0 * softness);
    if value > 0.0 { 0.5 * (value + size) } else { 2.0 * softness * softness / (size - value).max(f64::MIN_POSITIVE) }
}

/// `a - b`
pub fn difference<const N: usize>(a: &Square<N>, b: &Square<N>) -> Square<N> {
    std::array::from_fn(|i| std::array::from_fn(|j| a[i][j] - b[i][j]))
}
