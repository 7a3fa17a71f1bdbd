//! Measured parts of a process's resident memory, which can't be computed: on Debian 12 with Open MPI 4.1 and HDF5
//! 1.10, by `scripts/validate memory`.

/// The program itself and the libraries that it is linked with, without any data of a scene.
const PROGRAM: f64 = 21e6 + Process::CHECKS;

/// Memory of MPI in each process that a launcher starts.
const LAUNCHED: f64 = 7e6;

/// Memory of HDF5 in the process that keeps files open to write to them, without chunks.
const WRITES: f64 = 7e6;

/// Memory held by the allocator over memory allocated at the peak, because of fragmentation.
const ALLOCATOR: f64 = 1.1;

/// The kind of a process, which determines the memory of its libraries.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Process {
    /// Whether a launcher started it together with others.
    pub is_launched: bool,
    /// Whether it keeps files open.
    pub writes: bool,
}

impl Process {
    /// Part of the program of a build that checks its arithmetic, as builds for development and for tests do.
    pub const CHECKS: f64 = if cfg!(debug_assertions) { 8e6 } else { 0.0 };

    /// A single process that keeps files open.
    pub const ALONE: Self = Self { is_launched: false, writes: true };

    /// One of several ranks, the first of which keeps files open.
    pub fn of(rank: usize, ranks: usize) -> Self {
        Self { is_launched: ranks > 1, writes: rank == 0 }
    }

    /// Resident memory at the peak, given the bytes allocated then.
    pub fn resident(self, allocated: f64) -> f64 {
        let launched = if self.is_launched { LAUNCHED } else { 0.0 };
        let writes = if self.writes { WRITES } else { 0.0 };
        PROGRAM + launched + writes + ALLOCATOR * allocated
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_process_takes_more_than_it_allocates() {
        let [alone, first, other] = [Process::ALONE, Process::of(0, 2), Process::of(1, 2)];
        assert_eq!(Process::of(0, 1), alone);
        for process in [alone, first, other] {
            let part = process.resident(1e9) - process.resident(0.0);
            assert!((1e9..1.5e9).contains(&part), "{part}");
        }
        let programs = [alone, first, other].map(|process| process.resident(0.0) as usize);
        let expected = [PROGRAM + WRITES, PROGRAM + LAUNCHED + WRITES, PROGRAM + LAUNCHED];
        assert_eq!(programs, expected.map(|bytes| bytes as usize));
    }
}
