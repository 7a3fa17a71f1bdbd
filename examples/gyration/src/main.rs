//! An observable of one's own, written outside of the program: the radius of gyration of each species. Run it by
//! `cargo run -p gyration`.

use domain::{Boundaries, Comm, PeriodicBox, Vector};
use simulation::{Quantity, Simulation};
use std::error::Error;
use suspension::{Model, Observable, ObservedState, Parameters, Species, Start, SuspensionRun};

/// Radius of gyration of the spheres of each species, with positions without periodicity and the mass of a sphere
/// proportional to its volume,
///
/// ```text
/// R = sqrt(sum m (x - c)^2 / sum m),      c = sum m x / sum m
/// ```
struct RadiusOfGyration {
    species: Vec<String>,
}

impl Observable for RadiusOfGyration {
    fn quantity(&self) -> Quantity {
        let table = Some((self.species.clone(), vec!["radius".to_owned()]));
        Quantity { name: "gyration".into(), unit: "length", table }
    }

    fn row(&mut self, present: &mut ObservedState) -> Vec<f64> {
        let (suspension, cell) = (present.suspension(), *present.suspension().cell());
        let particles = suspension.particles();
        // Mass, first and second moments of each species, over this rank's spheres and then over all.
        let mut sums = vec![[0.0; 5]; self.species.len()];
        for (row, &kind) in particles.species.iter().enumerate() {
            let position = particles.positions[row] + cell.lattice(particles.steps[row]);
            let mass = particles.radii[row].powi(3);
            let own = [1.0, position.x, position.y, position.z, position.length_squared()].map(|moment| moment * mass);
            sums[kind as usize].iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
        }
        suspension.comm().sum(sums.as_flattened_mut());
        let radius = |[mass, x, y, z, square]: [f64; 5]| {
            (square / mass - Vector::new(x, y, z).length_squared() / (mass * mass)).max(0.0).sqrt()
        };
        sums.into_iter().map(radius).collect()
    }
}

/// Positions of the corners of a cube around the origin, with edges of a length.
fn cube(edge: f64) -> impl Iterator<Item = Vector> {
    let signs = [-0.5, 0.5];
    signs.into_iter().flat_map(move |x| {
        signs.into_iter().flat_map(move |y| signs.into_iter().map(move |z| Vector::new(x, y, z) * edge))
    })
}

/// A run of a settling cloud in unbounded fluid: light spheres at the corners of a cube, a heavy one above its middle.
fn cloud(comm: &Comm) -> Result<(SuspensionRun, Vec<String>), Box<dyn Error>> {
    let pulled = |name, count, force| Species { force: Vector::Z * force, ..Species::new(name, 1.0, count) };
    let cell = PeriodicBox::new(Vector::splat(20.0))?.with_boundaries(Boundaries::Open)?;
    let start =
        Start::Positions(cube(6.0).chain([Vector::Z * 2.0]).map(|corner| corner + Vector::splat(10.0)).collect());
    let usual = Parameters::new(cell, 1.0, vec![pulled("light", 8, -1.0), pulled("heavy", 1, -4.0)], 0.1, 10);
    let model = Model::new(Parameters { start, ..usual })?;
    let names: Vec<String> = model.species.iter().map(|species| species.name.clone()).collect();
    let mut run = SuspensionRun::start(&model, None, comm)?;
    run.add_observable(Box::new(RadiusOfGyration { species: names.clone() }))?;
    Ok((run, names))
}

fn main() -> Result<(), Box<dyn Error>> {
    let (mut run, names) = cloud(&Comm::alone())?;
    for step in 1..=10 {
        run.advance(step)?;
        let radii = run.observe().pop().unwrap_or_default();
        let each: Vec<String> = names.iter().zip(radii).map(|(name, radius)| format!("{name} {radius:.4}")).collect();
        println!("step {step}: {}", each.join(", "));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The corners of a cube are `sqrt(3)/2` of its edge from its centre, a single sphere has no extent; on any number
    /// of ranks. The quantity is the last of the time series, and its name can't be taken twice.
    #[test]
    fn the_radius_of_a_cube_is_half_its_diagonal() {
        for ranks in [1, 3] {
            let found = Comm::threads(ranks, |comm| {
                let (mut run, species) = cloud(&comm).unwrap();
                let again = run.add_observable(Box::new(RadiusOfGyration { species })).unwrap_err();
                assert!(again.to_string().contains("\"gyration\""));
                let columns = run.quantities().pop().unwrap().columns();
                let first = run.observe().pop().unwrap();
                run.advance(1).unwrap();
                (columns, first, run.observe().pop().unwrap())
            });
            let (columns, first, then) = &found[0];
            assert_eq!(columns, &["gyration_radius[light]", "gyration_radius[heavy]"]);
            assert!((first[0] - 3.0_f64.sqrt() * 3.0).abs() < 1e-12 && first[1] < 1e-6, "{first:?}");
            assert!((then[0] - first[0]).abs() > 1e-6, "the heavy sphere drags the light ones along");
        }
    }
}
