//! Memory that the ranks on one machine need together.

use super::Comm;
use crate::readable_bytes;
use crate::room::{Room, Taken};

/// What a rank will need at its peak, in bytes.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Need {
    /// Resident memory.
    pub resident: f64,
    /// Of it, what stands in the memory of other ranks on the same machine.
    pub reached: f64,
    /// Memory of other ranks that is mapped without being resident.
    pub mapped: f64,
}

/// More memory is needed than there is.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error(
    "{ranks} rank(s) on one machine would take {} of memory at their peak, {} of it still to come, but {limit} leaves {}",
    readable_bytes(*needed), readable_bytes(*to_come), readable_bytes(*left)
)]
pub struct NoRoom {
    /// Ranks that share the limit.
    pub ranks: usize,
    /// What they would take.
    pub needed: f64,
    /// What they have not taken yet.
    pub to_come: f64,
    /// What there is.
    pub left: f64,
    /// What limits it.
    pub limit: String,
}

impl Comm {
    /// Refuses what the ranks of this one's machine, or this rank by its own limits, have no memory for. Collective; each
    /// rank has its own answer.
    pub fn check_room(&self, need: Need) -> Result<(), NoRoom> {
        let taken = Taken::now();
        let resident = taken.map_or(0.0, |taken| taken.resident);
        let to_come = (need.resident - resident).max(0.0);
        let machine = self.machine();
        // A rank's share of the memory of others is counted by those.
        let mut sums = [need.resident - need.reached, (to_come - need.reached).max(0.0)];
        machine.sum(&mut sums);
        let of_all = Self::fits(machine.size(), sums, Room::of_machine());
        of_all.and_then(|()| Self::fits(1, [need.resident, to_come], Room::of_process(need.mapped)))
    }

    /// Refuses what a number of ranks, which are only thought of, would have no memory for on this machine.
    pub fn check_room_of(needs: &[Need]) -> Result<(), NoRoom> {
        let needed = needs.iter().map(|need| need.resident - need.reached).sum();
        let fits = Self::fits(needs.len(), [needed; 2], Room::of_machine());
        let one = |need: &Need| Self::fits(1, [need.resident; 2], Room::of_process(need.mapped));
        fits.and_then(|()| needs.iter().try_for_each(one))
    }

    fn fits(ranks: usize, [needed, to_come]: [f64; 2], room: Option<Room>) -> Result<(), NoRoom> {
        match room {
            Some(Room { bytes: left, limit }) if to_come > left => Err(NoRoom { ranks, needed, to_come, left, limit }),
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_ranks_need_together_is_refused_on_all_of_them() {
        let half =
            Need { resident: 0.7 * Room::of_machine().map_or(f64::INFINITY, |room| room.bytes), ..Need::default() };
        if !half.resident.is_finite() {
            return;
        }
        assert!(Comm::alone().check_room(half).is_ok());
        let refused = Comm::threads(2, |comm| comm.check_room(half).unwrap_err());
        assert!(refused.iter().all(|error| error.ranks == 2 && error.to_come > error.left), "{refused:?}");
        let shared = Need { reached: 0.5 * half.resident, ..half };
        assert!(Comm::threads(2, |comm| comm.check_room(shared)).iter().all(Result::is_ok));
        assert!(Comm::check_room_of(&[half, half]).unwrap_err().to_string().contains("2 rank(s)"));
    }
}
