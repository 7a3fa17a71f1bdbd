//! Neighbour lists that outlive small motions.

use crate::neighbours::Batch;
use crate::{Neighbour, Neighbours, Particles, PeriodicBox, Vector};
use rayon::prelude::*;

/// Who is near each particle, found anew only after somebody has moved too far (Verlet 1967): lists reach farther than
/// the cutoff by a skin, and those who are within the cutoff are picked from them.
///
/// Lists name particles by the rows that they had at the search, since rows are sorted anew as particles move, and are in the
/// order of the ids, so that they do not depend on when the search was.
#[derive(Debug)]
pub struct Vicinity {
    cutoff: f64,
    found: Option<Found>,
    near: Neighbours,
    searches: u64,
}

/// What a search has found, and where everybody was.
#[derive(Debug)]
struct Found {
    cell: PeriodicBox,
    /// The row of each id then.
    rows: Vec<u32>,
    positions: Vec<Vector>,
    reach: f64,
    lists: Neighbours,
}

/// The skin over the cutoff: a third more are looked at in a list, which is cheap beside a search.
const SKIN: f64 = 0.1;

/// The largest id over the number of particles for which a table of ids is kept.
const SPARSEST: usize = 16;

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
        let cutoff = self.cutoff;
        let follow = |found: &Found| found.follow(cell, particles, cutoff);
        let mut now = self.found.as_ref().and_then(follow);
        if now.is_none() {
            self.found = Some(self.search(cell, particles));
            now = self.found.as_ref().and_then(follow);
        }
        match (&self.found, now) {
            (Some(found), Some(now)) => self.near = found.within(&now, cutoff),
            // Whom a search has just found, and nobody will follow.
            (found, _) => self.near = found.as_ref().map_or_else(Neighbours::default, |found| found.lists.clone()),
        }
    }

    fn search(&mut self, cell: &PeriodicBox, particles: &Particles) -> Found {
        let Particles { ids, positions, .. } = particles;
        let last = ids.iter().max().map_or(0, |&last| last as usize);
        let can_be_followed = last <= SPARSEST * ids.len();
        // Who asks but once needs no skin.
        let skin = if self.searches > 0 && can_be_followed { SKIN } else { 0.0 };
        let reach = (1.0 + skin) * self.cutoff;
        self.searches += 1;
        let mut lists = Neighbours::find(cell, positions, positions.len(), reach);
        lists.sort_by_key(|neighbour| (ids[neighbour.row as usize], neighbour.steps));
        let mut rows = Vec::new();
        if can_be_followed {
            rows.resize(last + 1, NOBODY);
            for (row, &id) in ids.iter().enumerate() {
                rows[id as usize] = row as u32;
            }
        }
        Found { cell: *cell, rows, positions: positions.clone(), reach, lists }
    }
}

/// The row of an id that nobody has.
const NOBODY: u32 = u32::MAX;

/// Who is where, by the rows of the search: in which row now, at which place if nobody had been wrapped since, and by which
/// lattice steps each has been.
struct Now<'a> {
    cell: &'a PeriodicBox,
    rows: Vec<u32>,
    places: Vec<Vector>,
    wrapped: Vec<[i8; 3]>,
}

impl Found {
    /// Where everybody is now, or nothing if somebody may be within the cutoff who is in no list.
    ///
    /// In lattice coordinates the flow of a shear does not move anybody. What it does to a distance is at least the factor
    /// `sqrt(1 + g^2/4) - g/2` at the strain `g` since.
    fn follow<'a>(&self, cell: &'a PeriodicBox, particles: &Particles, cutoff: f64) -> Option<Now<'a>> {
        if particles.len() != self.positions.len() || cell.edges() != self.cell.edges() {
            return None;
        }
        let rows = self.rows_now(&particles.ids)?;
        let half = 0.5 * (cell.strain() - self.cell.strain()).abs();
        let spare = self.reach * ((1.0 + half * half).sqrt() - half) - cutoff;
        let edges = cell.edges();
        let follow = |(&row, &before): (&u32, &Vector)| {
            let now = particles.positions[row as usize];
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

    /// The rows now by those of the search, if they are the same particles.
    fn rows_now(&self, ids: &[u64]) -> Option<Vec<u32>> {
        let mut rows = vec![NOBODY; ids.len()];
        for (row, &id) in ids.iter().enumerate() {
            let before = *self.rows.get(id as usize)?;
            *rows.get_mut(before as usize)? = row as u32;
        }
        (!rows.contains(&NOBODY)).then_some(rows)
    }

    /// Those of the lists who are within a cutoff.
    fn within(&self, now: &Now, cutoff: f64) -> Neighbours {
        let count = now.rows.len();
        let pick = |batch: usize| {
            let mut picked = Batch::default();
            for row in batch * BATCH..count.min((batch + 1) * BATCH) {
                now.pick(row, self.lists.of(row), cutoff, &mut picked.list);
                picked.ends.push((now.rows[row], picked.list.len()));
            }
            picked
        };
        Neighbours::join((0..count.div_ceil(BATCH)).into_par_iter().map(pick).collect(), count)
    }
}

impl Now<'_> {
    /// Appends those of a list who are within the cutoff.
    fn pick(&self, row: usize, list: &[Neighbour], cutoff: f64, picked: &mut Vec<Neighbour>) {
        let (place, home) = (self.places[row], self.wrapped[row]);
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
    fn other_particles_are_searched_for() {
        let cell = PeriodicBox::new(Vector::splat(6.0)).unwrap();
        let mut vicinity = Vicinity::new(1.5);
        let mut some = particles(&cell, &places(20, cell.edges()), 0);
        vicinity.update(&cell, &some);
        // Ids may have gaps.
        some.ids[3] = 77;
        vicinity.update(&cell, &some);
        vicinity.update(&cell, &some);
        assert_eq!(vicinity.searches(), 2);
        // With gaps like these nobody is followed, but everybody found.
        some.ids[3] = u64::MAX;
        vicinity.update(&cell, &some);
        vicinity.update(&cell, &some);
        assert_eq!(vicinity.searches(), 4);
        assert_eq!(vicinity.near().count(), Neighbours::find(&cell, &some.positions, 20, 1.5).count());
    }
}
