//! Which grid points a particle's envelope touches.

use domain::Vector;
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

/// The stencils of the particles at `positions`, in the order of the planes and lines where they begin, so that
/// neighbours in the list are neighbours in memory.
pub(crate) fn places(grid: &Grid, support: Support, positions: &[Vector]) -> Vec<Place> {
    let spacing = grid.spacing();
    let [nx, ny, nz] = grid.points().map(|n| n as i32);
    let width = Vector::new(support.lanes as f64, support.support as f64, support.support as f64);
    let unsorted = positions.iter().enumerate().map(|(row, &position)| {
        let coordinates = grid.cell().lattice_coordinates(position);
        let first = (coordinates / spacing - 0.5 * width).ceil();
        let offset = first * spacing - coordinates;
        let [x, y, z] = first.to_array().map(|f| f as i32);
        Place { row: row as u32, first: [x.rem_euclid(nx), y, z], offset }
    });
    let key = |place: &Place| (place.first[2].rem_euclid(nz) * ny + place.first[1].rem_euclid(ny)) as usize;
    sort_by_key(unsorted.collect(), key, (ny * nz) as usize)
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
