//! Particles in viscous flow by the force-coupling method: the program.

mod args;
mod bench;
mod check;
mod clock;
mod extrapolation;
mod granular;
mod info;
mod integrator;
mod launch;
mod least_repulsion;
mod lubricated;
mod machine;
mod march;
mod mobility;
mod new;
mod number;
mod output;
mod preparing;
mod progress;
mod resume;
mod run;
mod signals;
mod simulation;
mod statistics;
mod stats;
mod suspension;
mod two_sphere;

use args::Args;
use domain::Comm;
use std::process::ExitCode;

fn main() -> ExitCode {
    launch::leave_files_unlocked();
    launch::keep_memory();
    let comm = match Comm::world() {
        Ok(comm) => comm,
        Err(error) => return launch::refused(&error),
    };
    let args = match Args::read() {
        Ok(args) => args,
        Err(message) => return launch::explain(&comm, &message),
    };
    match launch::start_threads(args.threads).and_then(|()| args.command.carry_out(&comm)) {
        Ok(code) => code,
        Err(error) => {
            if comm.is_first() {
                eprintln!("error: {error:#}");
            }
            ExitCode::FAILURE
        }
    }
}
