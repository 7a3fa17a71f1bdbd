//! Magnetic and electric moments of the spheres, in an applied field.

use super::{Parameters, Species};
use crate::model::box_axes::UserAxes;
use domain::{Boundaries, Number, ParameterError, Vector, sphere};
use fcm::Magnetisation;

/// Magnetic or electric field applied to a suspension, whose spheres have moments, see
/// [`fcm::DipoleField`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AppliedField {
    /// Field at time zero: the average over the box.
    pub amplitude: Vector,
    /// Change with time.
    pub variation: FieldVariation,
    /// Permeability of the vacuum, or permittivity of the fluid: force over moment and field gradient.
    pub constant: f64,
    /// Relative error of the moments' field; `None` for the tolerance of the hydrodynamics.
    pub tolerance: Option<f64>,
}

/// Change of a field with time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FieldVariation {
    /// None.
    Constant,
    /// As the cosine of an angular frequency times the time.
    Alternating {
        /// Angular frequency.
        frequency: f64,
    },
    /// Rotation.
    Rotating {
        /// Angular frequency.
        frequency: f64,
        /// Axis of rotation, of any length.
        axis: Vector,
    },
}

/// Moment of a sphere.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SphereMoment {
    /// Permanent moment along the axis of its orientation; electric ones over the permittivity of the fluid.
    pub permanent: f64,
    /// Susceptibility: the ratio of the induced moment to the volume and the field within the sphere. For dielectric
    /// spheres it is the ratio of the permittivities of sphere and fluid minus 1.
    pub susceptibility: f64,
    /// Magnetisation of the material in the strongest fields, by the law of [`fcm::Magnetisation`]; without it the
    /// induced moment is in proportion to the field.
    pub saturation: Option<f64>,
}

impl SphereMoment {
    /// No moment.
    pub const NONE: Self = Self { permanent: 0.0, susceptibility: 0.0, saturation: None };

    /// Ratio of the induced moment of a sphere to the field within it.
    pub fn polarisability(&self, radius: f64) -> f64 {
        self.susceptibility * sphere::volume(radius)
    }

    /// Law of the induced moment of a sphere.
    pub fn magnetisation(&self, radius: f64) -> Magnetisation {
        let saturation = self.saturation.map_or(f64::INFINITY, |most| most * sphere::volume(radius));
        Magnetisation { polarisability: self.polarisability(radius), saturation }
    }

    /// Induced moment of a sphere alone in an applied field, `4 pi a^3 chi / (chi + 3)` times it without saturation.
    pub fn moment_alone(&self, radius: f64, applied: Vector) -> Vector {
        self.magnetisation(radius).moment_alone(applied, 1.0 / (3.0 * sphere::volume(radius)))
    }

    /// The same over its value without saturation, times the present susceptibility over that in weak fields: 1 in weak
    /// fields, and falling faster than the moment.
    pub fn unsaturated(&self, radius: f64, applied: Vector) -> f64 {
        let linear = Self { saturation: None, ..*self }.moment_alone(radius, applied).length();
        let (moment, most) = (self.moment_alone(radius, applied).length(), self.magnetisation(radius).saturation);
        if linear > 0.0 { moment / linear * (1.0 - moment / most) } else { 1.0 }
    }
}

/// Kind of moments.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MomentKind {
    /// Magnetic moments.
    Magnetic,
    /// Electric moments.
    Electric,
}

impl MomentKind {
    /// Both kinds.
    pub const ALL: [Self; 2] = [Self::Magnetic, Self::Electric];

