//! Orientations at the start of a run.

use crate::columns::{ORIENTATION, ORIENTATION_NUMBERS};
use crate::model::{Model, Orientation};
use crate::rotation::orientations;
use crate::start::placement;
use domain::{Comm, Particles, Quaternion, Random, Vector};

/// Added to the seed for the random numbers of orientations, which are independent of positions and noise then.
const STREAM: u64 = 0x6f72_6965_6e74_6174;

/// Gives each sphere of a species with orientations its own, by the seed and its id; those that were provided with the
/// positions are in the column. Collective.
pub fn start(particles: &mut Particles, model: &Model, comm: &Comm) {
    if !model.has_orientations() {
        return;
    }
    placement::share_columns(particles, comm);
    let (axes, ids, kinds) = (model.user_axes(), particles.ids.clone(), particles.species.clone());
    for (own, (id, kind)) in orientations(particles).iter_mut().zip(ids.into_iter().zip(kinds)) {
        *own = match model.species[kind as usize].orientation {
            None => Quaternion::NONE,
            Some(Orientation::Given | Orientation::OfBody) => *own,
            Some(Orientation::Random) => {
                axes.orientation_in(Quaternion::random(&mut Random::new(model.seed.wrapping_add(STREAM), id)))
            }
            Some(Orientation::Aligned(along)) => {
                axes.orientation_in(Quaternion::between(Vector::Z, axes.vector(along)))
            }
        };
    }
}

/// Whether spheres of these species need orientations, which are provided then. Refuses a list that is missing or of
/// another length, and quaternions without direction.
pub fn check_given(given: Option<&[Quaternion]>, species: &[u32], model: &Model) -> Result<bool, String> {
    let of_kind = |kind: u32| model.species[kind as usize].orientation;
    let needs = |kind: u32| matches!(of_kind(kind), Some(Orientation::Given | Orientation::OfBody));
    let Some(kind) = species.iter().copied().find(|&kind| needs(kind)) else { return Ok(false) };
    let Some(given) = given else {
        return Err(match of_kind(kind) {
            Some(Orientation::OfBody) => "has no orientations, which bodies and filaments need".to_owned(),
            _ => format!("has no orientations, but species[{kind}].orientation is \"file\"; take \"random\""),
        });
    };
    if given.len() != species.len() {
        return Err(format!("has {} positions, but {} orientations", species.len(), given.len()));
    }
    let is_none = |&(_, (given, kind)): &(usize, (&Quaternion, &u32))| {
        needs(*kind) && !(given.length() > 0.0 && given.length().is_finite())
    };
    match given.iter().zip(species).enumerate().find(is_none) {
        Some((row, (none, _))) => Err(format!("has the orientation {:?} in row {row}, which is none", none.to_array())),
        None => Ok(true),
    }
}

/// Refuses particles of a saved state that have orientations where the model has none, or have none where it has.
pub fn check(particles: &Particles, model: &Model) -> Result<(), String> {
    let width = particles.columns.iter().find(|column| column.name == ORIENTATION).map_or(0, |column| column.width);
    let expected = if model.has_orientations() { ORIENTATION_NUMBERS } else { 0 };
    if width == expected {
        return Ok(());
    }
    Err("the state has other orientations than the scene; start a new run to change species.orientation".to_owned())
}
