//! Species of a scene.

use super::super::checks::{few_enough, positive};
use super::swimming::swimming;
use super::{KeyError, dipoles, names, raw};
use domain::{Number, Vector, sphere};
use suspension::{MAX_FRACTION, Orientation, SizeClass, SizeDistribution, Species};

/// Default number of classes that represent a distribution of radii.
const CLASSES: usize = 4;

/// Species of a scene, in a box or a ball with this volume.
pub(super) fn species(raw: &raw::SuspensionSections, volume: f64) -> Result<Vec<Species>, KeyError> {
    raw.species
        .iter()
        .enumerate()
        .try_for_each(|(index, one)| names::check(one.name.as_deref(), &format!("species[{index}]")))?;
    let lists: Result<Vec<_>, _> = (0..raw.species.len()).map(|index| of_section(raw, index, volume)).collect();
    Ok(lists?.into_iter().flatten().collect())
}

/// Species of a section: one, or the classes of a distribution.
fn of_section(raw: &raw::SuspensionSections, index: usize, volume: f64) -> Result<Vec<Species>, KeyError> {
    let one = &raw.species[index];
    if one.density_difference.is_some() && raw.gravity.is_none() {
        let message = "is set, but there is no [gravity]; write [gravity] acceleration = [x, y, z], or a force instead";
        return Err(KeyError::new(format!("species[{index}].density_difference"), message));
    }
    let swimming = swimming(one, index)?;
    let orientation = orientation(one, index)?.or_else(|| swimming.as_ref().map(|_| Orientation::Random));
    let electric = dipoles::electric_moment(one, index, raw.electric)?;
    let classes = classes(one, index)?;
    let total = count(raw, index, volume, &classes)?;
    let name = one.name.clone().unwrap_or_else(|| format!("{}", index + 1));
    let species = |(k, class): (usize, &SizeClass)| Species {
        name: if one.distribution.is_some() { format!("{name} {}", k + 1) } else { name.clone() },
        radius: class.radius,
        count: total.map(|total| (class.share * total as f64).round() as u64),
        density_difference: one.density_difference.unwrap_or(0.0),
        force: Vector::from_array(one.force),
        torque: Vector::from_array(one.torque),
        orientation,
        swimming: swimming.clone(),
        magnetic: dipoles::magnetic_moment(one),
        electric,
    };
    let all: Vec<Species> = classes.iter().enumerate().map(species).collect();
    if one.distribution.is_some() && all.iter().any(|class| class.count == Some(0)) {
        let message =
            format!("has {} classes, the rarest of which would have no sphere; take fewer, or more spheres", all.len());
        return Err(KeyError::new(format!("species[{index}].distribution"), message));
    }
    Ok(all)
}

/// Orientations of the spheres of a section at the start.
fn orientation(one: &raw::SpeciesSection, index: usize) -> Result<Option<Orientation>, KeyError> {
    let of_axis = |message| Err(KeyError::new(format!("species[{index}].orientation_axis"), message));
    Ok(match (one.orientation, one.orientation_axis) {
        (Some(raw::InitialOrientation::Aligned), None) => {
            return of_axis("is missing; orientation = \"aligned\" needs it, as [0.0, 0.0, 1.0]");
        }
        (Some(raw::InitialOrientation::Aligned), Some(axis)) => Some(Orientation::Aligned(Vector::from_array(axis))),
        (_, Some(_)) => return of_axis("goes with orientation = \"aligned\" only; leave it out or change that"),
        (Some(raw::InitialOrientation::Random), None) => Some(Orientation::Random),
        (Some(raw::InitialOrientation::File), None) => Some(Orientation::Given),
        (None, None) => None,
    })
}

