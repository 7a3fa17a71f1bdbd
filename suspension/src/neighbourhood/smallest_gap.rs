//! Smallest gap of a suspension.

use crate::bodies;
use domain::parallel::least;
use domain::{DomainView, Halo, Neighbour, Neighbours, Pair, Particles, Vector};

/// Smallest gap between the surfaces of two particles, of a particle and its own image, or of a particle and a wall.
/// Particles of the same rigid body do not count.
/// The search proceeds by size, from the largest down: each pass takes particles within a factor of two in size
/// together with all smaller ones, so that the search range for small particles is short. Collective.
pub fn smallest_gap(particles: &Particles, domain: DomainView) -> f64 {
    let (mut smallest, mut limit) = (smallest_gap_at_walls(particles, domain), f64::INFINITY);
    loop {
        let below = particles.radii.iter().copied().filter(|&a| a < limit);
        let mut largest = [below.fold(0.0, f64::max)];
        domain.comm().max(&mut largest);
        if largest[0] == 0.0 {
            return smallest;
        }
        let sizes = [0.5 * largest[0], largest[0]];
        smallest = smallest_gap_of(sizes, smallest, particles, domain);
        limit = sizes[0].next_up();
    }
}

/// Smallest gap of a particle and a wall; infinite without walls. Collective.
pub(super) fn smallest_gap_at_walls(particles: &Particles, domain: DomainView) -> f64 {
    let cell = domain.cell;
    if cell.boundaries().walls() == 0 {
        return f64::INFINITY;
    }
    let of_one = |row: usize| {
        let gaps = cell.to_walls(particles.positions[row]).map(|to| to.distance - particles.radii[row]);
        gaps.fold(f64::INFINITY, f64::min)
    };
    let mut smallest = [least(particles.len(), of_one)];
    domain.comm().min(&mut smallest);
    smallest[0]
}

/// Smallest initial search margin, over the shortest edge of the box; it bounds the number of passes for any sizes.
const LEAST_MARGIN: f64 = 1e-9;

/// Smallest gap of the particles in a range of sizes and of those that are not larger, or `known` if that is smaller.
/// Collective.
fn smallest_gap_of(
    [half, largest]: [f64; 2],
    known: f64,
    particles: &Particles,
    DomainView { cell, partition }: DomainView,
) -> f64 {
    // Particles within the range of sizes come first.
    let of = |is_meant: &dyn Fn(f64) -> bool| (0..particles.len()).filter(|&r| is_meant(particles.radii[r])).collect();
    let first: Vec<usize> = of(&|a| a > half && a <= largest);
    let others: Vec<usize> = of(&|a| a <= half);
    let rows: Vec<usize> = first.iter().chain(&others).copied().collect();
    let pick = |r: &usize| (particles.positions[*r], particles.radii[*r]);
    let (positions, radii): (Vec<Vector>, Vec<f64>) = rows.iter().map(pick).unzip();
    let of_bodies = bodies::numbers(particles);
    let numbers: Vec<f64> = rows.iter().map(|&row| of_bodies.get(row).copied().unwrap_or(-1.0)).collect();
    // No two centres are farther apart than this, so the search ends.
    let (shortest, farthest) = (cell.edges().min_element(), cell.edges().element_sum());
    let (mut margin, mut smallest) = ((0.2 * largest).max(LEAST_MARGIN * shortest), known);
    loop {
        let cutoff = (2.0 * largest + margin).min(farthest);
        let halo = Halo::plan(partition, cell, &positions, [cutoff; 2]);
        let (mut places, mut sizes) = (positions.clone(), radii.clone());
        halo.extend(&mut places);
        halo.extend(&mut sizes);
        let mut numbers = numbers.clone();
        if bodies::exist(particles) {
            halo.extend(&mut numbers);
        }
        let neighbours = Neighbours::find(cell, &places, first.len(), cutoff);
        let gap = |row: usize, other: Neighbour| {
            let pair = Pair { i: row as u32, j: other.row, steps: other.steps };
            pair.separation(cell, &places).length() - (sizes[row] + sizes[other.row as usize])
        };
        let is_other = |row: usize, other: Neighbour| {
            numbers[row] < 0.0 || numbers[row].total_cmp(&numbers[other.row as usize]).is_ne()
        };
        let of_row = |row: usize| {
            let others = neighbours.of(row).iter().filter(|&other| is_other(row, other));
            others.map(|other| gap(row, other)).fold(f64::INFINITY, f64::min)
        };
        let mut found = [least(first.len(), of_row).min(smallest)];
        partition.comm().min(&mut found);
        smallest = found[0];
        // Pairs beyond the cutoff have gaps larger than the margin.
        if smallest <= margin || cutoff >= farthest {
            return smallest;
        }
        margin *= 2.0;
    }
}

