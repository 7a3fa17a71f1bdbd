//! Bonds and traps of a scene.

use super::raw;
use crate::document::excerpt;
use crate::key_error::KeyError;
use domain::Vector;
use suspension::{Bonds, Centres, Species, Trapped, Traps};

pub(super) fn bonds(raw: &[raw::BondsSection]) -> Vec<Bonds> {
    let bonds = |raw: &raw::BondsSection| Bonds {
        pairs: raw.pairs.clone(),
        length: raw.length,
        stiffness: raw.stiffness,
        breaking_force: raw.breaking_force,
    };
    raw.iter().map(bonds).collect()
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
