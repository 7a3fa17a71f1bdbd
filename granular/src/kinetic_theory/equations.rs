//! The boundary value problem as equations for the values at the collocation points, with their exact Jacobian.
//!
//! Units: density and diameter of the grains, and `U`. Unknowns on the half gap, `x = 2y/H` in [0, 1]: the logit `z`
//! of the solid fraction, `w = q / P^(3/2)`, `u`, and the number `s = S/P`. With the half gap `h` and the load `p`:
//!
//! ```text
//! z' = h w C2^(3/2) / (K v'(z)),   w' = h (s^2 C2^(1/2) / C1 - C6 / C2^(3/2)),   u' = -h s (p C2)^(1/2) / C1
//! x = 0: |u'| (1 - b C2/C1) = R5 a (C2/C1) u_slip,   w C2^(1/2) = C2 u_slip (R7 a u_slip + R8 b |u'|)/p - R6 d
//! x = 1: w = 0,   u = 1/2
//! ```

use super::{ContinuumProblem, Roughness, collocation::Collocation, jet::Jet};

/// Unknowns at a point.
pub const WIDTH: usize = 3;

/// Right-hand sides at a point, and their derivatives with respect to `z`, `w` and `s`.
pub struct Rates {
    pub values: [f64; WIDTH],
    by_z: [f64; WIDTH],
    by_w: [f64; WIDTH],
    by_s: [f64; WIDTH],
}

impl ContinuumProblem {
    /// Derivatives of `z`, `w` and `u` along `x`.
    pub fn rates(&self, z: f64, w: f64, s: f64) -> Rates {
        let (v, turn) = self.logistic(z);
        let f = self.parameters().grains.functions(v);
        let h = self.half_gap();
        let spread = f.c2.power(1.5) * h / (f.conduction * turn);
        let heat = f.c2.power(0.5) * h / f.c1;
        let loss = f.c6 * h / f.c2.power(1.5);
        let shear = heat * -self.load().sqrt();
        let dv = turn.value();
        Rates {
            values: [w * spread.value(), s * s * heat.value() - loss.value(), s * shear.value()],
            by_z: [w * spread.slope() * dv, (s * s * heat.slope() - loss.slope()) * dv, s * shear.slope() * dv],
            by_w: [spread.value(), 0.0, 0.0],
            by_s: [0.0, 2.0 * s * heat.value(), shear.value()],
        }
    }

    /// Solid fraction at a logit, and its derivative with respect to `z` as a function of the solid fraction.
    fn logistic(&self, z: f64) -> (f64, Jet) {
        let v = self.solid_fraction(z);
        let jet = Jet::variable(v);
        (v, jet * (-jet * (1.0 / self.parameters().grains.radial.packed()) + 1.0))
    }

    /// Residuals of the two wall laws at `(z, w, u, s)` and their derivatives with respect to each. `energy` scales
    /// the terms by which energy crosses the wall: 0 for none, 1 for all.
    fn wall_laws(&self, [z, w, u, s]: [f64; 4], energy: f64) -> [[f64; 5]; 2] {
        let (v, turn) = self.logistic(z);
        let f = self.parameters().grains.functions(v);
        let bumps = self.bump_integrals(f.contact);
        let Roughness { r5, r6, r7, r8 } = self.parameters().wall.roughness;
        let p = self.load();
        let slip = 1.0 - u;
        let gradient = (f.c2 * p).power(0.5) / f.c1;
        let pull = gradient * (-(bumps.gradient * f.c2 / f.c1) + 1.0);
        let push = f.c2 / f.c1 * (r5 * bumps.slip);
        let sliding = f.c2 * (energy * r7 * bumps.slip / p);
        let crossed = f.c2 * bumps.gradient * gradient * (energy * r8 / p);
        let root = f.c2.power(0.5);
        let dv = turn.value();
        let momentum = pull * s - push * slip;
        let heat = root * w - sliding * (slip * slip) - crossed * (slip * s);
        let heat_by_u = 2.0 * slip * sliding.value() + s * crossed.value();
        [
            [momentum.value(), momentum.slope() * dv, 0.0, push.value(), pull.value()],
            [
                heat.value() + energy * r6 * bumps.loss,
                heat.slope() * dv,
                root.value(),
                heat_by_u,
                -slip * crossed.value(),
            ],
        ]
    }

    /// Residuals of all equations and their Jacobian, row by row.
    pub fn linearise(&self, grid: &Collocation, unknowns: &[f64], energy: f64) -> (Vec<f64>, Vec<f64>) {
        let (points, size) = (grid.points.len(), unknowns.len());
        let s = unknowns[size - 1];
        let rates: Vec<Rates> = unknowns.chunks_exact(WIDTH).map(|y| self.rates(y[0], y[1], s)).collect();
        let (mut residual, mut jacobian) = (vec![0.0; size], vec![0.0; size * size]);
        for j in 1..points {
            for c in 0..WIDTH {
                let row = (j - 1) * WIDTH + c;
                let matrix = &mut jacobian[row * size..(row + 1) * size];
                residual[row] = unknowns[j * WIDTH + c] - unknowns[c];
                matrix[j * WIDTH + c] += 1.0;
                matrix[c] -= 1.0;
                for (k, (weight, rate)) in grid.up_to(j).iter().zip(&rates).enumerate() {
                    residual[row] -= weight * rate.values[c];
                    matrix[k * WIDTH] -= weight * rate.by_z[c];
                    matrix[k * WIDTH + 1] -= weight * rate.by_w[c];
                    matrix[size - 1] -= weight * rate.by_s[c];
                }
            }
        }
        let laws = self.wall_laws([unknowns[0], unknowns[1], unknowns[2], s], energy);
        for (row, law) in (size - 4..).zip(laws) {
            residual[row] = law[0];
            for (column, slope) in [0, 1, 2, size - 1].into_iter().zip(&law[1..]) {
                jacobian[row * size + column] = *slope;
            }
        }
        residual[size - 2] = unknowns[size - 3];
        jacobian[(size - 2) * size + size - 3] = 1.0;
        residual[size - 1] = unknowns[size - 2] - 0.5;
        jacobian[(size - 1) * size + size - 2] = 1.0;
        (residual, jacobian)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kinetic_theory::ContinuumParameters;

    #[test]
    fn the_jacobian_is_that_of_the_residuals() {
        let mut parameters = ContinuumParameters::default();
        parameters.wall.gradient = true;
        let problem = ContinuumProblem::new(parameters).unwrap();
        let grid = Collocation::new(6);
        let unknowns: Vec<f64> = (0..22).map(|i| 0.4 + 0.1 * f64::from(i * i % 7)).collect();
        let (_, jacobian) = problem.linearise(&grid, &unknowns, 0.7);
        for column in 0..22 {
            let shifted = |h: f64| {
                let mut moved = unknowns.clone();
                moved[column] += h;
                problem.linearise(&grid, &moved, 0.7).0
            };
            let (up, down) = (shifted(1e-5), shifted(-1e-5));
            for row in 0..22 {
                let difference = (up[row] - down[row]) / 2e-5;
                let exact = jacobian[row * 22 + column];
                // Central differences: relative error h^2 and round-off 1e-16 / h of numbers up to 1e2.
                assert!(
                    (difference - exact).abs() < 1e-7 * (1.0 + exact.abs()),
                    "{row} {column}: {difference} {exact}"
                );
            }
        }
    }
}
