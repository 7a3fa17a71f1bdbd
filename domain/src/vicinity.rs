//! Neighbour lists that outlive small motions.

use crate::neighbours::Batch;
use crate::{Neighbour, Neighbours, Particles, PeriodicBox, Vector};
use rayon::prelude::*;

/// Who is near each particle, found anew only after somebody has moved too far (Verlet 1967): lists reach farther than
/// the cutoff by a skin, and those who are within the cutoff are picked from them.
///
/// Lists name particles by their ids, so that they hold when rows are sorted anew, and are in the order of the ids, so that
/// they do not depend on when the last search was.
#[derive(Debug)]
pub struct Vicinity {
    cutoff: f64,
    found: Option<Found>,
    near: Neighbours,
    searches: u64,
}

/// What a search has found, and where everybody was, all by ids.
#[derive(Debug)]
struct Found {
    cell: PeriodicBox,
    positions: Vec<Vector>,
    reach: f64,
    lists: Neighbours,
}

/// The skin over the cutoff: a third more are looked at in a list, which is cheap beside a search.
const SKIN: f64 = 0.1;

/// Particles whose lists one thread goes through at a time.
const BATCH: usize = 1024;

impl Vicinity {
    /// Nobody yet.
    pub fn new(cutoff: f64) -> Self {
        Self { cutoff, found: None, near: Neighbours::default(), searches: 0 }
    }

    /// Those within the cutoff at the last positions, by rows.
    pub fn near(&self) -> &Neighbours {
        &self.near
    }

    /// Searches so far.
    pub fn searches(&self) -> u64 {
        self.searches
    }

    /// Takes the positions, inside the box, of all particles, of which there are no images on other ranks.
    pub fn update(&mut self, cell: &PeriodicBox, particles: &Particles) {
        let count = particles.len();
        let Some(rows) = rows(&particles.ids) else {
            // Ids with gaps name no places in a list.
            self.near = Neighbours::find(cell, &particles.positions, count, self.cutoff);
            self.searches += 1;
            return;
        };
        let cutoff = self.cutoff;
        let follow = |found: &Found| found.follow(cell, &rows, &particles.positions, cutoff);
        let mut now = self.found.as_ref().and_then(follow);
        if now.is_none() {
            self.found = Some(self.search(cell, &rows, &particles.positions));
            now = self.found.as_ref().and_then(follow);
        }
        if let (Some(found), Some(now)) = (&self.found, now) {
            self.near = found.within(&now, &particles.ids, self.cutoff);
        }
    }

    fn search(&mut self, cell: &PeriodicBox, rows: &[u32], positions: &[Vector]) -> Found {
        // Who asks but once needs no skin.
        let reach = if self.searches == 0 { self.cutoff } else { (1.0 + SKIN) * self.cutoff };
        self.searches += 1;
        let positions: Vec<Vector> = rows.iter().map(|&row| positions[row as usize]).collect();
        let mut lists = Neighbours::find(cell, &positions, positions.len(), reach);
        lists.sort();
        Found { cell: *cell, positions, reach, lists }
    }
}

/// The row of each id, if they are 0, 1, ... in any order.
fn rows(ids: &[u64]) -> Option<Vec<u32>> {
    let mut rows = vec![u32::MAX; ids.len()];
    for (row, &id) in ids.iter().enumerate() {
        *rows.get_mut(id as usize)? = row as u32;
    }
    (!rows.contains(&u32::MAX)).then_some(rows)
}

/// Who is where, by ids: in which row, at which place if nobody had been wrapped since the search, and by which lattice steps
/// each has been.
struct Now<'a> {
    cell: &'a PeriodicBox,
    rows: &'a [u32],
    places: Vec<Vector>,
    wrapped: Vec<[i8; 3]>,
}

impl Found {
    /// Where everybody is now, or nothing if somebody may be within the cutoff who is in no list.
    ///
    /// In lattice coordinates the flow of a shear does not move anybody. What it does to a distance is at least the factor
    /// `sqrt(1 + g^2/4) - g/2` at the strain `g` since.
    fn follow<'a>(&self, cell: &'a PeriodicBox, rows: &'a [u32], positions: &[Vector], cutoff: f64) -> Option<Now<'a>> {
        if positions.len() != self.positions.len() || cell.edges() != self.cell.edges() {
            return None;
        }
        let half = 0.5 * (cell.strain() - self.cell.strain()).abs();
        let spare = self.reach * ((1.0 + half * half).sqrt() - half) - cutoff;
        let edges = cell.edges();
        let follow = |(&row, &before): (&u32, &Vector)| {
            let now = positions[row as usize];
            let moved = cell.lattice_coordinates(now) - self.cell.lattice_coordinates(before);
            let steps = (moved / edges).round();
            let moved = moved - steps * edges;
            let moved = Vector::new(moved.x + cell.strain() * moved.y, moved.y, moved.z);
            // Both of a pair may have come nearer.
            let is_near = 4.0 * moved.length_squared() <= spare * spare && spare >= 0.0;
            let place =
                if steps == Vector::ZERO { now } else { now - cell.lattice(steps.to_array().map(|s| s as i32)) };
            is_near.then(|| (place, steps.to_array().map(|s| s as i8)))
        };
        let followed: Option<Vec<_>> = rows.par_iter().zip(&self.positions).map(follow).collect();
        let (places, wrapped) = followed?.into_iter().unzip();
        Some(Now { cell, rows, places, wrapped })
    }

