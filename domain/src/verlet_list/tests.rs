use super::*;
use crate::{Boundaries, Comm, Neighbour, Pairs, Particles, Random};

fn particles(cell: &PeriodicBox, places: &[Vector], turn: usize) -> Particles {
    let mut particles = Particles::default();
    // In a different order each time.
    for i in 0..places.len() {
        let id = (i * 7 + turn) % places.len();
        particles.push(id as u64, cell.wrap(places[id]).0, 1.0, 0);
    }
    particles
}

fn places(count: u64, edges: Vector) -> Vec<Vector> {
    (0..count).map(|i| Random::new(3, i).point() * edges).collect()
}

fn present(particles: &Particles) -> LocalAndGhosts<'_> {
    LocalAndGhosts { owned: particles.len(), ids: &particles.ids, positions: &particles.positions }
}

fn alone(cutoff: f64) -> VerletList {
    VerletList::new(cutoff, &Partition::new(&Comm::alone(), [8, 8]))
}

#[test]
fn a_table_and_a_list_know_the_same_rows() {
    for stride in [1, 3, 1000, 1 << 50] {
        let ids: Vec<u64> = (0..50).map(|k| (k * 7 % 50) * stride).collect();
        let rows = RowById::new(&ids);
        assert_eq!(matches!(rows, RowById::Table(_)), stride < 8);
        assert!(ids.iter().enumerate().all(|(row, &id)| rows.get(id) == Some(row)));
        assert!([50 * stride, u64::MAX, 50 * stride - 2].iter().all(|&id| ids.contains(&id) || rows.get(id).is_none()));
    }
}

/// Particles that move in a sheared box, across its faces, past its range of strains and from rank to rank: the
/// neighbours are always those of a new search.
#[test]
fn lists_are_those_of_a_search_at_all_times() {
    let sheared = |turn: usize, edges| PeriodicBox::sheared(edges, 0.4 + 0.01 * turn as f64).unwrap();
    lists_are_right(&sheared, 2..100);
}

/// The same if the box is not periodic along all axes and particles leave it.
#[test]
#[ignore = "heavy"]
fn lists_are_right_where_a_box_does_not_repeat() {
    for boundaries in [Boundaries::Wall, Boundaries::Open] {
        let cell = |_: usize, edges| PeriodicBox::new(edges).unwrap().with_boundaries(boundaries).unwrap();
        // This box does not follow the shear in which the particles move.
        lists_are_right(&cell, 2..190);
    }
}

fn lists_are_right(cell_at: &(impl Fn(usize, Vector) -> PeriodicBox + Sync), searches: std::ops::Range<u64>) {
    let (edges, cutoff) = (Vector::new(7.0, 5.0, 6.0), 1.4);
    for table in [[1, 1], [1, 2], [2, 1], [2, 3], [1, 13]] {
        Comm::threads(table[0] * table[1], |comm| {
            let partition = Partition::with_table(&comm, [10, 12], table);
            let mut verlet_list = VerletList::new(cutoff, &partition);
            let mut places = places(150, edges);
            for turn in 0..200 {
                let cell = cell_at(turn, edges);
                for (i, x) in places.iter_mut().enumerate() {
                    let step = Random::new(turn as u64, i as u64).point() - Vector::splat(0.5);
                    *x += 0.03 * step + Vector::new(0.01 * x.y, 0.0, 0.0) + Vector::new(0.004, 0.003, -0.005);
                }
                let all = particles(&cell, &places, turn);
                let is_here = |&row: &usize| partition.owner(&cell, all.positions[row]) == comm.rank();
                let particles = all.selected(&(0..all.len()).filter(is_here).collect::<Vec<_>>());
                let halo = Halo::plan(&partition, &cell, &particles.positions, [cutoff; 2]);
                let (owned, mut ids, mut positions) =
                    (particles.len(), particles.ids.clone(), particles.positions.clone());
                halo.extend(&mut ids);
                halo.extend(&mut positions);
                verlet_list.update(&cell, &LocalAndGhosts { owned, ids: &ids, positions: &positions });
                let pairs = Pairs::of(verlet_list.neighbours(), &ids, owned);
                assert_eq!(pairs.list(), Pairs::find(&cell, &positions, &ids, owned, cutoff).list());
                let fresh = Neighbours::find(&cell, &positions, owned, cutoff);
                for row in 0..owned {
                    let mut expected: Vec<Neighbour> = fresh.of(row).iter().collect();
                    expected.sort_unstable_by_key(|n| (ids[n.row as usize], n.steps));
                    let found: Vec<Neighbour> = verlet_list.neighbours().of(row).iter().collect();
                    assert_eq!(found, expected, "turn {turn}, row {row} on {table:?}");
                }
            }
            assert!(searches.contains(&verlet_list.searches()), "{} searches on {table:?}", verlet_list.searches());
        });
    }
}

#[test]
fn nobody_is_searched_for_who_has_not_moved() {
    let cell = PeriodicBox::new(Vector::splat(6.0)).unwrap();
    let places = places(100, cell.edges());
    let mut verlet_list = alone(1.5);
    // Without a skin, for particles that have not moved at all.
    for _ in 0..5 {
        verlet_list.update(&cell, &present(&particles(&cell, &places, 0)));
        assert_eq!(verlet_list.searches(), 1);
    }
    for turn in 1..5 {
        let moved: Vec<Vector> = places.iter().map(|&x| x + Vector::splat(0.01 * turn as f64)).collect();
        verlet_list.update(&cell, &present(&particles(&cell, &moved, turn)));
        assert_eq!(verlet_list.searches(), 2);
    }
    // Nor if a particle has left, which is in no list any more.
    let fewer = particles(&cell, &places[..99], 0);
    verlet_list.update(&cell, &present(&fewer));
    assert_eq!(verlet_list.searches(), 2);
    assert_eq!(verlet_list.neighbours().count(), Neighbours::find(&cell, &fewer.positions, 99, 1.5).count());
}

#[test]
fn other_particles_are_searched_for() {
    let cell = PeriodicBox::new(Vector::splat(6.0)).unwrap();
    let mut verlet_list = alone(1.5);
    let mut some = particles(&cell, &places(20, cell.edges()), 0);
    verlet_list.update(&cell, &present(&some));
    // Ids may have gaps.
    some.ids[3] = 77;
    verlet_list.update(&cell, &present(&some));
    verlet_list.update(&cell, &present(&some));
    assert_eq!(verlet_list.searches(), 2);
    // Of any size.
    some.ids[3] = u64::MAX;
    verlet_list.update(&cell, &present(&some));
    verlet_list.update(&cell, &present(&some));
    assert_eq!(verlet_list.searches(), 3);
    assert_eq!(verlet_list.neighbours().count(), Neighbours::find(&cell, &some.positions, 20, 1.5).count());
}
