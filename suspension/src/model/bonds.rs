//! Bonds between listed spheres.

use super::{Beam, Parameters, Species, beam};
use domain::{Number, ParameterError};

/// Bonds of one kind, each a spring along the line of centres of two spheres, which may resist bending as well.
#[derive(Debug, Clone, PartialEq)]
pub struct Bonds {
    /// Ids of the bonded spheres, counted from 0 in the order of the species or of the list of positions.
    pub pairs: Vec<[u64; 2]>,
    /// Distance of the centres at rest; `None` for their distance at the start.
    pub length: Option<f64>,
    /// Spring constant: force over extension.
    pub stiffness: f64,
    /// Tension above which a bond breaks at the end of a step; `None` for bonds that never break.
    pub breaking_force: Option<f64>,
    /// Resistance to bending and twisting; `None` for spheres that rotate freely.
    pub beam: Option<Beam>,
}

impl Bonds {
    fn check(&self, key: &str, shortest: f64) -> Result<(), ParameterError> {
        ParameterError::require_positive(&format!("{key}.stiffness"), self.stiffness)?;
        if let Some(force) = self.breaking_force {
            ParameterError::require_positive(&format!("{key}.breaking_force"), force)?;
        }
        self.beam.map_or(Ok(()), |beam| beam.check(key))?;
        if let Some(length) = self.length {
            let key = format!("{key}.length");
            ParameterError::require_positive(&key, length)?;
            if length >= 0.5 * shortest {
                let (length, half) = (Number(length), Number(0.5 * shortest));
                let message =
                    format!("is {length}; a bond needs to be shorter than half of the box's shortest edge, {half}");
                return Err(ParameterError::new(key, message));
            }
        }
        if self.pairs.is_empty() {
            return Err(ParameterError::new(
                format!("{key}.pairs"),
                "is empty; list pairs of ids, as [[0, 1], [1, 2]]",
            ));
        }
        Ok(())
    }
}

/// Checks all bonds of a model.
pub(super) fn check(p: &Parameters) -> Result<(), ParameterError> {
    for (index, bonds) in p.bonds.iter().enumerate() {
        bonds.check(&format!("bonds[{index}]"), p.shortest_vector())?;
    }
    check_pairs(&p.bonds)?;
    counted(&p.species).map_or(Ok(()), |count| check_ids(&p.bonds, count))?;
    beam::check_rotation(p)
}

/// Number of spheres, if the species give it.
pub(super) fn counted(species: &[Species]) -> Option<u64> {
    species.iter().map(|s| s.count).sum()
}

/// All pairs with the keys under which messages name them.
fn keyed(bonds: &[Bonds]) -> impl Iterator<Item = (String, [u64; 2])> + '_ {
    let of_one = |(k, bonds): (usize, &'_ Bonds)| {
        let pairs = bonds.pairs.clone().into_iter().enumerate();
        pairs.map(move |(row, pair)| (format!("bonds[{k}].pairs[{row}]"), pair))
    };
    bonds.iter().enumerate().flat_map(of_one)
}

fn check_pairs(bonds: &[Bonds]) -> Result<(), ParameterError> {
    let mut all: Vec<(String, [u64; 2])> = Vec::new();
    for (key, [first, second]) in keyed(bonds) {
        if first == second {
            return Err(ParameterError::new(key, format!("bonds sphere {first} to itself; name two")));
        }
        all.push((key, [first.min(second), first.max(second)]));
    }
    all.sort_by_key(|(_, pair)| *pair);
    match all.windows(2).find(|two| two[0].1 == two[1].1) {
        Some([(one, [first, second]), (other, _)]) => {
            let message = format!("bonds spheres {first} and {second}, as {one} does already; leave one of them out");
            Err(ParameterError::new(other.clone(), message))
        }
        _ => Ok(()),
    }
}

/// Refuses bonds with ids beyond the last of `count` spheres.
pub(crate) fn check_ids(bonds: &[Bonds], count: u64) -> Result<(), ParameterError> {
    for (key, pair) in keyed(bonds) {
        unless_known(&key, &pair, count)?;
    }
    Ok(())
}

/// Refuses ids beyond the last of `count` spheres.
pub(super) fn unless_known(key: &str, ids: &[u64], count: u64) -> Result<(), ParameterError> {
    match ids.iter().find(|&&id| id >= count) {
        Some(id) => {
            let message = format!("names sphere {id}; the scene has {count}, from 0 to {}", count.saturating_sub(1));
            Err(ParameterError::new(key, message))
        }
        None => Ok(()),
    }
}
