//! Square roots of pair resistances, made positive semi-definite.

use std::f64::consts::PI;

use crate::blocks::{Blocks, change, from_gap_coordinates};
use crate::dense::{Square, eigen};

/// Negative eigenvalues fade out over this fraction of the sum of all of a block.
const SOFTNESS: f64 = 1e-5;
/// Numbers in a flattened root.
pub const LANES: usize = 37;

/// Weight of strain against velocity in the distance to the positive semi-definite matrices: what has to be added is added to the
/// stresslets, so that motions under forces stay within 0.2% of exact for radii up to 2:1, relative motions and stresslets in strain within 1%.
const STRAIN_WEIGHT: f64 = 20.0;

/// A matrix `L` with `R = L L^T` for each block of a pair's resistance; rows are motions, columns modes.
///
/// The axial block is in gap coordinates (see [`from_gap_coordinates`]) with the motions in the order `(w, c, e1, e2)`.
/// Its first column belongs to the approach of the surfaces, which alone is singular like one over the gap; the rest is
/// a symmetric root of what remains, in units of the drag of single spheres, with rows scaled back. So are the roots of the other
/// blocks. They vary smoothly with the gap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Roots {
    /// `(w, c, e1, e2)`
    pub axial: Square<4>,
    /// `(Omega1, Omega2)`
    pub spin: Square<2>,
    /// `(U1, U2, Omega1, Omega2, e1, e2)`
    pub transverse: Square<6>,
    /// `(e1, e2)`
    pub planar: Square<2>,
}

/// Roots of the resistance of single spheres of radii 1 and a ratio, which make the blocks dimensionless.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scales {
    axial: [f64; 4],
    spin: [f64; 2],
    transverse: [f64; 6],
    planar: [f64; 2],
}

impl Scales {
    /// For radii 1 and `ratio`, viscosity 1.
    pub fn new(ratio: f64) -> Self {
        let root = |factor: f64, power: i32| [1.0, ratio].map(|a| (factor * PI * a.powi(power)).sqrt());
        let ([u, v], [o, p], [e, f]) = (root(6.0, 1), root(8.0, 3), root(20.0 / 3.0 * STRAIN_WEIGHT, 3));
        Self { axial: [u, u.hypot(v), e, f], spin: [o, p], transverse: [u, v, o, p, e, f], planar: [e, f] }
    }
}

/// Symmetric roots of dimensionless blocks, lower triangles one after another.
pub fn flat_roots(exact: &Blocks, known: &Blocks, ratio: f64) -> [f64; LANES] {
    let scales = Scales::new(ratio);
    let gap = from_gap_coordinates([1.0, ratio]);
    let order = [1, 0, 2, 3];
    let axial = difference(&change(&exact.axial, &gap), &change(&known.axial, &gap));
    let axial = std::array::from_fn(|i| std::array::from_fn(|j| axial[order[i]][order[j]]));
    let axial = bordered_root(&reduced(&axial, &scales.axial));
    let spin = root(&reduced(&difference(&exact.spin, &known.spin), &scales.spin));
    let transverse = root(&reduced(&difference(&exact.transverse, &known.transverse), &scales.transverse));
    let planar = root(&reduced(&difference(&exact.planar, &known.planar), &scales.planar));
    let mut lanes = [0.0; LANES];
    let values = lower(&axial).chain(lower(&spin)).chain(lower(&transverse)).chain(lower(&planar));
    lanes.iter_mut().zip(values).for_each(|(lane, value)| *lane = value);
    lanes
}

impl Roots {
    /// From the lanes of `flat_roots`, each times `factor`.
    pub fn from_flat(lanes: &[f64; LANES], factor: f64, scales: &Scales) -> Self {
        let mut lanes = lanes.iter().map(|lane| factor * lane);
        let mut axial = symmetric(&mut lanes);
        axial[0][1..].fill(0.0);
        Self {
            axial: scaled(axial, &scales.axial),
            spin: scaled(symmetric(&mut lanes), &scales.spin),
            transverse: scaled(symmetric(&mut lanes), &scales.transverse),
            planar: scaled(symmetric(&mut lanes), &scales.planar),
        }
    }
}

fn reduced<const N: usize>(matrix: &Square<N>, scales: &[f64; N]) -> Square<N> {
    std::array::from_fn(|i| std::array::from_fn(|j| matrix[i][j] / (scales[i] * scales[j])))
}

fn scaled<const N: usize>(mut root: Square<N>, scales: &[f64; N]) -> Square<N> {
    root.iter_mut().zip(scales).for_each(|(row, scale)| row.iter_mut().for_each(|value| *value *= scale));
    root
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

/// First column by Cholesky's rule, the rest symmetric.
fn bordered_root(matrix: &Square<4>) -> Square<4> {
    let pivot = matrix[0][0].max(0.0).sqrt();
    // No positive semi-definite matrix has more in a column than this, and a vanishing pivot must not blow it up.
    let column =
        |i: usize| if pivot > 0.0 { (matrix[i][0] / pivot).abs().min(matrix[i][i].max(0.0).sqrt()) } else { 0.0 };
    let column: [f64; 4] = std::array::from_fn(|i| column(i).copysign(matrix[i][0]));
    let rest: Square<3> =
        std::array::from_fn(|i| std::array::from_fn(|j| matrix[i + 1][j + 1] - column[i + 1] * column[j + 1]));
    let rest = root(&rest);
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            if j == 0 {
                column[i]
            } else if i == 0 {
                0.0
            } else {
                rest[i - 1][j - 1]
            }
        })
    })
}

/// Symmetric root of the positive part: eigenvalues `v` become `(v + sqrt(v² + 4 d²))/2` with a small `d`, smooth where one changes sign.
fn root<const N: usize>(matrix: &Square<N>) -> Square<N> {
    let (values, vectors) = eigen(*matrix);
    let softness = SOFTNESS * values.iter().map(|v| v.abs()).sum::<f64>();
    let roots = values.map(|v| positive_part(v, softness).sqrt());
    std::array::from_fn(|i| std::array::from_fn(|j| (0..N).map(|k| vectors[i][k] * roots[k] * vectors[j][k]).sum()))
}

fn positive_part(value: f64, softness: f64) -> f64 {
    let size = value.hypot(2.0 * softness);
    if value > 0.0 { 0.5 * (value + size) } else { 2.0 * softness * softness / (size - value).max(f64::MIN_POSITIVE) }
}

fn difference<const N: usize>(a: &Square<N>, b: &Square<N>) -> Square<N> {
    std::array::from_fn(|i| std::array::from_fn(|j| a[i][j] - b[i][j]))
}
