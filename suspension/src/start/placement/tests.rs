use super::*;
use crate::model::{Lattice, Orientation, Parameters};
use domain::{PeriodicBox, Quaternion, Vector};

/// Spheres of three species in a box of edge 20.
fn model(start: Start) -> Model {
    let species = [("a", 1.0, 41), ("b", 0.8, 7), ("c", 0.5, 53)].map(|(name, radius, count)| Species {
        orientation: (start == Start::Given).then_some(Orientation::Given),
        ..Species::new(name, radius, count)
    });
    let species = species.to_vec();
    let cell = PeriodicBox::new(Vector::splat(20.0)).unwrap();
    Model::new(Parameters { start, ..Parameters::new(cell, 1.0, species, 0.1, 1) }).unwrap()
}

fn listed() -> Vec<Vector> {
    (0..101).map(|n| Vector::new(f64::from(n % 5), f64::from(n / 5 % 5), f64::from(n / 25)) * 3.0).collect()
}

/// Positions, radii, species and orientations do not depend on the number of ranks, each of which makes a part.
#[test]
fn all_ranks_together_make_the_particles_of_one() {
    let given = GivenPositions {
        name: "a file".to_owned(),
        positions: listed(),
        orientations: Some((0..101).map(|n| Quaternion { w: f64::from(n + 1), v: Vector::X }).collect()),
        ..GivenPositions::default()
    };
    let starts = [
        (Start::Lattice(Lattice::SimpleCubic), None),
        (Start::Lattice(Lattice::FaceCentredCubic), None),
        (Start::Positions(listed()), None),
        (Start::Given, Some(given)),
    ];
    for (start, placed) in starts {
        let model = model(start);
        let made = |ranks| {
            Comm::threads(ranks, |comm| {
                particles(&model, placed.clone().filter(|_| comm.is_first()), None, &comm).unwrap()
            })
        };
        let whole = made(1).remove(0);
        assert_eq!((whole.len(), whole.columns.len()), (101, usize::from(placed.is_some())));
        assert!(model.start == Start::Positions(listed()) || placed.is_some() || !whole.species.is_sorted());
        for ranks in [2, 3, 5] {
            let parts = made(ranks);
            for (rank, part) in parts.iter().enumerate() {
                let rows: Vec<usize> = block(101, ranks, rank).collect();
                assert_eq!(*part, whole.selected(&rows), "rank {rank} of {ranks}");
            }
        }
    }
}

/// The species are those of a shuffled list of all.
#[test]
fn species_on_a_lattice_are_mixed() {
    let model = model(Start::Lattice(Lattice::SimpleCubic));
    let mut all: Vec<u32> = [vec![0; 41], vec![1; 7], vec![2; 53]].concat();
    Random::new(model.seed, u64::MAX).shuffle(&mut all);
    assert_eq!(mixed_species(&model, 13..77), all[13..77]);
}
