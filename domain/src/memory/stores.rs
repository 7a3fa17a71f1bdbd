//! Forecasts of the memory of particles, ghosts and neighbour lists.

use crate::shared_pairs::FEW;
use crate::verlet_list::SPARSEST;
use crate::{ById, Bytes, GROWING, Halo, IdBlocks, Neighbours, Pair, Pairs, Particles, Vector, VerletList};

/// Largest width of a column of particles in this project.
const WIDEST: f64 = 6.0;

impl Particles {
    /// A store of `count` particles whose columns have `numbers` numbers in total.
    pub fn bytes(count: f64, numbers: usize) -> Bytes {
        let fixed =
            size_of::<u64>() + size_of::<Vector>() + size_of::<[i32; 3]>() + size_of::<f64>() + size_of::<u32>();
        Bytes::keep(count * (fixed + numbers * size_of::<f64>()) as f64)
    }

    /// Additional memory of [`Particles::migrate`]: buffers for one property, and the order of the rows.
    pub fn migration_bytes(count: f64) -> Bytes {
        Bytes::list::<[usize; 2]>(count).then(Bytes::list::<f64>(2.0 * WIDEST * count)).freed()
    }

    /// Memory of [`Particles::gathered`] on a rank that owns `owned` of `all` particles; the first rank receives all.
    pub fn gathering_bytes(owned: f64, all: f64, numbers: usize, is_first: bool) -> Bytes {
        let send = Bytes::list::<[usize; 2]>(owned).then(Bytes::list::<f64>(WIDEST * owned));
        if !is_first {
            return send.freed();
        }
        let order = Bytes::list::<[usize; 2]>(all);
        Self::bytes(all, numbers).then(send.then(order).then(Bytes::list::<f64>(2.0 * WIDEST * all)).freed())
    }
}

impl Particles {
    /// Memory of [`Particles::by_id`] on a rank that owns `owned` of `total` particles: their order, and blocks of
    /// the widest column as they are sent, received and sorted.
    pub fn by_id_bytes(owned: f64, total: f64) -> Bytes {
        let block = (ById::BLOCK as f64).min(total);
        Bytes::list::<usize>(owned).then(Bytes::list::<[f64; 4]>(WIDEST * block)).freed()
    }
}

impl IdBlocks {
    /// Expected number of particles in the blocks of a rank, out of `total` particles whose ids have no gaps.
    pub fn expected(total: f64, rank: usize, ranks: usize) -> f64 {
        let (size, ranks) = (Self::SIZE as f64, ranks as f64);
        let whole = (total / size).floor();
        let own = ((whole - rank as f64) / ranks).ceil().max(0.0);
        let has_last = (whole % ranks - rank as f64).abs() < 0.5;
        own * size + if has_last { total - whole * size } else { 0.0 }
    }

    /// Memory of [`IdBlocks::distributed`] on a rank that owns `owned` particles and has `distributed` in its blocks.
    pub fn distribution_bytes([owned, distributed]: [f64; 2], numbers: usize) -> Bytes {
        let lists = Bytes::list::<[usize; 2]>(owned).then(Bytes::list::<[u64; 2]>(distributed));
        let property = Bytes::list::<f64>(WIDEST * (owned + 2.0 * distributed));
        Particles::bytes(distributed, numbers).then(lists.then(property).freed())
    }
}

/// Memory of [`crate::fold_shared_pairs`] on a rank that owns `owned` particles and has `present` within the cutoff:
/// ghosts, no more at a time than its own particles or a minimum, and all of them sorted by id and into cells.
pub fn shared_pairs_bytes(owned: f64, present: f64) -> Bytes {
    let ghosts = (present - owned).min(owned.max(FEW as f64));
    let all = owned + ghosts;
    let listed = Bytes::list::<u32>(present - owned);
    let near = Bytes::list::<([Vector; 2], [u32; 3], u64, bool)>(all).then(Halo::bytes(owned, all).freed());
    listed.then(near).then(Bytes::list::<(usize, [f64; 3], [u32; 2])>(all)).freed()
}

impl Halo {
    /// Rows that are sent, about as many as there are ghosts, and the buffers of an exchange.
    pub fn bytes(owned: f64, present: f64) -> Bytes {
        Bytes::list::<u32>(present - owned).then(Bytes::list::<[f64; 9]>(2.0 * (present - owned)).freed())
    }
}

