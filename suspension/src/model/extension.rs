//! Flows that stretch, and the boxes that repeat in them.

use super::Axis;
use super::cubic_field::CubicField;
use domain::{Number, ParameterError, PeriodicBox, Vector};
use solver::BackgroundFlow;

/// A flow that stretches along the axes, without rotation.
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

/// How far the box of an extension changes, in its own axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Extremes {
    /// The longest edges that it ever has, over those without strain.
    pub longest: Vector,
    /// The least part of any of them that is left at any time.
    pub contraction: f64,
    /// Its largest strain.
    pub strain: f64,
    /// The largest tilts of its third vector.
    pub tilts: [f64; 2],
}

/// Edges that are equal may differ by this part of them.
const ROUND_OFF: f64 = 1e-12;

impl Extension {
    /// Rates along x, y and z, over that of the flow.
    pub fn rates(self) -> Vector {
        match self {
            Self::Planar => Vector::new(1.0, -1.0, 0.0),
            Self::Uniaxial => Vector::new(1.0, -0.5, -0.5),
            Self::Biaxial => Vector::new(1.0, 1.0, -2.0),
        }
    }

    /// The axis about which it is the same in all directions, if there is one.
    pub fn axis(self) -> Option<Axis> {
        match self {
            Self::Planar => None,
            Self::Uniaxial => Some(Axis::X),
            Self::Biaxial => Some(Axis::Z),
        }
    }

    /// The flow at a rate.
    pub fn flow(self, rate: f64) -> BackgroundFlow {
        let Vector { x, y, .. } = self.rates() * rate;
        BackgroundFlow::stretching([x, y])
    }

    /// The rate of the shear that dissipates as much, over that of the flow.
    pub fn as_shear(self) -> f64 {
        2.0_f64.sqrt() * self.rates().length()
    }

    /// By which factors it stretches lengths along x, y and z over a strain, the integral of its rate.
    pub fn stretch(self, strain: f64) -> Vector {
        (self.rates() * strain).exp()
    }

    /// The component of a stress `s` along its rate of strain `E` that drives it, `s : e / (2 e : e)` with `e = E / rate`:
    /// viscosity times rate in a fluid alone.
    pub fn driving_stress(self, diagonal: [f64; 3]) -> f64 {
        let rates = self.rates();
        Vector::from_array(diagonal).dot(rates) / (2.0 * rates.length_squared())
    }

    /// The box that repeats in it, as it is without strain: of the volume of a box of these edges.
    ///
    /// In planar extension its first two vectors are those of a square lattice, turned by `atan((sqrt(5) - 1) / 2)` (Kraynik &
    /// Reinelt, Int. J. Multiphase Flow 18, 1045, 1992). In the others its vectors are
    /// `(rho^k, sqrt(2) Re z^k, sqrt(2) Im z^k)`, `k = 0, 1, -1`, by the roots `rho` and `z` of `x^3 = x + 1`, the axis of the flow first.
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

    /// Its name in prose.
    pub fn name(self) -> &'static str {
        match self {
            Self::Planar => "planar extension",
            Self::Uniaxial => "uniaxial extension",
            Self::Biaxial => "biaxial extension",
        }
    }

    /// Whether a box is one that [`Self::cell`] makes.
    pub(crate) fn has_box(self, cell: &PeriodicBox) -> bool {
        let near = |(a, b): (Vector, Vector)| (a - b).length() <= 10.0 * ROUND_OFF * a.length();
        let edges = if self == Self::Planar { cell.edges() } else { Vector::splat(cell.volume().cbrt()) };
        self.cell(edges).is_ok_and(|own| own.lattice_vectors().into_iter().zip(cell.lattice_vectors()).all(near))
    }

    /// The shortest lattice vector at any strain, of a box of this kind.
    pub(crate) fn shortest_vector(self, cell: &PeriodicBox) -> f64 {
        match self {
            Self::Planar => (self.extremes().contraction * cell.edges().x).min(cell.edges().z),
            // The first vector is shortest where there is no strain.
            Self::Uniaxial | Self::Biaxial => cell.edges().x,
        }
    }

    /// How far its box changes. Of the square of planar extension, of its area and a first vector of `sqrt(g)`, the edges are
    /// `sqrt(g)` and `1 / sqrt(g)`, with the least `g = 2 / sqrt(5)`, and 1 where there is no strain; the strain is half a vector
    /// along the first over the second edge, which is no less than the first. The others have their extremes at either end of a
    /// period.
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

/// A square lattice turned so that planar extension repeats it.
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
        assert!((cell.volume() / edges.element_product() - 1.0).abs() < 1e-14 && cell.is_upright());
        assert!(Extension::Planar.has_box(&cell) && !Extension::Planar.has_box(&PeriodicBox::new(edges).unwrap()));
        let error = Extension::Planar.cell(Vector::new(3.0, 4.0, 5.0)).unwrap_err().to_string();
        assert!(error.contains("[3, 4, 5], but") && error.contains("equal edges along x and y"), "{error}");
        for kind in [Extension::Uniaxial, Extension::Biaxial] {
            let cell = kind.cell(Vector::splat(3.0)).unwrap();
            assert!((cell.volume() / 27.0 - 1.0).abs() < 1e-14 && !cell.is_upright());
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
