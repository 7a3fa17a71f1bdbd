//! What particles, their images and their neighbour lists take.

use crate::{Bytes, GROWING, Halo, Neighbour, Neighbours, Pair, Pairs, Particles, Vector, VerletList};

/// The most numbers that a column of particles has in this project.
const WIDEST: f64 = 6.0;

impl Particles {
    /// So many particles with columns of so many numbers together.
    pub fn bytes(count: f64, numbers: usize) -> Bytes {
        let fixed =
            size_of::<u64>() + size_of::<Vector>() + size_of::<[i32; 3]>() + size_of::<f64>() + size_of::<u32>();
        Bytes::keep(count * (fixed + numbers * size_of::<f64>()) as f64)
    }

    /// What [`Particles::migrate`] needs besides: one property on its way, and the order of the rows.
    pub fn migration_bytes(count: f64) -> Bytes {
        Bytes::list::<[usize; 2]>(count).then(Bytes::list::<f64>(2.0 * WIDEST * count)).freed()
    }

    /// What [`Particles::gathered`] needs on a rank that owns some of all: the others send, the first receives all.
    pub fn gathering_bytes(owned: f64, all: f64, numbers: usize, is_first: bool) -> Bytes {
        let send = Bytes::list::<[usize; 2]>(owned).then(Bytes::list::<f64>(WIDEST * owned));
        if !is_first {
            return send.freed();
        }
        let order = Bytes::list::<[usize; 2]>(all);
        Self::bytes(all, numbers).then(send.then(order).then(Bytes::list::<f64>(2.0 * WIDEST * all)).freed())
    }
}

impl Halo {
    /// The rows that a rank sends its images by, as many as it has images itself; and the lists that travel.
    pub fn bytes(owned: f64, present: f64) -> Bytes {
        Bytes::list::<u32>(present - owned).then(Bytes::list::<[f64; 9]>(2.0 * (present - owned)).freed())
    }
}

impl Neighbours {
    /// Lists of so many particles with so many neighbours each.
    pub fn bytes(listed: f64, neighbours: f64) -> Bytes {
        Bytes::list::<[usize; 2]>(listed).then(Bytes::list::<Neighbour>(listed * neighbours))
    }

    /// What [`Neighbours::find`] needs besides: cells, about as many as particles, and the lists batch by batch.
    pub fn search_bytes(listed: f64, present: f64, neighbours: f64) -> Bytes {
        let cells = Bytes::list::<(usize, u32, [f64; 3], [u32; 2])>(present);
        cells.then(Self::batch_bytes(listed, neighbours)).then(Self::bytes(listed, neighbours))
    }

    fn batch_bytes(listed: f64, neighbours: f64) -> Bytes {
        Bytes::list::<(u32, usize)>(GROWING * listed).then(Bytes::list::<Neighbour>(GROWING * listed * neighbours))
    }
}

impl Pairs {
    /// Pairs of so many particles present with so many neighbours each, each pair once.
    pub fn bytes(owned: f64, present: f64, neighbours: f64) -> Bytes {
        let search = Neighbours::search_bytes(present, present, neighbours);
        let pairs = 0.5 * owned * neighbours;
        let lists = Neighbours::bytes(present, neighbours).then(Bytes::list::<Pair>(GROWING * pairs));
        search.freed().then(lists.then(Bytes::list::<Pair>(pairs)).freed()).then(Bytes::list::<Pair>(pairs))
    }
}

impl VerletList {
    /// Lists of the particles that a rank owns: all that are present, or near enough to become so, who have so many
    /// neighbours within the cutoff and so many within the reach of the lists, and the ids of all ranks' particles.
    pub fn bytes([owned, present, all]: [f64; 3], [near, reached]: [f64; 2]) -> Bytes {
        let found = Bytes::list::<(u32, Vector, bool)>(present).then(Bytes::list::<u32>(all));
        let search = Neighbours::search_bytes(owned, present, reached).freed();
        let lists = Neighbours::bytes(owned, reached);
        let now = Bytes::list::<(u32, [Vector; 2], [[i8; 3]; 2])>(present);
        let picking = now.then(Neighbours::batch_bytes(owned, near)).then(Neighbours::bytes(owned, near)).freed();
        found.then(search).then(lists).then(picking).then(Neighbours::bytes(owned, near))
    }
}

/// What [`crate::random_packing`] needs for so many spheres: sizes, order, cells and places, and where spheres are
/// dense the descent that moves them apart.
pub fn packing_bytes(count: f64, is_dense: bool) -> Bytes {
    let one_by_one = Bytes::list::<(f64, f64, usize, [u32; 2], Vector)>(count);
    if !is_dense {
        return one_by_one.freed();
    }
    // Within a fifth of a diameter beyond contact dense spheres have a dozen neighbours.
    let descent = Bytes::list::<(u64, [Vector; 3])>(count).then(Pairs::bytes(count, count, 12.0));
    one_by_one.then(descent).freed()
}
