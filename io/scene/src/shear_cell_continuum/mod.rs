//! Scenes of the continuum shear cell.

mod raw;

use crate::checks::rows;
use crate::key_error::KeyError;
use domain::Number;
use granular::kinetic_theory::{
    ContinuumParameters, ContinuumProblem, GrainProperties, RadialDistribution, Roughness, SolutionStart, Wall,
    WallShape,
};
pub(super) use raw::ContinuumSections;
use std::path::PathBuf;

/// A checked scene of the continuum shear cell; only [`Scene`](crate::Scene) makes one.
#[derive(Debug)]
#[non_exhaustive]
pub struct ContinuumScene {
    /// Title in plots and files.
    pub title: String,
    /// The problems to solve: every pressure at every speed, ordered by pressure.
    pub problems: Vec<ContinuumProblem>,
    /// Number of heights in each profile.
    pub points: usize,
    /// Results folder; `None` if the caller chooses it.
    pub folder: Option<PathBuf>,
}

/// Largest number of problems of a scene.
const MOST_PROBLEMS: f64 = 100_000.0;
/// Default number of heights in a profile.
const POINTS: usize = 101;

impl ContinuumScene {
    pub(super) fn checked(raw: ContinuumSections) -> Result<Self, KeyError> {
        for (key, list) in [("cell.speeds", &raw.cell.speeds), ("cell.pressures", &raw.cell.pressures)] {
            if list.is_empty() {
                return Err(KeyError::new(key, "is empty; list at least one value"));
            }
        }
        let problems = raw.cell.speeds.len() as f64 * raw.cell.pressures.len() as f64;
        if problems > MOST_PROBLEMS {
            let message =
                format!("and cell.pressures make {problems:.1e} problems; at most {MOST_PROBLEMS} are solved");
            return Err(KeyError::new("cell.speeds", message));
        }
        let points = rows("output.points", raw.output.points.unwrap_or(POINTS))?;
        if points < 2 {
            return Err(KeyError::new("output.points", format!("is {points}; a profile needs at least 2 heights")));
        }
        let (grains, wall) = (grains(&raw.grains), wall(&raw)?);
        let start = raw.start.map_or(SolutionStart::Densest, SolutionStart::SolidFraction);
        let mut problems = Vec::new();
        for &pressure in &raw.cell.pressures {
            for &speed in &raw.cell.speeds {
                problems.push(ContinuumProblem::new(ContinuumParameters {
                    gap: raw.cell.gap,
                    speed,
                    pressure,
                    grains,
                    wall,
                    start,
                })?);
            }
        }
        Ok(Self { title: raw.title.unwrap_or_default(), problems, points, folder: raw.output.folder })
    }
}

fn grains(raw: &raw::ContinuumGrainsSection) -> GrainProperties {
    let radial = match raw.radial_distribution {
        raw::RadialDistributionKind::CarnahanStarling => RadialDistribution::CarnahanStarling,
        raw::RadialDistributionKind::LunSavage => RadialDistribution::LunSavage,
        raw::RadialDistributionKind::JohnsonJackson => RadialDistribution::JohnsonJackson,
        raw::RadialDistributionKind::SinclairJackson => RadialDistribution::SinclairJackson,
        raw::RadialDistributionKind::MaAhmadi => RadialDistribution::MaAhmadi,
        raw::RadialDistributionKind::Torquato => RadialDistribution::Torquato,
    };
    GrainProperties { diameter: raw.diameter, density: raw.density, restitution: raw.restitution, radial }
}

fn wall(raw: &ContinuumSections) -> Result<Wall, KeyError> {
    let walls = &raw.walls;
    let degrees = walls.theta.unwrap_or(90.0);
    if !(degrees > 0.0 && degrees <= 90.0) {
        let message = format!("is {}; it needs 0 < theta <= 90 (degrees)", Number(degrees));
        return Err(KeyError::new("walls.theta", message));
    }
    let shape = match walls.shape {
        raw::WallShapeKind::Disk => WallShape::Disk,
        raw::WallShapeKind::Sphere => WallShape::Sphere,
    };
    Ok(Wall {
        shape,
        theta: degrees.to_radians(),
        gradient: walls.gradient,
        diameter: walls.diameter.unwrap_or(raw.grains.diameter),
        restitution: walls.restitution,
        roughness: Roughness { r5: walls.r5, r6: walls.r6, r7: walls.r7, r8: walls.r8 },
    })
}
