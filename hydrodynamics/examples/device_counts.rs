//! Counts what a card does in a solve with lubrication, by an emulator that runs its kernels: copies, launches, and
//! the memory that kernels read and write. A sector of 32 bytes counts once in a run of a kernel; transforms are left
//! out.
//!
//!     cargo run --package fcm-solve-hydrodynamics --example device_counts

use domain::{Boundaries, Comm, Particles, Partition, PeriodicBox, Traceless, Vector, random_packing};
use fcm::{
    Costs, Fixed, Loading, Loads, Method, Mobility, Multipoles, Output, Plan, Precision, Problem, StressletSolver,
};
use gpu::{Counted, DeviceCounts, Emulator};
use hydrodynamics::{CoupledSolver, Guess, ShortRange, SolveInput, StrainRate};
use lubrication::LubricationRange;
use std::collections::BTreeMap;
use std::error::Error;
use std::f64::consts::PI;

/// Number of spheres, volume fraction, strain of the box, and tolerance.
const SPHERES: usize = 128;
const FRACTION: f64 = 0.4;
const STRAIN: f64 = 0.3;
const TOLERANCE: f64 = 1e-2;

/// Kernels by what they are for: the beginnings of their names.
const GROUPS: [(&str, &[&str]); 5] = [
    ("order and lists of spheres", &["bin_", "scan_", "scatter_", "order_", "find_neighbours"]),
    ("assembly of near pairs", &["find_near_", "assemble_", "invert_", "moments_"]),
    ("far field", &["gather_loads", "spread_", "transform", "solve_", "interpolate_", "pair_motions"]),
    ("near pairs, and preconditioner", &["row_loads", "_pairs", "remainder_"]),
    ("vectors and sums", &["combine_", "sum_", "step_all", "measure_", "start_", "gather_all", "coupled_"]),
];

/// Spheres of two sizes in a sheared box.
fn suspension() -> Result<(PeriodicBox, Particles), Box<dyn Error>> {
    let radii: Vec<f64> = (0..SPHERES).map(|i| if i % 2 == 0 { 1.0 } else { 1.4 }).collect();
    let volume: f64 = radii.iter().map(|a| 4.0 / 3.0 * PI * a.powi(3)).sum();
    let cell = PeriodicBox::sheared(Vector::splat((volume / FRACTION).cbrt()), STRAIN)?;
    let positions = random_packing(&cell, &radii, 0.0, 1)?;
    let mut particles = Particles::default();
    for (id, (&position, &radius)) in positions.iter().zip(&radii).enumerate() {
        particles.push(id as u64, position, radius, 0);
    }
    particles.wrap(&cell);
    Ok((cell, particles))
}

fn plan(cell: &PeriodicBox) -> Result<Plan, Box<dyn Error>> {
    let (precision, method) = (Some(Precision::Single), Some(Method::Split));
    Ok(Plan::choose(&Problem {
        edges: cell.edges(),
        boundaries: Boundaries::Periodic,
        volume: cell.volume(),
        shortest_vector: cell.edges().x,
        smallest_edge_ratio: 1.0,
        largest_strain: STRAIN,
        largest_tilts: [0.0; 2],
        radii: vec![(1.0, SPHERES / 2), (1.4, SPHERES / 2)],
        viscosity: 1.0,
        multipoles: Multipoles::Dipole,
        rigid: true,
        lubricated: true,
        loading: Loading::Varied,
        tolerance: TOLERANCE,
        threads: 1,
        ranks: 1,
        costs: Costs::default(),
        network: None,
        fixed: Fixed { precision, method, ..Fixed::default() },
    })?)
}

/// Counts of all that came after others.
fn since(before: &DeviceCounts, after: &DeviceCounts) -> DeviceCounts {
    let less = |a: [u64; 2], b: [u64; 2]| std::array::from_fn(|k| a[k] - b[k]);
    let sums = |before: &BTreeMap<String, u64>, after: &BTreeMap<String, u64>| {
        let one = |(name, sum): (&String, &u64)| (name.clone(), sum - before.get(name).copied().unwrap_or(0));
        after.iter().map(one).collect::<BTreeMap<_, _>>()
    };
    DeviceCounts {
        runs: sums(&before.runs, &after.runs),
        moved: sums(&before.moved, &after.moved),
        launches: after.launches - before.launches,
        replays: after.replays - before.replays,
        uploads: less(after.uploads, before.uploads),
        downloads: less(after.downloads, before.downloads),
        memory: after.memory,
    }
}

fn print(counts: &DeviceCounts) {
    let each = |bytes: u64| (bytes as f64 / SPHERES as f64).round();
    println!("  commands from the host                 {:>6}", counts.launches);
    println!("  of these, replays of recordings        {:>6}", counts.replays);
    for (group, names) in GROUPS {
        let is_of = |kernel: &String| names.iter().any(|name| kernel.starts_with(name) || kernel.ends_with(name));
        let of_group = |sums: &BTreeMap<String, u64>| {
            sums.iter().filter(|(kernel, _)| is_of(kernel)).map(|(_, sum)| sum).sum::<u64>()
        };
        let (runs, moved) = (of_group(&counts.runs), each(of_group(&counts.moved)));
        if runs > 0 {
            println!("  {group:31} {runs:>5} runs {moved:>8} bytes a sphere of its memory");
        }
    }
    println!("  copies to the card    {:>5}, {:>5} bytes a sphere", counts.uploads[0], each(counts.uploads[1]));
    println!("  copies from the card  {:>5}, {:>5} bytes a sphere", counts.downloads[0], each(counts.downloads[1]));
}

fn main() -> Result<(), Box<dyn Error>> {
    let (cell, particles) = suspension()?;
    let plan = plan(&cell)?;
    let folder = std::env::current_exe()?.parent().ok_or("a program is in a folder")?.to_owned();
    let (device, counts) =
        Counted::new(Box::new(Emulator::start(&Emulator::compile(&folder, &[Emulator::COUNTING])?, 1)?));
    let partition = Partition::new(&Comm::alone(), [plan.grid[1], plan.grid[2]]);
    let far = StressletSolver::of(Mobility::on(Box::new(device), &plan, &partition), &Comm::alone());
    let short_range = ShortRange { lubrication: Some(LubricationRange::default()), springs: None };
    let mut solver = CoupledSolver::of(far, &partition, short_range)?;
    let known = |counts: &gpu::SharedCounts| counts.borrow().clone();
    let before = known(&counts);
    solver.mobility().follow(&cell, &particles);
    println!("{SPHERES} spheres at {:.0}%, grid {:?} in f32", 100.0 * FRACTION, plan.grid);
    println!("order and lists of spheres that have moved");
    print(&since(&before, &known(&counts)));
    let loads = Loads::default();
    let shear = SolveInput::new(&loads, StrainRate::uniform(Traceless([0.0, 0.5, 0.0, 0.0, 0.0])));
    let before = known(&counts);
    solver.solve(&cell, &particles, &shear, Guess::default())?;
    let first = since(&before, &known(&counts)).uploads[1];
    let before = known(&counts);
    let solution = solver.solve(&cell, &particles, &shear, Guess::default())?;
    let solve = since(&before, &known(&counts));
    println!("tables of lubrication, once a run: {} kB", (first - solve.uploads[1]) / 1000);
    println!("a solve with lubrication, {} iterations", solution.iterations);
    print(&solve);
    let before = known(&counts);
    solver.mobility().apply(&solution.far, Output::All);
    println!("an evaluation with loads and motions of the host");
    print(&since(&before, &known(&counts)));
    Ok(())
}
