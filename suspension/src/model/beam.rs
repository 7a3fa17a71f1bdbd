//! Stiffness of bonds against bending and twisting.

use super::{Bonds, MultipoleOrder, Parameters};
use domain::{Number, ParameterError};

/// Stiffness of bonds as of an Euler-Bernoulli beam between two spheres, whose ends are clamped in the spheres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beam {
    /// Bending stiffness `EI`: torque over curvature, a force times a squared length.
    pub bending: f64,
    /// Twisting stiffness `GJ`: torque over the angle of twist per length; 0 for bonds that twist freely.
    pub twisting: f64,
    /// Shape without load.
    pub rest: RestShape,
}

/// Shape of bonded spheres without load.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum RestShape {
    /// The shape at the start, with its curvature.
    #[default]
    Start,
    /// A straight line along each chain, without twist at the start.
    Straight,
}

/// Refusal of a bending stiffness of spheres that do not rotate.
pub(super) const MONOPOLES: &str = "is set, but spheres do not rotate with hydrodynamics.multipoles = \"monopole\"; \
    take \"dipole\", or leave it out";

impl Beam {
    pub(super) fn check(&self, key: &str) -> Result<(), ParameterError> {
        ParameterError::require_positive(&format!("{key}.bending_stiffness"), self.bending)?;
        if self.twisting >= 0.0 && self.twisting.is_finite() {
            return Ok(());
        }
        let message = format!("is {}; it needs to be 0 or more", Number(self.twisting));
        Err(ParameterError::new(format!("{key}.twisting_stiffness"), message))
    }
}

impl Parameters {
    /// Whether there are bonds that resist bending.
    pub(crate) fn has_beams(&self) -> bool {
        self.bonds.iter().any(|bonds| bonds.beam.is_some())
    }
}

/// Refuses bonds that bend between spheres that do not rotate or have no orientations, as far as the ids tell.
pub(super) fn check_rotation(p: &Parameters) -> Result<(), ParameterError> {
    let Some(index) = p.bonds.iter().position(|bonds| bonds.beam.is_some()) else { return Ok(()) };
    let key = format!("bonds[{index}].bending_stiffness");
    if p.hydrodynamics.multipoles == MultipoleOrder::Monopole {
        return Err(ParameterError::new(key, MONOPOLES));
    }
    for (index, bonds) in p.bonds.iter().enumerate().filter(|(_, bonds)| bonds.beam.is_some()) {
        check_oriented(p, bonds, &format!("bonds[{index}].bending_stiffness"))?;
    }
    Ok(())
}

fn check_oriented(p: &Parameters, bonds: &Bonds, key: &str) -> Result<(), ParameterError> {
    let mut end = Some(0);
    for species in &p.species {
        let first = end;
        end = end.zip(species.count).map(|(end, count)| end + count);
        let (Some(first), Some(end), None) = (first, end, species.orientation) else { continue };
        if let Some(id) = bonds.pairs.as_flattened().iter().find(|id| (first..end).contains(id)) {
            return Err(ParameterError::new(key, without_orientation(*id, &species.name)));
        }
    }
    Ok(())
}

/// Explanation for a sphere whose species has no orientation.
pub(crate) fn without_orientation(id: u64, species: &str) -> String {
    format!("needs orientations, which sphere {id} of species \"{species}\" has not; give it orientation = \"random\"")
}
