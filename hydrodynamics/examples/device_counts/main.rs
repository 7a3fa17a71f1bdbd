//! Counts what a card does in solves with and without lubrication and in Brownian steps, by an emulator that runs its
//! kernels: copies, launches, and the memory that kernels read and write. A sector of 32 bytes counts once in
//! a run of a kernel; transforms pass over their data once for each axis.
//!
//!     cargo run --package fcm-solve-hydrodynamics --example device_counts

mod substep;

use domain::{Boundaries, Comm, Particles, Partition, PeriodicBox, RemoteFrame, Traceless, Vector, random_packing};
use fcm::{
    Costs, Fixed, HeldDraw, Loading, Loads, Method, Mobility, MovingFlow, Multipoles, Output, PastSolutions, Plan,
    Precision, Problem, SolutionColumns, Stream, StressletSolver,
};
use gpu::{Counted, Device, DeviceCounts, Emulator};
use hydrodynamics::{CoupledSolver, Guess, HeldFluctuations, ShortRange, SolveInput, StrainRate};
use lubrication::LubricationRange;
use solver::BackgroundFlow;
use std::collections::{BTreeMap, VecDeque};
use std::error::Error;
use std::f64::consts::PI;

/// Strain of the box at the start and at most, tolerance, and strain between the steps of a run.
const STRAIN: f64 = 0.3;
const LARGEST_STRAIN: f64 = 0.4;
const TOLERANCE: f64 = 1e-2;
const STEP: f64 = 0.005;

/// A suspension.
struct CountedCase {
    spheres: usize,
    fraction: f64,
    /// Whether near spheres are lubricated; others have a weight.
    lubricated: bool,
}

/// Columns of the velocities by which spheres move, and of those that are drawn.
const VELOCITY: &str = "velocity";
const DRAWN: &str = "drawn velocity";

/// Factor of random motions and loads, by which spheres move by thousandths of their radii in a step.
const AMPLITUDE: f64 = 1.0;

/// Weights of past solutions in the start of a step, which is extrapolated by a parabola, the last one first.
const PARABOLA: [f64; 3] = [3.0, -3.0, 1.0];

/// Steps of a run before the one that is counted: the past of its start, and some in which commands are recorded.
const STEPS_BEFORE: usize = 9;

/// Kernels by what they are for: the beginnings of their names.
const GROUPS: [(&str, &[&str]); 11] = [
    ("order and lists of spheres", &["bin_", "scan_", "scatter_", "order_", "find_neighbours"]),
    ("assembly of near pairs", &["find_near_", "assemble_", "moments_"]),
    ("groups of the preconditioner", &["begin_", "choose_", "join_", "count_", "place_groups", "invert_"]),
    ("far field", &["gather_loads", "spread_", "transform", "solve_", "interpolate_", "pair_motions"]),
    ("near pairs, and preconditioner", &["row_loads", "step_pairs", "turn_pairs", "remainder_"]),
    ("vectors and sums", &["sum_", "step_all", "measure_", "start_", "gather_all", "coupled_", "strain_"]),
    ("columns of solutions", &["guess_", "load_known", "store_", "compare_"]),
    ("motion of the spheres", &["displace_", "place_all", "overlapping_"]),
    ("random motions and loads", &["random_", "krylov_", "drawn_"]),
    ("control of steps", &["combine_", "limit_", "displacement_error", "gap_changes", "pushed_apart"]),
    ("contacts", &["find_contacts", "load_contacts", "end_contacts"]),
];

impl CountedCase {
    fn radii(&self) -> Vec<f64> {
        (0..self.spheres).map(|i| if i % 2 == 0 { 1.0 } else { 1.4 }).collect()
    }

    /// The box at a strain.
    fn cell(&self, strain: f64) -> Result<PeriodicBox, Box<dyn Error>> {
        let volume: f64 = self.radii().iter().map(|a| 4.0 / 3.0 * PI * a.powi(3)).sum();
        Ok(PeriodicBox::sheared(Vector::splat((volume / self.fraction).cbrt()), strain)?)
    }

