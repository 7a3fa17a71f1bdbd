//! Environment variables by which a launcher such as `mpirun` or `srun` describes a process.

/// Description of how this process was started.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Launcher {
    /// Processes of the job.
    pub(super) job: Job,
    /// Whether the launcher enabled them to find each other.
    pub(super) connects: bool,
    /// Rank of this process.
    rank: usize,
    /// Number of them on this machine.
    pub(super) ranks_here: usize,
    /// Cores that a batch queue granted to this process.
    pub(super) cores: Option<usize>,
}

/// Processes that a launcher started.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Job {
    /// This process alone, without a launcher.
    Alone,
    /// This number of them.
    Of(usize),
    /// An unknown number of them.
    Unknown,
}

/// Variables with the number of processes of a job: Open MPI, MVAPICH, Spectrum MPI, and launchers with PMI, which
/// are MPICH, Intel MPI and Slurm.
const SIZES: [&str; 5] = ["OMPI_COMM_WORLD_SIZE", "MV2_COMM_WORLD_SIZE", "JSM_NAMESPACE_SIZE", "PMI_SIZE", "PMIX_SIZE"];
const RANKS: [&str; 5] = ["OMPI_COMM_WORLD_RANK", "MV2_COMM_WORLD_RANK", "JSM_NAMESPACE_RANK", "PMI_RANK", "PMIX_RANK"];
const RANKS_HERE: [&str; 4] =
    ["OMPI_COMM_WORLD_LOCAL_SIZE", "MV2_COMM_WORLD_LOCAL_SIZE", "JSM_NAMESPACE_LOCAL_SIZE", "MPI_LOCALNRANKS"];

/// Variables any of which means that processes can find each other.
const CONNECTIONS: [&str; 6] = ["PMIX_RANK", "PMIX_NAMESPACE", "PMI_RANK", "PMI_FD", "PMI_CONTROL_PORT", "PALS_RANKID"];

/// Slurm's steps from this number on are not started by `srun`: the batch script, the shell of `salloc`.
const SPECIAL_STEPS: usize = 0xffff_fff0;

impl Launcher {
    /// Reads the environment of this process.
    pub fn of_this_process() -> Self {
        Self::of(&|name| std::env::var(name).ok())
    }

    fn of(variable: &dyn Fn(&str) -> Option<String>) -> Self {
        let number = |name: &str| variable(name)?.trim().parse::<usize>().ok();
        let first = |names: &[&str]| names.iter().find_map(|name| number(name));
        let step = number("SLURM_STEP_ID").filter(|&step| step < SPECIAL_STEPS);
        let in_step = |name: &str| step.and_then(|_| number(name));
        let size = first(&SIZES);
        let connects = size.is_some() || CONNECTIONS.iter().any(|name| variable(name).is_some());
        let job = match size.or_else(|| in_step("SLURM_STEP_NUM_TASKS")) {
            Some(1) if !connects => Job::Alone,
            Some(size) => Job::Of(size),
            None if connects => Job::Unknown,
            None => Job::Alone,
        };
        let tasks = step.and(variable("SLURM_STEP_TASKS_PER_NODE"));
        let here = tasks.and_then(|list| item(&list, number("SLURM_NODEID").unwrap_or(0)));
        let ranks_here = first(&RANKS_HERE).or(here).unwrap_or(1).max(1);
        let cores = number("SLURM_CPUS_PER_TASK").or_else(|| Some(number("SLURM_CPUS_ON_NODE")? / ranks_here));
        let cores = cores.filter(|_| variable("SLURM_JOB_ID").is_some()).map(|cores| cores.max(1));
        let rank = first(&RANKS).or_else(|| in_step("SLURM_PROCID")).unwrap_or(0);
        Self { job, connects, rank, ranks_here, cores }
    }

    /// Whether this is the first of the processes that were started.
    pub fn is_first(&self) -> bool {
        self.rank == 0
    }
}

