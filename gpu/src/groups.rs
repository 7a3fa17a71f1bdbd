//! Groups of spheres whose stiff pairs the preconditioner couples, see `gpu/kernels/grouping.h` and
//! `gpu/kernels/groups.h`.

use crate::device::{DeviceError, KernelLaunch};
use crate::far_field::{PARTICLE_THREADS, SplitFarField};
use crate::task::KernelTask;
use bytemuck::{Pod, Zeroable};

/// Largest number of spheres of a group.
const GROUP: usize = 8;

/// Spheres of a block of threads that preconditions.
const BLOCK_MEMBERS: usize = 42;

/// Members of a block that is full of groups of a size, at least.
const FULL_BLOCK: usize = 40;

/// Threads of a block that inverts the matrix of a group.
const INVERT_THREADS: usize = 64;

/// Rounds in which groups join.
pub(crate) const ROUNDS: usize = 8;

/// Numbers of the inverse of the matrix of a group, at most, by member: six rows of the matrix.
const INVERSE_NUMBERS: usize = 36 * GROUP;

/// Integers of a group while it is formed, as in `gpu/kernels/task.h`.
const GROUP_INTEGERS: usize = 3 + GROUP;

/// A sphere of a block, with the fields of `gpu/kernels/task.h` in the same order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
struct GroupMember {
    row: i32,
    first: i16,
    count: i16,
}

/// Blocks of threads that precondition some particles, however they form groups. A block has groups of one size `c`, at
/// most `m_c = 42 / c` of them, and all blocks but the last one of each size are full. So `n_c` groups of size `c` take
/// `ceil(n_c / m_c)` blocks, of which the full ones have 40 members at least.
pub(crate) fn group_blocks(particles: usize) -> usize {
    (particles.div_ceil(FULL_BLOCK) + GROUP - 1).min(particles)
}

/// Places of members in the blocks.
fn member_places(particles: usize) -> usize {
    BLOCK_MEMBERS * group_blocks(particles)
}

/// Bytes of the lists in which groups are formed: groups, and numbers of groups of each size.
fn list_bytes(particles: usize) -> [usize; 2] {
    [4 * GROUP_INTEGERS * particles, 4 * (GROUP * particles + 1)]
}

/// Bytes of the groups, of the members of blocks, and of the inverses of the matrices.
pub(crate) fn group_bytes(particles: usize) -> usize {
    let each = size_of::<GroupMember>() + size_of::<f64>() * INVERSE_NUMBERS;
    list_bytes(particles).iter().sum::<usize>() + each * member_places(particles)
}

impl SplitFarField {
    /// Takes room for the groups.
    pub(crate) fn reserve_groups(&mut self) -> Result<(), DeviceError> {
        let Self { device, buffers, task, .. } = self;
        let (on, places, count) = (device.as_mut(), &mut buffers.near.groups, task.particles as usize);
        let [groups, sizes] = list_bytes(count);
        task.groups = places.groups.reserve(on, groups)?;
        task.group_places = places.sizes.reserve(on, sizes)?;
        task.members = places.members.reserve(on, size_of::<GroupMember>() * member_places(count))?;
        task.inverses = places.inverses.reserve(on, size_of::<f64>() * INVERSE_NUMBERS * member_places(count))?;
        Ok(())
    }

    /// Forms groups by the stiff pairs that are assembled, in some rounds, and gives each a place in a block. After
    /// [`ROUNDS`], solves take as many steps as with all rounds.
    pub(crate) fn form_groups(&mut self, rounds: usize) -> Result<(), DeviceError> {
        let count = self.task.particles as usize;
        if count == 0 {
            return Ok(());
        }
        let (blocks, threads, places) =
            (self.particle_blocks(1, PARTICLE_THREADS), PARTICLE_THREADS, member_places(count));
        let begin = KernelLaunch { kernel: "begin_groups", blocks: places.div_ceil(threads), threads };
        self.device.launch(&begin, &KernelTask { list_size: places as i64, ..self.task })?;
        for _ in 0..rounds {
            self.launch("choose_groups", blocks, threads)?;
            self.launch("join_groups", blocks, threads)?;
        }
        self.launch("count_groups", blocks, threads)?;
        self.scan(self.task.group_places, GROUP * count + 1, None)?;
        self.launch("place_groups", blocks, threads)
    }