    /// Spheres of two sizes in a sheared box.
    fn suspension(&self) -> Result<(PeriodicBox, Particles), Box<dyn Error>> {
        let (radii, cell) = (self.radii(), self.cell(STRAIN)?);
        let positions = random_packing(&cell, &radii, 0.0, 1)?;
        let mut particles = Particles::default();
        for (id, (&position, &radius)) in positions.iter().zip(&radii).enumerate() {
            particles.push(id as u64, position, radius, 0);
        }
        particles.wrap(&cell);
        Ok((cell, particles))
    }

    fn weight(&self) -> Loads {
        let forces: Vec<Vector> = self.radii().iter().map(|a| -Vector::Z * a.powi(3)).collect();
        Loads { forces: if self.lubricated { Vec::new() } else { forces }, ..Loads::default() }
    }

    fn plan(&self, cell: &PeriodicBox) -> Result<Plan, Box<dyn Error>> {
        let (precision, method) = (Some(Precision::Single), Some(Method::Split));
        Ok(Plan::choose(&Problem {
            edges: cell.edges(),
            boundaries: Boundaries::Periodic,
            volume: cell.volume(),
            shortest_vector: cell.edges().x,
            smallest_edge_ratio: 1.0,
            largest_strain: LARGEST_STRAIN,
            largest_tilts: [0.0; 2],
            radii: vec![(1.0, self.spheres.div_ceil(2)), (1.4, self.spheres / 2)],
            viscosity: 1.0,
            multipoles: Multipoles::Dipole,
            rigid: true,
            lubricated: self.lubricated,
            loading: Loading::Varied,
            tolerance: TOLERANCE,
            threads: 1,
            ranks: 1,
            costs: Costs::default(),
            network: None,
            fixed: Fixed { precision, method, ..Fixed::default() },
        })?)
    }

    /// Prints what a device does for the spheres, and for a step of a run, with the start that it would have.
    fn count(&self) -> Result<(), Box<dyn Error>> {
        let (cell, particles) = self.suspension()?;
        let plan = self.plan(&cell)?;
        let partition = Partition::new(&Comm::alone(), [plan.grid[1], plan.grid[2]]);
        let short_range =
            ShortRange { lubrication: self.lubricated.then(LubricationRange::default), ..ShortRange::default() };
        let loads = Loads::default();
        let shear = SolveInput::new(&loads, StrainRate::uniform(Traceless([0.0, 0.5, 0.0, 0.0, 0.0])));
        let (device, counts) = counted()?;
        let far = StressletSolver::of(Mobility::on(device, &plan, &partition), &Comm::alone());
        let mut on_card = CoupledSolver::of(far, &partition, short_range)?;
        let stage = |title: &str, before: &DeviceCounts| {
            println!("{title}");
            self.print(&since(before, &counts.borrow()));
        };
        let kind = if self.lubricated { "" } else { " under their weight, without lubrication," };
        println!("{} spheres{kind} at {:.0}%, grid {:?} in f32", self.spheres, 100.0 * self.fraction, plan.grid);
        on_card.solve(&cell, &particles, &shear, Guess::default())?;
        let before = counts.borrow().clone();
        let solution = on_card.solve(&cell, &particles, &shear, Guess::default())?;
        stage(&format!("a solve from rest, {} iterations", solution.iterations), &before);
        let mut moving = particles.clone();
        let mut past = VecDeque::new();
        moving.move_to(on_card.holder().ok_or("the card moves no particles")?);
        on_card.hold_loads(&self.weight(), &moving);
        let mut before = DeviceCounts::default();
        let mut iterations = 0;
        for step in 0..=STEPS_BEFORE {
            before = counts.borrow().clone();
            iterations = self.step(&mut on_card, &mut moving, &mut past, STRAIN + step as f64 * STEP)?;
        }
        stage(&format!("a step of a run, {iterations} iterations"), &before);
        if self.lubricated {
            let mut iterations = 0;
            for _ in 0..3 {
                before = counts.borrow().clone();
                iterations = self.substep(&mut on_card, &mut moving, &mut past)?;
            }
            stage(&format!("an implicit substep with contacts, {iterations} iterations"), &before);
        }
        let solution = on_card.solve(&cell, &particles, &shear, Guess::default())?;
        let mut before = counts.borrow().clone();
        on_card.mobility().apply(&solution.far, Output::All);
        stage("an evaluation with loads and motions of the host", &before);
        // The first steps take memory and record commands.
        let mut iterations = [0; 2];
        for number in 0..3 {
            before = counts.borrow().clone();
            iterations = self.midpoint(&mut on_card, &mut moving, number)?;
        }
        let [drawn, solved] = iterations;
        stage(&format!("a Brownian step, {drawn} iterations of its draw and {solved} of its solve"), &before);
        Ok(())
    }
}

