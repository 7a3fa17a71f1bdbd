//! Bonds and traps of a scene.

use super::raw;
use crate::document::excerpt;
use crate::key_error::KeyError;
use domain::Vector;
use suspension::{Beam, Bonds, Centres, RestShape, Species, Trapped, Traps};

pub(super) fn bonds(raw: &[raw::BondsSection]) -> Result<Vec<Bonds>, KeyError> {
    let bonds = |(index, raw): (usize, &raw::BondsSection)| {
        let section = format!("bonds[{index}]");
        let beam = BeamKeys { bending: raw.bending_stiffness, twisting: raw.twisting_stiffness, rest: raw.rest_shape };
        Ok(Bonds {
            pairs: raw.pairs.clone(),
            length: raw.length,
            stiffness: raw.stiffness,
            breaking_force: raw.breaking_force,
            beam: beam.read(&section)?,
        })
    };
    raw.iter().enumerate().map(bonds).collect()
}

/// Keys of the resistance to bending in a section.
pub(super) struct BeamKeys {
    pub bending: Option<f64>,
    pub twisting: Option<f64>,
    pub rest: Option<raw::RestShapeName>,
}

impl BeamKeys {
    /// The resistance to bending; `None` without. Refuses keys that need it.
    pub(super) fn read(&self, section: &str) -> Result<Option<Beam>, KeyError> {
        let rest = match self.rest {
            None | Some(raw::RestShapeName::Start) => RestShape::Start,
            Some(raw::RestShapeName::Straight) => RestShape::Straight,
        };
        let unused = [("twisting_stiffness", self.twisting.is_some()), ("rest_shape", self.rest.is_some())];
        match (self.bending, unused.into_iter().find(|(_, is_set)| *is_set)) {
            (Some(bending), _) => Ok(Some(Beam { bending, twisting: self.twisting.unwrap_or(0.0), rest })),
            (None, None) => Ok(None),
            (None, Some((name, _))) => {
                let message = "goes with bending_stiffness; set that too, or leave it out";
                Err(KeyError::new(format!("{section}.{name}"), message))
            }
        }
    }
}

pub(super) fn traps(raw: &[raw::TrapsSection], species: &[Species]) -> Result<Vec<Traps>, KeyError> {
    let traps = |(index, raw): (usize, &raw::TrapsSection)| {
        let (of, centres) = (trapped(raw, index, species)?, centres(raw, index)?);
        Ok(Traps { of, centres, stiffness: raw.stiffness })
    };
    raw.iter().enumerate().map(traps).collect()
}

fn trapped(raw: &raw::TrapsSection, index: usize, species: &[Species]) -> Result<Trapped, KeyError> {
    match (&raw.species, &raw.particles) {
        (None, None) => Ok(Trapped::All),
        (None, Some(ids)) => Ok(Trapped::Spheres(ids.clone())),
        (Some(name), None) => of_species(name, index, species),
        (Some(_), Some(_)) => {
            let message = "is set beside traps.species; leave one of them out";
            Err(KeyError::new(format!("traps[{index}].particles"), message))
        }
    }
}

fn of_species(name: &str, index: usize, species: &[Species]) -> Result<Trapped, KeyError> {
    let place = species.iter().position(|one| one.name == name);
    place.map(|place| Trapped::Species(place as u32)).ok_or_else(|| {
        let names: Vec<String> = species.iter().map(|one| format!("\"{}\"", one.name)).collect();
        let message = format!("is \"{}\"; the scene has {}", excerpt(name), names.join(", "));
        KeyError::new(format!("traps[{index}].species"), message)
    })
}

fn centres(raw: &raw::TrapsSection, index: usize) -> Result<Centres, KeyError> {
    match (&raw.centre, &raw.centres) {
        (None, None) => Ok(Centres::AtStart),
        (Some(centre), None) => Ok(Centres::One(Vector::from_array(*centre))),
        (None, Some(list)) => Ok(Centres::Each(list.iter().map(|&centre| centre.into()).collect())),
        (Some(_), Some(_)) => {
            let message = "are set beside traps.centre; leave one of them out";
            Err(KeyError::new(format!("traps[{index}].centres"), message))
        }
    }
}