    /// Name: the section of a scene, and the contribution to the stress.
    pub fn name(self) -> &'static str {
        match self {
            Self::Magnetic => "magnetic",
            Self::Electric => "electric",
        }
    }

    /// Keys of a species with its permanent moment and with its susceptibility.
    fn keys(self) -> [&'static str; 2] {
        match self {
            Self::Magnetic => ["magnetic_moment", "magnetic_susceptibility"],
            Self::Electric => ["electric_moment", "permittivity"],
        }
    }

    /// The field of a model, if there is one.
    pub fn field(self, p: &Parameters) -> Option<AppliedField> {
        match self {
            Self::Magnetic => p.magnetic,
            Self::Electric => p.electric,
        }
    }

    /// The moment of a species.
    pub fn of(self, species: &Species) -> SphereMoment {
        match self {
            Self::Magnetic => species.magnetic,
            Self::Electric => species.electric,
        }
    }

    /// Key of the constant of the field.
    fn constant(self) -> &'static str {
        match self {
            Self::Magnetic => "permeability",
            Self::Electric => "permittivity",
        }
    }

    fn check(self, p: &Parameters) -> Result<(), ParameterError> {
        let Some(field) = self.field(p) else { return self.check_unused(p) };
        let (name, fault) = (self.name(), |message: &str| ParameterError::new(self.name(), message));
        if !matches!(p.cell.boundaries(), Boundaries::Periodic | Boundaries::Open) {
            return Err(fault(
                "is for boxes that repeat along all axes or are open along all of them; the field of moments near \
                 walls and in layers is not available: leave it out, or make box.boundaries \"periodic\" or \"open\"",
            ));
        }
        if p.shear_rates().stress().is_some() {
            return Err(fault(
                "can't be with flow.control = \"stress\", whose rate takes no account of torques; give flow.rate",
            ));
        }
        if p.species.iter().all(|species| self.of(species) == SphereMoment::NONE) {
            let [moment, susceptibility] = self.keys();
            let message = format!("has no effect without moments; give species[0].{moment} or {susceptibility}");
            return Err(ParameterError::new(name, message));
        }
        field.check(self, &p.user_axes())?;
        p.species.iter().enumerate().try_for_each(|(index, species)| self.check_species(index, species))?;
        self.check_signs(p)
    }

    fn check_unused(self, p: &Parameters) -> Result<(), ParameterError> {
        for (index, species) in p.species.iter().enumerate() {
            let SphereMoment { permanent, susceptibility, saturation } = self.of(species);
            let keys = self.keys().into_iter().chain(["magnetic_saturation"]);
            for (key, value) in keys.zip([permanent, susceptibility, saturation.unwrap_or(0.0)]) {
                if value != 0.0 {
                    let name = self.name();
                    let message = format!("is set, but there is no [{name}]; write [{name}] field = [x, y, z]");
                    return Err(ParameterError::new(format!("species[{index}].{key}"), message));
                }
            }
        }
        Ok(())
    }

    fn check_species(self, index: usize, species: &Species) -> Result<(), ParameterError> {
        let [moment, susceptibility] = self.keys().map(|key| format!("species[{index}].{key}"));
        let SphereMoment { permanent, susceptibility: chi, saturation } = self.of(species);
        if let Some(most) = saturation {
            check_saturation(&format!("species[{index}].magnetic_saturation"), most, chi)?;
        }
        ParameterError::require_finite(&moment, permanent)?;
        ParameterError::require_finite(&susceptibility, chi)?;
        if permanent != 0.0 && species.orientation.is_none() {
            let message = format!(
                "is along the axis of the sphere, which has none; give species[{index}].orientation, as \"random\""
            );
            return Err(ParameterError::new(moment, message));
        }
        if chi > -1.0 {
            return Ok(());
        }
        let message = match self {
            Self::Magnetic => format!("is {}; it needs to be above -1", Number(chi)),
            Self::Electric => "needs to be above 0".to_owned(),
        };
        Err(ParameterError::new(susceptibility, message))
    }

    /// With both signs the equations for the moments are not definite.
    fn check_signs(self, p: &Parameters) -> Result<(), ParameterError> {
        let of = |species: &Species| self.of(species).susceptibility;
        let is_positive = p.species.iter().any(|species| of(species) > 0.0);
        match p.species.iter().position(|species| of(species) < 0.0).filter(|_| is_positive) {
            None => Ok(()),
            Some(index) => {
                let message = match self {
                    Self::Magnetic => "is negative, and that of another species positive; give all the same sign",
                    Self::Electric => {
                        "is below that of the fluid, and that of another species above; take all on one side of it"
                    }
                };
                Err(ParameterError::new(format!("species[{index}].{}", self.keys()[1]), message))
            }
        }
    }
}