impl CountedCase {
    /// Moves particles on the card by the velocities of the last step, if there are any, to a strain of the box, and
    /// solves there, from past solutions, to which the solution is added. Returns the number of iterations.
    fn step(
        &self,
        on_card: &mut CoupledSolver,
        moving: &mut Particles,
        past: &mut VecDeque<SolutionColumns>,
        strain: f64,
    ) -> Result<usize, Box<dyn Error>> {
        let (cell, flow, loads) = (self.cell(strain)?, BackgroundFlow::shear(1.0), Loads::default());
        if !past.is_empty() {
            moving.displace_by([VELOCITY], [STEP]);
            advance(on_card, moving, &cell);
        }
        let shear = SolveInput::new(&loads, StrainRate::uniform(flow.strain_rate()));
        let shear = SolveInput { keeps_columns: true, moving_in: Some(MovingFlow::carrying(flow)), ..shear };
        let solution = on_card.solve(&cell, moving, &shear, extrapolated(past.make_contiguous()))?;
        let columns = solution.kept.ok_or("the card keeps no solutions")?.columns;
        if let Some([velocities, _]) = &columns.moving {
            moving.column(VELOCITY, 3).values = velocities.clone();
        }
        past.push_front(columns);
        past.truncate(PARABOLA.len());
        Ok(solution.iterations)
    }
}

impl CountedCase {
    /// Takes a step of the midpoint scheme for Brownian spheres, at the last strain. Returns the numbers of iterations
    /// of the draw and of the solve.
    fn midpoint(
        &self,
        on_card: &mut CoupledSolver,
        moving: &mut Particles,
        number: u64,
    ) -> Result<[usize; 2], Box<dyn Error>> {
        const MISSING: &str = "the card draws no motions";
        let (cell, flow) = (self.cell(STRAIN + STEPS_BEFORE as f64 * STEP)?, BackgroundFlow::shear(1.0));
        let (none, stream) = (Loads::default(), Stream::new(1, number));
        let draw = HeldDraw { particles: moving, tolerance: TOLERANCE, stream, amplitude: AMPLITUDE, carried: &flow };
        let (motions, drawn) = on_card.draw_motions(&cell, &draw).ok_or(MISSING)?;
        moving.set_column(DRAWN, 3, motions.velocities);
        moving.displace_by([DRAWN], [0.5 * STEP]);
        advance(on_card, moving, &cell);
        on_card
            .close_spheres(&cell, moving, self.lubricated.then_some(LubricationRange::MINIMUM_GAP))
            .ok_or(MISSING)?;
        let loads = on_card.draw_loads(&cell, moving, stream, AMPLITUDE).ok_or(MISSING)?;
        let fluctuations = HeldFluctuations { ambient: motions.ambient, loads };
        let shear = SolveInput::new(&none, StrainRate::uniform(flow.strain_rate()));
        let moving_in = Some(MovingFlow::carrying(flow));
        let input = SolveInput { keeps_columns: true, moving_in, fluctuations: Some(&fluctuations), ..shear };
        let solution = on_card.solve(&cell, moving, &input, Guess::default())?;
        let [velocities, _] = solution.kept.and_then(|kept| kept.columns.moving).ok_or("the card keeps no motions")?;
        moving.set_column(VELOCITY, 3, velocities);
        moving.displace_by([VELOCITY, DRAWN], [STEP, -0.5 * STEP]);
        advance(on_card, moving, &cell);
        Ok([drawn.iterations, solution.iterations])
    }
}

