//! Harmonic traps.

use super::Parameters;
use super::bonds::{counted, unless_known};
use crate::model::box_axes::UserAxes;
use domain::{Number, ParameterError, Vector};

/// Harmonic traps, one for each of some spheres, with the force `-stiffness (x - centre)`.
#[derive(Debug, Clone, PartialEq)]
pub struct Traps {
    /// The trapped spheres.
    pub of: Trapped,
    /// Centres of the traps.
    pub centres: Centres,
    /// Spring constant: force over the distance from the centre.
    pub stiffness: f64,
}

/// The trapped spheres.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Trapped {
    /// All spheres.
    All,
    /// All spheres of a species, given by its index in the list of species.
    Species(u32),
    /// Spheres with these ids, counted from 0 in the order of the species or of the list of positions.
    Spheres(Vec<u64>),
}

/// Centres of the traps.
#[derive(Debug, Clone, PartialEq)]
pub enum Centres {
    /// Each trap is centred at the initial position of its sphere.
    AtStart,
    /// One centre for all.
    One(Vector),
    /// One centre for each sphere, in the order of the listed ids.
    Each(Vec<Vector>),
}

impl Traps {
    /// Index of the trap of a sphere in the list of centres; `None` if the sphere is not trapped.
    pub(crate) fn place_of(&self, id: u64, species: u32) -> Option<usize> {
        match &self.of {
            Trapped::All => Some(0),
            Trapped::Species(trapped) => (*trapped == species).then_some(0),
            Trapped::Spheres(ids) => ids.iter().position(|&trapped| trapped == id),
        }
    }

    /// Refuses ids beyond the last of `count` spheres; `index` is the position of these traps in the model.
    pub(crate) fn check_ids(&self, index: usize, count: u64) -> Result<(), ParameterError> {
        match &self.of {
            Trapped::Spheres(ids) => unless_known(&format!("traps[{index}].particles"), ids, count),
            _ => Ok(()),
        }
    }

    fn check(&self, key: &str, axes: &UserAxes) -> Result<(), ParameterError> {
        ParameterError::require_positive(&format!("{key}.stiffness"), self.stiffness)?;
        if let Trapped::Spheres(ids) = &self.of {
            let key = format!("{key}.particles");
            if ids.is_empty() {
                return Err(ParameterError::new(key, "is empty; list ids, or leave it out for all spheres"));
            }
        }
        match &self.centres {
            Centres::AtStart => Ok(()),
            Centres::One(centre) => {
                ParameterError::require_finite_vector(&format!("{key}.centre"), axes.place(*centre)).map(drop)
            }
            Centres::Each(list) => self.check_list(&format!("{key}.centres"), list, axes),
        }
    }

    fn check_list(&self, key: &str, list: &[Vector], axes: &UserAxes) -> Result<(), ParameterError> {
        let Trapped::Spheres(ids) = &self.of else {
            let message = "go with a list of particles, one for each; write centre = [x, y, z] for one that all have";
            return Err(ParameterError::new(key, message));
        };
        if ids.len() != list.len() {
            let message = format!("has {} positions for {} particles; give one for each", list.len(), ids.len());
            return Err(ParameterError::new(key, message));
        }
        for (row, &centre) in list.iter().enumerate() {
            ParameterError::require_finite_vector(&format!("{key}[{row}]"), axes.place(centre))?;
        }
        Ok(())
    }

    /// The trapped ids (as `[1, id]`) and species (as `[0, species]`).
    fn named(&self, p: &Parameters) -> Vec<[u64; 2]> {
        match &self.of {
            Trapped::All => (0..p.species.len() as u64).map(|species| [0, species]).collect(),
            Trapped::Species(species) => vec![[0, u64::from(*species)]],
            Trapped::Spheres(ids) => ids.iter().map(|&id| [1, id]).collect(),
        }
    }
}

/// Checks all traps of a model.
pub(super) fn check(p: &Parameters) -> Result<(), ParameterError> {
    for (index, traps) in p.traps.iter().enumerate() {
        traps.check(&format!("traps[{index}]"), &p.user_axes())?;
        counted(&p.species).map_or(Ok(()), |count| traps.check_ids(index, count))?;
    }
    if !p.traps.is_empty() && p.shear_rates().stress().is_some() {
        let message = "can't be with flow.control = \"stress\": the traps carry part of the stress; give flow.rate";
        return Err(ParameterError::new("traps", message));
    }
    let mut named: Vec<([u64; 2], usize)> =
        p.traps.iter().enumerate().flat_map(|(k, traps)| traps.named(p).into_iter().map(move |one| (one, k))).collect();
    named.sort_unstable();
    match named.windows(2).find(|two| two[0].0 == two[1].0) {
        Some([([kind, number], first), (_, second)]) => {
            let what = match kind {
                0 => format!("species \"{}\"", p.species[*number as usize].name),
                _ => format!("sphere {}", Number(*number as f64)),
            };
            let message = format!("hold {what}, as traps[{first}] do already; a sphere can be in one trap");
            Err(ParameterError::new(format!("traps[{second}]"), message))
        }
        _ => Ok(()),
    }
}
