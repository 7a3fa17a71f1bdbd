//! Boys functions, from which the radial functions of Gaussians in Stokes flow are built.

use libm::erf;

/// `F_n(x) = int_0^1 t^(2n) exp(-x t^2) dt` for `n = 0..N`, `x >= 0`, to a few units in the last place.
///
/// Upwards from the error function where that is stable, `(2n + 1) F_n = 2x F_(n+1) + exp(-x)`; else downwards from the
/// series `F_n = exp(-x) sum_m (2x)^m / ((2n+1)(2n+3)...(2n+2m+1))`, whose terms are all positive.
pub(crate) fn boys<const N: usize>(x: f64) -> [f64; N] {
    let mut f = [0.0; N];
    let decay = (-x).exp();
    if x > 2.5 * N as f64 {
        let root = x.sqrt();
        f[0] = 0.5 * std::f64::consts::PI.sqrt() * erf(root) / root;
        for n in 1..N {
            f[n] = ((2 * n - 1) as f64 * f[n - 1] - decay) / (2.0 * x);
        }
    } else {
        f[N - 1] = series(N - 1, x) * decay;
        for n in (1..N).rev() {
            f[n - 1] = (2.0 * x * f[n] + decay) / (2 * n - 1) as f64;
        }
    }
    f
}

fn series(n: usize, x: f64) -> f64 {
    let mut denominator = (2 * n + 1) as f64;
    let mut term = 1.0 / denominator;
    let mut sum = term;
    while term > 1e-17 * sum {
        denominator += 2.0;
        term *= 2.0 * x / denominator;
        sum += term;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::boys;

    /// Against Gauss-Legendre quadrature of the definition on 200 panels.
    #[test]
    fn they_are_their_integrals() {
        let nodes = [0.774_596_669_241_483_4, 0.0, -0.774_596_669_241_483_4];
        let weights = [5.0 / 9.0, 8.0 / 9.0, 5.0 / 9.0];
        for x in [0.0, 1e-8, 0.1, 1.0, 5.0, 12.0, 19.9, 20.1, 45.0] {
            let found = boys::<8>(x);
            for (n, value) in found.iter().enumerate() {
                let panels = 400;
                let mut integral = 0.0;
                for p in 0..panels {
                    for (node, weight) in nodes.iter().zip(weights) {
                        let t = (f64::from(p) + 0.5 + 0.5 * node) / f64::from(panels);
                        integral += 0.5 * weight / f64::from(panels) * t.powi(2 * n as i32) * (-x * t * t).exp();
                    }
                }
                assert!((value - integral).abs() < 5e-14 * integral, "F_{n}({x}) = {value}, not {integral}");
            }
        }
    }
}
