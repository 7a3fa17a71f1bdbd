//! Sheared disks against exact answers.

use domain::{Particles, Vector};
use granular::disks::{DiskFlow, DiskModel, DiskParameters, Disks, Gear, Sizes};

/// A cell without liquid or flow.
fn dry() -> DiskParameters {
    DiskParameters { viscosity: 0.0, flow: DiskFlow::Still, edges: [40.0; 2], ..DiskParameters::default() }
}

/// Disks with given positions, velocities and radii.
fn placed(disks: &[(f64, f64, f64, f64, f64)]) -> Particles {
    let mut particles = Particles::default();
    for (id, &(x, y, _, _, radius)) in disks.iter().enumerate() {
        particles.push(id as u64, Vector::new(x, y, 0.0), radius, 0);
    }
    for (v, disk) in particles.vectors("velocity").iter_mut().zip(disks) {
        *v = Vector::new(disk.2, disk.3, 0.0);
    }
    particles
}

/// Restitution in a head-on collision at a relative speed of 0.04, for several phases of first contact within a time
/// step: the mean and the largest deviation from it.
fn restitution(parameters: &DiskParameters, radii: [f64; 2], phases: u32) -> (f64, f64) {
    let speed = 0.04;
    let measure = |phase: u32| {
        let gap = speed * parameters.time_step * (2.0 + f64::from(phase) / f64::from(phases));
        let far = 10.0 + radii[0] + radii[1] + gap;
        let pair = [(10.0, 20.0, speed, 0.0, radii[0]), (far, 20.0, 0.0, 0.0, radii[1])];
        let mut disks = Disks::flowing(parameters.clone(), &placed(&pair)).unwrap();
        disks.advance((6.0 / parameters.time_step) as u64);
        let seen = disks.snapshot().disks;
        (seen[1].velocity.x - seen[0].velocity.x) / speed
    };
    let all: Vec<f64> = (0..phases).map(measure).collect();
    let mean = all.iter().sum::<f64>() / f64::from(phases);
    (mean, all.iter().map(|e| (e - mean).abs()).fold(0.0, f64::max))
}

#[test]
fn a_collision_leaves_the_restitution_asked_for() {
    for (gear, tolerance) in [(Gear::FiveValue, 1e-3), (Gear::FiveValuePositional, 1e-3), (Gear::FourValue, 2e-3)] {
        let (mean, _) = restitution(&DiskParameters { gear, ..dry() }, [1.0, 1.0], 1000);
        assert!((mean - 0.8).abs() < tolerance, "{gear:?}: {mean}");
    }
    let fine = DiskParameters { time_step: 0.01, ..dry() };
    let (mean, _) = restitution(&fine, [1.0, 1.0], 50);
    assert!((mean - 0.8).abs() < 3e-4, "fine: {mean}");
}

#[test]
fn it_is_the_same_for_all_masses() {
    let alike = |radii| restitution(&dry(), radii, 20);
    let (mean, spread) = alike([0.875, 0.875]);
    for radii in [[0.875, 3.5], [3.5, 3.5]] {
        let (other, also) = alike(radii);
        // Round-off of positions near 20 over a speed of 0.04, times the number of steps.
        assert!((mean - other).abs() < 1e-11 && (spread - also).abs() < 1e-11);
    }
}

#[test]
fn elastic_and_clipped_contacts_are_as_predicted() {
    let (mean, spread) = restitution(&DiskParameters { restitution: 1.0, ..dry() }, [1.0, 1.0], 1000);
    assert!((mean - 1.0).abs() < 1e-3 && spread < 1e-3, "{mean} {spread}");
    let (mean, _) = restitution(&DiskParameters { clip_attraction: true, ..dry() }, [1.0, 1.0], 1000);
    // The damped spring that is released when it would pull, in closed form; 5e-4 is the error of the time step.
    assert!((mean - 0.80809).abs() < 5e-4, "{mean}");
}

#[test]
fn drag_relaxes_as_stokes_says() {
    let parameters = DiskParameters { edges: [60.0; 2], ..DiskParameters::default() };
    let (rate, radius) = (0.01, 0.875);
    let drag = 6.0 * std::f64::consts::PI * 0.01 / radius;
    let (wx, vy) = (0.03, 0.02);
    let start = [(10.0, 30.0, wx, vy, radius), (50.0, 3.0, -0.27, 0.0, 3.5)];
    let mut disks = Disks::flowing(parameters, &placed(&start)).unwrap();
    disks.advance(60);
    let (t, disk) = (disks.clock().time(), disks.snapshot().disks[0]);
    let left = (-drag * t).exp();
    let expected_vy = vy * left;
    let expected_wx = (wx - rate * vy * t) * left;
    // (drag * dt)^4 = 1e-6 per relaxation time, for two relaxation times, from a start with the exact derivatives.
    assert!((disk.excess.y / expected_vy - 1.0).abs() < 1e-6, "{}", disk.excess.y / expected_vy - 1.0);
    assert!((disk.excess.x / expected_wx - 1.0).abs() < 1e-6);
    let risen = vy / drag * (1.0 - left);
    assert!(((disk.position.y - 30.0) / risen - 1.0).abs() < 1e-6);
    // x = int (u + w): u depends on y; eq. (A4) is the limit of the integral of w.
    let along = rate * vy / drag * (t - (1.0 - left) / drag) + wx / drag * (1.0 - left)
        - rate * vy / drag * ((1.0 - left) / drag - t * left);
    assert!(((disk.position.x - 10.0) / along - 1.0).abs() < 1e-6);
}

