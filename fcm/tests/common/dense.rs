//! Rigid particles by a dense solve.

use super::Suspension;
use domain::Traceless;
use fcm::{Loads, Motion};

impl Suspension {
    /// Stresslets that cancel the rate of strain of the background and the loads in every particle, and the resulting
    /// motion.
    pub fn rigid(&self, loads: &Loads, background: Traceless) -> (Vec<Traceless>, Motion) {
        let size = 5 * self.positions.len();
        let mut matrix = vec![vec![0.0; size + 1]; size];
        for column in 0..size {
            let mut stresslets = vec![Traceless::ZERO; self.positions.len()];
            stresslets[column / 5].0[column % 5] = 1.0;
            let motion = self.motion(&Loads { stresslets, ..Loads::default() });
            for row in 0..size {
                matrix[row][column] = motion.strain_rates[row / 5].0[row % 5];
            }
        }
        let motion = self.motion(&Loads { stresslets: Vec::new(), ..loads.clone() });
        for (row, equation) in matrix.iter_mut().enumerate() {
            equation[size] = -(motion.strain_rates[row / 5] + background).0[row % 5];
        }
        let stresslets: Vec<_> = eliminate(matrix).chunks(5).map(|s| Traceless(s.try_into().unwrap())).collect();
        let motion = self.motion(&Loads { stresslets: stresslets.clone(), ..loads.clone() });
        (stresslets, motion)
    }
}

/// Gaussian elimination with row pivoting of an augmented matrix.
fn eliminate(mut matrix: Vec<Vec<f64>>) -> Vec<f64> {
    let size = matrix.len();
    for pivot in 0..size {
        let best = (pivot..size).max_by(|&a, &b| matrix[a][pivot].abs().total_cmp(&matrix[b][pivot].abs())).unwrap();
        matrix.swap(pivot, best);
        let head = matrix[pivot].clone();
        for row in matrix.iter_mut().skip(pivot + 1) {
            let factor = row[pivot] / head[pivot];
            for (a, b) in row.iter_mut().zip(&head).skip(pivot) {
                *a -= factor * b;
            }
        }
    }
    let mut solution = vec![0.0; size];
    for row in (0..size).rev() {
        let known: f64 = (row + 1..size).map(|c| matrix[row][c] * solution[c]).sum();
        solution[row] = (matrix[row][size] - known) / matrix[row][row];
    }
    solution
}
