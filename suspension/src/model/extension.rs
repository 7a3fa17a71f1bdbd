//! Extensional flows and the boxes that repeat in them.

use super::Axis;
use super::cubic_field::CubicField;
use domain::{Number, ParameterError, PeriodicBox, Vector};
use solver::BackgroundFlow;

/// Extensional flow along the axes, without rotation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Extension {
    /// `u = rate (x, -y, 0)`.
    Planar,
    /// `u = rate (x, -y/2, -z/2)`.
    Uniaxial,
    /// `u = rate (x, y, -2 z)`.
    Biaxial,
}

/// Extremes of the shape of the box of an extension, in the box's own axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Extremes {
    /// Longest edges at any strain, over those at zero strain.
    pub longest: Vector,
    /// Smallest ratio of an edge's shortest to its longest length.
    pub contraction: f64,
    /// Largest strain (tilt of the second vector).
    pub strain: f64,
    /// Largest tilts of the third vector.
    pub tilts: [f64; 2],
}

/// Relative difference up to which edges count as equal.
const ROUND_OFF: f64 = 1e-12;

impl Extension {
    /// Rates of extension along x, y and z, over the rate of the flow.
    pub fn rates(self) -> Vector {
        match self {
            Self::Planar => Vector::new(1.0, -1.0, 0.0),
            Self::Uniaxial => Vector::new(1.0, -0.5, -0.5),
            Self::Biaxial => Vector::new(1.0, 1.0, -2.0),
        }
    }

    /// Axis of symmetry, if there is one.
    pub fn axis(self) -> Option<Axis> {
        match self {
            Self::Planar => None,
            Self::Uniaxial => Some(Axis::X),
            Self::Biaxial => Some(Axis::Z),
        }
    }

    /// The flow at a given rate.
    pub fn flow(self, rate: f64) -> BackgroundFlow {
        let Vector { x, y, .. } = self.rates() * rate;
        BackgroundFlow::stretching([x, y])
    }

    /// Rate of the simple shear with equal dissipation, over the rate of the flow.
    pub fn as_shear(self) -> f64 {
        2.0_f64.sqrt() * self.rates().length()
    }

    /// Stretch ratios along x, y and z at a strain (the integral of the rate).
    pub fn stretch(self, strain: f64) -> Vector {
        (self.rates() * strain).exp()
    }

    /// Component of a stress `s` along the rate of strain `E`, `s : e / (2 e : e)` with `e = E / rate`; viscosity times
    /// rate in pure fluid.
    pub fn driving_stress(self, diagonal: [f64; 3]) -> f64 {
        let rates = self.rates();
        Vector::from_array(diagonal).dot(rates) / (2.0 * rates.length_squared())
    }

    /// The periodic box of this flow at zero strain, of the volume of a box with the given edges.
    ///
    /// In planar extension the first two vectors span a square lattice, rotated by `atan((sqrt(5) - 1) / 2)` (Kraynik &
    /// Reinelt, Int. J. Multiphase Flow 18, 1045, 1992). In uniaxial and biaxial extension the vectors are
    /// `(rho^k, sqrt(2) Re z^k, sqrt(2) Im z^k)`, `k = 0, 1, -1`, by the roots `rho` and `z` of `x^3 = x + 1`, the axis
    /// of the flow first.
    pub fn cell(self, edges: Vector) -> Result<PeriodicBox, ParameterError> {
        let Vector { x, y, z } = edges;
        let differs = |a: f64, b: f64| (a - b).abs() > ROUND_OFF * a.abs();
        let (is_planar, name) = (self == Self::Planar, self.name());
        if differs(x, y) || (!is_planar && differs(x, z)) {
            let needed = if is_planar { "equal edges along x and y" } else { "three equal edges" };
            let edges = edges.to_array().map(|edge| Number(edge).to_string()).join(", ");
            let message = format!("is [{edges}], but a box that repeats for ever in {name} needs {needed}");
            return Err(ParameterError::new("box.edges", message));
        }
        let lattice = match self {
            Self::Planar => square(x, z),
            Self::Uniaxial => CubicField::get().vectors(x),
            Self::Biaxial => CubicField::get().vectors(x).map(|Vector { x, y, z }| Vector::new(y, z, x)),
        };
        PeriodicBox::of_lattice(lattice).map_err(|error| ParameterError::new("box.edges", error.to_string()))
    }

