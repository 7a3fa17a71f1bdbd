//! Sums over bodies whose spheres are on several ranks.

use domain::{Comm, Incoming, Outgoing};

/// Exchange of sums of the bodies with spheres on several ranks. The lowest of these ranks adds them in rank order and
/// returns the sum, so that ranks send messages only to ranks with which they share bodies.
#[derive(Clone)]
pub struct SharedBodies {
    comm: Comm,
    /// Whether any body is shared by any ranks.
    is_any: bool,
    /// Bodies that lower ranks sum, rank by rank.
    summed_there: Exchanged,
    /// Bodies of higher ranks that this rank sums, rank by rank.
    summed_here: Exchanged,
}

/// Bodies, by their places in a rank's list, whose sums go to or come from other ranks.
#[derive(Debug, Clone, Default)]
struct Exchanged {
    /// The next `counts[r]` bodies are those of rank `r`.
    counts: Vec<usize>,
    places: Vec<u32>,
}

impl Exchanged {
    fn new(lists: &[Vec<u32>], numbers: &[u32]) -> Self {
        let place = |number: &u32| numbers.partition_point(|n| n < number) as u32;
        Self { counts: lists.iter().map(Vec::len).collect(), places: lists.iter().flatten().map(place).collect() }
    }

    /// Number of values of each rank, with `width` values a body.
    fn lengths(&self, width: usize) -> Vec<usize> {
        self.counts.iter().map(|count| count * width).collect()
    }

    fn values<'a>(&'a self, of_bodies: &'a [f64], width: usize) -> Vec<f64> {
        let of_body = |&place: &u32| &of_bodies[place as usize * width..][..width];
        self.places.iter().flat_map(of_body).copied().collect()
    }
}

impl SharedBodies {
    /// Finds the bodies that ranks share, given the numbers of this rank's bodies in ascending order. Collective.
    pub fn new(comm: &Comm, numbers: &[u32]) -> Self {
        let mut of_sums = vec![Vec::new(); comm.size()];
        if comm.size() > 1 {
            for [number, rank] in lowest_holders(comm, numbers) {
                of_sums[rank as usize].push(number);
            }
        }
        let is_any = comm.size() > 1 && comm.any(of_sums.iter().any(|list| !list.is_empty()));
        let asked = if is_any { comm.exchange(&of_sums) } else { Vec::new() };
        let [summed_there, summed_here] = [of_sums, asked].map(|lists| Exchanged::new(&lists, numbers));
        Self { comm: comm.clone(), is_any, summed_there, summed_here }
    }

    /// Replaces the values of this rank's bodies, equally many for each, by their sums over all ranks. Collective.
    pub fn sum(&self, of_bodies: &mut [f64], width: usize) {
        if !self.is_any {
            return;
        }
        let (there, here) = (&self.summed_there, &self.summed_here);
        let [to, from] = [there, here].map(|bodies| bodies.lengths(width));
        let mut received = vec![0.0; here.places.len() * width];
        let own = there.values(of_bodies, width);
        self.comm.send_receive(Outgoing { values: &own, counts: &to }, Incoming { room: &mut received, counts: &from });
        for (&place, values) in here.places.iter().zip(received.chunks(width)) {
            let sums = &mut of_bodies[place as usize * width..][..width];
            sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
        }
        let sums = here.values(of_bodies, width);
        let mut received = own;
        self.comm
            .send_receive(Outgoing { values: &sums, counts: &from }, Incoming { room: &mut received, counts: &to });
        for (&place, values) in there.places.iter().zip(received.chunks(width)) {
            of_bodies[place as usize * width..][..width].copy_from_slice(values);
        }
    }
}

/// This rank's bodies of which lower ranks have spheres too, each with the lowest rank that has any, in ascending
/// order. Ranks share the search: rank `number mod ranks` compares the lists of all ranks. Collective.
fn lowest_holders(comm: &Comm, numbers: &[u32]) -> Vec<[u32; 2]> {
    let mut asked = vec![Vec::new(); comm.size()];
    for &number in numbers {
        asked[number as usize % comm.size()].push(number);
    }
    let held = comm.exchange(&asked);
    let mut holders: Vec<[u32; 2]> =
        held.iter().zip(0..).flat_map(|(list, rank)| list.iter().map(move |&number| [number, rank])).collect();
    holders.sort_unstable();
    let mut replies = vec![Vec::new(); comm.size()];
    for of_body in holders.chunk_by(|[a, _], [b, _]| a == b) {
        for &[number, rank] in &of_body[1..] {
            replies[rank as usize].push([number, of_body[0][1]]);
        }
    }
    let mut found = comm.exchange(&replies).concat();
    found.sort_unstable();
    found
}
