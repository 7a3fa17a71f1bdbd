//! Direct solution of a tridiagonal system of 2 x 2 blocks.

use super::double_double::DoubleDouble;

/// A 2 x 2 block: `[equation][sphere]`.
pub type Matrix2 = [[DoubleDouble; 2]; 2];

/// Two equations: `below y_{n-1} + middle y_n + above y_{n+1} = right`, with several right-hand sides.
#[derive(Debug, Clone)]
pub struct BlockRow {
    /// Coefficients of the previous unknowns.
    pub below: Matrix2,
    /// Coefficients of the unknowns of this row.
    pub middle: Matrix2,
    /// Coefficients of the next unknowns.
    pub above: Matrix2,
    /// `[equation][right-hand side]`
    pub right: [Vec<DoubleDouble>; 2],
}

impl BlockRow {
    /// Zero row for `count` right-hand sides.
    pub fn new(count: usize) -> Self {
        let zeros = vec![DoubleDouble::default(); count];
        Self {
            below: Matrix2::default(),
            middle: Matrix2::default(),
            above: Matrix2::default(),
            right: [zeros.clone(), zeros],
        }
    }
}

/// Solution as `[row][right-hand side][sphere]`, by block elimination; destroys the rows.
#[inline(always)]
pub fn solve(rows: &mut [BlockRow]) -> Vec<Vec<[DoubleDouble; 2]>> {
    for n in 0..rows.len() {
        let (done, rest) = rows.split_at_mut(n);
        let row = &mut rest[0];
        if let Some(before) = done.last() {
            eliminate(row, before);
        }
        let inverse = inverse(&row.middle);
        row.above = product(&inverse, &row.above);
        for d in 0..row.right[0].len() {
            let [first, second] = apply(&inverse, [row.right[0][d], row.right[1][d]]);
            (row.right[0][d], row.right[1][d]) = (first, second);
        }
    }
    substitute(rows)
}

#[inline(always)]
fn eliminate(row: &mut BlockRow, before: &BlockRow) {
    let carried = product(&row.below, &before.above);
    for (i, line) in carried.iter().enumerate() {
        for (j, value) in line.iter().enumerate() {
            row.middle[i][j] += -*value;
        }
    }
    for d in 0..row.right[0].len() {
        let carried = apply(&row.below, [before.right[0][d], before.right[1][d]]);
        row.right[0][d] += -carried[0];
        row.right[1][d] += -carried[1];
    }
}

#[inline(always)]
fn substitute(rows: &[BlockRow]) -> Vec<Vec<[DoubleDouble; 2]>> {
    let mut solution: Vec<Vec<[DoubleDouble; 2]>> = Vec::with_capacity(rows.len());
    for row in rows.iter().rev() {
        let mut values: Vec<[DoubleDouble; 2]> = Vec::with_capacity(row.right[0].len());
        for d in 0..row.right[0].len() {
            let after = solution.last().map_or([DoubleDouble::default(); 2], |next| apply(&row.above, next[d]));
            values.push([row.right[0][d] - after[0], row.right[1][d] - after[1]]);
        }
        solution.push(values);
    }
    solution.reverse();
    solution
}

#[inline(always)]
fn apply(block: &Matrix2, x: [DoubleDouble; 2]) -> [DoubleDouble; 2] {
    let [first, second] = block;
    [first[0] * x[0] + first[1] * x[1], second[0] * x[0] + second[1] * x[1]]
}

#[inline(always)]
fn product(a: &Matrix2, b: &Matrix2) -> Matrix2 {
    let [first, second] = [apply(a, [b[0][0], b[1][0]]), apply(a, [b[0][1], b[1][1]])];
    [[first[0], second[0]], [first[1], second[1]]]
}

#[inline(always)]
fn inverse(a: &Matrix2) -> Matrix2 {
    let scale = DoubleDouble::from(1.0) / (a[0][0] * a[1][1] - a[0][1] * a[1][0]);
    [[a[1][1] * scale, -(a[0][1] * scale)], [-(a[1][0] * scale), a[0][0] * scale]]
}