    /// Name in prose.
    pub fn name(self) -> &'static str {
        match self {
            Self::Planar => "planar extension",
            Self::Uniaxial => "uniaxial extension",
            Self::Biaxial => "biaxial extension",
        }
    }

    /// Whether a box is of the kind that [`Self::cell`] makes.
    pub(crate) fn has_box(self, cell: &PeriodicBox) -> bool {
        let near = |(a, b): (Vector, Vector)| (a - b).length() <= 10.0 * ROUND_OFF * a.length();
        let edges = if self == Self::Planar { cell.edges() } else { Vector::splat(cell.volume().cbrt()) };
        self.cell(edges).is_ok_and(|own| own.lattice_vectors().into_iter().zip(cell.lattice_vectors()).all(near))
    }

    /// Shortest lattice vector, at any strain, of a box of this kind.
    pub(crate) fn shortest_vector(self, cell: &PeriodicBox) -> f64 {
        match self {
            Self::Planar => (self.extremes().contraction * cell.edges().x).min(cell.edges().z),
            // The first vector is shortest at zero strain.
            Self::Uniaxial | Self::Biaxial => cell.edges().x,
        }
    }

    /// Extremes of the shape of the box. A square cell of unit area whose first vector has length `sqrt(g)` has the
    /// edges `sqrt(g)` and `1 / sqrt(g)`, with `g` at least `2 / sqrt(5)`, and 1 at zero strain; its strain is at most
    /// half a first vector over the second edge, which is no shorter than the first. The boxes of the other flows have
    /// their extremes at the ends of a period.
    pub(crate) fn extremes(self) -> Extremes {
        match self {
            Self::Planar => Extremes {
                longest: Vector::new(1.0, 1.25_f64.powf(0.25), 1.0),
                contraction: 0.8_f64.powf(0.25),
                strain: 0.5,
                tilts: [0.0; 2],
            },
            Self::Uniaxial | Self::Biaxial => CubicField::get().extremes(),
        }
    }
}

/// A square lattice, rotated so that planar extension repeats it.
fn square(edge: f64, height: f64) -> [Vector; 3] {
    let (sin, cos) = (0.5 * (5.0_f64.sqrt() - 1.0)).atan().sin_cos();
    [Vector::new(cos, sin, 0.0) * edge, Vector::new(-sin, cos, 0.0) * edge, Vector::Z * height]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_have_the_volume_of_their_edges() {
        let edges = Vector::new(3.0, 3.0, 7.0);
        let cell = Extension::Planar.cell(edges).unwrap();
        assert!((cell.volume() / edges.element_product() - 1.0).abs() < 1e-14 && cell.is_orthogonal());
        assert!(Extension::Planar.has_box(&cell) && !Extension::Planar.has_box(&PeriodicBox::new(edges).unwrap()));
        let error = Extension::Planar.cell(Vector::new(3.0, 4.0, 5.0)).unwrap_err().to_string();
        assert!(error.contains("[3, 4, 5], but") && error.contains("equal edges along x and y"), "{error}");
        for kind in [Extension::Uniaxial, Extension::Biaxial] {
            let cell = kind.cell(Vector::splat(3.0)).unwrap();
            assert!((cell.volume() / 27.0 - 1.0).abs() < 1e-14 && !cell.is_orthogonal());
            assert!(kind.has_box(&cell) && !kind.has_box(&PeriodicBox::new(Vector::splat(3.0)).unwrap()));
            let error = kind.cell(edges).unwrap_err().to_string();
            assert!(error.contains("[3, 3, 7], but") && error.contains("three equal edges"), "{error}");
        }
    }

    #[test]
    fn a_fluid_alone_is_driven_by_its_viscosity() {
        let kinds = [(Extension::Planar, 4.0), (Extension::Uniaxial, 3.0), (Extension::Biaxial, 12.0)];
        for (kind, square) in kinds {
            let strain_rate = kind.flow(0.7).strain_rate().tensor();
            let stress = [0, 1, 2].map(|d| 2.0 * 3.0 * strain_rate.col(d)[d]);
            assert!((kind.driving_stress(stress) - 3.0 * 0.7).abs() < 1e-14);
            assert!((kind.as_shear().powi(2) - square).abs() < 1e-14);
            assert!((kind.stretch(0.3).element_product() - 1.0).abs() < 1e-15);
        }
    }
}
