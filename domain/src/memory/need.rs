//! Memory that the ranks of one machine need, compared with what is available.

use super::{AvailableMemory, ProcessMemory, readable_bytes};
use crate::Comm;

/// Memory that a rank will need at its peak, in bytes.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct MemoryNeed {
    /// Resident memory.
    pub resident: f64,
    /// The part of it that belongs to other ranks on the same machine.
    pub remote: f64,
    /// Memory of other ranks that is mapped but not resident.
    pub mapped: f64,
}

/// More memory is needed than is available.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error(
    "{ranks} rank(s) on one machine would take {} of memory at their peak, {} of it still to come, but {limit} leaves \
     {}",
    readable_bytes(*needed), readable_bytes(*to_come), readable_bytes(*left)
)]
pub struct NotEnoughMemory {
    /// Number of ranks that share the limit.
    pub ranks: usize,
    /// Bytes that they need.
    pub needed: f64,
    /// Bytes that they have yet to allocate.
    pub to_come: f64,
    /// Bytes that are available.
    pub left: f64,
    /// Description of the limit.
    pub limit: String,
}

impl Comm {
    /// Refuses needs that exceed the memory of the machine for all its ranks, or the limits of this process.
    /// Collective; the result may differ among ranks.
    pub fn check_memory(&self, need: MemoryNeed) -> Result<(), NotEnoughMemory> {
        let taken = ProcessMemory::now();
        let resident = taken.map_or(0.0, |taken| taken.resident);
        let to_come = (need.resident - resident).max(0.0);
        let machine = self.machine();
        // Memory of other ranks is counted by those.
        let mut sums = [need.resident - need.remote, (to_come - need.remote).max(0.0)];
        machine.sum(&mut sums);
        let of_all = Self::fits(machine.size(), sums, AvailableMemory::of_machine());
        of_all.and_then(|()| Self::fits(1, [need.resident, to_come], AvailableMemory::of_process(need.mapped)))
    }

    /// Refuses the needs of ranks that are not started yet if they exceed the memory of this machine.
    pub fn check_memory_of(needs: &[MemoryNeed]) -> Result<(), NotEnoughMemory> {
        let needed = needs.iter().map(|need| need.resident - need.remote).sum();
        let fits = Self::fits(needs.len(), [needed; 2], AvailableMemory::of_machine());
        let one = |need: &MemoryNeed| Self::fits(1, [need.resident; 2], AvailableMemory::of_process(need.mapped));
        fits.and_then(|()| needs.iter().try_for_each(one))
    }

    fn fits(ranks: usize, [needed, to_come]: [f64; 2], room: Option<AvailableMemory>) -> Result<(), NotEnoughMemory> {
        match room {
            Some(AvailableMemory { bytes: left, limit }) if to_come > left => {
                Err(NotEnoughMemory { ranks, needed, to_come, left, limit })
            }
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_ranks_need_together_is_refused_on_all_of_them() {
        let half = MemoryNeed {
            resident: 0.7 * AvailableMemory::of_machine().map_or(f64::INFINITY, |room| room.bytes),
            ..MemoryNeed::default()
        };
        if !half.resident.is_finite() {
            return;
        }
        assert!(Comm::alone().check_memory(half).is_ok());
        let refused = Comm::threads(2, |comm| comm.check_memory(half).unwrap_err());
        assert!(refused.iter().all(|error| error.ranks == 2 && error.to_come > error.left), "{refused:?}");
        let shared = MemoryNeed { remote: 0.5 * half.resident, ..half };
        assert!(Comm::threads(2, |comm| comm.check_memory(shared)).iter().all(Result::is_ok));
        assert!(Comm::check_memory_of(&[half, half]).unwrap_err().to_string().contains("2 rank(s)"));
    }
}
