//! Box of a file, and its comparison with the box of a scene.

use domain::{BoxError, Number, PeriodicBox, Tensor, Vector};
use std::fmt::{Display, Formatter};

/// Relative difference of edges at which boxes count as equal: text may have six digits.
const ROUNDING: f64 = 1e-5;
/// A strain below this is round-off of zero.
const NO_STRAIN: f64 = 1e-12;

/// Box of a file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FileBox {
    /// Lattice vectors.
    pub vectors: [Vector; 3],
    /// Corner at the origin of lattice coordinates.
    pub origin: Vector,
    /// Whether the box is periodic along each edge.
    pub periodic: [bool; 3],
    /// Strain of a sheared box, if the file has it in addition to the vectors.
    pub strain: Option<f64>,
}

/// Boundary condition along an axis of a scene's box.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum BoxAxis {
    /// Periodic.
    Periodic,
    /// Walls.
    Walls,
    /// Open: the edge has no meaning.
    Open,
}

/// Box of a scene, in the axes of the user.
pub(super) struct SceneBox {
    pub(super) shape: BoxShape,
    pub(super) axes: [BoxAxis; 3],
}

/// Shape of a scene's box.
pub(super) enum BoxShape {
    /// Edges along x, y and z.
    Straight(Vector),
    /// Edges, and the strain by which the second lattice vector is tilted along x.
    Sheared(Vector, f64),
    /// Any lattice vectors.
    Lattice([Vector; 3]),
}

impl FileBox {
    /// A fully periodic box with edges along x, y and z.
    pub(super) fn straight(edges: Vector) -> Self {
        Self::lattice([Vector::X * edges.x, Vector::Y * edges.y, Vector::Z * edges.z])
    }

    /// A fully periodic box with any lattice vectors and its origin at zero.
    pub(super) fn lattice(vectors: [Vector; 3]) -> Self {
        Self { vectors, origin: Vector::ZERO, periodic: [true; 3], strain: None }
    }

    /// A box of this program.
    pub(super) fn of_cell(cell: &PeriodicBox) -> Self {
        let strain = cell.axes().is_none().then(|| cell.strain());
        let periodic = [0, 1, 2].map(|axis| cell.is_periodic(axis));
        Self { vectors: cell.lattice_vectors(), origin: cell.origin(), periodic, strain }
    }

    /// `Err` unless the vectors are finite and span a volume.
    pub(super) fn checked(self) -> Result<Self, String> {
        PeriodicBox::of_lattice(self.vectors).map_err(|error: BoxError| format!("its box: {error}"))?;
        if !(self.origin.is_finite() && self.strain.is_none_or(f64::is_finite)) {
            return Err("its box begins nowhere, or has a strain that is no number".to_owned());
        }
        Ok(self)
    }

    /// Edges along x, y and z of an orthogonal box, or of one sheared along x.
    pub(crate) fn edges(&self) -> Vector {
        let [a, b, c] = self.vectors;
        Vector::new(a.x, b.y, c.z)
    }

    /// Strain of the box, after comparing it with that of a scene: edges must be equal along the
    /// axes that both boxes have.
    pub(super) fn strain_in(&self, scene: &SceneBox) -> Result<f64, String> {
        let differs = || format!("its box is {self}, but that of the scene is {scene}");
        match &scene.shape {
            BoxShape::Lattice(vectors) => {
                if is_same_lattice(&self.vectors, vectors) {
                    Ok(0.0)
                } else {
                    Err(differs())
                }
            }
            BoxShape::Straight(edges) => {
                let strain = self.compared(*edges, scene).ok_or_else(differs)?;
                if strain == 0.0 { Ok(0.0) } else { Err(differs()) }
            }
            BoxShape::Sheared(edges, _) => self.compared(*edges, scene).ok_or_else(differs),
        }
    }