#[cfg(test)]
/// Three spheres, two of them near each other across a face of a box of edge 10.
pub(super) fn three() -> Particles {
    let mut particles = Particles::default();
    particles.push(0, Vector::new(1.0, 1.0, 1.0), 1.0, 0);
    particles.push(1, Vector::new(1.0, 9.0, 1.0), 0.5, 0);
    particles.push(2, Vector::new(6.0, 5.0, 5.0), 1.0, 0);
    particles
}

#[cfg(test)]
mod tests {
    use super::*;
    use domain::{Comm, Partition, PeriodicBox};

    #[test]
    fn the_search_ends_for_spheres_of_no_size_to_speak_of() {
        let cell = PeriodicBox::new(Vector::splat(10.0)).unwrap();
        let mut particles = three();
        particles.radii = vec![1.0, f64::from_bits(1), f64::from_bits(1)];
        let partition = Partition::new(&Comm::alone(), [8, 8]);
        let gap = smallest_gap(&particles, DomainView { cell: &cell, partition: &partition });
        assert!((gap - 1.0).abs() < 1e-12, "{gap}");
    }

    /// Spheres with sizes over four decades, on several numbers of ranks, against a search over all pairs and images.
    #[test]
    fn the_smallest_gap_of_any_sizes_is_that_of_all_pairs() {
        let cell = PeriodicBox::sheared(Vector::new(9.0, 10.0, 11.0), 0.3).unwrap();
        for seed in 0..6 {
            let mut all = Particles::default();
            for id in 0..40 {
                let mut random = domain::Random::new(seed, id);
                let place = cell.wrap(random.point() * cell.edges()).0;
                all.push(id, place, 1.2 * 10_f64.powf(-4.0 * random.uniform() * seed as f64 / 5.0), 0);
            }
            let gap = |i: usize, j: usize| {
                let apart = cell.nearest_image(all.positions[j] - all.positions[i]).length();
                apart - all.radii[i] - all.radii[j]
            };
            let pairs = (0..40).flat_map(|i| (0..i).map(move |j| (i, j)));
            let expected = pairs.map(|(i, j)| gap(i, j)).fold(f64::INFINITY, f64::min);
            for ranks in [1, 3] {
                Comm::threads(ranks, |comm| {
                    let partition = Partition::new(&comm, [8, 8]);
                    let mut particles = if comm.is_first() { all.clone() } else { Particles::default() };
                    particles.migrate(&partition, &cell);
                    assert!(
                        (smallest_gap(&particles, DomainView { cell: &cell, partition: &partition }) - expected).abs()
                            < 1e-12
                    );
                });
            }
        }
    }

    #[test]
    fn the_smallest_gap_is_found_near_and_far() {
        let cell = PeriodicBox::new(Vector::splat(10.0)).unwrap();
        for ranks in [1, 3, 13, 64] {
            Comm::threads(ranks, |comm| {
                let partition = Partition::new(&comm, [8, 8]);
                let mut particles = if comm.is_first() { three() } else { Particles::default() };
                particles.migrate(&partition, &cell);
                assert!(
                    (smallest_gap(&particles, DomainView { cell: &cell, partition: &partition }) - 0.5).abs() < 1e-14
                );
                let mut alone = if comm.is_first() { three().selected(&[2]) } else { Particles::default() };
                alone.migrate(&partition, &cell);
                assert!(
                    (smallest_gap(&alone, DomainView { cell: &cell, partition: &partition }) - 8.0).abs() < 1e-14,
                    "to its own image"
                );
            });
        }
    }
}
