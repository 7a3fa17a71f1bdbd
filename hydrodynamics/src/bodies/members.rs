//! Spheres of bodies on a rank.

use crate::bodies::matrix::{load_on_body, motion_of_member};
use crate::six_vector::{SixVector, SixVectors};
use domain::Vector;
use domain::parallel::{MeasuredLoop, SortedRows, change_rows, concat, copied, mapped, sort};
use rayon::prelude::*;
use std::ops::AddAssign;

/// Spheres of a rank and the bodies to which they belong, for use by any thread.
#[derive(Clone)]
pub struct Members {
    /// Numbers of the bodies with spheres on this rank, in ascending order.
    numbers: Vec<u32>,
    /// Place of the body of each row in `numbers`; its length for free spheres.
    places: Vec<u32>,
    /// Rows of each body, and of the free spheres.
    rows: SortedRows,
    /// Positions of the spheres minus those of the centres of their bodies, row by row.
    arms: Vec<Vector>,
}

/// Number of bodies whose members one thread sums at a time, at least.
const BATCH: usize = 64;

/// Number of spheres whose bodies one thread collects at a time.
const TILE: usize = 4096;

impl Members {
    /// Spheres with the number of their body, `None` for a free one, and with arms.
    pub(super) fn new(bodies: &[Option<u32>], arms: &[Vector]) -> Self {
        assert_eq!(bodies.len(), arms.len(), "each sphere has an arm");
        let of_tile = |tile: &[Option<u32>]| tile.iter().copied().flatten().collect();
        let mut numbers = concat(bodies.par_chunks(TILE).map(of_tile).measured().collect());
        sort(numbers.len(), || numbers.par_sort_unstable());
        numbers.dedup();
        let free = numbers.len() as u32;
        let place = |body: &Option<u32>| body.map_or(free, |body| numbers.partition_point(|&n| n < body) as u32);
        let places = mapped(bodies, place);
        let rows = SortedRows::by_key(&places, numbers.len() + 1);
        Self { numbers, places, rows, arms: copied(arms) }
    }

    /// The same with arms in another unit.
    pub(super) fn scaled(&self, factor: f64) -> Self {
        Self { arms: mapped(&self.arms, |&arm| arm * factor), ..self.clone() }
    }

    /// Numbers of the bodies with spheres on this rank, in ascending order.
    pub fn numbers(&self) -> &[u32] {
        &self.numbers
    }

    /// Number of spheres of the rank, those that are free included.
    pub fn spheres(&self) -> usize {
        self.places.len()
    }

    /// Number of the body of the sphere in a row; `None` for a free sphere.
    pub fn body(&self, row: usize) -> Option<u32> {
        self.place(row).map(|place| self.numbers[place])
    }

    /// Place of the body of the sphere in a row in lists of bodies; `None` for a free sphere.
    pub fn place(&self, row: usize) -> Option<usize> {
        let place = self.places[row] as usize;
        (place < self.numbers.len()).then_some(place)
    }

    /// Arm of the sphere in a row.
    pub fn arm(&self, row: usize) -> Vector {
        self.arms[row]
    }

    /// Rows of the spheres of a body, by its place.
    pub fn rows(&self, place: usize) -> &[u32] {
        self.rows.of(place)
    }
}

impl Members {
    /// `K Q` in a row: motion of the sphere as a part of its body; `None` for a free sphere.
    pub(crate) fn motion(&self, row: usize, bodies: &SixVectors) -> Option<SixVector> {
        self.place(row).map(|place| motion_of_member(bodies.0[place], self.arms[row]))
    }

    /// `K^T L` of this rank's spheres.
    pub(super) fn totals(&self, loads: &SixVectors) -> SixVectors {
        SixVectors(self.sums(|row| load_on_body(loads.0[row], self.arms[row])))
    }

    /// Sets values of free spheres to zero.
    pub(crate) fn keep_members(&self, values: &mut SixVectors) {
        change_rows(&mut values.0, |row, value| {
            if self.place(row).is_none() {
                *value = SixVector::default();
            }
        });
    }

    /// Sums over this rank's members of the bodies, in the order of the rows.
    pub(super) fn sums<T: Default + AddAssign + Send>(&self, of_member: impl Fn(usize) -> T + Sync) -> Vec<T> {
        let of_body = |body: usize| {
            let mut sum = T::default();
            self.rows.of(body).iter().for_each(|&row| sum += of_member(row as usize));
            sum
        };
        (0..self.numbers.len()).into_par_iter().with_min_len(BATCH).map(of_body).measured().collect()
    }
}
