//! Time integrators.

use domain::ParameterError;

/// Time integrator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Integrator {
    /// Adams-Bashforth method of order 2 to 4 with fixed steps.
    AdamsBashforth {
        /// Order of the method.
        order: u8,
    },
    /// Each step is divided into as many substeps as the error requires.
    Adaptive(Adaptive),
    /// Adaptive substeps with implicit short-range forces, whose stiffness then does not limit the substep.
    Implicit(Adaptive),
    /// Fixed steps with Brownian motion.
    Brownian(BrownianScheme),
}

/// Scheme for the drift of Brownian motion.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum BrownianScheme {
    /// Midpoint scheme: one solve, half a step ahead, with frozen noise.
    #[default]
    Midpoint,
    /// Two evaluations: a finite difference of random motions over a small fraction of the step. It gives the Brownian
    /// stress as well; for dense suspensions, and where stresses are wanted.
    TwoEvaluations,
}

/// Limits of the length of a substep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Adaptive {
    /// Largest position error of a substep, over the radius; infinite for no limit by errors.
    pub tolerance: f64,
    /// Largest fraction of the gap between two spheres that a substep may close.
    pub gap_fraction: f64,
}

impl Adaptive {
    /// Substeps limited by gaps only, as suits contacts.
    pub const UNLIMITED: Self = Self { tolerance: f64::INFINITY, gap_fraction: 0.5 };
}

impl Default for Adaptive {
    fn default() -> Self {
        Self { tolerance: 1e-4, gap_fraction: 0.25 }
    }
}

impl Integrator {
    /// With contacts, whose sticking and sliding cause errors of their own, the error tolerance may be infinite.
    pub(super) fn check(&self, with_contacts: bool) -> Result<(), ParameterError> {
        match self {
            Self::AdamsBashforth { order } if !(2..=4).contains(order) => {
                let message = format!("is {order}; the Adams-Bashforth methods here have order 2, 3 or 4");
                Err(ParameterError::new("time.order", message))
            }
            Self::AdamsBashforth { .. } | Self::Brownian(_) => Ok(()),
            Self::Adaptive(Adaptive { tolerance, gap_fraction })
            | Self::Implicit(Adaptive { tolerance, gap_fraction }) => {
                if !(with_contacts && *tolerance == f64::INFINITY) {
                    ParameterError::require_between("time.tolerance", *tolerance, [1e-10, 0.9])?;
                }
                ParameterError::require_between("time.gap_fraction", *gap_fraction, [1e-10, 0.9]).map(drop)
            }
        }
    }
}