    /// The strain, if the edges are equal to those of a scene.
    fn compared(&self, edges: Vector, scene: &SceneBox) -> Option<f64> {
        let counts = [0, 1, 2].map(|axis| match scene.axes[axis] {
            BoxAxis::Periodic => self.periodic[axis],
            BoxAxis::Walls => true,
            BoxAxis::Open => false,
        });
        let reduced = self.reduced(counts);
        let is_same = |axis: usize| {
            let own = Vector::AXES[axis] * edges[axis];
            let besides = if axis == 1 && counts[0] { Vector::X * reduced[1].x } else { Vector::ZERO };
            (reduced[axis] - own - besides).abs().max_element() <= ROUNDING * edges[axis]
        };
        if !(0..3).all(|axis| !counts[axis] || is_same(axis)) {
            return None;
        }
        let strain = if counts[0] && counts[1] { self.strain.unwrap_or(reduced[1].x / reduced[1].y) } else { 0.0 };
        let strain = PeriodicBox::sheared(edges, strain).ok()?.strain();
        Some(if strain.abs() < NO_STRAIN { 0.0 } else { strain })
    }

    /// The lattice vectors, with multiples of other vectors subtracted from the second and third
    /// along the axes in `counts`.
    fn reduced(&self, counts: [bool; 3]) -> [Vector; 3] {
        let [a, mut b, mut c] = self.vectors;
        if counts[1] {
            c -= b * (c.y / b.y).round();
        }
        if counts[0] {
            c -= a * (c.x / a.x).round();
            b -= a * (b.x / a.x).round();
        }
        [a, b, c]
    }
}

/// Whether two sets of vectors span the same lattice.
fn is_same_lattice(one: &[Vector; 3], other: &[Vector; 3]) -> bool {
    let [one, other] = [one, other].map(|v| Tensor::from_cols(v[0], v[1], v[2]));
    let steps = other.inverse() * one;
    let is_whole = steps.to_cols_array().iter().all(|step| (step - step.round()).abs() <= ROUNDING);
    is_whole && (steps.determinant().abs() - 1.0).abs() <= ROUNDING
}

/// Whether two strains of a box with these edges give the same lattice, up to the rounding of text.
pub(super) fn is_same_strain(one: f64, other: f64, edges: Vector) -> bool {
    let period = edges.x / edges.y;
    let apart = (one - other) / period;
    (apart - apart.round()).abs() <= ROUNDING
}

impl Display for FileBox {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        write_vectors(f, &self.vectors, self.strain)
    }
}

impl Display for SceneBox {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        match &self.shape {
            BoxShape::Straight(edges) => write_edges(f, *edges, 0.0),
            BoxShape::Sheared(edges, strain) => write_edges(f, *edges, *strain),
            BoxShape::Lattice(vectors) => write_vectors(f, vectors, None),
        }
    }
}

fn write_vectors(f: &mut Formatter<'_>, [a, b, c]: &[Vector; 3], strain: Option<f64>) -> std::fmt::Result {
    let is_sheared = [a.y, a.z, b.z, c.x, c.y].iter().all(|&lean| lean == 0.0);
    if is_sheared {
        return write_edges(f, Vector::new(a.x, b.y, c.z), strain.unwrap_or(b.x / b.y));
    }
    let vector = |v: &Vector| v.to_array().map(|x| Number(x).to_string()).join(", ");
    write!(f, "of the vectors ({}), ({}) and ({})", vector(a), vector(b), vector(c))
}

