//! Memory of fields, transforms and operators.

use crate::channel::Update;
use crate::layout::Layout;
use crate::open_space::entries;
use crate::transform::ROOM;
use crate::{OpenSpace, Real};
use domain::{Bytes, Place, Vector};

/// A rank's share of a grid for memory forecasts, without building it: the points of the grid, the place of the rank,
/// and the length of the halo after each row.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GridFootprint {
    components: usize,
    points: [usize; 3],
    place: Place,
    halo: usize,
    is_tilted: bool,
}

impl GridFootprint {
    /// For vector fields on a grid of `points` points, which a transform accepts.
    pub fn new(points: [usize; 3], place: &Place, halo: usize) -> Self {
        Self { components: 3, points, place: place.clone(), halo, is_tilted: false }
    }

    /// The same for fields of another number of components.
    #[must_use]
    pub fn of_components(self, components: usize) -> Self {
        Self { components, ..self }
    }

    /// The same for a box whose third lattice vector is tilted, or not.
    #[must_use]
    pub fn tilted(self, is_tilted: bool) -> Self {
        Self { is_tilted, ..self }
    }

    /// A field, [`crate::Transform::field`].
    pub fn field<T: Real>(&self) -> Bytes {
        Bytes::list::<T>(self.layout::<T>().capacity as f64)
    }

    /// A transform: whole columns in each direction that is distributed over ranks, those along z for one round, and
    /// work space for each thread.
    pub fn transform<T: Real>(&self, threads: usize) -> Bytes {
        let layout = self.layout::<T>();
        let [nx, ny, nz] = self.points;
        let room = 2 * T::LANES * (nx / 2).next_multiple_of(T::LANES).max(ny).max(nz);
        let desk = (2 + self.components) * room + T::LANES * layout.physical.y;
        Bytes::keep(self.columns_bytes::<T>()).then(Bytes::list::<T>((threads * desk) as f64))
    }

    /// The whole columns of a transform, which other ranks on the same machine map.
    pub fn columns_bytes<T: Real>(&self) -> f64 {
        let columns = self.columns::<T>(&self.layout::<T>());
        Bytes::list::<T>(columns.into_iter().map(|[whole, _]| whole).sum()).kept
    }

    /// Memory that a rank writes in the columns of others on its machine: resident on both, but present only once.
    pub fn reached_bytes<T: Real>(&self) -> f64 {
        let columns = self.columns::<T>(&self.layout::<T>());
        Bytes::list::<T>(columns.into_iter().map(|[_, beside]| beside).sum()).kept
    }

    /// Tables of a Stokes operator, complete on every rank: three for each mode of the first two axes, and in a
    /// tilted box two more, made from a list of wavevectors.
    pub fn operator<T: Real>(&self) -> Bytes {
        let [nx, ny, nz] = self.points.map(|n| n as f64);
        let columns = (nx / 2.0 / T::LANES as f64).ceil() * T::LANES as f64;
        let orthogonal = Bytes::list::<T>(3.0 * ny * columns + columns + 2.0 * nz);
        if !self.is_tilted {
            return orthogonal;
        }
        let tilted = Bytes::list::<T>(2.0 * ny * columns + nz);
        tilted.then(Bytes::list::<Vector>(ny * columns).freed()).then(orthogonal)
    }

    /// Channel update of the operator, for the rank's share of the spectrum.
    pub fn channel<T: Real>(&self) -> Bytes {
        let layout = self.layout::<T>();
        Bytes::keep((Update::<T>::BYTES * T::LANES * layout.blocks.len() * layout.modes.len()) as f64)
    }

    /// Tables of the operator in open space, complete on every rank, and the memory to make them: a field in
    /// `f64` on a grid as long as the particles' half of this one plus its diagonal, with some margin, and one number
    /// for each mode of an octant of that grid.
    pub fn open_space<T: Real>(&self) -> Bytes {
        let half = self.points.map(|n| 0.5 * n as f64);
        let diagonal = half.iter().map(|n| n * n).sum::<f64>().sqrt();
        let long = half.map(|n| n + 1.2 * diagonal).iter().product::<f64>();
        let table = OpenSpace::<T>::values(self.points) / entries(3) as f64 * entries(self.components) as f64;
        let made = self.components as f64 + 0.125;
        Bytes::list::<T>(table).then(Bytes::list::<f64>(made * long).freed())
    }

