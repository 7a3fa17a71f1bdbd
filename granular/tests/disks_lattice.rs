//! Sheared disks: images, restarts, threads.

use domain::Particles;
use granular::disks::{DiskFlow, DiskModel, DiskParameters, Disks, Progress, Stage};

fn sheared(edges: [f64; 2], rate: f64) -> Disks {
    let flow = DiskFlow::Shear { rate };
    Disks::prepared(&DiskModel::new(DiskParameters { edges, flow, ..DiskParameters::default() }).unwrap()).unwrap()
}

#[test]
fn going_on_from_a_store_is_going_on() {
    let mut through = sheared([40.0, 50.0], 0.05);
    through.advance(777);
    let (particles, progress) = through.store();
    let mut resumed = Disks::resume(through.model(), &particles, &progress).unwrap();
    through.advance(1500);
    // A snapshot or a store in between changes nothing.
    resumed.advance(400);
    let _ = (resumed.snapshot(), resumed.store());
    resumed.advance(1100);
    let ((one, a), (other, b)) = (through.store(), resumed.store());
    assert!(through.clock().step() == 2277 && one == other);
    assert_eq!(a, b);
    assert_eq!(Progress::from_numbers(&a.to_numbers()[1..]), None);
    assert_eq!(Progress::from_numbers(&a.to_numbers()), Some(a));
}

/// Pairs that separate or meet between the positions of the forces and those at the step's end count once, too.
#[test]
fn collisions_are_counted_alike_wherever_a_run_is_resumed() {
    let mut through = sheared([40.0, 50.0], 0.05);
    for _ in 0..2000 {
        let (particles, progress) = through.store();
        let mut resumed = Disks::resume(through.model(), &particles, &progress).unwrap();
        through.advance(1);
        resumed.advance(1);
        assert_eq!(through.store().1, resumed.store().1);
    }
}

#[test]
fn a_preparation_can_be_resumed_too() {
    let model = DiskModel::new(DiskParameters { edges: [30.0; 2], ..DiskParameters::default() }).unwrap();
    let mut through = Disks::random(&model);
    through.advance(50);
    let (particles, progress) = through.store();
    let mut resumed = Disks::resume(&model, &particles, &progress).unwrap();
    for disks in [&mut through, &mut resumed] {
        disks.advance(disks.left().unwrap());
        disks.enter_next_stage();
        disks.advance(disks.left().unwrap());
        disks.enter_next_stage();
    }
    assert!(through.stage() == Stage::Flow && through.store().0 == resumed.store().0);
    assert!(through.store().0 == Disks::prepared(&model).unwrap().store().0);
}

/// The same disks in another cell of the same lattice: the origin shifted by `up`, and with it the liquid's zero.
fn moved(disks: &Disks, up: f64, rate: f64) -> Particles {
    let (mut particles, _) = disks.store();
    let height = disks.model().parameters().edges[1];
    let cell = disks.model().cell(0.0);
    for row in 0..particles.len() {
        particles.positions[row].y += up;
        particles.vectors("velocity")[row].x += rate * up;
        let (wrapped, taken) = cell.wrap(particles.positions[row]);
        particles.positions[row] = wrapped;
        particles.vectors("velocity")[row].x -= rate * height * f64::from(taken[1]);
    }
    particles
}

#[test]
fn the_choice_of_the_cell_does_not_matter() {
    let rate = 0.02;
    let start = sheared([50.0; 2], rate);
    let parameters = start.model().parameters().clone();
    let mut one = Disks::flowing(parameters.clone(), &start.store().0).unwrap();
    let mut other = Disks::flowing(parameters, &moved(&start, 17.3, rate)).unwrap();
    // Consecutive collisions multiply round-off by about 10 each: a few times in 30 time units.
    one.advance(200);
    other.advance(200);
    let (a, b) = (one.snapshot(), other.snapshot());
    for (p, q) in a.disks.iter().zip(&b.disks) {
        assert!((p.excess - q.excess).length() < 1e-9, "disk {}: {} and {}", p.id, p.excess, q.excess);
    }
    let (x, y) = (one.tally().latest.stress(), other.tally().latest.stress());
    assert!((x - y).length() < 1e-10 && x.length() > 1e-5);
}

#[test]
fn disks_at_rest_in_the_flow_stay_there() {
    // A dilute row across the cell's top, carried through many periods of the lattice.
    let mut particles = Particles::default();
    for id in 0..4 {
        particles.push(id, domain::Vector::new(9.0 * id as f64, 8.0 * id as f64 + 0.5, 0.0), 0.6, 0);
    }
    let parameters =
        DiskParameters { edges: [40.0, 33.0], flow: DiskFlow::Shear { rate: 0.3 }, ..DiskParameters::default() };
    let mut disks = Disks::flowing(parameters, &particles).unwrap();
    disks.advance(20_000);
    assert!(disks.strain() > 800.0);
    for disk in disks.snapshot().disks {
        // Round-off of x in steps of 10 over 20000 steps.
        assert!(disk.excess.length() < 1e-12 && (disk.position.y - 8.0 * disk.id as f64 - 0.5).abs() < 1e-12);
    }
    let steps = disks.store().0.steps;
    assert!(steps[3][0] > 100 && steps[0][0] < -100, "the flow has carried them around: {steps:?}");
}

/// The unwrapped positions, from the positions in the cell and the lattice steps removed from them, are continuous
/// through every reduction of the lattice strain, whenever the neighbour list was built.
#[test]
fn lattice_steps_keep_the_way_of_every_disk() {
    for rate in [0.3, -0.3] {
        let mut particles = Particles::default();
        for id in 0..4 {
            particles.push(id, domain::Vector::new(9.0 * id as f64, 8.0 * id as f64 + 0.5, 0.0), 0.6, 0);
        }
        particles.steps = vec![[0, 0, 0], [2, 1, 0], [-1, -3, 0], [0, 7, 0]].into();
        let edges @ [length, height] = [40.0, 33.0];
        let parameters = DiskParameters { edges, flow: DiskFlow::Shear { rate }, ..DiskParameters::default() };
        let mut disks = Disks::flowing(parameters, &particles).unwrap();
        let way = |disks: &Disks, row: usize| {
            let (particles, _) = disks.store();
            let ([along, up, _], place) = (particles.steps[row], particles.positions[row]);
            let tilt = disks.cell().strain() * height;
            [place.x + f64::from(along) * length + f64::from(up) * tilt, place.y + f64::from(up) * height]
        };
        let start: Vec<_> = (0..4).map(|row| way(&disks, row)).collect();
        let mut turned = false;
        for _ in 0..400 {
            let before = disks.cell().strain();
            disks.advance(1);
            turned |= (disks.cell().strain() - before).abs() > 0.5;
            for (row, start) in start.iter().enumerate() {
                let [x, y] = way(&disks, row);
                let far = start[0] + rate * (start[1] - 0.5 * height) * disks.clock().time();
                // Round-off of positions up to 1e3.
                assert!(
                    (x - far).abs() < 1e-9 && (y - start[1]).abs() < 1e-9,
                    "disk {row} at {}",
                    disks.clock().time()
                );
            }
        }
        assert!(turned, "the lattice was turned back");
    }
}

#[test]
fn threads_do_not_change_a_bit() {
    let model = DiskModel::new(DiskParameters { edges: [330.0; 2], ..DiskParameters::default() }).unwrap();
    assert!(model.sizes().len() > 15_000, "several chunks");
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut disks = Disks::random(&model);
            disks.advance(60);
            disks.store()
        })
    };
    let (one, three) = (run(1), run(3));
    assert!(one == three);
}
