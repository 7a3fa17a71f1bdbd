//! Memory bandwidth of this machine.

use domain::parallel::Machine;
use std::hint::black_box;
use std::num::NonZero;
use std::thread;
use std::time::Instant;

/// Numbers in each of the three arrays of a thread: more than caches hold.
const NUMBERS: usize = 1 << 23;

/// Number of passes, of which the fastest counts.
const PASSES: usize = 4;

/// Seconds by which a parallel loop is longer for each doubling of its threads: 8 microseconds on 16.
const WAKE_UP: f64 = 2e-6;

/// Measures the bandwidth of one thread and of all cores by the triad `a = b + s c` of the benchmark STREAM.
pub fn measured_machine() -> Machine {
    let cores = thread::available_parallelism().map_or(1, NonZero::get);
    Machine { cores, bandwidth_of_one: triad(1), bandwidth: triad(cores), wake_up: WAKE_UP }
}

/// Bytes a second of a number of threads together.
fn triad(threads: usize) -> f64 {
    let bytes = (3 * NUMBERS * size_of::<f64>()) as f64;
    let slowest = thread::scope(|scope| {
        let started: Vec<_> = (0..threads).map(|_| scope.spawn(seconds)).collect();
        started.into_iter().map(|thread| thread.join().unwrap_or(f64::NAN)).fold(0.0, f64::max)
    });
    threads as f64 * bytes / slowest
}

/// Seconds of the fastest pass.
fn seconds() -> f64 {
    let (mut a, b, c) = (vec![0.0; NUMBERS], vec![1.0; NUMBERS], vec![2.0; NUMBERS]);
    let pass = |_| {
        let start = Instant::now();
        for ((a, b), c) in a.iter_mut().zip(&b).zip(&c) {
            *a = b + 3.0 * c;
        }
        black_box(&mut a);
        start.elapsed().as_secs_f64()
    };
    (0..PASSES).map(pass).fold(f64::INFINITY, f64::min)
}
