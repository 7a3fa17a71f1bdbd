//! A gas of hard spheres in the event-driven engine, run long enough to time it and to compare it with kinetic
//! theory. Prints one line of JSON. See `scripts/validate grains`.
//!
//!     gas hit COUNT SOLID_FRACTION HITS          elastic: speed, rate of collisions over Enskog's, overlap, energy
//!     gas cool COUNT SOLID_FRACTION RESTITUTION  inelastic: temperature over Haff's until a twelfth is left

use domain::Vector;
use granular::shear_cell::{CellModel, CellState, CollisionEngine, CollisionRule, EventDriven, FrictionLaw, Grains};
use std::error::Error;
use std::f64::consts::PI;

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    match words.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["hit", count, fraction, collisions] => hit(count.parse()?, fraction.parse()?, collisions.parse()?),
        ["cool", count, fraction, restitution] => cool(count.parse()?, fraction.parse()?, restitution.parse()?),
        _ => Err("gas hit | cool, see the head of its source".into()),
    }
}

/// Smooth grains of diameter 1 and mass 1 in a periodic cube, at random positions and at a temperature of 1.
fn gas(count: usize, solid_fraction: f64, restitution: f64) -> Result<(CellModel, Grains), Box<dyn Error>> {
    let edge = (count as f64 * PI / 6.0 / solid_fraction).cbrt();
    let contact = CollisionRule { restitution, friction: 0.0, law: FrictionLaw::Box };
    let model = CellModel::gas(Vector::splat(edge), 1.0, 6.0 / PI, contact)?;
    let mut grains = model.pack(count, 11)?;
    grains.set_velocities(&model, 1.0, 12);
    Ok((model, grains))
}

/// Collision rate of one grain at temperature `T` (Enskog): `4 n D^2 g0 sqrt(pi T)` with Carnahan and Starling's `g0`.
fn enskog(solid_fraction: f64, temperature: f64) -> f64 {
    let g0 = (1.0 - 0.5 * solid_fraction) / (1.0 - solid_fraction).powi(3);
    4.0 * 6.0 / PI * solid_fraction * g0 * (PI * temperature).sqrt()
}

/// Makes `collisions` collisions after ten of each grain, in ten parts with a check for overlaps after each part.
fn hit(count: usize, solid_fraction: f64, collisions: u64) -> Result<(), Box<dyn Error>> {
    let (model, grains) = gas(count, solid_fraction, 1.0)?;
    let mut engine = EventDriven::new(&model, &CellState::new(&model, &grains))?;
    engine.advance_collisions(10 * count as u64);
    let (events, time) = (engine.events(), engine.tally().time);
    let (mut seconds, mut overlap) = (0.0, 0.0_f64);
    for _ in 0..10 {
        let before = processor_seconds()?;
        engine.advance_collisions(collisions / 10);
        seconds += processor_seconds()? - before;
        overlap = overlap.max(engine.grains().deepest_overlap(&model));
    }
    let made = engine.events().collisions - events.collisions;
    let all = engine.events().total() - events.total();
    let rate = 2.0 * made as f64 / count as f64 / (engine.tally().time - time);
    let over_enskog = rate / enskog(solid_fraction, engine.grains().temperature());
    let energy = engine.grains().energy(&model) / grains.energy(&model) - 1.0;
    let overlap = overlap.max(engine.tally().largest_overlap);
    println!(
        "{{\"hits\": {made}, \"events\": {all}, \"seconds\": {seconds}, \"over_enskog\": {over_enskog}, \
         \"overlap\": {overlap:e}, \"energy\": {energy:e}}}"
    );
    Ok(())
}

/// Haff's law `T = T0 / (1 + (1 - e^2) w0 t / 6)^2` with Enskog's rate `w0` at `T0`.
fn cool(count: usize, solid_fraction: f64, restitution: f64) -> Result<(), Box<dyn Error>> {
    let (model, grains) = gas(count, solid_fraction, restitution)?;
    let mut engine = EventDriven::new(&model, &CellState::new(&model, &grains))?;
    engine.advance_collisions(count as u64);
    let (start, hot) = (engine.tally().time, engine.grains().temperature());
    let rate = (1.0 - restitution * restitution) * enskog(solid_fraction, hot) / 6.0;
    let mut rows = Vec::new();
    for _ in 0..10 {
        engine.advance(0.25 / rate, &|| true);
        let (time, temperature) = (rate * (engine.tally().time - start), engine.grains().temperature() / hot);
        rows.push(format!("[{time}, {temperature}, {}]", temperature * (1.0 + time).powi(2)));
    }
    println!("{{\"cooled\": [{}]}}", rows.join(", "));
    Ok(())
}

/// Processor time of this thread so far.
fn processor_seconds() -> Result<f64, Box<dyn Error>> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat")?;
    Ok(text.split_whitespace().next().ok_or("an empty schedstat")?.parse::<f64>()? * 1e-9)
}
