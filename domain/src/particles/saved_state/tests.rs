use crate::{Comm, Particles, Partition, PeriodicBox, Vector};

/// Lists of numbers of the columns that are in memory, each once.
fn distinct(particles: &mut Particles) -> usize {
    let lists: Vec<_> = particles.all_columns().map(|column| column.values.clone()).collect();
    (0..lists.len()).filter(|&k| !lists[..k].iter().any(|other| other.shares_memory_with(&lists[k]))).count()
}

fn cell() -> PeriodicBox {
    PeriodicBox::new(Vector::splat(4.0)).unwrap()
}

fn scattered(count: u64) -> Particles {
    let mut particles = Particles::default();
    for id in 0..count {
        let t = id as f64;
        particles.push(id, Vector::new((t * 0.37) % 1.0, (t * 0.73) % 1.0, (t * 0.57) % 1.0) * 4.0, 1.0, 0);
    }
    for (name, width) in [("velocity", 3), ("past", 5), ("older", 5)] {
        let values = &mut particles.column(name, width).values;
        values.iter_mut().enumerate().for_each(|(k, value)| *value = 1.0 / (k as f64 + width as f64));
    }
    particles.scalars.set("strain", &[0.25]);
    particles
}

/// A step that moves particles to other ranks, rotates a history, changes a column, on one rank only where it has a
/// certain particle, and removes another.
fn change(particles: &mut Particles, partition: &Partition) {
    let steps = [Vector::new(0.3, 1.1, -1.7), Vector::new(-0.2, 2.9, 0.4)];
    for (k, step) in steps.into_iter().enumerate() {
        particles.positions.iter_mut().for_each(|position| *position += step);
        particles.wrap(&cell());
        let newest = particles.column("velocity", 3).values.clone();
        particles.column("past velocity", 3).values = newest;
        particles.migrate(partition, &cell());
        let known: Option<usize> = particles.ids.iter().position(|&id| id == 7);
        if let Some(row) = known {
            particles.column("past", 5).values[5 * row] += 1.0;
        }
        particles.vectors("velocity").iter_mut().for_each(|v| *v *= 2.0);
        particles.scalars.set("strain", &[k as f64]);
    }
    particles.remove(|name| name == "older");
}

#[test]
fn a_saved_state_is_restored_on_any_number_of_ranks() {
    for ranks in [1, 2, 3, 4, 7, 16] {
        let all = scattered(60);
        let restored = Comm::threads(ranks, |comm| {
            let partition = Partition::new(&comm, [8, 8]);
            let rows: Vec<usize> = (0..60).filter(|row| row % ranks == comm.rank()).collect();
            let mut particles = all.selected(&rows);
            particles.migrate(&partition, &cell());
            let before = particles.clone();
            particles.save(&comm);
            change(&mut particles, &partition);
            assert!(comm.any(particles.ids != before.ids || particles.positions != before.positions));
            particles.restore(&comm);
            (before, particles)
        });
        for (before, after) in restored {
            assert_eq!(after, before, "{ranks} ranks");
        }
    }
}

#[test]
fn changes_are_those_without_a_saved_state() {
    let partition = Partition::new(&Comm::alone(), [8, 8]);
    let (mut with, mut without) = (scattered(60), scattered(60));
    with.save(&Comm::alone());
    change(&mut with, &partition);
    change(&mut without, &partition);
    assert_ne!(with, without);
    with.forget();
    assert_eq!(with, without);
}

#[test]
fn numbers_that_do_not_change_are_in_memory_once() {
    let partition = Partition::new(&Comm::alone(), [8, 8]);
    let mut particles = scattered(60);
    particles.save(&Comm::alone());
    assert_eq!(distinct(&mut particles), 3);
    particles.migrate(&partition, &cell());
    assert_eq!(distinct(&mut particles), 3, "they move together");
    particles.vectors("velocity")[0] = Vector::ONE;
    assert_eq!(distinct(&mut particles), 4);
    particles.arrange(&(0..60).rev().collect::<Vec<_>>());
    assert_eq!(distinct(&mut particles), 4);
}

#[test]
fn a_copy_can_be_restored_as_well() {
    let partition = Partition::new(&Comm::alone(), [8, 8]);
    let before = scattered(60);
    let mut particles = before.clone();
    particles.save(&Comm::alone());
    let mut copy = particles.copied();
    for store in [&mut particles, &mut copy] {
        change(store, &partition);
        store.restore(&Comm::alone());
        assert_eq!(*store, before);
    }
}

#[test]
#[should_panic(expected = "a saved state")]
fn nothing_is_restored_without_a_saved_state() {
    scattered(3).restore(&Comm::alone());
}
