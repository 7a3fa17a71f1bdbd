//! Command-line program for particles in viscous flow by the force-coupling method.

// `print!` and the like panic if a stream is full or closed; `streams` does not.
#![warn(clippy::print_stdout, clippy::print_stderr)]

mod args;
mod bench;
mod calibrate;
mod causes;
mod check;
mod commands;
mod continuation;
mod converge;
mod crash;
mod export;
mod family;
mod info;
mod launch;
mod manual;
mod mobility;
mod new;
mod number;
mod outlined;
mod part_progress;
mod prepared_scene;
mod progress;
mod report;
mod resume;
mod run;
mod run_loop;
mod sampled_frames;
mod scene_file;
mod signals;
mod stats;
mod stop;
mod streams;
mod trajectory_statistics;
mod two_sphere;
mod walltime;
mod whole_scene;

use args::Args;
use domain::Comm;
use std::process::ExitCode;

fn main() -> ExitCode {
    walltime::starts_now();
    launch::leave_files_unlocked();
    launch::keep_memory();
    launch::survive_long_files();
    crash::name_damaged_files();
    launch::with_stack(carry_out)
}

fn carry_out() -> ExitCode {
    let args = Args::read();
    let is_alone = args.as_ref().is_ok_and(|args| args.alone);
    let comm = match if is_alone { Ok(Comm::alone()) } else { Comm::world() } {
        Ok(comm) => comm,
        Err(error) => return launch::refused(&error),
    };
    let args = match args {
        Ok(args) => args,
        Err(message) => return launch::explain(&comm, &message),
    };
    if args.quiet {
        streams::be_quiet();
    }
    let code = match launch::start_threads(args.threads, &comm).and_then(|()| args.command.carry_out(&comm)) {
        Ok(code) => code,
        Err(error) => launch::failed(comm.is_first(), &error),
    };
    streams::finish_log();
    code
}
