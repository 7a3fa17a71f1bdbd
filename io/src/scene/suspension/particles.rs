//! The spheres of a scene: their species and where they start.

use super::super::checks::{DENSEST, few_enough, finite, positive, vector, volume};
use super::{Fault, raw};
use domain::{Number, PeriodicBox, Vector};
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// A kind of spheres.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Species {
    /// Its name in tables.
    pub name: String,
    /// Radius.
    pub radius: f64,
    /// How many; `None` where the file of positions says it.
    pub count: Option<u64>,
    /// Density less that of the fluid.
    pub density_difference: f64,
    /// Steady force on each, besides its weight.
    pub force: Vector,
    /// Steady torque on each.
    pub torque: Vector,
}

impl Species {
    /// The steady force on a sphere of this species and of the given radius: its own, and its weight less its buoyancy.
    pub fn force_on(&self, radius: f64, gravity: Vector) -> Vector {
        self.force + gravity * (self.density_difference * volume(radius))
    }
}

/// Where the spheres are at first.
#[derive(Debug, Clone, PartialEq)]
pub enum Start {
    /// At random without overlap.
    Random {
        /// Smallest gap between surfaces.
        minimum_gap: f64,
    },
    /// On a lattice, the species mixed at random.
    Lattice(Lattice),
    /// At the places that the scene lists, species by species.
    Positions(Vec<Vector>),
    /// At the places that a file or a former run has.
    File(PathBuf),
}

/// Cubic lattices.
#[derive(Deserialize, Debug, Clone, Copy, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum Lattice {
    /// One site a cell.
    SimpleCubic,
    /// Four sites a cell.
    FaceCentredCubic,
}

pub(super) fn species(raw: &raw::Raw, cell: &PeriodicBox) -> Result<Vec<Species>, Fault> {
    if raw.species.is_empty() {
        return Err(Fault::new("species", "is empty; write at least one [[species]] section"));
    }
    let species: Vec<Species> =
        (0..raw.species.len()).map(|index| one_species(raw, index, cell)).collect::<Result<_, _>>()?;
    for (index, one) in species.iter().enumerate() {
        if species[..index].iter().any(|other| other.name == one.name) {
            let message = format!("is \"{}\", as another species' name; give each its own", one.name);
            return Err(Fault::new(format!("species[{index}].name"), message));
        }
    }
    let total: f64 = species.iter().map(|s| s.count.unwrap_or(0) as f64).sum();
    few_enough("species", "a list of several", (total, "spheres"))?;
    let filled: f64 = species.iter().map(|s| s.count.unwrap_or(0) as f64 * volume(s.radius)).sum();
    let fraction = filled / cell.volume();
    if fraction >= DENSEST {
        let filled = Number(fraction);
        let message = format!("fill {filled:.3} of the box together; spheres need less than {DENSEST}");
        return Err(Fault::new("species", message));
    }
    Ok(species)
}

fn one_species(raw: &raw::Raw, index: usize, cell: &PeriodicBox) -> Result<Species, Fault> {
    let one = &raw.species[index];
    let key = |name: &str| format!("species[{index}].{name}");
    let radius = positive(&key("radius"), one.radius)?;
    let shortest = cell.edges().min_element();
    if 2.0 * radius >= shortest {
        let (radius, shortest) = (Number(radius), Number(shortest));
        let message =
            format!("is {radius}; a sphere needs to be smaller than the box, whose shortest edge is {shortest}");
        return Err(Fault::new(key("radius"), message));
    }
    if one.density_difference.is_some() && raw.gravity.is_none() {
        let message = "is set, but there is no [gravity]; write [gravity] acceleration = [x, y, z], or a force instead";
        return Err(Fault::new(key("density_difference"), message));
    }
    Ok(Species {
        name: one.name.clone().unwrap_or_else(|| format!("{}", index + 1)),
        radius,
        count: count(raw, index, cell)?,
        density_difference: finite(&key("density_difference"), one.density_difference.unwrap_or(0.0))?,
        force: vector(&key("force"), one.force)?,
        torque: vector(&key("torque"), one.torque)?,
    })
}

