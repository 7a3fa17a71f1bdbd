//! How a step is taken.

use domain::ParameterError;

/// How a step is taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Integrator {
    /// All steps are alike, by the Adams-Bashforth method of an order from 2 to 4.
    AdamsBashforth {
        /// Its order.
        order: u8,
    },
    /// Each in as many parts as are needed.
    Adaptive(Adaptive),
    /// The same, with short-range forces as they will be at the end of a part, so that their stiffness does not limit it.
    Implicit(Adaptive),
    /// All steps are alike, and heat moves the spheres.
    Brownian(BrownianScheme),
}

/// How a step of Brownian motion has its drift.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum BrownianScheme {
    /// By one solve with frozen noise, half a step on.
    #[default]
    Midpoint,
    /// By the change of random motions over a small part of that, with the stress by heat: for dense suspensions, and stresses.
    TwoEvaluations,
}

/// What limits the length of a substep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Adaptive {
    /// Largest error of a substep in a position, over the radius; infinite where errors limit no substep.
    pub tolerance: f64,
    /// Largest part of a gap between two spheres that a substep may take away.
    pub gap_fraction: f64,
}

impl Adaptive {
    /// Substeps as long as gaps allow: what suits contacts.
    pub const UNLIMITED: Self = Self { tolerance: f64::INFINITY, gap_fraction: 0.5 };
}

impl Default for Adaptive {
    fn default() -> Self {
        Self { tolerance: 1e-4, gap_fraction: 0.25 }
    }
}

impl Integrator {
    /// With contacts, which make errors of their own where they stick and slide, errors need not limit substeps.
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
                    ParameterError::unless_between("time.tolerance", *tolerance, [1e-10, 0.9])?;
                }
                ParameterError::unless_between("time.gap_fraction", *gap_fraction, [1e-10, 0.9]).map(drop)
            }
        }
    }
}
