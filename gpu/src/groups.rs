//! Groups of spheres whose stiff pairs the preconditioner couples, see `gpu/kernels/groups.h`.

use crate::device::{DeviceError, KernelLaunch};
use crate::far_field::SplitFarField;
use crate::pair_rows::{IN_FLOW, PAIR_NUMBERS};
use bytemuck::{Pod, Zeroable};

/// Largest number of spheres of a group.
const GROUP: usize = 8;

/// Spheres of a block of threads that preconditions.
const BLOCK_MEMBERS: usize = 42;

/// Threads of a block that inverts the matrix of a group.
const INVERT_THREADS: usize = 64;

/// Numbers of the inverses of the matrices of groups, at most, by particle: six rows of a matrix.
pub(crate) const INVERSE_NUMBERS: usize = 36 * GROUP;

/// Pairs are coupled if the force by the other sphere's velocity along the axis exceeds this power of two times the
/// resistance of a single sphere; the strongest come first, and pairs within a factor of two in the order of rows.
const WEAKEST: i32 = -1;
const STRONGEST: i32 = 14;

/// A sphere of a block, with the fields of `gpu/kernels/task.h` in the same order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
struct GroupMember {
    row: i32,
    first: i32,
    count: i32,
    unused: i32,
    inverse: i64,
}

/// No sphere.
const NOBODY: GroupMember = GroupMember { row: -1, first: 0, count: 0, unused: 0, inverse: 0 };

/// Blocks of threads that precondition some particles, however they form groups: all but the last are filled but for a
/// group.
pub(crate) fn group_blocks(particles: usize) -> usize {
    particles.div_ceil(BLOCK_MEMBERS + 1 - GROUP)
}

/// Bytes of the members of the blocks.
pub(crate) fn member_bytes(particles: usize) -> usize {
    size_of::<GroupMember>() * BLOCK_MEMBERS * group_blocks(particles)
}

/// Stiff pairs by rows: where those of a row begin, their other spheres, and their strengths over that of a single
/// sphere.
struct StiffPairs<'a> {
    starts: &'a [i32],
    others: &'a [i32],
    strengths: &'a [f64],
}

/// Groups as sets of rows: the parent of each row, of which that of a group is its first row, and numbers of rows.
struct Joined {
    parents: Vec<usize>,
    counts: Vec<usize>,
}

impl Joined {
    fn root(&mut self, mut row: usize) -> usize {
        while self.parents[row] != row {
            self.parents[row] = self.parents[self.parents[row]];
            row = self.parents[row];
        }
        row
    }

    /// Joins the groups of two rows unless there would be too many rows.
    fn join(&mut self, [a, b]: [usize; 2]) {
        let (a, b) = (self.root(a), self.root(b));
        let count = self.counts[a] + self.counts[b];
        if a != b && count <= GROUP {
            self.parents[a.max(b)] = a.min(b);
            self.counts[a.min(b)] = count;
        }
    }
}

impl StiffPairs<'_> {
    /// Groups of rows: each pair in the order of strength joins those of its spheres.
    fn joined(&self) -> Joined {
        let rows = self.starts.len() - 1;
        let mut of_strength = vec![Vec::new(); (STRONGEST - WEAKEST + 1) as usize];
        for (row, range) in self.starts.windows(2).enumerate() {
            for pair in range[0] as usize..range[1] as usize {
                let (other, power) = (self.others[pair] as usize, self.strengths[pair].abs().log2().floor());
                if row < other && power >= f64::from(WEAKEST) {
                    of_strength[(power as i32).min(STRONGEST).abs_diff(STRONGEST) as usize].push([row, other]);
                }
            }
        }
        let mut joined = Joined { parents: (0..rows).collect(), counts: vec![1; rows] };
        of_strength.into_iter().flatten().for_each(|pair| joined.join(pair));
        joined
    }
}

/// Members of all blocks, groups in the order of their first rows.
fn members(pairs: &StiffPairs) -> Vec<GroupMember> {
    let mut joined = pairs.joined();
    let (mut members, mut numbers) = (Vec::new(), 0_usize);
    let mut places = vec![0; joined.parents.len()];
    for row in 0..places.len() {
        let root = joined.root(row);
        if root == row {
            let count = joined.counts[row];
            if members.len() % BLOCK_MEMBERS + count > BLOCK_MEMBERS {
                members.resize(members.len().next_multiple_of(BLOCK_MEMBERS), NOBODY);
            }
            let (place, inverse) = (members.len(), numbers as i64);
            let first = (place % BLOCK_MEMBERS) as i32;
            members.resize(place + count, GroupMember { row: -1, first, count: count as i32, unused: 0, inverse });
            places[row] = place;
            numbers += 36 * count * count;
        }
        members[places[root]].row = row as i32;
        places[root] += 1;
    }
    members.resize(BLOCK_MEMBERS * group_blocks(places.len()), NOBODY);
    members
}