impl Neighbours {
    /// Lists of `listed` particles with `neighbours` neighbours each.
    pub fn bytes(listed: f64, neighbours: f64) -> Bytes {
        Bytes::list::<[usize; 2]>(listed).then(Bytes::list::<u32>(listed * neighbours))
    }

    /// Additional memory of [`Neighbours::find`]: cells, about as many as particles, and the lists of each batch.
    pub fn search_bytes(listed: f64, present: f64, neighbours: f64) -> Bytes {
        let cells = Bytes::list::<(usize, u32, [f64; 3], [u32; 2])>(present);
        cells.then(Self::batch_bytes(listed, neighbours)).then(Self::bytes(listed, neighbours))
    }

    fn batch_bytes(listed: f64, neighbours: f64) -> Bytes {
        Bytes::list::<(u32, usize)>(GROWING * listed).then(Bytes::list::<u32>(GROWING * listed * neighbours))
    }
}

impl Pairs {
    /// Pairs of `present` particles and ghosts with `neighbours` neighbours each, each pair once.
    pub fn bytes(owned: f64, present: f64, neighbours: f64) -> Bytes {
        let search = Neighbours::search_bytes(present, present, neighbours);
        let pairs = 0.5 * owned * neighbours;
        let lists = Neighbours::bytes(present, neighbours).then(Bytes::list::<Pair>(GROWING * pairs));
        search.freed().then(lists.then(Bytes::list::<Pair>(pairs)).freed()).then(Bytes::list::<Pair>(pairs))
    }
}

impl VerletList {
    /// Lists of `owned` particles, among `present` particles and ghosts within the reach of the lists and `all`
    /// particles of all ranks, with `near` neighbours within the cutoff and `reached` within the reach.
    pub fn bytes([owned, present, all]: [f64; 3], [near, reached]: [f64; 2]) -> Bytes {
        let rows =
            if all < SPARSEST as f64 * present { Bytes::list::<u32>(all) } else { Bytes::list::<(u64, u32)>(present) };
        let found = Bytes::list::<(u32, Vector, bool)>(present).then(rows);
        let search = Neighbours::search_bytes(owned, present, reached).freed();
        let lists = Neighbours::bytes(owned, reached);
        let now = Bytes::list::<([u32; 3], Vector)>(present);
        // Each batch has room for all of its neighbours within the reach.
        let batches = Bytes::list::<(u32, usize)>(owned).then(Bytes::list::<u32>(owned * reached));
        let picking = now.then(batches).then(Neighbours::bytes(owned, near)).freed();
        found.then(search).then(lists).then(picking).then(Neighbours::bytes(owned, near))
    }
}

/// Memory of [`crate::random_packing`]: sizes, order, spheres with their cells and positions, and for dense packings
/// the minimisation that separates the spheres.
pub fn packing_bytes(count: f64, is_dense: bool) -> Bytes {
    let spheres = Bytes::list::<(Vector, f64, usize)>(GROWING * count).then(Bytes::list::<[u32; 5]>(count));
    let one_by_one = Bytes::list::<(f64, f64, usize, (f64, usize), (u64, Vector), Vector)>(count).then(spheres);
    if !is_dense {
        return one_by_one.freed();
    }
    // Within a fifth of a diameter beyond contact dense spheres have a dozen neighbours.
    let moved = Bytes::list::<(f64, f64, usize, [u32; 2], Vector)>(count);
    let descent = Bytes::list::<(u64, [Vector; 3])>(count).then(Pairs::bytes(count, count, 12.0));
    one_by_one.freed().or(moved.then(descent).freed())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The numbers in the blocks of all ranks add up, on any number of ranks.
    #[test]
    fn blocks_have_all_particles() {
        for total in [0_u64, 1, 65_535, 65_536, 65_537, 300_000, 393_216] {
            for ranks in [1, 2, 3, 7] {
                for rank in 0..ranks {
                    let own = (0..total).filter(|id| (id / IdBlocks::SIZE) as usize % ranks == rank).count();
                    let found = IdBlocks::expected(total as f64, rank, ranks);
                    assert!((found - own as f64).abs() < 1e-9, "{total} on {rank} of {ranks}");
                }
            }
        }
    }
}
