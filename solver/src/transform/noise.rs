//! Random fields whose covariance is an operator.

use super::Transform;
use crate::modes::{Complexes, MODES};
use crate::stokes::ModeBlock;
use crate::{Field, Physical, Real, Spectral, Stokes};
use simd::vectorised;

/// Source of random numbers for modes.
pub trait Draw: Sync {
    /// Numbers of variance 1 for modes by their signed indices; `#[inline(always)]`.
    fn draw(&self, modes: &[[i64; 3]; MODES]) -> Complexes;
}

impl<T: Real> Transform<T> {
    /// Random velocity field whose covariance is the operator over the volume of a grid point. Interpolated with
    /// weights times that volume, it has the covariance of [`Self::apply`] between forces spread with these weights,
    /// since
    ///
    /// ```text
    /// u_hat(k) = sqrt(m(k) / volume) (I - k k/k^2) c(k),       <c_i(k) c_j(k)*> = delta_ij
    /// ```
    ///
    /// is the operator's square root times noise. `draw` gives the numbers `c`; it is called for only one of a mode
    /// and its opposite. Collective.
    pub fn noise(&mut self, operator: &Stokes<T>, volume: f64, draw: &impl Draw) -> Field<T, Physical> {
        let points = self.local.layout().points;
        assert_eq!(points, operator.points(), "transform and operator have one grid");
        let signed = |mode: usize, axis: usize| {
            if 2 * mode > points[axis] { mode as i64 - points[axis] as i64 } else { mode as i64 }
        };
        let mut field = Field::<T, Spectral>::zero(self.local.layout());
        field.set_blocks(|mode @ [first, m2, m3]| {
            vectorised(
                #[inline(always)]
                || {
                    let (along_y, along_z) = (signed(m2, 1), signed(m3, 2));
                    let mut modes: [[i64; 3]; MODES] =
                        std::array::from_fn(|lane| [(first + lane) as i64, along_y, along_z]);
                    // In the plane m1 = 0 both a mode and its opposite are kept.
                    let is_opposite = first == 0 && (along_y, along_z) < (0, 0);
                    if is_opposite {
                        modes[0] = modes[0].map(|m| -m);
                    }
                    let mut drawn = draw.draw(&modes);
                    if is_opposite {
                        for [_, imaginary] in &mut drawn {
                            imaginary[0] = -imaginary[0];
                        }
                    }
                    across(drawn, &operator.mode_block(mode), volume)
                },
            )
        });
        self.backward(field)
    }
}

/// Parts of the numbers transverse to the wavevectors, times the square roots of the factors over a volume.
#[inline(always)]
fn across(mut numbers: Complexes, modes: &ModeBlock, volume: f64) -> Complexes {
    let [x, y, z] = &modes.vectors;
    for lane in 0..MODES {
        let square = x[lane] * x[lane] + y[lane] * y[lane] + z[lane] * z[lane];
        let over = if square > 0.0 { square } else { f64::INFINITY };
        let root = (modes.factors[lane] / volume).sqrt();
        for part in 0..2 {
            let [a, b, c] = [numbers[0][part][lane], numbers[1][part][lane], numbers[2][part][lane]];
            let along = (a * x[lane] + b * y[lane] + c * z[lane]) / over;
            numbers[0][part][lane] = (a - along * x[lane]) * root;
            numbers[1][part][lane] = (b - along * y[lane]) * root;
            numbers[2][part][lane] = (c - along * z[lane]) * root;
        }
    }
    numbers
}
