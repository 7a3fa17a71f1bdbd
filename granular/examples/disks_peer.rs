//! Compares the disks with LAMMPS: writes a start for both, times a run, and measures the distance between two runs.
//! See `scripts/peers/disks_lammps.sh`.
//!
//!     disks_peer start SEED START.data
//!     disks_peer run START.data VISCOSITY TIME_STEP STEPS EVERY OUT.dump
//!     disks_peer compare ONE.dump OTHER.dump
//!     disks_peer speed EDGE STEPS

use domain::{Particles, Vector};
use granular::disks::{DiskModel, DiskParameters, Disks};
use std::error::Error;
use std::fmt::Write as _;
use std::fs;
use std::time::Instant;

type ExampleResult = Result<(), Box<dyn Error>>;
/// Step and positions of a frame.
type PositionsAtStep = (u64, Vec<Vector>);

fn main() -> ExampleResult {
    let words: Vec<String> = std::env::args().skip(1).collect();
    match words.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["start", seed, file] => start(seed.parse()?, file),
        ["run", file, viscosity, dt, steps, every, out] => {
            let parameters =
                DiskParameters { viscosity: viscosity.parse()?, time_step: dt.parse()?, ..DiskParameters::default() };
            run(parameters, file, [steps.parse()?, every.parse()?], out)
        }
        ["compare", one, other] => compare(one, other),
        ["speed", edge, steps] => speed(edge.parse()?, steps.parse()?),
        _ => Err("disks_peer start | run | compare | speed, see the head of its source".into()),
    }
}

/// Writes a prepared system in LAMMPS's `read_data` format, with the origin at the centre.
fn start(seed: u64, file: &str) -> ExampleResult {
    let model = DiskModel::new(DiskParameters { seed, ..DiskParameters::default() })?;
    let (particles, _) = Disks::prepared(&model)?.store();
    let mut text = format!("disks, seed {seed}\n\n{} atoms\n2 atom types\n\n", particles.len());
    text += "-50 50 xlo xhi\n-50 50 ylo yhi\n-0.5 0.5 zlo zhi\n0 0 0 xy xz yz\n\nAtoms # sphere\n\n";
    for row in 0..particles.len() {
        let (p, species) = (particles.positions[row] - Vector::new(50.0, 50.0, 0.0), particles.species[row] + 1);
        let (id, diameter) = (particles.ids[row] + 1, 2.0 * particles.radii[row]);
        writeln!(text, "{id} {species} {diameter} 1.0 {} {} 0", p.x, p.y)?;
    }
    Ok(fs::write(file, text)?)
}

fn run(parameters: DiskParameters, file: &str, [steps, every]: [u64; 2], out: &str) -> ExampleResult {
    let mut disks = Disks::flowing(parameters, &read_data(file)?)?;
    let mut text = String::new();
    let mut spent = 0.0;
    write_frame(&mut text, &disks)?;
    while disks.clock().step() < steps {
        let before = cpu_seconds()?;
        disks.advance(every.min(steps - disks.clock().step()));
        spent += cpu_seconds()? - before;
        write_frame(&mut text, &disks)?;
    }
    let count = disks.model().sizes().len() as f64;
    println!("{:.3e} particle-steps per CPU-second", count * steps as f64 / spent);
    println!("energy balance closes to {:.1e}", disks.tally().imbalance());
    Ok(fs::write(out, text)?)
}

fn read_data(file: &str) -> Result<Particles, Box<dyn Error>> {
    let text = fs::read_to_string(file)?;
    let (_, rows) = text.split_once("Atoms").ok_or("no section Atoms")?;
    let mut particles = Particles::default();
    for line in rows.lines().skip(1).filter(|l| !l.is_empty()) {
        let n: Vec<f64> = line.split_whitespace().map(str::parse).collect::<Result<_, _>>()?;
        let place = Vector::new((n[4] + 50.0).rem_euclid(100.0), (n[5] + 50.0).rem_euclid(100.0), 0.0);
        particles.push(n[0] as u64, place, 0.5 * n[2], n[1] as u32 - 1);
    }
    Ok(particles)
}

