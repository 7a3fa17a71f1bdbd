//! The program as a process with limits.

use rustix::process::{Pid, Resource, Rlimit, Signal, kill_process, prlimit};
use std::ffi::OsString;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

/// Limits of a process.
#[derive(Debug, Clone, Copy)]
pub struct ProcessLimits {
    /// Address space in bytes.
    pub memory: u64,
    /// Time after which a run is asked to stop.
    pub patience: Duration,
    /// Processor time in seconds after which any other command must have ended, and within which a
    /// run must stop when asked to.
    pub processor_seconds: u64,
}

/// The program.
#[derive(Debug)]
pub struct Program {
    /// Path of the program.
    pub path: PathBuf,
    /// Limits of its processes.
    pub limits: ProcessLimits,
}

/// A process that has ended.
#[derive(Debug)]
pub struct Ended {
    /// Its arguments.
    pub arguments: Vec<OsString>,
    /// Exit status.
    pub status: ExitStatus,
    /// Standard output.
    pub stdout: String,
    /// Standard error.
    pub stderr: String,
    /// Whether it was asked to stop.
    pub asked_to_stop: bool,
}

impl Program {
    /// The same program with all time limits multiplied.
    pub fn with_patience(&self, times: u32) -> Self {
        let ProcessLimits { memory, patience, processor_seconds } = self.limits;
        let processor_seconds = processor_seconds * u64::from(times);
        Self {
            path: self.path.clone(),
            limits: ProcessLimits { memory, patience: patience * times, processor_seconds },
        }
    }

    /// Runs the program in a folder, which is also that of the machine's costs.
    pub fn run(&self, folder: &Path, arguments: &[OsString]) -> anyhow::Result<Ended> {
        let [out, err] = ["stdout", "stderr"].map(|name| folder.join(name));
        let mut child = Command::new(&self.path)
            .args(arguments)
            .current_dir(folder)
            .env("XDG_CACHE_HOME", folder)
            .env("RAYON_NUM_THREADS", "1")
            .stdin(Stdio::null())
            .stdout(File::create(&out)?)
            .stderr(File::create(&err)?)
            .spawn()?;
        let may_take_long = arguments.first().is_some_and(|first| first == "run" || first == "resume");
        let (status, asked_to_stop) = self.wait(&mut child, may_take_long)?;
        let read = |path: &Path| Ok::<_, std::io::Error>(String::from_utf8_lossy(&std::fs::read(path)?).into_owned());
        Ok(Ended { arguments: arguments.to_vec(), status, stdout: read(&out)?, stderr: read(&err)?, asked_to_stop })
    }

    fn wait(&self, child: &mut Child, may_take_long: bool) -> anyhow::Result<(ExitStatus, bool)> {
        let pid = Pid::from_child(child);
        let ProcessLimits { memory, patience, processor_seconds } = self.limits;
        // A run is asked to stop after a time on all cores.
        let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get) as u64;
        let processor_seconds = if may_take_long { processor_seconds * (cores + 1) } else { processor_seconds };
        for (resource, most) in [(Resource::As, memory), (Resource::Cpu, processor_seconds), (Resource::Core, 0)] {
            // The process may have ended already.
            let _ = prlimit(Some(pid), resource, Rlimit { current: Some(most), maximum: Some(most) });
        }
        let (start, mut asked, mut nap) = (Instant::now(), false, Duration::from_millis(1));
        loop {
            if let Some(status) = child.try_wait()? {
                return Ok((status, asked));
            }
            if may_take_long && !asked && start.elapsed() > patience {
                kill_process(pid, Signal::TERM)?;
                asked = true;
            }
            if start.elapsed() > 12 * patience {
                child.kill()?;
            }
            std::thread::sleep(nap);
            nap = (nap * 2).min(Duration::from_millis(20));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verdict::{Names, ProcessEnd, judge};

    /// Verdict on a shell that executes these lines as the command `run` or another one.
    fn judged(name: &str, lines: &str) -> Result<ProcessEnd, String> {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join(name), lines).unwrap();
        let limits = ProcessLimits { memory: 1 << 30, patience: Duration::from_secs(1), processor_seconds: 1 };
        let shell = Program { path: PathBuf::from("/bin/sh"), limits };
        judge(&shell.run(folder.path(), &[name.into()]).unwrap(), &Names::default())
    }

    #[test]
    #[ignore = "heavy"]
    fn what_does_not_end_hangs() {
        assert!(judged("check", "while :; do :; done").unwrap_err().contains("hang"));
        assert!(judged("run", "trap '' TERM; while :; do :; done").unwrap_err().contains("hang"));
        assert!(judged("check", "exec sleep 60").unwrap_err().contains("hang"));
    }

    #[test]
    fn runs_that_take_long_are_asked_to_stop() {
        assert_eq!(judged("run", "trap 'exit 75' TERM; while :; do sleep 0.1; done"), Ok(ProcessEnd::Stopped));
        assert_eq!(judged("check", "echo 1.5"), Ok(ProcessEnd::Answered));
    }
}
