//! The event-driven engine against the kinetic theory of a granular gas.

use domain::Vector;
use granular::shear_cell::{CellModel, CellState, CollisionEngine, CollisionRule, EventDriven, FrictionLaw, Grains};
use std::f64::consts::PI;

fn gas(count: usize, solid_fraction: f64, restitution: f64, friction: f64) -> (CellModel, Grains) {
    let edge = (count as f64 * PI / 6.0 / solid_fraction).cbrt();
    let contact = CollisionRule { restitution, friction, law: FrictionLaw::Box };
    let model = CellModel::gas(Vector::splat(edge), 1.0, 6.0 / PI, contact).unwrap();
    let mut grains = model.pack(count, 11).unwrap();
    grains.set_velocities(&model, 1.0, 12);
    (model, grains)
}

/// Collision rate of one grain at temperature `T` (Enskog): `4 n D^2 g0 sqrt(pi T)`, Carnahan and Starling's `g0`.
fn enskog(solid_fraction: f64, temperature: f64) -> f64 {
    let g0 = (1.0 - 0.5 * solid_fraction) / (1.0 - solid_fraction).powi(3);
    4.0 * 6.0 / PI * solid_fraction * g0 * (PI * temperature).sqrt()
}

/// 60 collisions of each of 3000 grains: the statistical error is 0.3 %, that of `g0` below 0.5 %.
#[test]
fn elastic_grains_hit_at_enskogs_rate_and_keep_their_energy() {
    for solid_fraction in [0.05, 0.2, 0.4] {
        let (model, grains) = gas(3000, solid_fraction, 1.0, 0.0);
        let mut engine = EventDriven::new(&model, &CellState::new(&model, &grains)).unwrap();
        engine.advance_collisions(30_000);
        let (time, collisions) = (engine.tally().time, engine.tally().pair_collisions);
        engine.advance_collisions(90_000);
        let rate = 2.0 * (engine.tally().pair_collisions - collisions) as f64 / 3000.0 / (engine.tally().time - time);
        let expected = enskog(solid_fraction, engine.grains().temperature());
        assert!((rate / expected - 1.0).abs() < 0.01, "{solid_fraction}: {rate} {expected}");
        let after = engine.grains();
        assert!((after.energy(&model) / grains.energy(&model) - 1.0).abs() < 1e-12);
        assert!((after.momentum(&model) - grains.momentum(&model)).length() < 1e-9);
        assert!(after.deepest_overlap(&model) < 1e-12 && engine.tally().largest_overlap < 1e-12);
    }
}

/// Haff's law `T = T0 / (1 + (1 - e^2) w0 t / 6)^2` with Enskog's rate `w0` at `T0`. The Sonine correction of the
/// cooling at e = 0.9 is 0.3 %. The gas is dilute: at a solid fraction of 0.1, repeated collisions of the same
/// grains, which Enskog's theory neglects, make cooling 2 % slower by then.
#[test]
fn inelastic_grains_cool_by_haffs_law() {
    let (model, grains) = gas(8000, 0.02, 0.9, 0.0);
    let mut engine = EventDriven::new(&model, &CellState::new(&model, &grains)).unwrap();
    // Two collisions per grain: the velocity distribution relaxes.
    engine.advance_collisions(8000);
    let (start, collisions, hot) = (engine.tally().time, engine.tally().pair_collisions, engine.grains().temperature());
    let rate = (1.0 - 0.81) * enskog(0.02, hot) / 6.0;
    for _ in 0..5 {
        engine.advance(0.5 / rate, &|| true);
        let cooled = (hot / engine.grains().temperature()).sqrt() - 1.0;
        let found = cooled / (rate * (engine.tally().time - start));
        // Relative error of the cooling rate, over at least a unit of its time.
        assert!((found - 1.0).abs() < 0.01 || cooled < 0.9, "{cooled}: {found}");
    }
    // From 1 to a twelfth, with the number of collisions that the rates at all temperatures add up to.
    let expected = 4000.0 * enskog(0.02, hot) * 3.5_f64.ln() / rate;
    assert!(((engine.tally().pair_collisions - collisions) as f64 / expected - 1.0).abs() < 0.01);
}

#[test]
fn energy_lost_is_energy_booked() {
    let (model, grains) = gas(500, 0.3, 0.7, 0.4);
    let mut engine = EventDriven::new(&model, &CellState::new(&model, &grains)).unwrap();
    engine.advance_collisions(20_000);
    let lost = grains.energy(&model) - engine.grains().energy(&model);
    assert!((engine.tally().dissipated / lost - 1.0).abs() < 1e-12);
}

/// So inelastic that clusters collapse: infinitely many collisions in finite time. The contact time makes them finite.
#[test]
fn very_inelastic_grains_do_not_collapse() {
    let (model, grains) = gas(1000, 0.3, 0.2, 0.0);
    let mut engine = EventDriven::new(&model, &CellState::new(&model, &grains)).unwrap();
    engine.advance_collisions(150_000);
    let tally = engine.tally();
    assert!(tally.elastic_collisions > 0 && tally.elastic_collisions < tally.pair_collisions);
    assert!(engine.grains().deepest_overlap(&model) < 1e-12);
}

#[test]
fn the_same_start_gives_the_same_bits() {
    let twice = [0, 1].map(|_| {
        let (model, grains) = gas(400, 0.3, 0.9, 0.3);
        let mut engine = EventDriven::new(&model, &CellState::new(&model, &grains)).unwrap();
        engine.advance_collisions(5000);
        engine.grains()
    });
    assert_eq!(twice[0], twice[1]);
    let (model, _) = gas(400, 0.3, 0.9, 0.3);
    assert_ne!(model.pack(400, 1).unwrap(), model.pack(400, 2).unwrap());
}

/// `cargo test --release -p fcm-solve-granular --test all shear_cell_gas -- --ignored`: about a quarter of a minute.
#[test]
#[ignore = "heavy"]
fn ten_million_hits_leave_no_overlap() {
    let (model, grains) = gas(10_000, 0.5, 1.0, 0.0);
    let mut engine = EventDriven::new(&model, &CellState::new(&model, &grains)).unwrap();
    for _ in 0..10 {
        engine.advance_collisions(1_000_000);
        assert!(engine.grains().deepest_overlap(&model) < 1e-12);
    }
    assert!(engine.tally().largest_overlap < 1e-12);
    assert!((engine.grains().energy(&model) / grains.energy(&model) - 1.0).abs() < 1e-11);
}
