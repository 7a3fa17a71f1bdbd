//! Background flow: the flow in the absence of particles.

use domain::{Tensor, Traceless, Vector};

/// Reason why a background flow is invalid.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum FlowError {
    /// The velocity gradient is not finite, or its trace is not zero, so the flow is not incompressible.
    #[error(
        "the background velocity gradient has trace {0}; an incompressible flow needs xx + yy + zz = 0 \
         and finite components"
    )]
    Trace(f64),
}

/// Linear flow `u_i(x) = G_ij x_j` with the velocity gradient `G_ij = du_i/dx_j`, an inverse time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BackgroundFlow {
    gradient: Tensor,
}

impl BackgroundFlow {
    /// No flow.
    pub const NONE: Self = Self { gradient: Tensor::ZERO };

    /// Simple shear `u = rate y e_x`: flow along x, gradient along y, vorticity along -z.
    pub fn shear(rate: f64) -> Self {
        Self { gradient: Tensor::from_cols(Vector::ZERO, Vector::new(rate, 0.0, 0.0), Vector::ZERO) }
    }

    /// Simple shear `u = rate z e_x`, between walls across z with the one at `z = 0` at rest.
    pub fn couette(rate: f64) -> Self {
        Self { gradient: Tensor::from_cols(Vector::ZERO, Vector::ZERO, Vector::new(rate, 0.0, 0.0)) }
    }

    /// Extensional flow along the axes, `u = (a x, b y, -(a + b) z)`, with the rates `a` along x and `b` along y.
    pub fn stretching([a, b]: [f64; 2]) -> Self {
        Self { gradient: Tensor::from_diagonal(Vector::new(a, b, -(a + b))) }
    }

    /// Flow with a given velocity gradient; component `ij` of a tensor is `gradient.col(j)[i]`.
    pub fn with_gradient(gradient: Tensor) -> Result<Self, FlowError> {
        let trace = gradient.x_axis.x + gradient.y_axis.y + gradient.z_axis.z;
        let size: f64 = gradient.to_cols_array().iter().map(|g| g.abs()).sum();
        if trace.abs() <= 1e-12 * size && size.is_finite() {
            Ok(Self { gradient })
        } else {
            Err(FlowError::Trace(trace))
        }
    }

    /// Velocity gradient.
    pub fn gradient(&self) -> Tensor {
        self.gradient
    }

    /// Velocity at a position relative to the stagnation point.
    pub fn velocity(&self, position: Vector) -> Vector {
        self.gradient * position
    }

    /// Half the vorticity, `1/2 curl u`: the angular velocity of a sphere in this flow.
    pub fn angular_velocity(&self) -> Vector {
        let g = self.gradient;
        0.5 * Vector::new(g.y_axis.z - g.z_axis.y, g.z_axis.x - g.x_axis.z, g.x_axis.y - g.y_axis.x)
    }

    /// Rate of strain `(G + G^T)/2`.
    pub fn strain_rate(&self) -> Traceless {
        Traceless::part_of(&self.gradient)
    }

    /// Shear rate `G_xy` of a Lees-Edwards box that deforms with the flow.
    pub fn shear_rate(&self) -> f64 {
        self.gradient.y_axis.x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shear_turns_spheres_at_minus_half_the_rate_about_z() {
        let flow = BackgroundFlow::shear(2.0);
        assert_eq!(flow.velocity(Vector::new(5.0, 3.0, 1.0)), Vector::new(6.0, 0.0, 0.0));
        assert_eq!(flow.angular_velocity(), Vector::new(0.0, 0.0, -1.0));
        assert_eq!(flow.strain_rate(), Traceless([0.0, 1.0, 0.0, 0.0, 0.0]));
        assert!(flow.shear_rate().to_bits() == 2.0_f64.to_bits());
    }

    #[test]
    fn a_linear_flow_is_its_rotation_and_its_strain() {
        let gradient = Tensor::from_cols_array(&[0.3, 1.0, -2.0, 0.7, -0.5, 3.0, 0.1, -0.4, 0.2]);
        let flow = BackgroundFlow::with_gradient(gradient).unwrap();
        let x = Vector::new(0.4, -1.2, 2.3);
        let sum = flow.angular_velocity().cross(x) + flow.strain_rate().tensor() * x;
        assert!((sum - flow.velocity(x)).length() < 1e-15);
    }

    #[test]
    fn stretching_is_strain_alone() {
        let flow = BackgroundFlow::stretching([2.0, -0.5]);
        assert_eq!(flow.velocity(Vector::new(1.0, 2.0, 4.0)), Vector::new(2.0, -1.0, -6.0));
        assert_eq!(flow.angular_velocity(), Vector::ZERO);
        assert_eq!(BackgroundFlow::with_gradient(flow.gradient()), Ok(flow));
    }

    #[test]
    fn a_flow_that_swells_is_refused() {
        assert_eq!(BackgroundFlow::with_gradient(Tensor::IDENTITY), Err(FlowError::Trace(3.0)));
        assert!(BackgroundFlow::with_gradient(Tensor::IDENTITY * f64::NAN).is_err());
    }
}
