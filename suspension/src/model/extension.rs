//! Flows that stretch, and the boxes that repeat in them.

use domain::{Number, ParameterError, PeriodicBox, Vector};
use solver::BackgroundFlow;

/// A flow that stretches along the axes, without rotation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Extension {
    /// `u = rate (x, -y, 0)`.
    Planar,
}

/// Edges that are equal may differ by this part of them.
const ROUND_OFF: f64 = 1e-12;

impl Extension {
    /// Rates along x, y and z, over that of the flow.
    pub fn rates(self) -> Vector {
        match self {
            Self::Planar => Vector::new(1.0, -1.0, 0.0),
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
    /// Reinelt, Int. J. Multiphase Flow 18, 1045, 1992).
    pub fn cell(self, edges: Vector) -> Result<PeriodicBox, ParameterError> {
        let Vector { x, y, z } = edges;
        if (x - y).abs() > ROUND_OFF * x.abs() {
            let edges = edges.to_array().map(|edge| Number(edge).to_string()).join(", ");
            let message = format!(
                "is [{edges}], but a box that repeats for ever in planar extension needs equal edges along x and y"
            );
            return Err(ParameterError::new("box.edges", message));
        }
        let (sin, cos) = (0.5 * (5.0_f64.sqrt() - 1.0)).atan().sin_cos();
        let lattice = [Vector::new(cos, sin, 0.0) * x, Vector::new(-sin, cos, 0.0) * x, Vector::Z * z];
        PeriodicBox::of_lattice(lattice).map_err(|error| ParameterError::new("box.edges", error.to_string()))
    }

    /// Whether a box is one that [`Self::cell`] makes.
    pub(crate) fn has_box(self, cell: &PeriodicBox) -> bool {
        let near = |(a, b): (Vector, Vector)| (a - b).length() <= 10.0 * ROUND_OFF * a.length();
        self.cell(cell.edges()).is_ok_and(|own| own.lattice_vectors().into_iter().zip(cell.lattice_vectors()).all(near))
    }

    /// The shortest lattice vector at any strain, of a box of this kind.
    pub(crate) fn shortest_vector(self, cell: &PeriodicBox) -> f64 {
        let (_, contraction) = self.extremes();
        (contraction * cell.edges().x).min(cell.edges().z)
    }

    /// The longest edges that the box ever has in its own axes, over those without strain, and the least part of them that is left
    /// at any time: of the square of its area and a first vector of `sqrt(g)` the edges are `sqrt(g)` and `1 / sqrt(g)`, with the
    /// least `g = 2 / sqrt(5)`, and 1 where there is no strain.
    pub(crate) fn extremes(self) -> (Vector, f64) {
        match self {
            Self::Planar => (Vector::new(1.0, 1.25_f64.powf(0.25), 1.0), 0.8_f64.powf(0.25)),
        }
    }
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
    }

    #[test]
    fn a_fluid_alone_is_driven_by_its_viscosity() {
        let strain_rate = Extension::Planar.flow(0.7).strain_rate().tensor();
        let stress = [0, 1, 2].map(|d| 2.0 * 3.0 * strain_rate.col(d)[d]);
        assert!((Extension::Planar.driving_stress(stress) - 3.0 * 0.7).abs() < 1e-14);
        assert!((Extension::Planar.as_shear() - 2.0).abs() < 1e-15);
        assert!((Extension::Planar.stretch(0.3).element_product() - 1.0).abs() < 1e-15);
    }
}
