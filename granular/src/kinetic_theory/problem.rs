//! The checked input of the boundary value problem.

use super::{GrainProperties, RadialDistribution, Roughness, Wall, WallShape, jet::Jet, wall::BumpIntegrals};
use crate::parameter::{ParameterError, of_sensible_size, positive, require, restitution};
use domain::Number;
use std::f64::consts::FRAC_PI_2;

/// Smallest factor on the slip law: below it the shear stress is lost in the rounding of the pressure.
const SMOOTHEST: f64 = 1e-12;

/// Choice between several solutions.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum SolutionStart {
    /// The densest that the solver finds.
    #[default]
    Densest,
    /// The solution that Newton's method reaches from this uniform solid fraction.
    SolidFraction(f64),
}

/// Parameters of a scene. The default is Yu and Tichy's cell at `U` = 1.4 m/s and 5.5 kPa, with the reading of the
/// paper that reproduces it best: Sinclair and Jackson's radial distribution, half-disks between which one grain just
/// fits, no gradient term, all factors 0.5.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContinuumParameters {
    /// Gap `H` between the planes of the walls' bumps.
    pub gap: f64,
    /// Speed `U` of the lower wall; the upper one rests.
    pub speed: f64,
    /// Normal stress `P` on the walls.
    pub pressure: f64,
    /// Properties of the grains.
    pub grains: GrainProperties,
    /// Properties of both walls.
    pub wall: Wall,
    /// Choice of the solution.
    pub start: SolutionStart,
}

impl Default for ContinuumParameters {
    fn default() -> Self {
        let diameter = 0.787e-3;
        Self {
            gap: 4e-3,
            speed: 1.4,
            pressure: 5500.0,
            grains: GrainProperties {
                diameter,
                density: 2550.0,
                restitution: 0.9,
                radial: RadialDistribution::SinclairJackson,
            },
            wall: Wall {
                shape: WallShape::Disk,
                theta: FRAC_PI_2,
                gradient: false,
                diameter,
                restitution: 0.9,
                roughness: Roughness { r5: 0.5, r6: 0.5, r7: 0.5, r8: 0.5 },
            },
            start: SolutionStart::Densest,
        }
    }
}

/// A boundary value problem with checked parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContinuumProblem {
    parameters: ContinuumParameters,
}

impl ContinuumProblem {
    /// Checks the parameters.
    pub fn new(parameters: ContinuumParameters) -> Result<Self, ParameterError> {
        let ContinuumParameters { gap, speed, pressure, grains, wall, start } = parameters;
        let sizes = [
            ("cell.gap", gap, 40),
            ("cell.speeds", speed, 70),
            ("cell.pressures", pressure, 130),
            ("grains.diameter", grains.diameter, 40),
            ("grains.density", grains.density, 130),
            ("walls.diameter", wall.diameter, 40),
        ];
        sizes.into_iter().try_for_each(|(key, value, _)| positive(key, value))?;
        // For e < 1/3 the theory of nearly elastic spheres has negative terms in its viscosity.
        let e = grains.restitution;
        require((1.0 / 3.0..1.0).contains(&e), "grains.restitution", Number(e), "1/3 <= restitution < 1")?;
        let theta = wall.theta;
        require(theta > 0.0 && theta <= FRAC_PI_2, "walls.theta", Number(theta), "0 < theta <= pi/2 (radians)")?;
        restitution("walls.restitution", wall.restitution)?;
        let Roughness { r5, r6, r7, r8 } = wall.roughness;
        let allowed = format_args!("{} <= r5 <= 1: a smooth wall drives no flow", Number(SMOOTHEST));
        require((SMOOTHEST..=1.0).contains(&r5), "walls.r5", Number(r5), allowed)?;
        for (key, r) in [("walls.r6", r6), ("walls.r7", r7), ("walls.r8", r8)] {
            require((0.0..=1.0).contains(&r), key, Number(r), "a factor from 0 (smooth) to 1 (rough)")?;
        }
        sizes.into_iter().try_for_each(|(key, value, power)| of_sensible_size(key, value, power))?;
        if let SolutionStart::SolidFraction(v) = start {
            let packed = grains.radial.packed();
            require(v > 0.0 && v < packed, "start", Number(v), format_args!("0 < solid fraction < {packed}"))?;
        }
        Ok(Self { parameters })
    }

    /// The checked parameters.
    pub fn parameters(&self) -> &ContinuumParameters {
        &self.parameters
    }

    /// Half the gap in diameters.
    pub(super) fn half_gap(&self) -> f64 {
        0.5 * self.parameters.gap / self.parameters.grains.diameter
    }

    /// `P / (rho U^2)`: with the gap in diameters, the only parameter of the solution.
    pub(super) fn load(&self) -> f64 {
        self.parameters.pressure / (self.parameters.grains.density * self.parameters.speed.powi(2))
    }

    pub(super) fn bump_integrals(&self, contact: Jet) -> BumpIntegrals {
        self.parameters.wall.bump_integrals(&self.parameters.grains, contact)
    }
}