    /// Those of the lists who are within a cutoff, by rows, in the order of the ids.
    fn within(&self, now: &Now, ids: &[u64], cutoff: f64) -> Neighbours {
        let pick = |batch: usize| {
            let mut picked = Batch::default();
            for row in batch * BATCH..ids.len().min((batch + 1) * BATCH) {
                let id = ids[row] as usize;
                now.pick(id, self.lists.of(id), cutoff, &mut picked.list);
                picked.ends.push((row as u32, picked.list.len()));
            }
            picked
        };
        Neighbours::join((0..ids.len().div_ceil(BATCH)).into_par_iter().map(pick).collect(), ids.len())
    }
}

impl Now<'_> {
    /// Appends those of a list who are within the cutoff.
    fn pick(&self, id: usize, list: &[Neighbour], cutoff: f64, picked: &mut Vec<Neighbour>) {
        let (place, home) = (self.places[id], self.wrapped[id]);
        let mut found = picked.len();
        picked.resize(found + list.len(), Neighbour { row: 0, steps: [0; 3] });
        for &Neighbour { row: other, steps } in list {
            let other = other as usize;
            let mut x = place - self.places[other];
            if steps != [0; 3] {
                x -= self.cell.lattice(steps.map(i32::from));
            }
            let away = self.wrapped[other];
            let steps = [steps[0] + home[0] - away[0], steps[1] + home[1] - away[1], steps[2] + home[2] - away[2]];
            // Without a branch, which would be mispredicted all the time.
            picked[found] = Neighbour { row: self.rows[other], steps };
            found += usize::from(x.length_squared() < cutoff * cutoff);
        }
        picked.truncate(found);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Random;

    fn particles(cell: &PeriodicBox, places: &[Vector], turn: usize) -> Particles {
        let mut particles = Particles::default();
        // In another order each turn.
        for i in 0..places.len() {
            let id = (i * 7 + turn) % places.len();
            particles.push(id as u64, cell.wrap(places[id]).0, 1.0, 0);
        }
        particles
    }

    fn places(count: u64, edges: Vector) -> Vec<Vector> {
        (0..count).map(|i| Random::new(3, i).point() * edges).collect()
    }

    /// Particles that wander in a box that shears, past its faces and its range of strains: the lists are at all times
    /// those of a search.
    #[test]
    fn lists_are_those_of_a_search_at_all_times() {
        let (edges, cutoff) = (Vector::new(7.0, 5.0, 6.0), 1.4);
        let mut vicinity = Vicinity::new(cutoff);
        let mut places = places(150, edges);
        for turn in 0..200 {
            let cell = PeriodicBox::sheared(edges, 0.4 + 0.01 * turn as f64).unwrap();
            for (i, x) in places.iter_mut().enumerate() {
                let step = Random::new(turn as u64, i as u64).point() - Vector::splat(0.5);
                *x += 0.03 * step + Vector::new(0.01 * x.y, 0.0, 0.0) + Vector::new(0.004, 0.003, -0.005);
            }
            let particles = particles(&cell, &places, turn);
            vicinity.update(&cell, &particles);
            let fresh = Neighbours::find(&cell, &particles.positions, 150, cutoff);
            for row in 0..150 {
                let mut expected = fresh.of(row).to_vec();
                expected.sort_unstable_by_key(|n| (particles.ids[n.row as usize], n.steps));
                assert_eq!(vicinity.near().of(row), expected, "turn {turn}, row {row}");
            }
        }
        assert!((2..100).contains(&vicinity.searches()), "{} searches", vicinity.searches());
    }

    #[test]
    fn nobody_is_searched_for_who_has_not_moved() {
        let cell = PeriodicBox::new(Vector::splat(6.0)).unwrap();
        let places = places(100, cell.edges());
        let mut vicinity = Vicinity::new(1.5);
        // Without a skin, those who have not moved at all.
        for _ in 0..5 {
            vicinity.update(&cell, &particles(&cell, &places, 0));
            assert_eq!(vicinity.searches(), 1);
        }
        for turn in 1..5 {
            let moved: Vec<Vector> = places.iter().map(|&x| x + Vector::splat(0.01 * turn as f64)).collect();
            vicinity.update(&cell, &particles(&cell, &moved, turn));
            assert_eq!(vicinity.searches(), 2);
        }
        vicinity.update(&cell, &particles(&cell, &places[1..], 0));
        assert_eq!(vicinity.searches(), 3);
    }

    #[test]
    fn ids_with_gaps_are_searched_for_each_time() {
        let cell = PeriodicBox::new(Vector::splat(6.0)).unwrap();
        let mut vicinity = Vicinity::new(1.5);
        let mut some = particles(&cell, &places(20, cell.edges()), 0);
        some.ids[3] = 77;
        for searches in 1..3 {
            vicinity.update(&cell, &some);
            assert_eq!(vicinity.searches(), searches);
        }
    }
}
