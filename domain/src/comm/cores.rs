//! Number of cores of a rank.

use super::{Backend, Comm, Launcher};

/// Largest number of processors of a machine that is supported.
const MOST: usize = 1024;

/// Processors that a process may use, one bit for each.
type Mask = [u64; MOST / 64];

impl Comm {
    /// Number of cores for the threads of this rank: those to which it is bound, divided among the ranks on this
    /// machine bound to the same ones, and at most the number granted by the batch queue. At least 1. Collective.
    pub fn cores(&self) -> usize {
        let granted = std::thread::available_parallelism().map_or(1, usize::from);
        let launcher = Launcher::of_this_process();
        let share = match (&self.backend, mask()) {
            (Backend::Processes(_), Some(mine)) => {
                let machine = self.machine();
                let masks = machine.all_gather(&[mine]);
                // A quota of processor time may grant less than the mask does.
                let count = mine.iter().map(|word| word.count_ones() as usize).sum();
                let quota = if granted < count { granted / masks.len() } else { count };
                share(&mine, &masks).min(quota)
            }
            _ if launcher.cores.is_some() => granted,
            _ => granted / launcher.ranks_here,
        };
        launcher.cores.map_or(share, |cores| share.min(cores)).max(1)
    }
}

/// Number of processors of a mask, each divided by the number of masks that contain it.
fn share(mine: &Mask, masks: &[Mask]) -> usize {
    let has = |mask: &Mask, core: usize| mask[core / 64] >> (core % 64) & 1 == 1;
    let part = |core: usize| 1.0 / masks.iter().filter(|mask| has(mask, core)).count() as f64;
    let parts: f64 = (0..MOST).filter(|&core| has(mine, core)).map(part).sum();
    (parts + 1e-9) as usize
}

#[cfg(all(feature = "mpi", target_os = "linux"))]
fn mask() -> Option<Mask> {
    let set = rustix::thread::sched_getaffinity(None).ok()?;
    let mut mask = [0; MOST / 64];
    (0..MOST).filter(|&core| set.is_set(core)).for_each(|core| mask[core / 64] |= 1 << (core % 64));
    Some(mask)
}

/// Unknown on other systems.
#[cfg(not(all(feature = "mpi", target_os = "linux")))]
fn mask() -> Option<Mask> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A mask of the cores from `first` on.
    fn cores(first: usize, count: usize) -> Mask {
        let mut mask = [0; MOST / 64];
        (first..first + count).for_each(|core| mask[core / 64] |= 1 << (core % 64));
        mask
    }

    #[test]
    fn bound_cores_are_not_shared_out_again() {
        let bound = [cores(0, 1), cores(1, 1), cores(60, 8), cores(68, 8)];
        assert_eq!(bound.map(|mine| share(&mine, &bound)), [1, 1, 8, 8]);
    }

    #[test]
    fn common_cores_are_shared_out() {
        let free = [cores(0, 8); 3];
        assert_eq!(share(&free[0], &free), 2);
        assert_eq!(share(&cores(5, 64), &[cores(5, 64); 64]), 1);
        // Two on one half of the machine, one on all of it.
        let mixed = [cores(0, 4), cores(0, 4), cores(0, 8)];
        assert_eq!(mixed.map(|mine| share(&mine, &mixed)), [1, 1, 5]);
    }

    #[test]
    fn there_is_a_core_for_everybody() {
        assert!(Comm::alone().cores() >= 1);
    }
}