    /// Grid points of this rank.
    pub fn points(&self) -> f64 {
        self.points[0] as f64 * self.place.owned().map(|lines| lines.len() as f64).iter().product::<f64>()
    }

    fn layout<T: Real>(&self) -> Layout {
        Layout::new::<T>(self.components, self.points, &self.place, self.halo)
    }

    /// Number of values in whole columns along y and along z, and how many of them come from this rank and go to
    /// others.
    fn columns<T: Real>(&self, layout: &Layout) -> [[f64; 2]; 2] {
        let [rows, columns] = self.place.table();
        let (nx, [_, ny, nz]) = (layout.width_in_all as f64, self.points.map(|n| n as f64));
        let [lines, planes] = layout.rows.clone().map(|lines| lines.len() as f64);
        let (width, modes) = (layout.width as f64, layout.modes.len() as f64);
        let components = self.components as f64;
        let along_y = [components * planes * ny * width, components * planes * lines * (nx - width)];
        let rounds = layout.rounds(columns, ROOM / size_of::<T>());
        let largest = layout.modes.len().div_ceil(rounds) as f64;
        let along_z = [components * nz * largest * width, components * planes * (ny - modes) / rounds as f64 * width];
        [if rows > 1 { along_y } else { [0.0; 2] }, if columns > 1 { along_z } else { [0.0; 2] }]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Field, Grid, Physical, Stokes, Transform};
    use domain::{Comm, Partition, PeriodicBox};

    /// Forecasts for hypothetical ranks hold for real ones.
    fn fits<T: Real>(points: [usize; 3], ranks: usize) {
        Comm::threads(ranks, |comm| {
            let partition = Partition::new(&comm, [points[1], points[2]]);
            let transform = Transform::<T>::new(points, &partition, 16);
            let place = Place::of(ranks, comm.rank(), [points[1], points[2]]);
            let footprint = GridFootprint::new(points, &place, 16);
            let lines: usize = partition.owned().map(|lines| lines.len()).iter().product();
            assert_eq!(footprint.points() as usize, points[0] * lines);
            let field: Field<T, Physical> = transform.field();
            let found = size_of_val(field.memory.values());
            let expected = footprint.field::<T>().kept;
            assert!((found as f64 - expected).abs() < 64.0, "{found} bytes of a field, {expected} expected");
            let threads = rayon::current_num_threads();
            let (found, expected) = (transform.bytes() as f64, footprint.transform::<T>(threads).kept);
            assert!((found / expected - 1.0).abs() < 1e-3, "{found} bytes of a transform, {expected} expected");
        });
    }

    /// For any box, and any number of modes per block.
    #[test]
    fn tables_of_operators_are_those_that_are_allocated() {
        fn fits<T: Real>(points: [usize; 3]) {
            let orthogonal = [Vector::X * 3.0, Vector::Y * 2.0, Vector::Z * 2.5];
            let tilted = [Vector::X * 3.0, Vector::new(0.62, 2.0, 0.0), Vector::new(1.1, -0.7, 2.5)];
            for (vectors, is_tilted) in [(orthogonal, false), (tilted, true)] {
                let grid = Grid::new(points, PeriodicBox::of_lattice(vectors).unwrap()).unwrap();
                let found = Stokes::<T>::new(&grid, 1.0).bytes() as f64;
                let alone = Place::of(1, 0, [points[1], points[2]]);
                let expected = GridFootprint::new(points, &alone, 16).tilted(is_tilted).operator::<T>();
                assert!((found - expected.kept).abs() < 1.0, "{found} bytes, {expected:?} expected");
                assert!(expected.most >= expected.kept);
            }
        }
        fits::<f32>([96, 60, 42]);
        fits::<f64>([46, 22, 106]);
    }

    #[test]
    fn bytes_are_those_that_are_allocated() {
        for ranks in [1, 2, 3, 4, 6, 7, 12] {
            fits::<f32>([96, 60, 42], ranks);
            fits::<f64>([32, 24, 36], ranks);
            fits::<f32>([46, 106, 22], ranks);
            fits::<f64>([2 * 97, 22, 2 * 59], ranks);
        }
    }
}
