//! Forces between surfaces: repulsion and attraction.

use super::pairwise::{PairLaw, PairwiseForce};
use crate::model::{Attraction, Model, Repulsion};
use domain::Vector;
use hydrodynamics::TakenForce;
use lubrication::{Barrier, BarrierError, PairKind, SurfaceForce};

/// Repulsion or attraction, which are added pair by pair.
pub type SurfaceForces = PairwiseForce<SurfaceLaw>;

/// Law of repulsion or attraction.
#[derive(Debug, Clone, Copy)]
pub struct SurfaceLaw {
    name: &'static str,
    force: SurfaceForce,
}

const REPULSION: &str = "repulsion";
const ATTRACTION: &str = "attraction";

impl PairLaw for SurfaceLaw {
    fn name(&self) -> &'static str {
        self.name
    }

    fn reach(&self, between: PairKind) -> f64 {
        self.force.reach(between)
    }

    fn force(&self, separation: Vector, between: PairKind) -> Vector {
        self.force.force(separation, between)
    }

    fn is_implicit(&self) -> bool {
        self.name == REPULSION
    }

    fn stiffness(&self, gap: f64, between: PairKind) -> f64 {
        self.force.stiffness(gap, between)
    }
}

impl SurfaceForces {
    /// Surface forces of a model, without laws if it has none.
    pub fn of(model: &Model) -> Result<Self, BarrierError> {
        let repulsion = repulsion(model)?.map(|force| SurfaceLaw { name: REPULSION, force });
        let attraction = model.attraction.map(Attraction::force).map(|force| SurfaceLaw { name: ATTRACTION, force });
        Ok(Self::of_laws("surface", repulsion.into_iter().chain(attraction).collect()))
    }

    /// Repulsion and attraction as the solver takes them.
    pub fn between_spheres(&self) -> Vec<TakenForce> {
        self.laws().iter().map(|law| TakenForce { force: law.force, is_implicit: law.is_implicit() }).collect()
    }

    /// Gap over the mean radius up to which spheres of a model repel each other; 0 without repulsion.
    pub fn repulsion_range(&self, model: &Model) -> f64 {
        let smallest = model.species.iter().map(|s| s.radius).fold(f64::INFINITY, f64::min);
        match self.laws().iter().find(|law| law.name == REPULSION).map(|law| law.force) {
            Some(SurfaceForce::Barrier(barrier)) => barrier.range(),
            Some(SurfaceForce::Screened { length, .. }) => length / smallest,
            _ => 0.0,
        }
    }
}

/// Repulsion of a model, if there is any.
pub fn repulsion(model: &Model) -> Result<Option<SurfaceForce>, BarrierError> {
    let usual = if model.hydrodynamics.lubrication { Barrier::RANGE_WITH_LUBRICATION } else { Barrier::RANGE_ALONE };
    let force = |r: Repulsion| match r.screening_length {
        None => {
            let barrier = Barrier::new(r.strength, r.range.unwrap_or(usual))?;
            Ok(SurfaceForce::Barrier(barrier.growing(r.radius_power)))
        }
        Some(length) => Ok(SurfaceForce::Screened { strength: r.strength, radius_power: r.radius_power, length }),
    };
    model.repulsion.map(force).transpose()
}