fn count(raw: &raw::Raw, index: usize, cell: &PeriodicBox) -> Result<Option<u64>, Fault> {
    let one = &raw.species[index];
    let fault = |name: &str, message: String| Err(Fault::new(format!("species[{index}]{name}"), message));
    let from_file = raw.particles.initial == raw::Initial::File;
    match (one.count, one.volume_fraction) {
        (None, None) if from_file => Ok(None),
        (None, None) => fault("", "has neither count nor volume_fraction; set one of them".into()),
        (Some(_), Some(_)) => fault("", "has both count and volume_fraction; leave one of them out".into()),
        (Some(0), None) => fault(".count", "is 0; a species needs at least one sphere".into()),
        (Some(count), None) => {
            few_enough(&format!("species[{index}].count"), &format!("{count}"), (count as f64, "spheres"))?;
            Ok(Some(count))
        }
        (None, Some(fraction)) if !(fraction > 0.0 && fraction < DENSEST) => {
            let message = format!("is {}; spheres need 0 < volume_fraction < {DENSEST}", Number(fraction));
            fault(".volume_fraction", message)
        }
        (None, Some(fraction)) => {
            let count = (fraction * cell.volume() / volume(one.radius)).round();
            let found = format!("{fraction}, with species[{index}].radius = {}", one.radius);
            few_enough(&format!("species[{index}].volume_fraction"), &found, (count, "spheres"))?;
            let count = count as u64;
            if count > 0 {
                return Ok(Some(count));
            }
            fault(
                ".volume_fraction",
                format!("is {}, which is less than one sphere in this box; set count instead", Number(fraction)),
            )
        }
    }
}

pub(super) fn start(raw: &raw::Particles, species: &[Species], folder: &Path) -> Result<Start, Fault> {
    use raw::Initial::{File, Lattice, Positions, Random};
    let belongs = [
        ("minimum_gap", raw.minimum_gap.is_some(), Random, "random"),
        ("lattice", raw.lattice.is_some(), Lattice, "lattice"),
        ("path", raw.path.is_some(), File, "file"),
        ("positions", raw.positions.is_some(), Positions, "positions"),
    ];
    for (name, is_set, initial, with) in belongs {
        if is_set && raw.initial != initial {
            let message = format!("goes with particles.initial = \"{with}\" only; leave it out or change that");
            return Err(Fault::new(format!("particles.{name}"), message));
        }
    }
    let missing = |name: &str, what: &str| Fault::new(format!("particles.{name}"), format!("is missing; {what}"));
    match raw.initial {
        Random => Ok(Start::Random { minimum_gap: gap(raw.minimum_gap.unwrap_or(0.0))? }),
        Lattice => Ok(Start::Lattice(raw.lattice.unwrap_or(self::Lattice::SimpleCubic))),
        File => {
            let path = raw.path.as_ref().ok_or_else(|| missing("path", "name a file or the folder of a former run"))?;
            Ok(Start::File(folder.join(path)))
        }
        Positions => {
            let list = raw.positions.as_ref().ok_or_else(|| missing("positions", "list [x, y, z] for every sphere"))?;
            Ok(Start::Positions(listed(list, species)?))
        }
    }
}

fn gap(gap: f64) -> Result<f64, Fault> {
    let fault = || Fault::new("particles.minimum_gap", format!("is {}; it needs to be 0 or more", Number(gap)));
    if gap >= 0.0 && gap.is_finite() { Ok(gap) } else { Err(fault()) }
}

fn listed(list: &[[f64; 3]], species: &[Species]) -> Result<Vec<Vector>, Fault> {
    let counted: u64 = species.iter().filter_map(|s| s.count).sum();
    if list.len() as u64 != counted {
        let message = format!("has {} places, but the species count {counted} spheres", list.len());
        return Err(Fault::new("particles.positions", message));
    }
    list.iter().enumerate().map(|(i, &p)| vector(&format!("particles.positions[{i}]"), p)).collect()
}
