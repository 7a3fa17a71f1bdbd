//! The attraction of a scene.

use super::{KeyError, raw};
use raw::AttractionKind::{Depletion, VanDerWaals};
use suspension::Attraction;

pub(super) fn attraction(raw: &raw::AttractionSection) -> Result<Attraction, KeyError> {
    let keys = [
        ("hamaker", raw.hamaker.is_some(), VanDerWaals),
        ("regularisation_length", raw.regularisation_length.is_some(), VanDerWaals),
        ("range", raw.range.is_some(), VanDerWaals),
        ("osmotic_pressure", raw.osmotic_pressure.is_some(), Depletion),
        ("depletant_radius", raw.depletant_radius.is_some(), Depletion),
    ];
    if let Some((name, ..)) = keys.into_iter().find(|&(_, is_set, kind)| is_set && kind != raw.kind) {
        let message = "goes with another attraction.kind; leave it out or change that";
        return Err(KeyError::new(format!("attraction.{name}"), message));
    }
    let needed = |name: &str, value: Option<f64>| {
        value.ok_or_else(|| KeyError::new(format!("attraction.{name}"), "is missing; this kind of attraction needs it"))
    };
    Ok(match raw.kind {
        VanDerWaals => Attraction::VanDerWaals {
            hamaker: needed("hamaker", raw.hamaker)?,
            closest: raw.regularisation_length.unwrap_or(Attraction::CLOSEST),
            range: raw.range.unwrap_or(Attraction::RANGE),
        },
        Depletion => Attraction::Depletion {
            pressure: needed("osmotic_pressure", raw.osmotic_pressure)?,
            radius: needed("depletant_radius", raw.depletant_radius)?,
        },
    })
}
