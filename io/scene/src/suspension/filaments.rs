//! Filaments of a scene.

use super::bodies::BodiesReader;
use super::tethers::BeamKeys;
use super::{KeyError, raw};
use crate::document::NumberOr;
use suspension::{Filaments, Species};

/// Filaments of a scene with these other species, in a box of a volume.
pub(super) fn filaments(
    raw: &raw::SuspensionSections,
    species: &[Species],
    volume: f64,
) -> Result<Vec<Filaments>, KeyError> {
    let mut all: Vec<Filaments> = Vec::new();
    for (index, one) in raw.filaments.iter().enumerate() {
        let section = format!("filaments[{index}]");
        let beam = BeamKeys {
            bending: one.bending_stiffness,
            twisting: one.twisting_stiffness,
            rest: one.bending_stiffness.map(|_| raw::RestShapeName::Straight),
        };
        let beam = beam.read(&section)?;
        let rod = rod(one);
        let reader = BodiesReader { raw, one: &rod, section };
        let mut rods = reader.bodies(volume)?;
        if rods.name.is_empty() {
            rods.name = format!("filament {}", index + 1);
        }
        let taken = species.iter().map(|one| &one.name).chain(all.iter().map(|one| &one.rods.name));
        if taken.clone().any(|name| *name == rods.name) {
            return reader.fault("name", format!("is \"{}\", which another name is already; take another", rods.name));
        }
        all.push(Filaments { rods, stiffness: one.stiffness, beam, breaking_force: one.breaking_force });
    }
    Ok(all)
}

/// The section of rods as which filaments start.
fn rod(one: &raw::FilamentsSection) -> raw::BodiesSection {
    raw::BodiesSection {
        name: one.name.clone(),
        shape: Some(raw::BodyShapeName::Rod),
        spheres: Some(NumberOr::Number(one.spheres as f64)),
        radius: Some(one.radius),
        gap: one.gap,
        count: one.count,
        volume_fraction: one.volume_fraction,
        positions: one.positions.clone(),
        orientation: one.orientation,
        orientation_axis: one.orientation_axis,
        density_difference: one.density_difference,
        force: one.force,
        ..raw::BodiesSection::default()
    }
}
