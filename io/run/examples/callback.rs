//! A run that calls a user's function between steps: a scene that comes with the program, observed as it settles.
//!
//!     cargo run --release -p fcm-solve-run --example callback

use domain::Comm;
use scene::{Scene, Template};
use simulation::Simulation;
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let template = Template::named("silica-in-water").ok_or("no such template")?;
    let scene = Scene::parse(template.text, "silica-in-water.toml", &["time.steps=100".to_owned()])?;
    let mut simulation = run::start(&scene, &Comm::alone(), &mut |_| ())?;
    println!("{}", simulation.plan());
    run(&mut *simulation, scene.kind().steps(), |simulation| {
        let mut particles = simulation.frame().particles;
        let velocities = particles.vectors("velocity");
        let mean = velocities.iter().map(|v| v.z).sum::<f64>() / velocities.len() as f64;
        println!("time {:.3} s: mean velocity {mean:.4e} m/s", simulation.clock().time());
    })
}

/// Advances to step `last`, calling `call` every twenty steps.
fn run(simulation: &mut dyn Simulation, last: u64, call: impl Fn(&mut dyn Simulation)) -> Result<(), Box<dyn Error>> {
    while simulation.clock().step() < last {
        let next = (simulation.clock().step() / 20 + 1) * 20;
        simulation.advance(next.min(last))?;
        if simulation.clock().step().is_multiple_of(20) {
            call(simulation);
        }
    }
    Ok(())
}