fn write_edges(f: &mut Formatter<'_>, edges: Vector, strain: f64) -> std::fmt::Result {
    write!(f, "{} x {} x {}", Number(edges.x), Number(edges.y), Number(edges.z))?;
    if strain == 0.0 { Ok(()) } else { write!(f, " with a strain of {}", Number(strain)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EDGES: Vector = Vector::new(8.0, 4.0, 5.0);

    fn scene(axes: [BoxAxis; 3]) -> SceneBox {
        let repeats = axes == [BoxAxis::Periodic; 3];
        SceneBox { shape: if repeats { BoxShape::Sheared(EDGES, 0.0) } else { BoxShape::Straight(EDGES) }, axes }
    }

    fn file(a: [f64; 3], b: [f64; 3], c: [f64; 3]) -> FileBox {
        FileBox::lattice([a, b, c].map(Vector::from_array))
    }

    #[test]
    fn the_strain_is_that_of_the_second_edge() {
        let all = scene([BoxAxis::Periodic; 3]);
        let strain = |box_: FileBox| box_.strain_in(&all);
        assert_eq!(strain(FileBox::straight(EDGES)), Ok(0.0));
        assert_eq!(strain(file([8.0, 0.0, 0.0], [1.0, 4.0, 0.0], [0.0, 0.0, 5.0])), Ok(0.25));
        assert_eq!(strain(file([8.0, 0.0, 0.0], [9.0, 4.0, 0.0], [9.0, 4.0, 5.0])), Ok(0.25), "the same lattice");
        assert_eq!(strain(file([8.0, 0.0, 0.0], [5.0, 4.0, 0.0], [0.0, 0.0, 5.0])), Ok(-0.75), "in its range");
        let noted = FileBox { strain: Some(0.1), ..file([8.0, 0.0, 0.0], [0.4, 4.0, 0.0], [0.0, 0.0, 5.0]) };
        assert_eq!(strain(noted), Ok(0.1), "as the file says it, to the last bit");
        let rounded = file([8.00003, 0.0, 0.0], [0.0, 3.99998, 0.0], [0.0, 0.0, 5.0]);
        assert_eq!(strain(rounded), Ok(0.0), "as text rounds it");
    }

    #[test]
    fn other_boxes_are_refused_with_both() {
        let all = scene([BoxAxis::Periodic; 3]);
        let message = FileBox::straight(EDGES * 2.0).strain_in(&all).unwrap_err();
        assert_eq!(message, "its box is 16 x 8 x 10, but that of the scene is 8 x 4 x 5");
        assert!(
            file([8.0, 0.0, 0.0], [0.0, 4.0, 0.0], [1.0, 0.0, 5.0]).strain_in(&all).unwrap_err().contains("(1, 0, 5)")
        );
        assert!(file([8.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 1.0, 5.0]).strain_in(&all).is_err());
        assert!(file([0.0, 4.0, 0.0], [-8.0, 0.0, 0.0], [0.0, 0.0, 5.0]).strain_in(&all).is_err(), "turned");
    }

    #[test]
    fn edges_count_where_the_scene_has_them() {
        let sheared = file([8.0, 0.0, 0.0], [1.0, 4.0, 0.0], [0.0, 0.0, 5.0]);
        let high = FileBox::straight(Vector::new(8.0, 4.0, 50.0));
        let walls = scene([BoxAxis::Periodic, BoxAxis::Periodic, BoxAxis::Walls]);
        assert!(sheared.strain_in(&walls).unwrap_err().contains("8 x 4 x 5 with a strain of 0.25"));
        assert!(high.strain_in(&walls).is_err());
        assert_eq!(high.strain_in(&scene([BoxAxis::Periodic, BoxAxis::Periodic, BoxAxis::Open])), Ok(0.0));
        let single = FileBox { periodic: [true, true, false], ..high };
        assert_eq!(single.strain_in(&scene([BoxAxis::Periodic; 3])), Ok(0.0), "a length that is no period");
        assert!(single.strain_in(&walls).is_err(), "walls have a distance");
        assert_eq!(sheared.strain_in(&scene([BoxAxis::Open; 3])), Ok(0.0));
    }

    #[test]
    fn a_lattice_is_the_same_by_any_of_its_vectors() {
        let vectors = [[2.0, 1.0, 0.0], [-1.0, 2.5, 0.0], [0.5, 0.0, 4.0]].map(Vector::from_array);
        let other = [vectors[0] + vectors[2], vectors[1], vectors[2]];
        let scene = SceneBox { shape: BoxShape::Lattice(vectors), axes: [BoxAxis::Periodic; 3] };
        assert_eq!(FileBox::lattice(other).strain_in(&scene), Ok(0.0));
        let stretched = vectors.map(|vector| vector * Vector::new(1.1, 1.0 / 1.1, 1.0));
        assert!(FileBox::lattice(stretched).strain_in(&scene).is_err());
        assert!(FileBox::lattice([vectors[0] * 2.0, vectors[1], vectors[2]]).strain_in(&scene).is_err());
    }

    #[test]
    fn boxes_without_a_volume_are_refused() {
        let flat = file([8.0, 0.0, 0.0], [8.0, 0.0, 0.0], [0.0, 0.0, 5.0]);
        assert!(flat.checked().unwrap_err().contains("its box: "));
        assert!(FileBox { strain: Some(f64::NAN), ..FileBox::straight(EDGES) }.checked().is_err());
    }

    #[test]
    fn strains_a_period_apart_are_the_same() {
        assert!(is_same_strain(0.25, 2.25, EDGES) && is_same_strain(0.25, 0.25 + 1e-6, EDGES));
        assert!(!is_same_strain(0.25, 1.25, EDGES));
    }
}