/// Item of a list in Slurm's notation: `2(x3),1` stands for 2, 2, 2, 1.
fn item(list: &str, index: usize) -> Option<usize> {
    let mut left = index;
    for part in list.split(',') {
        let (value, times) = part.split_once("(x").unwrap_or((part, "1)"));
        let times: usize = times.strip_suffix(')')?.parse().ok()?;
        if left < times {
            return value.trim().parse().ok();
        }
        left -= times;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The launcher of an environment written as `NAME=value NAME=value`.
    fn of(environment: &str) -> Launcher {
        let find = |name: &str| {
            let mut pairs = environment.split_whitespace().map(|pair| pair.split_once('=').unwrap());
            pairs.find(|(key, _)| *key == name).map(|(_, value)| value.to_owned())
        };
        Launcher::of(&find)
    }

    const STEP: &str = "SLURM_JOB_ID=5 SLURM_STEP_ID=0 SLURM_STEP_NUM_TASKS=4 SLURM_NTASKS=4 SLURM_PROCID=3 \
        SLURM_NODEID=1 SLURM_STEP_TASKS_PER_NODE=3,1 SLURM_CPUS_ON_NODE=8";

    #[test]
    fn every_launcher_says_how_many_it_started() {
        let cases = [
            ("", Job::Alone, false),
            ("OMPI_COMM_WORLD_SIZE=3 OMPI_COMM_WORLD_RANK=3 PMIX_RANK=3", Job::Of(3), true),
            ("PMI_SIZE=7 PMI_RANK=3 PMI_FD=5", Job::Of(7), true),
            ("MV2_COMM_WORLD_SIZE=2 MV2_COMM_WORLD_RANK=3", Job::Of(2), true),
            ("PMIX_RANK=3 PMIX_NAMESPACE=x", Job::Unknown, true),
            (STEP, Job::Of(4), false),
            (&format!("{STEP} PMIX_RANK=3"), Job::Of(4), true),
            (&format!("{STEP} PMI_SIZE=4 PMI_RANK=3 PMI_FD=11"), Job::Of(4), true),
            // Under mpirun in a step of srun, mpirun's numbers count.
            (&format!("{STEP} OMPI_COMM_WORLD_SIZE=9 OMPI_COMM_WORLD_RANK=3"), Job::Of(9), true),
        ];
        for (environment, job, connects) in cases {
            let launcher = of(environment);
            assert_eq!((launcher.job, launcher.connects), (job, connects), "{environment}");
            assert_eq!(launcher.is_first(), environment.is_empty(), "{environment}");
        }
    }

    /// The variables of the job are set, but nothing started several processes.
    #[test]
    fn scripts_and_shells_of_slurm_are_one_process() {
        let job = "SLURM_JOB_ID=5 SLURM_NTASKS=4 SLURM_NPROCS=4 SLURM_TASKS_PER_NODE=4 SLURM_PROCID=0";
        let special = |step: u32| format!("{job} SLURM_STEP_ID={step} SLURM_STEP_NUM_TASKS=4");
        let one = format!("{job} SLURM_STEP_ID=0 SLURM_STEP_NUM_TASKS=1");
        for environment in [job.to_owned(), special(0xffff_fffa), special(0xffff_fffb), one.clone()] {
            assert_eq!(of(&environment).job, Job::Alone, "{environment}");
        }
        assert_eq!(of(&format!("{one} PMIX_RANK=0")).job, Job::Of(1));
    }

    #[test]
    fn cores_are_those_of_the_queue() {
        let cases = [
            ("SLURM_CPUS_PER_TASK=3", None),
            (STEP, Some(8)),
            ("SLURM_JOB_ID=5 SLURM_CPUS_ON_NODE=6", Some(6)),
            ("SLURM_JOB_ID=5 SLURM_CPUS_ON_NODE=6 SLURM_CPUS_PER_TASK=2", Some(2)),
            ("SLURM_JOB_ID=5 SLURM_CPUS_ON_NODE=6 OMPI_COMM_WORLD_SIZE=8 OMPI_COMM_WORLD_LOCAL_SIZE=4", Some(1)),
            ("SLURM_JOB_ID=5 SLURM_CPUS_ON_NODE=2 MPI_LOCALNRANKS=4 PMI_SIZE=4", Some(1)),
            (
                "SLURM_JOB_ID=5 SLURM_STEP_ID=0 SLURM_CPUS_ON_NODE=9 SLURM_STEP_TASKS_PER_NODE=2(x3),3 SLURM_NODEID=3",
                Some(3),
            ),
        ];
        for (environment, cores) in cases {
            assert_eq!(of(environment).cores, cores, "{environment}");
        }
    }

    #[test]
    fn lists_of_slurm_are_read_item_by_item() {
        let items: Vec<_> = (0..6).map(|index| item("2(x3),1,5", index)).collect();
        assert_eq!(items, [Some(2), Some(2), Some(2), Some(1), Some(5), None]);
        for wrong in ["", "x", "2(x", "2(xa)", "2(x3"] {
            assert_eq!(item(wrong, 0), None, "{wrong}");
        }
    }
}
