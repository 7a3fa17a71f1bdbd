//! Manual pages and shell completions, generated from the definition of the command line.

use crate::streams;
use anyhow::Context;
use clap::Command;
use clap_complete::Shell;
use domain::Comm;
use std::path::{Path, PathBuf};

/// Manual pages to write.
#[derive(clap::Args)]
pub struct Pages {
    /// Write the pages of all commands into this folder, instead of the first one to the standard output
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Prints the manual page of the program, or writes those of all commands. Collective.
pub fn pages(asked: &Pages, program: Command, comm: &Comm) -> anyhow::Result<()> {
    let Some(folder) = &asked.out else {
        let mut page = Vec::new();
        clap_mangen::Man::new(program).render(&mut page)?;
        return streams::print(comm, &String::from_utf8_lossy(&page));
    };
    let written = if comm.is_first() { write(program, folder) } else { Ok(()) };
    Ok(comm.agree(written.map_err(|error| format!("{error:#}")))?)
}

fn write(program: Command, folder: &Path) -> anyhow::Result<()> {
    let written = std::fs::create_dir_all(folder).and_then(|()| clap_mangen::generate_to(program, folder));
    written.with_context(|| format!("can't write manual pages into {}", folder.display()))
}

/// Prints a script that completes commands in a shell. Collective.
pub fn completions(shell: Shell, program: &mut Command, comm: &Comm) -> anyhow::Result<()> {
    let mut script = Vec::new();
    clap_complete::generate(shell, program, "fcm-solve", &mut script);
    // For bash, clap_complete is inconsistent in the name of a command's state if the program's name has a hyphen.
    let script = String::from_utf8_lossy(&script).replace("fcm__subcmd__solve", "fcm__solve");
    streams::print(comm, &script)
}
