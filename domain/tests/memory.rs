//! Forecasts of memory against measured allocations.

mod heap;

use domain::{
    Bytes, Comm, ExpectedCounts, Halo, LocalAndGhosts, Neighbours, Pairs, Particles, Partition, PeriodicBox, Random,
    Vector, VerletList, packing_bytes, random_packing,
};
use heap::measured;

const COUNT: usize = 30_000;
const EDGE: f64 = 40.0;
const CUTOFF: f64 = 2.5;
const LINES: [usize; 2] = [40, 40];

/// Uniformly distributed, as forecasts assume.
fn particles() -> Particles {
    let mut particles = Particles::default();
    for id in 0..COUNT as u64 {
        particles.push(id, Random::new(1, id).point() * EDGE, 0.5, 0);
    }
    particles.vectors("velocity");
    particles.column("stresslet", 5);
    particles
}

#[track_caller]
fn within(share: f64, predicted: f64, found: f64) {
    assert!((predicted / found - 1.0).abs() < share, "{predicted:.3e} predicted, {found:.3e} found");
}

/// A single test function, since the allocations of concurrent tests would be counted.
#[test]
fn predictions_are_what_is_allocated() {
    let (all, cell) = (particles(), PeriodicBox::new(Vector::splat(EDGE)).unwrap());
    stores(&all);
    lists(&all, &cell);
    images(&all, &cell);
    packings();
}

fn stores(all: &Particles) {
    let (n, partition) = (COUNT as f64, Partition::new(&Comm::alone(), LINES));
    let (_, found) = measured(|| all.gathered(&partition));
    within(0.01, Particles::bytes(n, 8).most, found.kept);
    // The first rank also has room for the values from other ranks.
    let gathered = Particles::gathering_bytes(n, n, 8, true);
    within(0.01, gathered.kept, found.kept);
    assert!(gathered.most > found.most && gathered.most < 2.0 * found.most, "{gathered:?} {found:?}");
    let sent = Particles::gathering_bytes(n, 2.0 * n, 8, false);
    assert!(sent.kept == 0.0 && sent.most < gathered.most - gathered.kept, "{sent:?} {gathered:?}");
}

fn lists(all: &Particles, cell: &PeriodicBox) {
    let (n, partition) = (COUNT as f64, Partition::new(&Comm::alone(), LINES));
    let expected = ExpectedCounts::new(cell.edges(), &[(0.5, COUNT)], partition.place());
    let (near, reached) = (expected.neighbours(CUTOFF), expected.neighbours(CUTOFF * VerletList::REACH));
    let (neighbours, found) = measured(|| Neighbours::find(cell, &all.positions, COUNT, CUTOFF));
    within(0.05, near, neighbours.count() as f64 / n);
    within(0.05, Neighbours::bytes(n, near).kept, found.kept);
    within(0.15, Neighbours::search_bytes(n, n, near).most, found.most);
    let (_, found) = measured(|| Pairs::find(cell, &all.positions, &all.ids, COUNT, CUTOFF));
    within(0.05, Pairs::bytes(n, n, near).kept, found.kept);
    within(0.15, Pairs::bytes(n, n, near).most, found.most);
    let mut verlet_list = VerletList::new(CUTOFF, &partition);
    let moved: Vec<Vector> = all.positions.iter().map(|&position| cell.wrap(position + Vector::ONE).0).collect();
    let ((), found) = measured(|| {
        let present = |positions| LocalAndGhosts { owned: COUNT, ids: &all.ids, positions };
        // The first search has no skin, and serves as long as no particle moves.
        verlet_list.update(cell, &present(&all.positions));
        verlet_list.update(cell, &present(&moved));
    });
    let predicted = VerletList::bytes([n; 3], [near, reached]);
    within(0.05, predicted.kept, found.kept);
    within(0.1, predicted.most, found.most);
}

/// Nine numbers of every image in an exchange.
fn images(all: &Particles, cell: &PeriodicBox) {
    const RANKS: usize = 4;
    let owner = |partition: &Partition, row: usize| partition.owner(cell, all.positions[row]);
    let shares = Comm::threads(RANKS, |comm| {
        let partition = Partition::new(&comm, LINES);
        let rows = (0..COUNT).filter(|&row| owner(&partition, row) == comm.rank());
        rows.map(|row| all.positions[row]).collect::<Vec<_>>()
    });
    let extend = |comm: Comm| {
        let own = &shares[comm.rank()];
        let exchange = Halo::plan(&Partition::new(&comm, LINES), cell, own, [CUTOFF; 2]);
        let mut values = Vec::with_capacity(exchange.present());
        values.resize(own.len(), [0.0; 9]);
        comm.barrier();
        exchange.extend(&mut values);
        [own.len() as f64, values.len() as f64]
    };
    let (counts, found) = measured(|| Comm::threads(RANKS, extend));
    let one = |&[owned, present]: &[f64; 2]| Bytes::list::<[f64; 9]>(present).then(Halo::bytes(owned, present));
    within(0.25, counts.iter().map(|counts| one(counts).most).sum(), found.most);
    // Row of each image.
    let rows = |&[owned, present]: &[f64; 2]| within(1e-12, Halo::bytes(owned, present).kept, 4.0 * (present - owned));
    counts.iter().for_each(rows);
}

/// Dilute packings by sequential addition; dense ones also need pairs and the minimisation that separates the
/// spheres.
fn packings() {
    for (count, fraction) in [(20_000_u32, 0.2), (5_000, 0.4)] {
        let n = f64::from(count);
        let edge = (n * 4.0 / 3.0 * std::f64::consts::PI / fraction).cbrt();
        let (cell, radii) = (PeriodicBox::new(Vector::splat(edge)).unwrap(), vec![1.0; count as usize]);
        let (_, found) = measured(|| random_packing(&cell, &radii, 0.0, 1).unwrap());
        let predicted = packing_bytes(n, fraction > 0.25);
        assert!(
            predicted.kept.abs() < 1.0 && predicted.most > 0.8 * found.most && predicted.most < 1.6 * found.most,
            "{predicted:?} {found:?}"
        );
    }
}