/// Writes a frame in LAMMPS's dump format: id, type, radius, x, y, vx, vy.
fn write_frame(text: &mut String, disks: &Disks) -> ExampleResult {
    let (particles, _) = disks.store();
    writeln!(text, "ITEM: TIMESTEP\n{}\nITEM: NUMBER OF ATOMS\n{}", disks.clock().step(), particles.len())?;
    writeln!(text, "ITEM: ATOMS id type radius x y vx vy")?;
    let velocities = &particles.columns[0].values;
    for row in 0..particles.len() {
        let p = particles.positions[row] - Vector::new(50.0, 50.0, 0.0);
        let (id, species, r) = (particles.ids[row], particles.species[row] + 1, particles.radii[row]);
        let (vx, vy) = (velocities[3 * row], velocities[3 * row + 1]);
        writeln!(text, "{id} {species} {r} {} {} {vx} {vy}", p.x, p.y)?;
    }
    Ok(())
}

/// Positions in each frame of a dump, by step, in the order of the ids.
fn frames(file: &str) -> Result<Vec<PositionsAtStep>, Box<dyn Error>> {
    let text = fs::read_to_string(file)?;
    let mut all = Vec::new();
    for frame in text.split("ITEM: TIMESTEP").skip(1) {
        let (head, rows) = frame.split_once("ITEM: ATOMS").ok_or("a frame without atoms")?;
        let step = head.split_whitespace().next().ok_or("a frame without a step")?.parse()?;
        let mut places = Vec::new();
        for row in rows.lines().skip(1) {
            let n: Vec<f64> = row.split_whitespace().map(str::parse).collect::<Result<_, _>>()?;
            places.push((n[0] as u64, Vector::new(n[3], n[4], 0.0)));
        }
        places.sort_by_key(|p| p.0);
        all.push((step, places.into_iter().map(|p| p.1).collect()));
    }
    Ok(all)
}

/// Prints the distances of the disks in frames of the same step: median, 95 % and largest. The nearest image is
/// chosen along x and y independently: where the offset of the rows is not a whole number of cells, a disk that only
/// one of the two runs has wrapped upward shows a large distance.
fn compare(one: &str, other: &str) -> ExampleResult {
    let others = frames(other)?;
    for (step, places) in frames(one)? {
        let Some((_, theirs)) = others.iter().find(|f| f.0 == step) else { continue };
        let near = |d: f64| d - 100.0 * (d / 100.0).round();
        let apart = |(a, b): (&Vector, &Vector)| near(a.y - b.y).hypot(near(a.x - b.x));
        let mut far: Vec<f64> = places.iter().zip(theirs).map(apart).collect();
        far.sort_by(f64::total_cmp);
        let at = |fraction: f64| far[(fraction * (far.len() - 1) as f64) as usize];
        println!("step {step}: median {:.2e}, 95 % {:.2e}, largest {:.2e}", at(0.5), at(0.95), at(1.0));
    }
    Ok(())
}

/// Prints the speed for the paper's mixture in a square cell, by processor time and by wall-clock time.
fn speed(edge: f64, steps: u64) -> ExampleResult {
    let mut parameters = DiskParameters { edges: [edge; 2], ..DiskParameters::default() };
    parameters.preparation.mixed = parameters.preparation.settled;
    let mut disks = Disks::prepared(&DiskModel::new(parameters)?)?;
    disks.advance(steps);
    let (cpu, clock) = (cpu_seconds()?, Instant::now());
    disks.advance(steps);
    let work = disks.model().sizes().len() as f64 * steps as f64;
    let (by_cpu, by_clock) = (work / (cpu_seconds()? - cpu), work / clock.elapsed().as_secs_f64());
    println!(
        "{} disks: {by_cpu:.3e} particle-steps per CPU-second, {by_clock:.3e} per second",
        disks.model().sizes().len()
    );
    Ok(())
}

/// Processor time of all threads so far.
fn cpu_seconds() -> Result<f64, Box<dyn Error>> {
    let mut nanoseconds = 0.0;
    for task in fs::read_dir("/proc/self/task")? {
        let text = fs::read_to_string(task?.path().join("schedstat"))?;
        nanoseconds += text.split_whitespace().next().ok_or("an empty schedstat")?.parse::<f64>()?;
    }
    Ok(nanoseconds * 1e-9)
}
