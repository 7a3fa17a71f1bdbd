//! The species of a scene.

use super::super::checks::{few_enough, positive};
use super::{Fault, raw};
use domain::{Number, PeriodicBox, Vector};
use suspension::{MAX_FRACTION, Species};

pub(super) fn species(raw: &raw::Raw, cell: &PeriodicBox) -> Result<Vec<Species>, Fault> {
    (0..raw.species.len()).map(|index| one_species(raw, index, cell)).collect()
}

fn one_species(raw: &raw::Raw, index: usize, cell: &PeriodicBox) -> Result<Species, Fault> {
    let one = &raw.species[index];
    if one.density_difference.is_some() && raw.gravity.is_none() {
        let message = "is set, but there is no [gravity]; write [gravity] acceleration = [x, y, z], or a force instead";
        return Err(Fault::new(format!("species[{index}].density_difference"), message));
    }
    Ok(Species {
        name: one.name.clone().unwrap_or_else(|| format!("{}", index + 1)),
        radius: positive(&format!("species[{index}].radius"), one.radius)?,
        count: count(raw, index, cell)?,
        density_difference: one.density_difference.unwrap_or(0.0),
        force: Vector::from_array(one.force),
        torque: Vector::from_array(one.torque),
    })
}

fn count(raw: &raw::Raw, index: usize, cell: &PeriodicBox) -> Result<Option<u64>, Fault> {
    let one = &raw.species[index];
    let fault = |name: &str, message: &str| Err(Fault::new(format!("species[{index}]{name}"), message));
    let from_file = raw.particles.initial == raw::Initial::File;
    match (one.count, one.volume_fraction) {
        (None, None) if from_file => Ok(None),
        (None, None) => fault("", "has neither count nor volume_fraction; set one of them"),
        (Some(_), Some(_)) => fault("", "has both count and volume_fraction; leave one of them out"),
        (Some(count), None) => {
            few_enough(&format!("species[{index}].count"), &format!("{count}"), (count as f64, "spheres"))?;
            Ok(Some(count))
        }
        (None, Some(fraction)) => {
            let key = format!("species[{index}].volume_fraction");
            counted(&key, (fraction, one.radius), (index, cell)).map(Some)
        }
    }
}

/// How many spheres of a radius fill a fraction of the box.
fn counted(key: &str, (fraction, radius): (f64, f64), (index, cell): (usize, &PeriodicBox)) -> Result<u64, Fault> {
    if !(fraction > 0.0 && fraction < MAX_FRACTION) {
        let message = format!("is {}; spheres need 0 < volume_fraction < {MAX_FRACTION}", Number(fraction));
        return Err(Fault::new(key, message));
    }
    let volume = 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3);
    let count = (fraction * cell.volume() / volume).round();
    few_enough(key, &format!("{fraction}, with species[{index}].radius = {radius}"), (count, "spheres"))?;
    if count < 1.0 {
        let found = Number(fraction);
        let message = format!("is {found}, which is less than one sphere in this box; set count instead");
        return Err(Fault::new(key, message));
    }
    Ok(count as u64)
}
