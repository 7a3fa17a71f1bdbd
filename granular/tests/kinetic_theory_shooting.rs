//! The continuum shear cell solved again as in the paper: Runge-Kutta integration of eqs (11) and (12) across the whole
//! gap, with the solid fraction and the velocity at the lower wall iterated until the laws of the upper wall hold.

use super::kinetic_theory_coefficients::{reduced, wall_coefficients};
use granular::kinetic_theory::{ContinuumParameters, ContinuumProblem, RadialDistribution, WallShape};

/// `[u, u', v, v']` at a height.
type State = [f64; 4];

struct Shooting(ContinuumParameters);

impl Shooting {
    fn rates(&self, [_, du, v, dv]: State) -> State {
        let b = reduced(&self.0.grains, v, self.0.pressure);
        [du, -b.b1 * dv * du, dv, -b.b2 * dv * dv - b.b3 - b.b4 * du * du]
    }

    /// `u'` and `v'` along the normal into the flow according to the wall laws, at a slip and a solid fraction.
    fn wall(&self, slip: f64, v: f64) -> (f64, f64) {
        let (b, r) = (wall_coefficients(&self.0.wall, &self.0.grains, v, self.0.pressure), self.0.wall.roughness);
        let gradient = r.r5 * b.b5 * slip;
        (gradient, r.r7 * b.b7 * slip * slip + r.r8 * b.b8 * slip * gradient - r.r6 * b.b6)
    }

    /// Residuals of the upper wall's laws.
    fn miss(&self, v: f64, u: f64) -> [f64; 2] {
        let (gradient, slope) = self.wall(self.0.speed - u, v);
        let steps = 2000;
        let h = self.0.gap / f64::from(steps);
        let mut y = [u, -gradient, v, slope];
        let along = |y: State, k: State, h: f64| -> State { std::array::from_fn(|i| y[i] + h * k[i]) };
        for _ in 0..steps {
            let a = self.rates(y);
            let b = self.rates(along(y, a, 0.5 * h));
            let c = self.rates(along(y, b, 0.5 * h));
            let d = self.rates(along(y, c, h));
            y = std::array::from_fn(|i| y[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
        }
        let (gradient, slope) = self.wall(y[0], y[2]);
        [(y[1] + gradient) / (self.0.speed / self.0.gap), (y[3] + slope) * self.0.gap]
    }

    /// Newton's method with a numerical Jacobian, from a guess near the solution.
    fn solve(&self, mut v: f64, mut u: f64) -> (f64, f64) {
        for _ in 0..30 {
            let [f, g] = self.miss(v, u);
            let (hv, hu) = (1e-7, 1e-7 * self.0.speed);
            let ([fv, gv], [fu, gu]) = (self.miss(v + hv, u), self.miss(v, u + hu));
            let [a, b, c, d] = [(fv - f) / hv, (fu - f) / hu, (gv - g) / hv, (gu - g) / hu];
            let determinant = a * d - b * c;
            let (dv, du) = ((d * f - b * g) / determinant, (a * g - c * f) / determinant);
            (v, u) = (v - dv, u - du);
            if dv.abs() < 1e-12 && du.abs() < 1e-12 * self.0.speed {
                break;
            }
        }
        (v, u)
    }
}

/// The Runge-Kutta error is (H/2000)^4, far below the bound of 1e-7.
#[test]
fn shooting_over_the_whole_gap_agrees() {
    let readings = [
        (RadialDistribution::SinclairJackson, WallShape::Disk, false),
        (RadialDistribution::CarnahanStarling, WallShape::Sphere, true),
        (RadialDistribution::LunSavage, WallShape::Sphere, false),
        (RadialDistribution::MaAhmadi, WallShape::Disk, false),
    ];
    for (radial, shape, gradient) in readings {
        for speed in [1.4, 2.0, 2.8] {
            let mut parameters = ContinuumParameters { speed, ..ContinuumParameters::default() };
            parameters.grains.radial = radial;
            (parameters.wall.shape, parameters.wall.gradient) = (shape, gradient);
            let solution = ContinuumProblem::new(parameters).unwrap().solve().unwrap();
            let wall = solution.at(0.0);
            let (v, u) = Shooting(parameters).solve(wall.solid_fraction - 1e-3, wall.velocity - 1e-3);
            assert!((v - wall.solid_fraction).abs() < 1e-7, "{radial:?} {speed}: {v} {}", wall.solid_fraction);
            assert!((u - wall.velocity).abs() < 1e-7 * speed, "{radial:?} {speed}: {u} {}", wall.velocity);
        }
    }
}
