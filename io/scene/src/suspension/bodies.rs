//! Rigid bodies of a scene.

use super::{KeyError, names, raw};
use crate::checks::{few_enough, positive};
use crate::document::NumberOr;
use domain::{BodyShape, BodySphere, EqualSpheres, Number, Quaternion, Vector, sphere};
use raw::BodyShapeName::{Aggregate, Cube, Doublet, Plate, Ring, Rod, Shell, Tetrahedron};
use suspension::{Bodies, BodyOrientation, GivenMotion, MAX_FRACTION, Species};

/// Largest number of spheres of one body.
const MOST_SPHERES: f64 = 10_000.0;

/// Bodies of a scene with these other species, in a box of a volume.
pub(super) fn bodies(raw: &raw::SuspensionSections, species: &[Species], volume: f64) -> Result<Vec<Bodies>, KeyError> {
    let mut all: Vec<Bodies> = Vec::new();
    for (index, one) in raw.bodies.iter().enumerate() {
        let section = BodiesReader { raw, one, section: format!("bodies[{index}]") };
        let mut kind = section.bodies(volume)?;
        if kind.name.is_empty() {
            kind.name = format!("body {}", index + 1);
        }
        let taken = species.iter().map(|one| &one.name).chain(all.iter().map(|kind| &kind.name));
        if taken.clone().any(|name| *name == kind.name) {
            return section.fault("name", format!("is \"{}\", which another name is already; take another", kind.name));
        }
        all.push(kind);
    }
    Ok(all)
}

/// A section and its key.
pub(super) struct BodiesReader<'a> {
    pub raw: &'a raw::SuspensionSections,
    pub one: &'a raw::BodiesSection,
    pub section: String,
}

