//! Checks of a case.

use super::{Case, CaseTerms, MOST_DRAWS, periodic};
use domain::Number;

impl Case {
    /// Refuses invalid values by key.
    pub(super) fn check(&self) -> Result<(), String> {
        self.check_particles()?;
        self.check_method()?;
        self.check_bodies()?;
        self.check_noise()?;
        self.check_multipoles()
    }

    /// Box, lists with an entry per particle, and that all numbers are finite.
    fn check_particles(&self) -> Result<(), String> {
        if self.cell.is_none() || self.boundaries != periodic() {
            self.bounded_box().map_err(|error| error.to_string())?;
        }
        let count = self.positions.len();
        if count == 0 {
            return Err("positions is empty; list [x, y, z] for every sphere".to_owned());
        }
        let fits = |key: &str, found: usize, may_be_absent: bool| {
            if found == count || (may_be_absent && found == 0) {
                return Ok(());
            }
            Err(format!("{key} has {found} entries, but there are {count} positions; it needs one for each"))
        };
        fits("radii", self.radii().len(), false)?;
        fits("forces", self.forces.len(), true)?;
        fits("torques", self.torques.len(), true)?;
        fits("stresslets", self.stresslets.len(), true)?;
        let finite = |key: &str, mut numbers: Box<dyn Iterator<Item = f64> + '_>| {
            let wrong = numbers.find(|n| !n.is_finite());
            wrong.map_or(Ok(()), |n| Err(format!("{key} contains {n}; every number needs to be finite")))
        };
        finite("positions", Box::new(self.positions.iter().flatten().copied()))?;
        finite("forces", Box::new(self.forces.iter().flatten().copied()))?;
        finite("torques", Box::new(self.torques.iter().flatten().copied()))?;
        finite("stresslets", Box::new(self.stresslets.iter().flatten().copied()))?;
        finite("background.velocity_gradient", Box::new(self.background.velocity_gradient.into_iter().flatten()))?;
        finite("background.pressure_gradient", Box::new(self.background.pressure_gradient.into_iter()))?;
        if !(self.viscosity.is_finite() && self.viscosity > 0.0) {
            return Err(format!("viscosity is {}; it needs to be positive and finite", Number(self.viscosity)));
        }
        Ok(())
    }

    /// Rigidity and lubrication.
    fn check_method(&self) -> Result<(), String> {
        if self.is_rigid() && self.has_stresslets() {
            return Err("stresslets are given, but rigid particles have their own; set rigid to false".to_owned());
        }
        if self.lubrication && !self.is_rigid() {
            return Err("lubrication is true, but that is for rigid particles with dipoles; set rigid to true and \
                        multipoles to \"dipole\", or lubrication to false"
                .to_owned());
        }
        if let Some(cutoff) = self.lubrication_cutoff.filter(|c| !(self.lubrication && *c > 1e-3 && *c <= 8.0)) {
            return Err(format!(
                "lubrication_cutoff is {}; it needs 0.001 < lubrication_cutoff <= 8, in radii of a pair's larger \
                 sphere, and lubrication true",
                Number(cutoff)
            ));
        }
        Ok(())
    }

    /// Bodies have numbers without a gap, and are made of rigid particles.
    fn check_bodies(&self) -> Result<(), String> {
        let count = self.positions.len();
        if ![0, count].contains(&self.bodies.len()) {
            return Err(format!("bodies has {} entries, but there are {count} positions", self.bodies.len()));
        }
        let mut numbers: Vec<i64> = self.bodies.iter().copied().filter(|&number| number != -1).collect();
        numbers.sort_unstable();
        numbers.dedup();
        if let Some((place, wrong)) = (0..).zip(&numbers).find(|(place, number)| place != *number) {
            return Err(format!(
                "bodies has the number {wrong}, but no {place}; number bodies from 0, free particles -1"
            ));
        }
        if !numbers.is_empty() && !self.is_rigid() {
            return Err(
                "bodies are made of rigid particles with dipoles; set rigid to true and multipoles to \"dipole\""
                    .to_owned(),
            );
        }
        if !numbers.is_empty() && self.noise.is_some_and(|noise| noise.drift) {
            return Err("noise.drift is true, but the drift is that of free particles; leave out bodies".to_owned());
        }
        Ok(())
    }

    fn check_noise(&self) -> Result<(), String> {
        if self.noise.is_some_and(|noise| noise.draws == 0 || noise.draws > MOST_DRAWS) {
            return Err(format!("noise.draws needs to be 1 to {MOST_DRAWS}"));
        }
        if self.noise.is_some_and(|noise| noise.drift) && !self.is_rigid() {
            return Err("noise.drift is true, but only rigid particles drift; set rigid to true and multipoles to \
                \"dipole\", or noise.drift to false"
                .to_owned());
        }
        Ok(())
    }

    fn check_multipoles(&self) -> Result<(), String> {
        if self.multipoles == CaseTerms::Monopole {
            let twisted = self.torques.iter().flatten().any(|&t| t != 0.0);
            if twisted || self.has_stresslets() {
                return Err(
                    "torques or stresslets are given, but multipoles is \"monopole\"; use \"dipole\"".to_owned()
                );
            }
        }
        Ok(())
    }

    /// Whether the particles are rigid, with stresslets of their own.
    fn is_rigid(&self) -> bool {
        self.rigid && self.multipoles == CaseTerms::Dipole
    }

    fn has_stresslets(&self) -> bool {
        self.stresslets.iter().flatten().any(|&s| s != 0.0)
    }
}
