//! A member that is run, by a process of this program.

use super::outcome::Outcome;
use anyhow::Context;
use io::{Family, FamilyFolder, Member};
use std::fs::OpenOptions;
use std::io::Write;
use std::os::unix::process::CommandExt;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// The process of a member.
pub struct Running<'a> {
    /// The member.
    pub member: &'a Member,
    /// Cores that it has.
    pub threads: usize,
    /// Its start.
    pub began: Instant,
    child: Child,
    steps_taken: PathBuf,
}

/// The setting in which processes of members are started.
pub struct Launch<'a> {
    pub family: &'a Family,
    pub folder: &'a FamilyFolder,
    pub accepted: &'a [String],
    /// The time that it has, if there is an end.
    pub time: Option<Duration>,
}

impl<'a> Running<'a> {
    /// Starts a member, or goes on with it, on some cores. Its messages go to a log in its folder.
    pub fn start(member: &'a Member, threads: usize, launch: &Launch) -> anyhow::Result<Self> {
        let (out, log) = (launch.folder.member(member), launch.folder.log(member));
        let steps_taken = out.join(".steps-taken");
        let scene = launch.family.scene(member)?;
        let open = || OpenOptions::new().create(true).append(true).open(&log);
        let [log, said] = [open(), open()].map(|file| file.with_context(|| format!("can't write {}", log.display())));
        // One that is not there is none that an earlier process has left.
        let _ = std::fs::remove_file(&steps_taken);
        let mut command = Command::new(std::env::current_exe().context("can't find this program")?);
        command.args(["run", "-", "--continue", "--alone", "--threads", &threads.to_string(), "--out"]).arg(&out);
        command.arg("--steps-taken").arg(&steps_taken);
        command.args(launch.accepted.iter().flat_map(|key| ["--accept", key]));
        command.args([
            "--walltime",
            &launch.time.map_or_else(|| "unlimited".to_owned(), |time| format!("0:{}", time.as_secs())),
        ]);
        command.stdin(Stdio::piped()).stdout(log?).stderr(said?);
        // Ctrl-C goes to this program alone, which passes it on.
        command.process_group(0);
        end_with_parent(&mut command);
        let mut child = command.spawn().with_context(|| format!("can't start {member}"))?;
        if let Some(mut input) = child.stdin.take() {
            // A process that ends before it has read its scene says why in its log.
            let _ = input.write_all(scene.text().as_bytes());
        }
        Ok(Self { member, threads, began: Instant::now(), child, steps_taken })
    }

    /// Asks it to stop after its next checkpoint.
    pub fn ask_to_stop(&self) {
        // SAFETY: a signal is sent to a child that has not been waited for, whose number so is its own.
        unsafe {
            libc::kill(self.child.id() as libc::pid_t, libc::SIGTERM);
        }
    }

    /// Its outcome, if it has ended.
    pub fn outcome(&mut self, folder: &FamilyFolder) -> anyhow::Result<Option<Outcome>> {
        let Some(status) = self.child.try_wait().with_context(|| format!("can't wait for {}", self.member))? else {
            return Ok(None);
        };
        let steps = std::fs::read_to_string(&self.steps_taken).ok().and_then(|text| text.trim().parse().ok());
        let _ = std::fs::remove_file(&self.steps_taken);
        Ok(Some(Outcome::of(status, steps, || folder.error(self.member))))
    }
}

/// Lets a process be killed where this one is: it could not be stopped by anybody who doesn't know of it.
#[cfg(target_os = "linux")]
fn end_with_parent(command: &mut Command) {
    let parent = std::process::id();
    // SAFETY: between fork and exec only calls to the system are made, which need no memory.
    unsafe {
        command.pre_exec(move || {
            if libc::prctl(libc::PR_SET_PDEATHSIG, libc::SIGKILL) != 0 {
                return Err(std::io::Error::last_os_error());
            }
            // The parent may have ended before.
            if libc::getppid() as u32 == parent { Ok(()) } else { Err(std::io::Error::from_raw_os_error(libc::ESRCH)) }
        });
    }
}

#[cfg(not(target_os = "linux"))]
fn end_with_parent(_: &mut Command) {}
