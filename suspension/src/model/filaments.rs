//! Flexible filaments: chains of bonded spheres, which start as straight rods or from a file.

use super::{Beam, Bodies, Bonds, MultipoleOrder, Parameters, RestShape, Species, beam};
use domain::{BodyShape, EqualSpheres, ParameterError, Vector};

/// Filaments of one kind. Their spheres are particles of a species of their own, which [`Parameters::with_filaments`]
/// adds together with their bonds.
#[derive(Debug, Clone, PartialEq)]
pub struct Filaments {
    /// Name, and places and orientations at the start, when each is a straight rod along the third of its axes unless
    /// its spheres come from a file; and loads, which the spheres share. Motions and torques are not given.
    pub rods: Bodies,
    /// Spring constant of the bonds along them: force over extension.
    pub stiffness: f64,
    /// Resistance to bending and twisting; `None` for chains of freely jointed spheres.
    pub beam: Option<Beam>,
    /// Tension above which a bond breaks; `None` for bonds that never break.
    pub breaking_force: Option<f64>,
}

impl Filaments {
    /// Filaments without loads at random places, which resist bending with a stiffness `EI` and twist freely.
    pub fn new(name: &str, spheres: EqualSpheres, count: u64, [stiffness, bending]: [f64; 2]) -> Self {
        let beam = Beam { bending, twisting: 0.0, rest: RestShape::Straight };
        let rods = Bodies::new(name, BodyShape::Rod(spheres).spheres(), count);
        Self { rods, stiffness, beam: Some(beam), breaking_force: None }
    }

    /// Bonds of these filaments, whose first sphere has the id `first`.
    fn bonds(&self, first: u64) -> Bonds {
        let spheres = self.rods.spheres.len() as u64;
        let places: Vec<Vector> = self.rods.spheres.iter().take(2).map(|one| one.position).collect();
        let of_one = |filament: u64| {
            let start = first + filament * spheres;
            (start..(start + spheres).saturating_sub(1)).map(|id| [id, id + 1])
        };
        Bonds {
            pairs: (0..self.rods.count).flat_map(of_one).collect(),
            length: places.windows(2).map(|two| two[0].distance(two[1])).next(),
            stiffness: self.stiffness,
            breaking_force: self.breaking_force,
            beam: self.beam,
        }
    }

    fn check(&self, index: usize, p: &Parameters) -> Result<(), ParameterError> {
        let key = format!("filaments[{index}]");
        self.rods.check(&key, p)?;
        if self.rods.spheres.len() < 2 {
            return Err(ParameterError::new(format!("{key}.spheres"), "needs to be 2 at least"));
        }
        ParameterError::require_positive(&format!("{key}.stiffness"), self.stiffness)?;
        if let Some(force) = self.breaking_force {
            ParameterError::require_positive(&format!("{key}.breaking_force"), force)?;
        }
        if self.beam.is_some() && p.hydrodynamics.multipoles == MultipoleOrder::Monopole {
            return Err(ParameterError::new(format!("{key}.bending_stiffness"), beam::MONOPOLES));
        }
        self.beam.map_or(Ok(()), |beam| beam.check(&key))
    }
}

impl Parameters {
    /// These parameters with filaments in addition, their species and their bonds. It is called once, when the other
    /// species are complete.
    #[must_use]
    pub fn with_filaments(mut self, filaments: Vec<Filaments>) -> Self {
        let mut first: u64 = self.species.iter().filter_map(|species| species.count).sum();
        for one in &filaments {
            self.bonds.push(one.bonds(first));
            let oriented = |species: Species| Species { orientation: one.beam.and(species.orientation), ..species };
            self.species.extend(one.rods.species().into_iter().map(oriented));
            first += one.rods.count * one.rods.spheres.len() as u64;
        }
        Self { filaments, ..self }
    }
}

/// Checks all filaments.
pub(super) fn check(p: &Parameters) -> Result<(), ParameterError> {
    if p.filaments.is_empty() {
        return Ok(());
    }
    if !p.bodies.is_empty() {
        return Err(ParameterError::new("filaments[0]", "can't be with [[bodies]] yet; leave one of them out"));
    }
    p.filaments.iter().enumerate().try_for_each(|(index, one)| one.check(index, p))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Model;
    use domain::PeriodicBox;

    fn model(change: &dyn Fn(&mut Filaments)) -> Result<Model, String> {
        let cell = PeriodicBox::new(Vector::splat(30.0)).unwrap();
        let usual = Parameters::new(cell, 1.0, vec![Species::new("free", 1.0, 5)], 0.1, 1);
        let mut filaments = Filaments::new("threads", EqualSpheres { number: 3, radius: 1.0, gap: 0.2 }, 2, [9.0, 4.0]);
        change(&mut filaments);
        Model::new(usual.with_filaments(vec![filaments])).map_err(|error| error.to_string())
    }

    #[test]
    fn spheres_of_filaments_are_bonded_in_a_row_after_the_others() {
        let model = model(&|_| {}).unwrap();
        assert_eq!(model.bonds[0].pairs, [[5, 6], [6, 7], [8, 9], [9, 10]]);
        assert_eq!((model.species[1].count, model.free_species(), model.free_spheres()), (Some(6), 1, 5));
        assert!(model.has_orientations() && model.bodies.is_empty());
    }

    #[test]
    fn filaments_out_of_range_are_named() {
        let said = |change: &dyn Fn(&mut Filaments)| model(change).unwrap_err();
        assert!(said(&|one| one.stiffness = 0.0).starts_with("filaments[0].stiffness"));
        assert!(said(&|one| one.beam.as_mut().unwrap().bending = -1.0).starts_with("filaments[0].bending_stiffness"));
        assert!(said(&|one| one.beam.as_mut().unwrap().twisting = -1.0).starts_with("filaments[0].twisting_stiffness"));
        assert!(said(&|one| one.breaking_force = Some(f64::NAN)).starts_with("filaments[0].breaking_force"));
        assert!(said(&|one| one.rods.count = 0).starts_with("filaments[0].count"));
        assert!(said(&|one| one.rods.spheres.truncate(1)).starts_with("filaments[0].spheres"));
    }
}
