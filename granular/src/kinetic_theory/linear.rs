//! Dense linear equations.

/// Solves `a x = b` in place by elimination with partial pivoting; `a` is square, stored by rows, and overwritten.
/// `None` if `a` is singular to machine precision.
pub fn solve(a: &mut [f64], mut b: Vec<f64>) -> Option<Vec<f64>> {
    let n = b.len();
    for k in 0..n {
        let pivot = (k..n).max_by(|&i, &j| a[i * n + k].abs().total_cmp(&a[j * n + k].abs()))?;
        let largest = a[pivot * n + k];
        if !(largest.abs() > f64::MIN_POSITIVE && largest.is_finite()) {
            return None;
        }
        if pivot != k {
            let (upper, lower) = a.split_at_mut(pivot * n);
            upper[k * n..(k + 1) * n].swap_with_slice(&mut lower[..n]);
            b.swap(k, pivot);
        }
        let (upper, lower) = a.split_at_mut((k + 1) * n);
        let row = &upper[k * n + k..];
        for (i, other) in lower.chunks_exact_mut(n).enumerate() {
            let factor = other[k] / row[0];
            if factor != 0.0 {
                other[k..].iter_mut().zip(row).for_each(|(x, r)| *x -= factor * r);
                b[k + 1 + i] -= factor * b[k];
            }
        }
    }
    for k in (0..n).rev() {
        let known: f64 = (k + 1..n).map(|j| a[k * n + j] * b[j]).sum();
        b[k] = (b[k] - known) / a[k * n + k];
    }
    Some(b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pivots_and_refuses_singular_matrices() {
        // [0 2 1; 1 -1 0; 3 0 -2] (1, 2, 3) = (7, -1, -3)
        let mut a = [0.0, 2.0, 1.0, 1.0, -1.0, 0.0, 3.0, 0.0, -2.0];
        let x = solve(&mut a, vec![7.0, -1.0, -3.0]).unwrap();
        assert!(x.iter().zip([1.0, 2.0, 3.0]).all(|(x, y)| (x - y).abs() < 1e-14));
        assert!(solve(&mut [1.0, 2.0, 2.0, 4.0], vec![1.0, 1.0]).is_none());
    }
}