    /// Inverts the matrices of groups.
    pub(crate) fn invert_groups(&mut self) -> Result<(), DeviceError> {
        self.launch("invert_groups", member_places(self.task.particles as usize), INVERT_THREADS)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::emulator::Emulator;
    use crate::near_tables::NearTables;
    use crate::numbers::KernelNumbers;
    use crate::pair_rows::PAIR_NUMBERS;
    use crate::share::GridShare;
    use crate::tables::{GridSolve, NumberFormat, SplitTables, WindowPolynomials};

    /// Stiff pairs: both rows, and the force on one by the other's velocity along the axis.
    type Pairs = [(usize, usize, f64)];

    /// A far field without particles, whose threads run in an order by a seed.
    fn far_field(seed: u64) -> SplitFarField {
        let device = Emulator::beside_program(&[], seed).unwrap();
        let grid = [4; 3];
        let tables = SplitTables {
            numbers: NumberFormat::Double,
            grid,
            share: GridShare::whole(grid),
            points: 4,
            window: std::array::from_fn(|_| WindowPolynomials(vec![0.0; 4])),
            pairs: Vec::new(),
            isolated: Vec::new(),
            cutoff: 1.0,
            viscosity: 1.0,
            gaussian: 1.0,
            widening: 0.0,
            is_periodic: [true; 3],
            solve: GridSolve::Periodic,
        };
        SplitFarField::new(Box::new(device), tables).unwrap()
    }

    fn uploaded(field: &mut SplitFarField, bytes: &[u8]) -> u64 {
        let address = field.device.allocate(bytes.len()).unwrap();
        field.device.upload(address, bytes).unwrap();
        address
    }

    /// Members of the blocks of some rows with the resistance 1, by pairs each of which counts for both rows.
    fn members_of(rows: usize, pairs: &Pairs, rounds: usize, seed: u64) -> Vec<GroupMember> {
        let (mut starts, mut others, mut forces) = (vec![0], Vec::new(), Vec::new());
        for row in 0..rows {
            for &(a, b, force) in pairs.iter().filter(|&&(a, b, _)| a == row || b == row) {
                others.push((a + b - row) as i32);
                forces.push(-force);
            }
            starts.push(others.len() as i32);
        }
        let mut numbers = vec![0.0; PAIR_NUMBERS * forces.len()];
        for (entry, force) in forces.iter().enumerate() {
            numbers[3 * forces.len() + entry] = 0.25 * force;
            numbers[4 * forces.len() + entry] = 0.75 * force;
        }
        let mut field = far_field(seed);
        field.set_near_tables(&NearTables { resistances: vec![[1.0; 3]], ..NearTables::default() }).unwrap();
        let near_entries = [forces.len() as i64, 0];
        field.set_numbers(&KernelNumbers { near_entries, ..KernelNumbers::default() }).unwrap();
        field.task.particles = rows as i32;
        field.task.classes = uploaded(&mut field, bytemuck::cast_slice(&vec![0_i32; rows]));
        field.task.near_starts[0] = uploaded(&mut field, bytemuck::cast_slice(&starts));
        field.task.near_others[0] = uploaded(&mut field, bytemuck::cast_slice(&others));
        field.task.near_numbers[0] = uploaded(&mut field, bytemuck::cast_slice(&numbers));
        field.reserve_groups().unwrap();
        field.form_groups(rounds).unwrap();
        let mut members = vec![GroupMember::zeroed(); member_places(rows)];
        field.device.download(field.task.members, bytemuck::cast_slice_mut(&mut members)).unwrap();
        members
    }

    /// Groups in the order of their first rows, each of which is within a block.
    fn groups(members: &[GroupMember]) -> Vec<Vec<i32>> {
        let mut groups = Vec::new();
        for block in members.chunks(BLOCK_MEMBERS) {
            let is_first = |(place, member): &(usize, &GroupMember)| member.row >= 0 && member.first as usize == *place;
            for (first, GroupMember { count, .. }) in block.iter().enumerate().filter(is_first) {
                let group = &block[first..first + *count as usize];
                assert!(group.iter().all(|member| (member.first as usize, member.count) == (first, *count)));
                let mut rows: Vec<i32> = group.iter().map(|member| member.row).collect();
                rows.sort_unstable();
                groups.push(rows);
            }
        }
        groups.sort_unstable();
        assert_eq!(groups.concat().len(), members.iter().filter(|member| member.row >= 0).count());
        groups
    }

    /// Strong pairs join, weak ones and images of a sphere itself do not.
    #[test]
    fn strong_pairs_form_groups() {
        let found = members_of(6, &[(1, 4, 3.0), (4, 5, 0.1), (0, 5, 0.7), (2, 2, 50.0)], ROUNDS, 1);
        assert_eq!(groups(&found), [vec![0, 5], vec![1, 4], vec![2], vec![3]]);
    }

    /// A chain is cut where it is weakest, into groups of at most eight.
    #[test]
    fn a_chain_is_cut_at_weak_pairs() {
        let chain: Vec<_> = (0..15).map(|k| (k, k + 1, if k == 4 || k == 11 { 1.5 } else { 20.0 })).collect();
        let found = groups(&members_of(16, &chain, ROUNDS, 2));
        let expected: [Vec<i32>; 3] = [(0..5).collect(), (5..12).collect(), (12..16).collect()];
        assert_eq!(found, expected);
    }

    /// Numbers between 0 and 1.
    fn random_numbers(mut state: u64) -> impl FnMut() -> f64 {
        move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as f64 / 2_f64.powi(31)
        }
    }