impl SplitFarField {
    /// Forms groups by the stiff pairs that are assembled, and inverts their matrices. Returns the loads and first
    /// moments in the background.
    pub(crate) fn form_groups(&mut self, pairs: usize) -> Result<Vec<f64>, DeviceError> {
        let (count, task) = (self.task.particles as usize, self.task);
        let [mut starts, mut others] = [vec![0_i32; count + 1], vec![0_i32; pairs]];
        let (mut translations, mut in_flow) = (vec![0.0; 2 * pairs], vec![0.0; IN_FLOW * count]);
        // Translation across the axis, and along it minus across, are the fourth and the fifth of the lists of numbers.
        const { assert!(PAIR_NUMBERS == 9) };
        let across = task.near_numbers[0] + (3 * pairs * size_of::<f64>()) as u64;
        self.device.download_all(&mut [
            (task.near_starts[0], bytemuck::cast_slice_mut(&mut starts)),
            (task.near_others[0], bytemuck::cast_slice_mut(&mut others)),
            (across, bytemuck::cast_slice_mut(&mut translations)),
            (task.in_flow, bytemuck::cast_slice_mut(&mut in_flow)),
        ])?;
        let (across, besides) = translations.split_at(pairs);
        let single = self.near.least_resistance;
        let strengths: Vec<f64> = across.iter().zip(besides).map(|(a, b): (&f64, &f64)| (a + b) / single).collect();
        let members = members(&StiffPairs { starts: &starts, others: &others, strengths: &strengths });
        let (on, places) = (self.device.as_mut(), &mut self.buffers.near);
        self.task.members = places.members.fill(on, bytemuck::cast_slice(&members))?;
        self.task.inverses = places.inverses.reserve(on, size_of::<f64>() * INVERSE_NUMBERS * count)?;
        let launch = KernelLaunch { kernel: "invert_groups", blocks: members.len(), threads: INVERT_THREADS };
        if !members.is_empty() {
            self.device.launch(&launch, &self.task)?;
        }
        Ok(in_flow)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows of pairs with their strengths, each of which counts for both rows.
    fn members_of(rows: usize, pairs: &[(usize, usize, f64)]) -> Vec<GroupMember> {
        let (mut starts, mut others, mut strengths) = (vec![0], Vec::new(), Vec::new());
        for row in 0..rows {
            for &(a, b, strength) in pairs.iter().filter(|&&(a, b, _)| a == row || b == row) {
                others.push((a + b - row) as i32);
                strengths.push(-strength);
            }
            starts.push(others.len() as i32);
        }
        members(&StiffPairs { starts: &starts, others: &others, strengths: &strengths })
    }

    fn groups(members: &[GroupMember]) -> Vec<Vec<i32>> {
        let (mut groups, mut numbers): (Vec<Vec<i32>>, i64) = (Vec::new(), 0);
        for (place, member) in members.iter().enumerate().filter(|(_, member)| member.row >= 0) {
            if member.first as usize == place % BLOCK_MEMBERS {
                groups.push(Vec::new());
                assert_eq!(member.inverse, numbers);
                numbers += i64::from(36 * member.count * member.count);
            }
            groups.last_mut().unwrap().push(member.row);
            assert!(member.first as usize + member.count as usize <= BLOCK_MEMBERS);
        }
        groups
    }

    /// Strong pairs join, weak ones and images of a sphere itself do not.
    #[test]
    fn strong_pairs_form_groups() {
        let found = members_of(6, &[(1, 4, 3.0), (4, 5, 0.1), (0, 5, 0.7), (2, 2, 50.0)]);
        assert_eq!(groups(&found), [vec![0, 5], vec![1, 4], vec![2], vec![3]]);
        assert_eq!(found.len(), BLOCK_MEMBERS);
    }

    /// A chain is cut where it is weakest, into groups of at most eight.
    #[test]
    fn a_chain_is_cut_at_weak_pairs() {
        let chain: Vec<_> = (0..15).map(|k| (k, k + 1, if k == 4 || k == 11 { 1.5 } else { 20.0 })).collect();
        let found = groups(&members_of(16, &chain));
        let expected: [Vec<i32>; 3] = [(0..5).collect(), (5..12).collect(), (12..16).collect()];
        assert_eq!(found, expected);
    }

    /// Every row is in one group, which is within a block; there are as many blocks as predicted at most.
    #[test]
    fn groups_do_not_cross_blocks() {
        let chain: Vec<_> = (0..499).filter(|k| k % 7 != 6).map(|k| (k, k + 1, 10.0)).collect();
        let members = members_of(500, &chain);
        let mut rows: Vec<i32> = groups(&members).concat();
        assert!(groups(&members).iter().all(|group| group.len() <= 7) && members.len() > 500);
        assert_eq!(size_of_val(&members[..]), member_bytes(500));
        rows.sort_unstable();
        assert_eq!(rows, (0..500).collect::<Vec<_>>());
    }
}
