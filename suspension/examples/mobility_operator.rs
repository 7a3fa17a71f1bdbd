//! The mobility of spheres as a linear operator: the largest eigenvalue of forces to velocities, by power iteration.
//!
//!     cargo run --release -p fcm-solve-suspension --example mobility_operator
//!
//! Units: the radius and the viscosity are 1.

use domain::{Bytes, Comm, PeriodicBox, Vector, random_packing};
use fcm::Loads;
use solver::BackgroundFlow;
use std::error::Error;
use suspension::{Mobility, MobilityParameters};

const COUNT: usize = 200;

fn main() -> Result<(), Box<dyn Error>> {
    let cell = PeriodicBox::new(Vector::splat(20.0))?;
    let radii = vec![1.0; COUNT];
    let positions = random_packing(&cell, &radii, 0.1, 1)?;
    let mut mobility = mobility(cell, radii)?;
    mobility.place(&positions)?;
    println!("{}", mobility.plan().describe());

    // Any non-uniform forces will do: uniform ones move nothing, since the mean velocity of the fluid is zero.
    let mut forces: Vec<Vector> = (0..COUNT).map(|i| Vector::new(0.0, 0.0, (i as f64).sin())).collect();
    for iteration in 1..=50 {
        let length = norm(&forces);
        for force in &mut forces {
            *force /= length;
        }
        let motions = mobility.apply(&Loads { forces, ..Loads::default() }, &BackgroundFlow::NONE)?;
        forces = motions.motion.velocities;
        if iteration % 10 == 0 {
            println!("after {iteration} iterations: largest eigenvalue at least {:.8}", norm(&forces));
        }
    }
    Ok(())
}

fn mobility(cell: PeriodicBox, radii: Vec<f64>) -> Result<Mobility, Box<dyn Error>> {
    let parameters = MobilityParameters { tolerance: 1e-6, ..MobilityParameters::new(cell, 1.0, radii) };
    Ok(Mobility::new(parameters, Bytes::default(), &Comm::alone())?)
}

fn norm(vectors: &[Vector]) -> f64 {
    vectors.iter().map(|v| v.length_squared()).sum::<f64>().sqrt()
}