#[test]
fn drag_pulls_toward_the_parabola() {
    let flow = DiskFlow::Poiseuille { peak: 0.5 };
    let parameters = DiskParameters { edges: [60.0; 2], flow, viscosity: 0.05, ..DiskParameters::default() };
    let start = [(10.0, 15.0, 0.0, 0.0, 1.0), (20.0, 59.0, 0.0, 0.0, 1.0)];
    let mut disks = Disks::flowing(parameters, &placed(&start)).unwrap();
    disks.advance(300);
    let t = disks.clock().time();
    let relaxed = 1.0 - (-6.0 * std::f64::consts::PI * 0.05 * t).exp();
    for (disk, speed) in disks.snapshot().disks.iter().zip([0.375, 4.0 * 0.5 * 59.0 / 3600.0]) {
        assert!((disk.velocity.x / (speed * relaxed) - 1.0).abs() < 1e-6);
    }
}

fn gas(seed: u64) -> Disks {
    let parameters = DiskParameters { edges: [50.0; 2], seed, ..dry() };
    let model = DiskModel::new(DiskParameters { restitution: 1.0, ..parameters.clone() }).unwrap();
    let (mut particles, _) = Disks::prepared(&model).unwrap().store();
    for (id, v) in particles.vectors("velocity").iter_mut().enumerate() {
        let t = id as f64;
        *v = Vector::new((t * 12.9898).sin(), (t * 78.233).sin(), 0.0) * 0.1;
    }
    Disks::flowing(DiskParameters { restitution: 1.0, ..parameters }, &particles).unwrap()
}

#[test]
fn elastic_disks_keep_energy_and_momentum() {
    for (dt, tolerance) in [(0.15, 0.015), (0.05, 3e-4)] {
        let mut disks = gas(1);
        let parameters = DiskParameters { time_step: dt, ..disks.model().parameters().clone() };
        let (particles, _) = disks.store();
        disks = Disks::flowing(parameters, &particles).unwrap();
        let momentum = |d: &Disks| d.snapshot().disks.iter().map(|d| d.velocity * d.mass).sum::<glam::DVec2>();
        let (before, energy) = (momentum(&disks), disks.tally().latest.energy());
        disks.advance((1000.0 / dt) as u64);
        let kept = disks.tally().latest.energy() / energy - 1.0;
        assert!(kept.abs() < tolerance, "{dt}: {kept}");
        assert!((momentum(&disks) - before).length() < 1e-12 * 400.0);
    }
}

#[test]
fn work_and_losses_balance_in_the_flow() {
    let parameters = DiskParameters { edges: [50.0; 2], measure_every: 1, ..DiskParameters::default() };
    let mut disks = Disks::prepared(&DiskModel::new(parameters).unwrap()).unwrap();
    disks.advance(3000);
    disks.restart_tally();
    disks.advance(13334);
    let tally = disks.tally();
    assert!(tally.imbalance().abs() < 5e-4, "{}", tally.imbalance());
    assert!(tally.drag > 0.9 * tally.input && tally.damping > 0.0, "drag takes nearly all at this viscosity");
    assert!(tally.collisions.min_element() > 0.0);
}

#[test]
fn preparation_does_not_heat() {
    let energy = |time_step: f64| {
        let mut parameters = DiskParameters { edges: [50.0; 2], ..dry() };
        parameters.preparation.time_step = time_step;
        let mut disks = Disks::random(&DiskModel::new(parameters).unwrap());
        disks.advance(disks.left().unwrap());
        disks.tally().latest.kinetic
    };
    let (coarse, fine) = (energy(0.15), energy(0.075));
    assert!((coarse / fine - 1.0).abs() < 0.3, "{coarse} {fine}");
}

#[test]
fn other_sizes_and_flows_run() {
    let spread = Sizes::Spread { smallest: 0.5, largest: 2.0, exponent: -2.0 };
    for (sizes, flow) in
        [(spread, DiskFlow::Shear { rate: -0.02 }), (Sizes::monodisperse(), DiskFlow::Poiseuille { peak: 0.3 })]
    {
        let parameters =
            DiskParameters { edges: [30.0; 2], sizes, flow, measure_every: 1, ..DiskParameters::default() };
        let mut disks = Disks::prepared(&DiskModel::new(parameters).unwrap()).unwrap();
        disks.advance(2000);
        assert!(disks.tally().imbalance().abs() < 5e-3, "{}", disks.tally().imbalance());
        assert!(disks.tally().input > 0.0);
    }
}
