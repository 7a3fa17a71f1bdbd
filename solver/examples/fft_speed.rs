//! Speed of the transforms: prints one JSON line per case.
//!
//! `fft_speed [--rustfft] [--seconds S] [--threads N,N] SIZE...` with `S` seconds per case (default 1) on cubes of
//! `SIZE` points (default 48 to 192). `solve` is a full solve from force density to velocity: three components
//! forward, times the Stokes operator, and backward; `transform` is forward and backward of one component, a third of
//! the time for three. With `--rustfft` rows of any length are transformed by rustfft, on the same pencils and
//! threads. Times are medians. All values are zeros, which take the same time as others and neither grow nor
//! underflow.

use domain::{Comm, Partition, PeriodicBox, Vector};
use solver::{Grid, Real, Stokes, Transform};
use std::time::{Duration, Instant};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (mut seconds, mut threads, mut sizes, mut rustfft) = (1.0, vec![1, 2], Vec::new(), false);
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().ok_or(format!("{argument} needs a value"));
        match argument.as_str() {
            "--rustfft" => rustfft = true,
            "--seconds" => seconds = value()?.parse()?,
            "--threads" => threads = value()?.split(',').map(str::parse).collect::<Result<_, _>>()?,
            size => sizes.push(size.parse()?),
        }
    }
    if sizes.is_empty() {
        sizes = vec![48, 64, 96, 128, 144, 192];
    }
    for &threads in &threads {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
        for &size in &sizes {
            pool.install(|| case::<f64>(size, "f64", seconds, rustfft))?;
            pool.install(|| case::<f32>(size, "f32", seconds, rustfft))?;
        }
    }
    Ok(())
}

fn case<T: Real>(size: usize, precision: &str, seconds: f64, rustfft: bool) -> Result<(), solver::GridError> {
    let cell = PeriodicBox::new(Vector::ONE).expect("a cube of side 1");
    let grid = Grid::new([size; 3], cell)?;
    let partition = Partition::new(&Comm::alone(), grid.lines());
    let plan = if rustfft { Transform::<T>::by_rustfft } else { Transform::<T>::new };
    let mut transform = plan(grid.points(), &partition, 8);
    let operator = Stokes::new(&grid, 1.0);
    let mut field = transform.field();
    let solve = median(seconds, || transform.apply(&mut field, &operator));
    let mut kept = Some(field);
    let both = median(seconds, || {
        let mut field = kept.take().expect("it was put back");
        field.clear_halo();
        let spectrum = transform.forward(field);
        kept = Some(transform.backward(spectrum));
    });
    let threads = rayon::current_num_threads();
    println!(
        "{{\"program\": \"fft_speed\", \"rustfft\": {rustfft}, \"size\": {size}, \"precision\": \"{precision}\", \
         \"threads\": {threads}, \"solve_ms\": {:.3}, \"transform_ms\": {:.3}}}",
        1e3 * solve,
        1e3 * both / 3.0
    );
    Ok(())
}

/// Median time of repeated runs, in seconds.
fn median(seconds: f64, mut run: impl FnMut()) -> f64 {
    run();
    let (start, mut times) = (Instant::now(), Vec::new());
    while times.len() < 3 || start.elapsed() < Duration::from_secs_f64(seconds) {
        let begin = Instant::now();
        run();
        times.push(begin.elapsed().as_secs_f64());
    }
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}
