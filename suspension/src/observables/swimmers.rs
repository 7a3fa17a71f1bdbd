//! Speed of swimmers along their axes, and clusters.

use super::observable::{NumberRow, Observable, measure, numbers};
use crate::model::Model;
use crate::neighbourhood::NearParticles;
use crate::rotation;
use crate::suspension::Suspension;
use domain::Pair;
use simulation::Quantity;

/// Largest gap of spheres in one cluster, over their mean radius.
const CLOSE: f64 = 0.1;

/// Quantities of clusters.
const CLUSTERS: [NumberRow; 2] = [
    ("close_neighbours", "", |present| present.clusters().neighbours),
    ("largest_cluster", "", |present| present.clusters().largest),
];

/// Quantities of a model with swimmers; none without.
pub fn swimmers(model: &Model) -> Vec<Box<dyn Observable>> {
    if model.has_swimmers() { std::iter::once(speeds(model)).chain(numbers(&CLUSTERS)).collect() } else { Vec::new() }
}

/// Mean velocity along the own axis, relative to the background flow, `<(U - u_inf(x)) . p>`, of each species that
/// swims.
fn speeds(model: &Model) -> Box<dyn Observable> {
    let swimming: Vec<usize> =
        (0..model.species.len()).filter(|&index| model.species[index].swimming.is_some()).collect();
    let names = swimming.iter().map(|&index| model.species[index].name.clone()).collect();
    let table = Some((names, vec!["speed".to_owned()]));
    let species = model.species.len();
    measure(Quantity { name: "swimming".into(), unit: "length/time", table }, move |present| {
        let means = along_axes(present.suspension(), species);
        swimming.iter().map(|&index| means[index]).collect()
    })
}

/// Mean velocities along the axes, relative to the background flow, of all species with orientations. Collective.
fn along_axes(suspension: &Suspension, species: usize) -> Vec<f64> {
    let particles = suspension.particles();
    let (velocities, orientations) = (suspension.velocities_in_flow(), rotation::known(particles));
    let mut sums = vec![[0.0; 2]; species];
    for (row, orientation) in orientations.iter().enumerate().filter(|(_, orientation)| orientation.is_some()) {
        let sum = &mut sums[particles.species[row] as usize];
        *sum = [sum[0] + velocities[row].dot(orientation.axis()), sum[1] + 1.0];
    }
    suspension.comm().sum(sums.as_flattened_mut());
    sums.into_iter().map(|[sum, count]| sum / count).collect()
}

/// Spheres that are close to each other, with gaps below a tenth of their mean radius.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clusters {
    /// Mean number of spheres close to a sphere.
    neighbours: f64,
    /// Fraction of the spheres in the largest cluster, in which each is close to another.
    largest: f64,
}

impl Clusters {
    /// The clusters of a suspension. Collective.
    pub fn of(suspension: &Suspension) -> Self {
        let comm = suspension.comm();
        let radii = &suspension.particles().radii;
        let (mut largest, mut count) = ([radii.iter().copied().fold(0.0, f64::max)], [radii.len() as f64]);
        comm.max(&mut largest);
        comm.sum(&mut count);
        let pairs = comm.gather(&close_pairs(suspension, largest[0]));
        let mut numbers = vec![pairs.len() as f64 / count[0], largest_cluster(&pairs) as f64 / count[0]];
        comm.broadcast(&mut numbers);
        Self { neighbours: numbers[0], largest: numbers[1] }
    }
}

/// Ids of the close pairs of each of this rank's spheres. Collective.
fn close_pairs(suspension: &Suspension, largest_radius: f64) -> Vec<[u64; 2]> {
    let particles = suspension.particles();
    let range = (2.0 + CLOSE) * largest_radius;
    let NearParticles { present, neighbours } = suspension.near(range);
    let (positions, radii, ids) = (present.positions(), present.radii(), present.ids());
    let is_close = |pair: &Pair| {
        let reach = (1.0 + 0.5 * CLOSE) * (radii[pair.i as usize] + radii[pair.j as usize]);
        pair.separation(suspension.cell(), positions).length() < reach
    };
    let of_row = |row: usize| {
        neighbours.of(row).iter().map(move |other| Pair { i: row as u32, j: other.row, steps: other.steps })
    };
    (0..particles.len())
        .flat_map(of_row)
        .filter(is_close)
        .map(|pair| [ids[pair.i as usize], ids[pair.j as usize]])
        .collect()
}

/// Number of the spheres of the largest cluster that pairs of ids connect, each pair once or twice; 1 without pairs.
fn largest_cluster(pairs: &[[u64; 2]]) -> usize {
    let mut ids: Vec<u64> = pairs.as_flattened().to_vec();
    ids.sort_unstable();
    ids.dedup();
    let place = |id: u64| ids.binary_search(&id).expect("an id of the list");
    let mut parents: Vec<usize> = (0..ids.len()).collect();
    for &[a, b] in pairs {
        let [a, b] = [a, b].map(|id| root(&mut parents, place(id)));
        parents[a.max(b)] = a.min(b);
    }
    let mut sizes = vec![0; ids.len()];
    (0..ids.len()).for_each(|place| sizes[root(&mut parents, place)] += 1);
    sizes.into_iter().max().unwrap_or(1)
}

/// The root of a place in a forest, to which the path is shortened.
fn root(parents: &mut [usize], mut place: usize) -> usize {
    while parents[place] != place {
        parents[place] = parents[parents[place]];
        place = parents[place];
    }
    place
}

#[cfg(test)]
mod tests {
    use super::*;
    use domain::Random;

    #[test]
    fn clusters_of_known_pairs() {
        assert_eq!(largest_cluster(&[]), 1);
        assert_eq!(largest_cluster(&[[3, 9], [9, 3]]), 2);
        assert_eq!(largest_cluster(&[[3, 9], [7, 5], [1, 7], [4, 1]]), 4);
    }

    /// A chain of all ids is one cluster in whatever order its links are listed.
    #[test]
    fn a_shuffled_chain_is_one_cluster() {
        let mut links: Vec<[u64; 2]> = (0..200).map(|id| [id * 7, id * 7 + 7]).collect();
        for seed in 0..5 {
            Random::new(seed, 0).shuffle(&mut links);
            assert_eq!(largest_cluster(&links), 201);
            assert_eq!(largest_cluster(&links[..1]), 2);
        }
    }
}