impl AppliedField {
    /// A constant field in units in which its constant is 1.
    pub fn constant(amplitude: Vector) -> Self {
        Self { amplitude, variation: FieldVariation::Constant, constant: 1.0, tolerance: None }
    }

    /// The field at a time.
    pub fn at(&self, time: f64) -> Vector {
        let field = self.amplitude;
        match self.variation {
            FieldVariation::Constant => field,
            FieldVariation::Alternating { frequency } => field * (frequency * time).cos(),
            FieldVariation::Rotating { frequency, axis } => {
                let (axis, (sin, cos)) = (axis.normalize(), (frequency * time).sin_cos());
                let along = axis * axis.dot(field);
                along + (field - along) * cos + axis.cross(field) * sin
            }
        }
    }

    /// Angular frequency; `None` for a constant field.
    pub fn frequency(&self) -> Option<f64> {
        match self.variation {
            FieldVariation::Constant => None,
            FieldVariation::Alternating { frequency } | FieldVariation::Rotating { frequency, .. } => Some(frequency),
        }
    }

    fn check(&self, kind: MomentKind, axes: &UserAxes) -> Result<(), ParameterError> {
        let key = |name: &str| format!("{}.{name}", kind.name());
        ParameterError::require_finite_vector(&key("field"), axes.vector(self.amplitude))?;
        ParameterError::require_positive(&key(kind.constant()), self.constant)?;
        if let Some(tolerance) = self.tolerance {
            ParameterError::require_between(&key("tolerance"), tolerance, [1e-12, 0.5])?;
        }
        if let Some(frequency) = self.frequency() {
            ParameterError::require_finite(&key("frequency"), frequency)?;
        }
        if let FieldVariation::Rotating { axis, .. } = self.variation {
            ParameterError::require_finite_vector(&key("rotation_axis"), axes.vector(axis))?;
            if axis.normalize_or_zero() == Vector::ZERO {
                let message = "has no direction; one of its numbers needs to be other than 0";
                return Err(ParameterError::new(key("rotation_axis"), message));
            }
        }
        Ok(())
    }
}

/// Checks the largest magnetisation of a material.
fn check_saturation(key: &str, most: f64, susceptibility: f64) -> Result<(), ParameterError> {
    ParameterError::require_positive(key, most)?;
    if susceptibility > 0.0 {
        return Ok(());
    }
    let message = "is the largest magnetisation by an induced moment; give a magnetic_susceptibility above 0";
    Err(ParameterError::new(key, message))
}

/// Checks moments and fields of a model.
pub(super) fn check(p: &Parameters) -> Result<(), ParameterError> {
    MomentKind::ALL.into_iter().try_for_each(|kind| kind.check(p))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_rotate_and_alternate() {
        let (frequency, amplitude) = (2.0, Vector::new(1.0, 0.0, 0.5));
        let rotating = FieldVariation::Rotating { frequency, axis: Vector::Z * 3.0 };
        let field = AppliedField { variation: rotating, ..AppliedField::constant(amplitude) };
        let quarter = std::f64::consts::PI / 4.0;
        assert!((field.at(quarter) - Vector::new(0.0, 1.0, 0.5)).length() < 1e-15);
        let field = AppliedField { variation: FieldVariation::Alternating { frequency }, ..field };
        assert!((field.at(2.0 * quarter) + amplitude).length() < 1e-15);
        assert_eq!(AppliedField::constant(amplitude).at(5.0), amplitude);
    }
}
