//! Times a random start of equal spheres on all ranks: `cargo run --release -p fcm-solve-domain --example
//! random_start -- COUNT FRACTION`, with `--features mpi` under `mpirun`.

use domain::{Comm, Partition, PeriodicBox, Vector, shared_random_packing};
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let mut next = || arguments.next().ok_or("usage: random_start COUNT FRACTION");
    let (count, fraction): (usize, f64) = (next()?.parse()?, next()?.parse()?);
    let comm = Comm::world()?;
    let edge = (count as f64 * 4.0 / 3.0 * std::f64::consts::PI / fraction).cbrt();
    let cell = PeriodicBox::new(Vector::splat(edge))?;
    let partition = Partition::new(&comm, [edge as usize; 2]);
    comm.barrier();
    let began = Instant::now();
    let own = shared_random_packing(&cell, &[(1.0, count)], 0.02, 1, &partition)?.ok_or("too dense to be shared")?;
    let mut placed = [own.len() as f64];
    comm.sum(&mut placed);
    if comm.is_first() {
        println!("{{\"spheres\": {}, \"seconds\": {:.3}}}", placed[0], began.elapsed().as_secs_f64());
    }
    Ok(())
}
