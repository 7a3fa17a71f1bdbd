//! Measures of displacements and gaps on an emulator of a card, beside those of the host.

use super::*;
use crate::evaluation::gap_control::{Change, MOST_ROUNDS, RelativeMotion, SLACK, WATCHED};
use crate::evaluation::orders::{self, ErrorEstimate, USED};
use crate::flow::periodic_cell::PeriodicCell;
use crate::integrators::substeps::largest_displacement_here;
use crate::model::ShearRates;
use crate::model::radii::Radii;
use crate::start::plan::plan;
use domain::{Partition, Random, RemoteHolder, RemoteList, Tensor};
use fcm::{
    DisplacementOrders, DisplacementWeights, GapChanges, HeldSteps, HeldVelocities, Mobility, Separation,
    SeparationLimits,
};
use simulation::Clock;
use std::rc::Rc;

/// Largest radius of the models.
const LARGEST: f64 = 1.4;

/// Spheres with velocities in shear at some strain, and these on a card.
struct Case {
    particles: Particles,
    moving: PeriodicCell,
    partition: Partition,
    _mobility: Mobility,
    holder: Rc<dyn RemoteHolder>,
    steps: Rc<dyn HeldSteps>,
    positions: RemoteList,
    columns: Vec<RemoteList>,
}

impl Case {
    fn new(seed: u64) -> Self {
        let (model, mut random) = (sheared(), Random::new(seed, 0));
        let mut particles = started(&model, None).particles;
        let rates = ShearRates::new(1.0, Protocol::STEADY, 1e-2);
        let moving = PeriodicCell::at(&Clock::at(17 * seed, 1e-2), model.cell, rates, true);
        let cell = *moving.cell();
        // A few pairs overlap or nearly touch.
        for row in (1..particles.len()).step_by(4) {
            let contact = particles.radii[row - 1] + particles.radii[row];
            let turn = Vector::new(random.uniform(), random.uniform() - 0.5, random.uniform() - 0.5).normalize();
            let place = particles.positions[row - 1] + turn * (contact + 4e-3 * (random.uniform() - 0.3));
            particles.positions[row] = cell.wrap(place).0;
        }
        for name in USED {
            let flow: Vec<Vector> = particles.positions.iter().map(|&x| moving.flow().velocity(x)).collect();
            for (velocity, flow) in particles.vectors(name).iter_mut().zip(flow) {
                *velocity = flow + Vector::from_array(std::array::from_fn(|_| random.uniform() - 0.5));
            }
        }
        let plan = plan(&model, &Radii::of_model(&model).unwrap()).unwrap();
        let partition = Partition::new(&Comm::alone(), [plan.grid[1], plan.grid[2]]);
        let mut mobility = Mobility::on(emulator(seed).0, &plan, &partition);
        let far = mobility.coupled().unwrap();
        let (holder, steps) = (far.holder(), far.steps());
        particles.move_to(&*holder);
        mobility.arrange(&cell, &particles);
        let positions = particles.positions.remote_list().unwrap().clone();
        let columns = USED.map(|name| holder.hold(bytemuck::cast_slice(particles.vectors(name)))).to_vec();
        Self { particles, moving, partition, _mobility: mobility, holder, steps, positions, columns }
    }

    fn on_host(&mut self) -> RelativeMotion<4> {
        RelativeMotion::find(&mut self.particles, &self.moving, &self.partition, USED)
    }

    fn velocities(&self) -> HeldVelocities<'_> {
        let (flow, deformation) = (self.moving.flow(), Tensor::IDENTITY);
        HeldVelocities { positions: &self.positions, columns: &self.columns, flow, deformation }
    }
}

fn assert_near(found: &[f64], exact: &[f64]) {
    let is_near = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-9 * b.abs();
    assert!(found.iter().zip(exact).all(is_near), "{found:?} instead of {exact:?}");
}

fn assert_same_changes(found: GapChanges, exact: Change) {
    let Change { gap, loss, error, roughness } = exact;
    assert_near(&[found.gap, found.loss, found.error, found.roughness], &[gap, loss, error, roughness]);
    assert!(gap < 0.0 && loss > 0.0 && error > 0.0);
}

/// By weights of adaptive steps, of which those with the highest order are rough, and of implicit ones.
#[test]
fn changes_and_errors_are_those_of_the_host() {
    let (mut rough, alone) = (0, Comm::alone());
    for seed in 1..5 {
        let mut case = Case::new(seed);
        let (host, reach) = (case.on_host(), WATCHED * LARGEST);
        for (ages, step) in [(vec![0.0, 0.01, 0.02, 0.03], 0.01), (vec![0.0, 0.01, 0.025], 1e-3), (vec![0.0], 0.02)] {
            let weights: [DisplacementWeights; 4] = orders::weights(&ages, step);
            let four = DisplacementOrders::Four { weights: &weights, smooth: ErrorEstimate::SMOOTH };
            let found = case.steps.gap_changes(&case.velocities(), &four, [0.0, 1e-3], reach);
            let exact = host.after_orders(weights, [0.0, 1e-3], &alone);
            if ages.len() > 1 {
                assert_same_changes(found, exact);
            }
            let found = case.steps.displacement_error(&case.columns, &four);
            let exact = orders::of_displacements_here(&mut case.particles, &weights, &alone);
            assert_near(&[found.error, found.roughness], &[exact.error, exact.roughness]);
            rough += usize::from(exact.roughness > 0.0);
            let both = [weights[0], [0.5 * step, 0.3 * step, 0.0, 0.0]];
            let two = DisplacementOrders::Two(&both);
            let found = case.steps.gap_changes(&case.velocities(), &two, [0.01, 0.1], reach);
            assert_same_changes(found, host.after(both, [0.01, 0.1], &alone));
            let from_none = [weights[0], [0.0; 4]];
            let found = case.steps.displacement_error(&case.columns, &DisplacementOrders::Two(&from_none)).error;
            assert_near(&[found], &[largest_displacement_here(&mut case.particles, USED, weights[0], &alone)]);
        }
    }
    assert_eq!(rough, 4);
}

#[test]
fn pairs_are_moved_apart_as_on_the_host() {
    let mut pushed = 0;
    for seed in 1..5 {
        let mut case = Case::new(seed);
        let (host, weights) = (case.on_host(), [0.01, -2e-3, 0.0, 1e-3]);
        let (exact, is_done) = host.pushed(weights, 1e-2, &Comm::alone());
        let limits = SeparationLimits { closest: 1e-2, slack: SLACK, rounds: MOST_ROUNDS, reach: WATCHED * LARGEST };
        let found = case.steps.moved_apart(&case.velocities(), &weights, &limits);
        let Separation::By(list) = found else {
            assert!(!is_done && found == Separation::Fails, "{seed}: {found:?}");
            continue;
        };
        assert!(is_done, "{seed}");
        let found = case.holder.copies(&[&list]).remove(0);
        for (found, exact) in found.as_chunks::<3>().0.iter().zip(exact) {
            assert!((Vector::from_array(*found) - exact).length() < 1e-9, "{found:?} instead of {exact}");
            pushed += usize::from(exact.length() > 1e-3);
        }
    }
    assert!(pushed > 10, "{pushed}");
}