/// Radii of a section, and their relative numbers.
fn classes(one: &raw::SpeciesSection, index: usize) -> Result<Vec<SizeClass>, KeyError> {
    let key = format!("species[{index}].radius");
    match (one.radius, &one.distribution) {
        (Some(radius), None) => Ok(vec![SizeClass { radius: positive(&key, radius)?, share: 1.0 }]),
        (None, Some(raw)) => {
            let key = format!("species[{index}].distribution");
            Ok(distribution(raw, &key)?.classes(raw.classes.unwrap_or(CLASSES), &key)?)
        }
        (None, None) => Err(KeyError::new(key, "is missing; a species has a radius, or a distribution of them")),
        (Some(_), Some(_)) => Err(KeyError::new(key, "is set, and a distribution too; leave one of them out")),
    }
}

fn distribution(raw: &raw::DistributionSection, key: &str) -> Result<SizeDistribution, KeyError> {
    use raw::DistributionKind::{LogNormal, PowerLaw, Table};
    let keys = [
        ("mean", raw.mean.is_some(), LogNormal),
        ("standard_deviation", raw.standard_deviation.is_some(), LogNormal),
        ("smallest", raw.smallest.is_some(), PowerLaw),
        ("largest", raw.largest.is_some(), PowerLaw),
        ("exponent", raw.exponent.is_some(), PowerLaw),
        ("table", raw.table.is_some(), Table),
    ];
    for (name, is_set, kind) in keys {
        let message = match (is_set, kind == raw.kind) {
            (false, true) => "is missing; this kind needs it",
            (true, false) => "goes with another kind; leave it out",
            _ => continue,
        };
        return Err(KeyError::new(format!("{key}.{name}"), message));
    }
    let [mean, deviation, smallest, largest, exponent] =
        [raw.mean, raw.standard_deviation, raw.smallest, raw.largest, raw.exponent].map(Option::unwrap_or_default);
    Ok(match raw.kind {
        LogNormal => SizeDistribution::LogNormal { mean, deviation },
        PowerLaw => SizeDistribution::PowerLaw { smallest, largest, exponent },
        Table => SizeDistribution::Table(raw.table.clone().unwrap_or_default()),
    })
}

/// Number of spheres of all classes.
fn count(
    raw: &raw::SuspensionSections,
    index: usize,
    volume: f64,
    classes: &[SizeClass],
) -> Result<Option<u64>, KeyError> {
    let one = &raw.species[index];
    let fault = |name: &str, message: &str| Err(KeyError::new(format!("species[{index}]{name}"), message));
    let from_file = raw.particles.initial == raw::Initial::File;
    match (one.count, one.volume_fraction) {
        (None, None) if from_file => Ok(None),
        (None, None) => fault("", "has neither count nor volume_fraction; set one of them"),
        (Some(_), Some(_)) => fault("", "has both count and volume_fraction; leave one of them out"),
        (Some(count), None) => {
            few_enough(&format!("species[{index}].count"), &format!("{count}"), count as f64, "spheres")?;
            Ok(Some(count))
        }
        (None, Some(fraction)) => {
            let key = format!("species[{index}].volume_fraction");
            let cube: f64 = classes.iter().map(|class| class.share * class.radius.powi(3)).sum();
            let radius = if let [class] = classes { class.radius } else { cube.cbrt() };
            counted(&key, fraction, radius, index, volume).map(Some)
        }
    }
}

/// Number of spheres of a radius that fill a fraction of the box.
fn counted(key: &str, fraction: f64, radius: f64, index: usize, room: f64) -> Result<u64, KeyError> {
    if !(fraction > 0.0 && fraction < MAX_FRACTION) {
        let message = format!("is {}; spheres need 0 < volume_fraction < {MAX_FRACTION}", Number(fraction));
        return Err(KeyError::new(key, message));
    }
    let volume = sphere::volume(radius);
    let count = (fraction * room / volume).round();
    few_enough(key, &format!("{fraction}, with species[{index}].radius = {radius}"), count, "spheres")?;
    if count < 1.0 {
        let found = Number(fraction);
        let message = format!("is {found}, which is less than one sphere in this box; set count instead");
        return Err(KeyError::new(key, message));
    }
    Ok(count as u64)
}