impl BodiesReader<'_> {
    fn key(&self, name: &str) -> String {
        format!("{}.{name}", self.section)
    }

    pub(super) fn fault<T>(&self, name: &str, message: impl Into<String>) -> Result<T, KeyError> {
        Err(KeyError::new(self.key(name), message))
    }

    pub(super) fn bodies(&self, volume: f64) -> Result<Bodies, KeyError> {
        let one = self.one;
        names::check(one.name.as_deref(), &self.section)?;
        if one.density_difference.is_some() && self.raw.gravity.is_none() {
            let message = "is set, but there is no [gravity]; write [gravity] acceleration = [x, y, z], or a force";
            return self.fault("density_difference", message);
        }
        let spheres = self.spheres()?;
        let count = self.count(&spheres, volume)?;
        let name = one.name.clone().unwrap_or_default();
        let places = one.positions.as_ref().map(|list| list.iter().map(|&place| place.into()).collect());
        Ok(Bodies {
            positions: places,
            orientation: self.orientation()?,
            density_difference: one.density_difference.unwrap_or(0.0),
            force: one.force.into(),
            torque: one.torque.into(),
            motion: GivenMotion { velocity: given(one.velocity), angular_velocity: given(one.angular_velocity) },
            ..Bodies::new(&name, spheres, count)
        })
    }

    fn count(&self, spheres: &[BodySphere], volume: f64) -> Result<u64, KeyError> {
        let one = self.one;
        let given = [one.count.is_some(), one.volume_fraction.is_some(), one.positions.is_some()];
        match given.iter().filter(|is_given| **is_given).count() {
            1 => {}
            0 => return self.fault("count", "is missing; set it, or volume_fraction, or positions"),
            _ => return self.fault("count", "is one of count, volume_fraction and positions; leave two of them out"),
        }
        let of_one = spheres.iter().map(|one| sphere::volume(one.radius)).sum::<f64>();
        let count = match (one.count, one.volume_fraction) {
            (Some(count), _) => count as f64,
            (None, Some(fraction)) if !(fraction > 0.0 && fraction < MAX_FRACTION) => {
                let message = format!("is {}; it needs to be above 0 and below {MAX_FRACTION}", Number(fraction));
                return self.fault("volume_fraction", message);
            }
            (None, Some(fraction)) => (fraction * volume / of_one).round(),
            (None, None) => one.positions.as_ref().map_or(0, Vec::len) as f64,
        };
        if count < 1.0 {
            return self.fault("count", "comes to less than one; take more, or leave the section out");
        }
        few_enough(&self.key("count"), &format!("{count}"), count * spheres.len() as f64, "spheres")?;
        Ok(count as u64)
    }

    fn orientation(&self) -> Result<BodyOrientation, KeyError> {
        let one = self.one;
        let is_aligned = one.orientation == Some(raw::BodyOrientationName::Aligned);
        if one.orientation_axis.is_some() != is_aligned {
            let message = "goes with orientation = \"aligned\"; set both of them, or none";
            return self.fault("orientation_axis", message);
        }
        if one.orientations.is_some() && one.orientation.is_some() {
            return self.fault("orientations", "is set, and orientation too; leave one of them out");
        }
        Ok(match (&one.orientations, one.orientation_axis) {
            (Some(list), _) => BodyOrientation::Each(list.iter().map(|&q| Quaternion::from_array(q)).collect()),
            (None, Some(axis)) => BodyOrientation::Aligned(Vector::from_array(axis)),
            (None, None) => BodyOrientation::Random,
        })
    }

    fn spheres(&self) -> Result<Vec<BodySphere>, KeyError> {
        self.check_keys()?;
        match (self.one.shape, &self.one.spheres) {
            (Some(shape), _) => self.of_shape(shape),
            (None, Some(NumberOr::Other(list))) => {
                few(&self.key("spheres"), list.len() as f64)?;
                let read = |(row, one): (usize, &raw::BodySphereSection)| {
                    let radius = positive(&self.key(&format!("spheres[{row}].radius")), one.radius)?;
                    Ok(BodySphere { position: one.position.into(), radius })
                };
                list.iter().enumerate().map(read).collect()
            }
            (None, _) => self.fault("shape", "is missing; name one, or list the spheres"),
        }
    }

    /// Refuses keys that do not belong to the shape, and misses those that do.
    fn check_keys(&self) -> Result<(), KeyError> {
        let one = self.one;
        let shapes: [(&str, bool, &[raw::BodyShapeName], bool); 6] = [
            ("spheres", one.spheres.is_some(), &[Rod, Ring, Shell, Aggregate], true),
            ("edge", one.edge.is_some(), &[Plate, Tetrahedron, Cube], true),
            ("radius", one.radius.is_some(), &[Doublet, Rod, Ring, Plate, Tetrahedron, Cube, Aggregate], true),
            ("gap", one.gap.is_some(), &[Doublet, Rod, Ring, Plate, Tetrahedron, Cube, Aggregate], false),
            ("shell_radius", one.shell_radius.is_some(), &[Shell], true),
            ("shape_seed", one.shape_seed.is_some(), &[Aggregate], false),
        ];
        for (name, is_set, with, is_needed) in shapes {
            let belongs = match one.shape {
                Some(Shell) if name == "radius" => continue,
                Some(shape) => with.contains(&shape),
                None => name == "spheres",
            };
            if is_set && !belongs {
                return self.fault(name, "does not belong to this shape; leave it out");
            }
            if belongs && is_needed && !is_set && one.shape.is_some() {
                return self.fault(name, "is missing; this shape needs it");
            }
        }
        Ok(())
    }

    fn of_shape(&self, shape: raw::BodyShapeName) -> Result<Vec<BodySphere>, KeyError> {
        let one = self.one;
        let radius = one.radius.map(|radius| positive(&self.key("radius"), radius)).transpose()?;
        let equal = |number| self.equal_spheres(number, radius.unwrap_or_default());
        let number = || self.whole_number();
        let edge = |power| self.edge(power);
        Ok(match shape {
            Doublet => BodyShape::Rod(equal(2)?),
            Rod => BodyShape::Rod(equal(number()?)?),
            Ring => BodyShape::Ring(equal(number()?)?),
            Plate => BodyShape::Plate(equal(edge(2)?)?),
            Cube => BodyShape::Cube(equal(edge(3)?)?),
            Tetrahedron => BodyShape::Tetrahedron(equal(edge(3)?)?),
            Aggregate => {
                BodyShape::Aggregate { spheres: equal(number()?)?, seed: one.shape_seed.unwrap_or(self.raw.seed) }
            }
            Shell => {
                let shell_radius = positive(&self.key("shell_radius"), one.shell_radius.unwrap_or_default())?;
                BodyShape::Shell { number: number()?, shell_radius, radius }
            }
        }
        .spheres())
    }

    fn equal_spheres(&self, number: usize, radius: f64) -> Result<EqualSpheres, KeyError> {
        let gap = self.one.gap.unwrap_or(0.0);
        if !(gap > -2.0 * radius && gap.is_finite()) {
            let message = format!("is {}; neighbours need a gap above minus their diameter", Number(gap));
            return self.fault("gap", message);
        }
        Ok(EqualSpheres { number, radius, gap })
    }

    fn whole_number(&self) -> Result<usize, KeyError> {
        match &self.one.spheres {
            Some(NumberOr::Number(number)) if *number >= 2.0 && number.fract() == 0.0 => {
                few(&self.key("spheres"), *number)?;
                Ok(*number as usize)
            }
            Some(NumberOr::Other(_)) => self.fault("spheres", "is a list, which goes without a shape; write a number"),
            _ => self.fault("spheres", "needs to be a whole number of at least 2"),
        }
    }

    fn edge(&self, power: i32) -> Result<usize, KeyError> {
        match self.one.edge {
            Some(edge) if edge >= 2 => {
                few(&self.key("edge"), (edge as f64).powi(power))?;
                Ok(edge as usize)
            }
            _ => self.fault("edge", "needs to be at least 2"),
        }
    }
}

/// The components of a motion that are numbers.
fn given(components: Option<[NumberOr<raw::Free>; 3]>) -> [Option<f64>; 3] {
    let number = |component| if let NumberOr::Number(number) = component { Some(number) } else { None };
    components.map_or([None; 3], |components| components.map(number))
}

/// Refuses a body of too many spheres.
fn few(key: &str, spheres: f64) -> Result<(), KeyError> {
    if (1.0..=MOST_SPHERES).contains(&spheres) {
        return Ok(());
    }
    Err(KeyError::new(
        key,
        format!("is {} spheres that stay together; there can be 1 to {MOST_SPHERES}", Number(spheres)),
    ))
}
