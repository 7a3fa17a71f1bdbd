//! Distribution of the spheres across a channel or above a wall, and their flux along it.

use super::observable::{Observable, measure};
use crate::columns::VELOCITY;
use crate::model::box_axes::UserAxes;
use crate::sampling::column;
use crate::suspension::Suspension;
use domain::{Boundaries, Comm, Particles, PeriodicBox, Vector, sphere};
use simulation::Quantity;

/// Columns of the time series for the height of each species.
const HEIGHT: [&str; 2] = ["mean", "deviation"];

/// Whether heights are defined: in a box that is periodic along x and y but not along z.
pub fn has_height(boundaries: Boundaries) -> bool {
    !matches!(boundaries, Boundaries::Periodic | Boundaries::Open)
}

/// The quantities of the time series: heights, and between two walls the flux and the migration.
pub fn heights(boundaries: Boundaries, species: &[String], axes: &UserAxes) -> Vec<Box<dyn Observable>> {
    let table = |name: &'static str, unit, columns: &[&str]| {
        let columns = columns.iter().map(|&column| column.to_owned()).collect();
        Quantity { name: name.into(), unit, table: Some((species.to_vec(), columns)) }
    };
    let [along, across] = [0, 2].map(|axis| axes.name(axis).to_string());
    let mut all = Vec::new();
    if has_height(boundaries) {
        let height = table("height", "length", &HEIGHT);
        all.push(measure(height, |present| present.heights().moments.as_flattened().to_vec()));
    }
    if boundaries == Boundaries::Walls {
        let flux = table("particle_flux", "length/time", &[along.as_str()]);
        all.push(measure(flux, |present| present.heights().flux.clone()));
        let migration = table("migration", "", &[across.as_str()]);
        all.push(measure(migration, |present| present.heights().migration.clone()));
    }
    all
}

/// Numbers for each species: with `z` the heights of its `n` spheres of radii `a`, `V` the volume of the box and `H`
/// the distance of the walls,
///
/// ```text
/// mean = <z>,      deviation = sqrt(<(z - <z>)^2>)
/// flux = sum 4/3 pi a^3 v_x / V,      migration = sum (z - H/2)^2 / sum (H - 2 a)^2 / 12
/// ```
///
/// The flux is the volume of spheres that crosses a cross-section per area and time. The migration is 1 if the centres
/// are distributed uniformly between the walls, and 0 if all are in the middle.
pub struct Heights {
    /// Mean and deviation.
    moments: Vec<[f64; 2]>,
    flux: Vec<f64>,
    migration: Vec<f64>,
}

impl Heights {
    /// The numbers of a suspension of a number of species. Collective.
    pub fn of(suspension: &Suspension, species: usize) -> Self {
        let particles = suspension.particles();
        Self::of_particles(particles, column(particles, VELOCITY), suspension.cell(), species, suspension.comm())
    }

    fn of_particles(
        particles: &Particles,
        velocities: &[Vector],
        cell: &PeriodicBox,
        species: usize,
        comm: &Comm,
    ) -> Self {
        let (volume, height) = (cell.volume(), cell.edges().z);
        let numbers = |n: usize| {
            let (z, a) = (particles.positions[n].z, particles.radii[n]);
            let flux = sphere::volume(a) * velocities[n].x / volume;
            [1.0, z, flux, (z - 0.5 * height).powi(2), (height - 2.0 * a).powi(2) / 12.0]
        };
        let sums = sums(particles, species, comm, |n, _| numbers(n));
        let mean = |of: usize| sums[of][1] / sums[of][0];
        let squares = self::sums(particles, species, comm, |n, of| [(particles.positions[n].z - mean(of)).powi(2)]);
        let deviation = |of: usize| (squares[of][0] / sums[of][0]).sqrt();
        Self {
            moments: (0..species).map(|of| [mean(of), deviation(of)]).collect(),
            flux: sums.iter().map(|sum| sum[2]).collect(),
            migration: sums.iter().map(|sum| sum[3] / sum[4]).collect(),
        }
    }
}

/// Sums over the spheres of each species. Collective.
fn sums<const K: usize>(
    particles: &Particles,
    species: usize,
    comm: &Comm,
    of: impl Fn(usize, usize) -> [f64; K],
) -> Vec<[f64; K]> {
    let mut sums = vec![[0.0; K]; species];
    for (n, &kind) in particles.species.iter().enumerate() {
        let numbers = of(n, kind as usize);
        sums[kind as usize].iter_mut().zip(numbers).for_each(|(sum, number)| *sum += number);
    }
    comm.sum(sums.as_flattened_mut());
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Parameters;

    fn row(boundaries: Boundaries, ranks: usize) -> [Vec<f64>; 3] {
        let cell = PeriodicBox::new(Vector::new(4.0, 5.0, 10.0)).unwrap().with_boundaries(boundaries).unwrap();
        let spheres = [(2.0, 1.0, 0, 3.0), (8.0, 1.0, 0, 1.0), (5.0, 2.0, 1, -1.0), (6.0, 2.0, 1, 0.0)];
        let found = Comm::threads(ranks, |comm| {
            let mut particles = Particles::default();
            let own = spheres.iter().enumerate().filter(|(id, _)| id % ranks == comm.rank());
            let velocities: Vec<Vector> = own.clone().map(|(_, sphere)| Vector::X * sphere.3).collect();
            own.for_each(|(id, &(z, a, kind, _))| particles.push(id as u64, Vector::Z * z, a, kind));
            let found = Heights::of_particles(&particles, &velocities, &cell, 2, &comm);
            [found.moments.into_flattened(), found.flux, found.migration]
        });
        found[0].clone()
    }

    /// Spheres at known heights, on several numbers of ranks.
    #[test]
    fn rows_are_those_of_known_spheres() {
        let unit = 4.0 / 3.0 * std::f64::consts::PI / 200.0;
        for ranks in [1, 3, 7] {
            let [heights, flux, migration] = &row(Boundaries::Walls, ranks);
            assert_eq!(heights, &[5.0, 3.0, 5.5, 0.5]);
            // 9 over 64 / 12, and 1/2 over 36 / 12.
            let expected = [4.0 * unit, -8.0 * unit, 27.0 / 16.0, 1.0 / 6.0];
            let found = flux.iter().chain(migration).zip(expected);
            assert!(found.clone().all(|(a, b)| (a - b).abs() < 1e-14), "{flux:?} {migration:?}");
            assert_eq!(&row(Boundaries::Wall, ranks)[0], heights);
        }
        let quantities = |boundaries| {
            let cell = PeriodicBox::new(Vector::ONE).unwrap();
            let axes = Parameters::new(cell, 1.0, Vec::new(), 1.0, 1).user_axes();
            heights(boundaries, &["one".to_owned()], &axes).len()
        };
        assert_eq!([Boundaries::Walls, Boundaries::Wall, Boundaries::Periodic].map(quantities), [3, 1, 0]);
    }
}