    /// Pairs of random rows, with forces of all sizes.
    fn random_pairs(rows: usize, count: usize, seed: u64) -> Vec<(usize, usize, f64)> {
        let mut number = random_numbers(seed);
        let mut row = |_| ((number() * rows as f64) as usize, number());
        (0..count)
            .map(|k| (row(k), row(k)))
            .map(|((a, force), (b, _))| (a, b, 2_f64.powf(14.0 * force - 3.0)))
            .collect()
    }

    /// Order of pairs of the same strength, as in `gpu/kernels/grouping.h`.
    fn mixed(number: u32) -> u32 {
        let number = (number ^ number >> 16).wrapping_mul(0x85eb_ca6b);
        let number = (number ^ number >> 13).wrapping_mul(0xc2b2_ae35);
        number ^ number >> 16
    }

    /// Groups by pairs one after the other, the strongest first, each of which joins the groups of its rows.
    fn joined_in_order(rows: usize, pairs: &Pairs) -> Vec<Vec<i32>> {
        let rank = |&(a, b, force): &(usize, usize, f64)| {
            let level = (force * force).log2().floor().min(30.0) as i32;
            (level, mixed(a.min(b) as u32 ^ mixed(a.max(b) as u32)))
        };
        let mut pairs: Vec<_> = pairs.iter().filter(|&&(_, _, force)| force >= 0.5).collect();
        pairs.sort_by_key(|&pair| std::cmp::Reverse(rank(pair)));
        let mut groups: Vec<Vec<i32>> = (0..rows as i32).map(|row| vec![row]).collect();
        for &&(a, b, _) in &pairs {
            let [a, b] = [a, b].map(|row| groups.iter().position(|group| group.contains(&(row as i32))).unwrap());
            if a != b && groups[a].len() + groups[b].len() <= GROUP {
                let joined = std::mem::take(&mut groups[b]);
                groups[a].extend(joined);
            }
        }
        groups.retain(|group| !group.is_empty());
        for group in &mut groups {
            group.sort_unstable();
        }
        groups.sort_unstable();
        groups
    }

    /// Rounds of mutual choice form the groups of one pair after the other, whatever the order of threads.
    #[test]
    fn groups_are_those_of_the_strongest_pairs_first() {
        for (rows, count) in [(1, 0), (40, 20), (300, 150), (300, 400), (301, 1200)] {
            let pairs = random_pairs(rows, count, rows as u64 + count as u64);
            let found = members_of(rows, &pairs, 24, 3);
            assert_eq!(groups(&found), joined_in_order(rows, &pairs), "{rows} rows, {count} pairs");
            assert_eq!(found, members_of(rows, &pairs, 24, 4));
        }
    }

    /// There are at most as many blocks as predicted, for groups of which one is alone in a block of each size.
    #[test]
    fn blocks_of_groups_are_bounded() {
        for (full, sizes) in (0..40).flat_map(|full| (1..1 << GROUP).map(move |sizes: usize| (full, sizes))) {
            let sizes = (1..=GROUP).filter(|size| sizes >> (size - 1) & 1 == 1);
            let (particles, blocks) = sizes.fold((0, 0), |(particles, blocks), size| {
                (particles + size * (full * (BLOCK_MEMBERS / size) + 1), blocks + full + 1)
            });
            assert!(blocks <= group_blocks(particles), "{particles} particles in {blocks} blocks");
        }
    }
}
