//! Positions given by a user.

use crate::{Comm, Incoming, Outgoing, Quaternion, Vector, block};
use bytemuck::Pod;

/// Positions from a file or a caller, optionally with radii, species and orientations.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct GivenPositions {
    /// Their source, for messages.
    pub name: String,
    /// Positions.
    pub positions: Vec<Vector>,
    /// Radii, if they are known.
    pub radii: Option<Vec<f64>>,
    /// Species as indices from 0, if they are known.
    pub species: Option<Vec<u32>>,
    /// Orientations, if they are known.
    pub orientations: Option<Vec<Quaternion>>,
}

impl GivenPositions {
    /// Divides those of the first rank among all ranks in blocks, see [`block`]; returns this rank's block, without
    /// the name, and the number of all positions. Collective.
    #[must_use]
    pub fn divided(self, comm: &Comm) -> (Self, usize) {
        let Self { name: _, positions, radii, species, orientations } = self;
        let known = [radii.is_some(), species.is_some(), orientations.is_some()].map(usize::from);
        let mut facts = vec![positions.len(), known[0], known[1], known[2]];
        comm.broadcast(&mut facts);
        let division = Division { count: facts[0], comm };
        let own = Self {
            name: String::new(),
            positions: division.of(positions),
            radii: division.of_known(facts[1], radii),
            species: division.of_known(facts[2], species),
            orientations: division.of_known(facts[3], orientations),
        };
        (own, division.count)
    }
}

/// Division of lists of the first rank in blocks.
struct Division<'a> {
    count: usize,
    comm: &'a Comm,
}

impl Division<'_> {
    fn of<T: Pod>(&self, list: Vec<T>) -> Vec<T> {
        let ranks = self.comm.size();
        if ranks == 1 {
            return list;
        }
        let length = |rank: usize| block(self.count, ranks, rank).len();
        let mut own = vec![T::zeroed(); length(self.comm.rank())];
        let leaving: Vec<usize> = (0..ranks).map(|rank| if self.comm.is_first() { length(rank) } else { 0 }).collect();
        let arriving: Vec<usize> = (0..ranks).map(|rank| if rank == 0 { own.len() } else { 0 }).collect();
        let sent = Outgoing { values: &list[..leaving.iter().sum()], counts: &leaving };
        self.comm.send_receive(sent, Incoming { room: &mut own, counts: &arriving });
        own
    }

    /// The same for a list that the first rank has if the number is not 0.
    fn of_known<T: Pod>(&self, is_known: usize, list: Option<Vec<T>>) -> Option<Vec<T>> {
        (is_known > 0).then(|| self.of(list.unwrap_or_default()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_of_the_ranks_are_the_whole_in_its_order() {
        let numbers = |count: usize| (0..count).map(|n| n as f64);
        let whole = |count: usize| GivenPositions {
            name: "a file".to_owned(),
            positions: numbers(count).map(Vector::splat).collect(),
            radii: Some(numbers(count).collect()),
            species: None,
            orientations: Some(numbers(count).map(|w| Quaternion { w, v: Vector::ZERO }).collect()),
        };
        for (count, ranks) in [(7, 1), (7, 3), (2, 4), (0, 2)] {
            let parts = Comm::threads(ranks, |comm| {
                let first = if comm.is_first() { whole(count) } else { GivenPositions::default() };
                first.divided(&comm)
            });
            let mut joined = GivenPositions { name: "a file".to_owned(), ..parts[0].0.clone() };
            for (part, all) in &parts {
                assert_eq!(*all, count);
                assert!(part.species.is_none() && part.positions.len() <= count.div_ceil(ranks));
            }
            for (part, _) in &parts[1..] {
                joined.positions.extend(&part.positions);
                joined.radii.as_mut().unwrap().extend(part.radii.as_ref().unwrap());
                joined.orientations.as_mut().unwrap().extend(part.orientations.as_ref().unwrap());
            }
            assert_eq!(joined, whole(count));
        }
    }
}