/// Moves particles on the card by their displacements and wraps them into the box.
fn advance(on_card: &CoupledSolver, moving: &mut Particles, cell: &PeriodicBox) {
    let holder = on_card.holder().expect("the card moves particles");
    let frame = RemoteFrame::new(cell, BackgroundFlow::shear(1.0).gradient(), 1e9);
    assert!(moving.advance_remotely(frame, |name| [VELOCITY, DRAWN, substep::EXPECTED].contains(&name), holder));
}

/// An emulator that counts.
fn counted() -> Result<(Box<dyn Device>, gpu::SharedCounts), Box<dyn Error>> {
    let (device, counts) = Counted::new(Box::new(Emulator::beside_program(&[Emulator::COUNTING], 1)?));
    Ok((Box::new(device), counts))
}

/// Guess by the parabola through past solutions, the last one first, or by the last one if they are fewer.
fn extrapolated(past: &[SolutionColumns]) -> Guess {
    let Some(last) = past.first() else { return Guess::default() };
    let mut solutions = PastSolutions::last(last.guessed.clone());
    if past.len() >= PARABOLA.len() {
        (solutions.line, solutions.parabola) = (PARABOLA, PARABOLA);
        for (k, columns) in solutions.columns.iter_mut().enumerate() {
            *columns = std::array::from_fn(|age| past[age].guessed[k].clone());
        }
    }
    Guess { past: Some(solutions), ..Guess::default() }
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
        waits: after.waits - before.waits,
        memory: after.memory,
    }
}

impl CountedCase {
    fn print(&self, counts: &DeviceCounts) {
        let each = |bytes: u64| (bytes as f64 / self.spheres as f64).round();
        println!("  commands from the host                 {:>6}", counts.launches);
        println!("  of these, replays of recordings        {:>6}", counts.replays);
        for (group, names) in GROUPS {
            let is_of = |kernel: &String| names.iter().any(|name| kernel.starts_with(name));
            let of_group = |sums: &BTreeMap<String, u64>| {
                sums.iter().filter(|(kernel, _)| is_of(kernel)).map(|(_, sum)| sum).sum::<u64>()
            };
            let (runs, moved) = (of_group(&counts.runs), each(of_group(&counts.moved)));
            if runs > 0 {
                println!("  {group:31} {runs:>5} runs {moved:>8} bytes a sphere of its memory");
            }
        }
        let (runs, moved) = (counts.runs.values().sum::<u64>(), each(counts.moved.values().sum()));
        println!("  all                             {runs:>5} runs {moved:>8} bytes a sphere of its memory");
        println!("  copies to the card    {:>5}, {:>5} bytes a sphere", counts.uploads[0], each(counts.uploads[1]));
        println!("  copies from the card  {:>5}, {:>5} bytes a sphere", counts.downloads[0], each(counts.downloads[1]));
        println!("  waits of the host     {:>5}", counts.waits);
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let cases = [(128, 0.4, true), (500, 0.2, true), (500, 0.2, false)];
    cases
        .into_iter()
        .try_for_each(|(spheres, fraction, lubricated)| CountedCase { spheres, fraction, lubricated }.count())
}
