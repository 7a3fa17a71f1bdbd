//! Which grid points a particle's envelope touches.

use domain::Vector;
use rayon::prelude::*;
use solver::Grid;

/// The stencils of all particles: `lanes` points along x, a whole number of vectors, and `support` along y and z.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Support {
    /// Points along x.
    pub lanes: usize,
    /// Points along y and along z.
    pub support: usize,
}

/// Where one particle's stencil begins.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place {
    /// Row of the particle among those present.
    pub row: u32,
    /// First grid point along each axis: along x wrapped into the row, along y and z not wrapped.
    pub first: [i32; 3],
    /// Lattice coordinates of that point relative to the particle.
    pub offset: Vector,
}

/// The stencils of the particles at `positions`, in the order of the blocks where they begin.
pub(crate) fn places(grid: &Grid, support: Support, positions: &[Vector]) -> Vec<Place> {
    let spacing = grid.spacing();
    let points = grid.points().map(|n| n as i32);
    let width = Vector::new(support.lanes as f64, support.support as f64, support.support as f64);
    let unsorted = positions.par_iter().enumerate().map(|(row, &position)| {
        let coordinates = grid.cell().lattice_coordinates(position);
        let first = (coordinates / spacing - 0.5 * width).ceil();
        let offset = first * spacing - coordinates;
        let [x, y, z] = first.to_array().map(|f| f as i32);
        Place { row: row as u32, first: [x.rem_euclid(points[0]), y, z], offset }
    });
    let blocks = Blocks::of(grid.points());
    let key = |place: &Place| {
        let [x, y, z] = place.first;
        blocks.place([x, y.rem_euclid(points[1]), z.rem_euclid(points[2])].map(|p| p as usize))
    };
    sort_by_key(unsorted.collect(), key, blocks.count())
}

/// Blocks of the grid in an order in which neighbours in the list are neighbours in memory. What the stencils of a large
/// block touch stays in the second cache, what those of a small one touch in the first.
struct Blocks {
    counts: [usize; 3],
}

/// Points of a large block, and how many small ones it has along each axis.
const LARGE: [usize; 3] = [64, 16, 16];
const FINER: usize = 4;

impl Blocks {
    fn of(points: [usize; 3]) -> Self {
        Self { counts: std::array::from_fn(|d| points[d].div_ceil(LARGE[d])) }
    }

    /// The small blocks of all.
    fn count(&self) -> usize {
        self.counts.iter().product::<usize>() * FINER.pow(3)
    }

    /// The place of the small block of a point in the order of all.
    fn place(&self, point: [usize; 3]) -> usize {
        let (mut large, mut small) = (0, 0);
        for d in [2, 1, 0] {
            large = large * self.counts[d] + point[d] / LARGE[d];
            small = small * FINER + point[d] % LARGE[d] * FINER / LARGE[d];
        }
        large * FINER.pow(3) + small
    }
}

/// A stable counting sort by keys below `keys`.
fn sort_by_key(places: Vec<Place>, key: impl Fn(&Place) -> usize, keys: usize) -> Vec<Place> {
    if places.len() < keys / 8 {
        let mut places = places;
        places.sort_by_key(key);
        return places;
    }
    let mut starts = vec![0_u32; keys + 1];
    for place in &places {
        starts[key(place) + 1] += 1;
    }
    for k in 1..keys {
        starts[k] += starts[k - 1];
    }
    let mut sorted = places.clone();
    for place in &places {
        let next = &mut starts[key(place)];
        sorted[*next as usize] = *place;
        *next += 1;
    }
    sorted
}
