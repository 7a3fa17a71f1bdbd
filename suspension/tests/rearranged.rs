//! Spheres that a user moves during a run.

use crate::support::model_of;
use domain::{Comm, Vector};
use simulation::{Rearrangement, Simulation, State};
use suspension::{Model, SuspensionRun};

const SCENE: &str = r"
seed = 3
box.edges = [14.0, 14.0, 14.0]
fluid.viscosity = 1.0
hydrodynamics = { tolerance = 1e-4, iteration_tolerance = 1e-9 }
time = { step = 0.05, steps = 3 }
species = [{ radius = 1.0, count = 12, force = [1.0, 0.5, -6.0] }]
";

/// A state after two steps, with new positions of spheres 3 and 7, the former outside the box.
fn moved(model: &Model, comm: &Comm, change: &Rearrangement) -> (SuspensionRun, State) {
    let mut run = SuspensionRun::start(model, None, comm).unwrap();
    run.advance(1).unwrap();
    run.advance(2).unwrap();
    let state = run.state();
    let moved = run.rearranged(state, change).unwrap();
    (run, moved)
}

#[test]
fn spheres_are_where_they_are_put_on_any_number_of_ranks_and_in_the_axes_of_the_user() {
    let places = [Vector::new(15.0, 2.0, 6.0), Vector::new(7.0, 6.5, 3.0)];
    let change = Rearrangement {
        positions: vec![(3, places[0]), (7, places[1])],
        radii: vec![(7, 0.75)],
        ..Rearrangement::default()
    };
    let walls = "box.boundaries=[\"periodic\", \"walls\", \"periodic\"]";
    for key in ["time.order=2", "time.order=4", "flow={ kind=\"shear\", rate=0.5 }", walls] {
        let model = model_of(SCENE, &[key]);
        let frames = [1, 3].map(|ranks| {
            let all = Comm::threads(ranks, |comm| {
                let (before, state) = moved(&model, &comm, &change);
                let (before, mut run) = (before.frame(), SuspensionRun::resume(&model, Some(state), &comm).unwrap());
                let put = run.frame();
                run.advance(3).unwrap();
                (before, put, run.frame())
            });
            all.into_iter().next().unwrap()
        });
        for (before, put, after) in &frames {
            for (row, (place, radius)) in put.particles.positions.iter().zip(&put.particles.radii).enumerate() {
                let unwrapped = *place + put.cell.lattice(put.particles.steps[row]);
                let was = before.particles.positions[row] + before.cell.lattice(before.particles.steps[row]);
                let expected = match row {
                    3 => places[0] + before.cell.lattice(before.particles.steps[row]),
                    7 => places[1] + before.cell.lattice(before.particles.steps[row]),
                    _ => was,
                };
                assert!((unwrapped - expected).length() < 1e-13, "sphere {row}, {key}");
                assert!((radius - if row == 7 { 0.75 } else { 1.0 }).abs() < 1e-15, "sphere {row}, {key}");
            }
            assert!(after.particles.positions.iter().all(|place| place.is_finite()));
        }
        let [one, three] = frames.map(|(_, _, after)| after.particles.positions);
        let largest = one.iter().zip(&three).map(|(a, b)| (*a - *b).length()).fold(0.0, f64::max);
        assert!(largest < 1e-7, "{largest:e} on three ranks, {key}");
    }
}

#[test]
fn what_spheres_do_not_have_is_refused() {
    let model = model_of(SCENE, &[]);
    let run = SuspensionRun::start(&model, None, &Comm::alone()).unwrap();
    let refusal = |change: &Rearrangement| {
        let mut other = SuspensionRun::start(&model, None, &Comm::alone()).unwrap();
        run.rearranged(other.state(), change).unwrap_err().to_string()
    };
    let velocities = Rearrangement { velocities: vec![(0, Vector::X)], ..Rearrangement::default() };
    assert!(refusal(&velocities).contains("spheres in Stokes flow have no velocities of their own"));
    let spins = Rearrangement { angular_velocities: vec![(0, Vector::X)], ..Rearrangement::default() };
    assert!(refusal(&spins).contains("spheres in Stokes flow have no velocities of their own"));
    for radius in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let change = Rearrangement { radii: vec![(4, radius)], ..Rearrangement::default() };
        assert!(refusal(&change).contains("the radius of particle 4 would be"), "{radius}");
    }
}
