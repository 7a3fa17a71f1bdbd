//! Runs of members in child processes of this program.

use super::outcome::ProcessOutcome;
use anyhow::Context;
use run::FamilyFolder;
use scene::{Family, Member};
use std::fs::OpenOptions;
use std::io::Write;
use std::os::unix::process::CommandExt;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Child process that runs a member.
pub struct Running<'a> {
    /// Member that is run.
    pub member: &'a Member,
    /// Number of threads of the process.
    pub threads: usize,
    /// Start of the process.
    pub began: Instant,
    child: Child,
    steps_taken: PathBuf,
}

/// Settings shared by the processes of members.
pub struct Launch<'a> {
    pub family: &'a Family,
    pub folder: &'a FamilyFolder,
    pub accepted: &'a [String],
    /// Time limit of the process, if any.
    pub time: Option<Duration>,
}

impl<'a> Running<'a> {
    /// Starts or continues a member on `threads` threads. Its messages go to a log in its folder.
    pub fn start(member: &'a Member, threads: usize, launch: &Launch) -> anyhow::Result<Self> {
        let (out, log) = (launch.folder.member(member), launch.folder.log(member));
        let steps_taken = out.join(".steps-taken");
        let scene = launch.family.scene(member)?;
        let open = || OpenOptions::new().create(true).append(true).open(&log);
        let [log, said] = [open(), open()].map(|file| file.with_context(|| format!("can't write {}", log.display())));
        // Removes the file of an earlier process, if there is one.
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
        // In a process group of its own, the child does not receive Ctrl-C: this program forwards it.
        command.process_group(0);
        end_with_parent(&mut command);
        let mut child = command.spawn().with_context(|| format!("can't start {member}"))?;
        if let Some(mut input) = child.stdin.take() {
            // If the process ends before it has read its scene, its log has the reason.
            let _ = input.write_all(scene.text().as_bytes());
        }
        Ok(Self { member, threads, began: Instant::now(), child, steps_taken })
    }

    /// Asks the process to stop after its next checkpoint.
    pub fn ask_to_stop(&self) {
        // SAFETY: the signal goes to a child that has not been waited for, so its process id is not reused.
        unsafe {
            libc::kill(self.child.id() as libc::pid_t, libc::SIGTERM);
        }
    }

    /// Outcome of the process, if it has ended.
    pub fn outcome(&mut self, folder: &FamilyFolder) -> anyhow::Result<Option<ProcessOutcome>> {
        let Some(status) = self.child.try_wait().with_context(|| format!("can't wait for {}", self.member))? else {
            return Ok(None);
        };
        let steps = std::fs::read_to_string(&self.steps_taken).ok().and_then(|text| text.trim().parse().ok());
        let _ = std::fs::remove_file(&self.steps_taken);
        Ok(Some(ProcessOutcome::of(status, steps, || folder.error(self.member))))
    }
}

/// Has the child killed when this process is killed, since nobody would stop it then.
#[cfg(target_os = "linux")]
fn end_with_parent(command: &mut Command) {
    let parent = std::process::id();
    // SAFETY: between fork and exec, only system calls are made that do not allocate memory.
    unsafe {
        command.pre_exec(move || {
            if libc::prctl(libc::PR_SET_PDEATHSIG, libc::SIGKILL) != 0 {
                return Err(std::io::Error::last_os_error());
            }
            // The parent may have ended before the call.
            if libc::getppid() as u32 == parent { Ok(()) } else { Err(std::io::Error::from_raw_os_error(libc::ESRCH)) }
        });
    }
}

#[cfg(not(target_os = "linux"))]
fn end_with_parent(_: &mut Command) {}
