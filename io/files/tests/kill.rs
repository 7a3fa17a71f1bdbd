//! A trajectory can be read after the program that writes it was killed.

#![allow(clippy::float_cmp, reason = "what was written is read, to the bit")]

use domain::{Particles, PeriodicBox, Vector};
use files::{Provenance, Trajectory};
use simulation::Frame;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

const PARTICLES: usize = 50;

fn frame(step: u64) -> Frame {
    let mut particles = Particles::default();
    for id in 0..PARTICLES as u64 {
        particles.push(id, Vector::splat(step as f64), 1.0, 0);
    }
    particles.steps.fill([step as i32; 3]);
    particles.vectors("velocity").fill(Vector::splat(step as f64));
    Frame { particles, cell: PeriodicBox::new(Vector::ONE).unwrap(), periodic: [true; 3] }
}

/// Writes frames until it is killed, when it runs as the child process of the test below.
#[test]
fn writer_to_be_killed() {
    let Some(path) = std::env::var_os("TRAJECTORY_TO_WRITE") else { return };
    let path = Path::new(&path);
    let provenance =
        Provenance { scene: String::new(), program: "test 1".into(), plan: String::new(), ranks: 1, seed: 0 };
    let mut trajectory = Trajectory::create(path, &provenance, &frame(0), 1_000_000).unwrap();
    std::fs::write(path.with_extension("ready"), "").unwrap();
    for step in 0.. {
        trajectory.append((step, 0.5 * step as f64), &frame(step)).unwrap();
    }
}

/// Reads a trajectory like any reader, and returns its steps; the frames must be complete.
fn steps_of(path: &Path) -> Vec<u64> {
    let file = hdf5::File::open(path).unwrap();
    let reals = |name: &str| file.dataset(&format!("particles/all/{name}")).unwrap().read_raw::<f64>().unwrap();
    let (positions, velocities, times) = (reals("position/value"), reals("velocity/value"), reals("image/time"));
    let images: Vec<i32> = file.dataset("particles/all/image/value").unwrap().read_raw().unwrap();
    let steps: Vec<u64> = file.dataset("particles/all/position/step").unwrap().read_raw().unwrap();
    for (frame, &step) in steps.iter().enumerate() {
        let numbers = 3 * PARTICLES * frame..3 * PARTICLES * (frame + 1);
        assert!(positions[numbers.clone()].iter().chain(&velocities[numbers.clone()]).all(|&x| x == step as f64));
        assert!(images[numbers].iter().all(|&x| x == step as i32));
        assert_eq!(times[frame], 0.5 * step as f64);
    }
    steps
}

#[test]
fn a_writer_killed_at_any_moment_leaves_whole_frames() {
    let folder = tempfile::tempdir().unwrap();
    let mut most = 0;
    for attempt in 0..50 {
        let path = folder.path().join(format!("{attempt}.h5"));
        let mut child = Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "kill::writer_to_be_killed"])
            .env("TRAJECTORY_TO_WRITE", &path)
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        while !path.with_extension("ready").exists() {
            std::thread::yield_now();
        }
        // Each attempt sleeps for a different time, so that the kill occurs at a different point of writing a frame.
        std::thread::sleep(Duration::from_micros(731 * attempt));
        child.kill().unwrap();
        child.wait().unwrap();
        let steps = steps_of(&path);
        assert_eq!(steps, (0..steps.len() as u64).collect::<Vec<_>>());
        most = most.max(steps.len());
        std::fs::remove_file(&path).unwrap();
    }
    assert!(most > 20, "the writer was at work: {most} frames");
}
