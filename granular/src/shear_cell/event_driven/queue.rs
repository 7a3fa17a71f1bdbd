//! The event queue: a tree of minima.

/// Children of a node: eight times fill a cache line.
const CHILDREN: usize = 8;

/// The next time of each of a fixed number of entries, and the earliest of them.
pub struct Queue {
    /// Times by entry, then the minima of groups of eight of the level below, up to a single group.
    levels: Vec<Vec<f64>>,
}

impl Queue {
    /// Entries with an infinite time.
    pub fn new(entries: usize) -> Self {
        let above = |&blocks: &usize| (blocks > 1).then(|| blocks.div_ceil(CHILDREN));
        let blocks = std::iter::successors(Some(entries.max(1).div_ceil(CHILDREN)), above);
        Self { levels: blocks.map(|blocks| vec![f64::INFINITY; blocks * CHILDREN]).collect() }
    }

    #[expect(clippy::float_cmp, reason = "minima are copies")]
    pub fn set(&mut self, entry: usize, time: f64) {
        let (mut place, mut time) = (entry, time);
        for level in &mut self.levels {
            if level[place] == time {
                return;
            }
            level[place] = time;
            place /= CHILDREN;
            time = least(level[place * CHILDREN..].first_chunk().expect("levels are whole blocks"));
        }
    }

    /// The earliest entry and its time; the first of entries with equal times.
    #[expect(clippy::float_cmp, reason = "minima are copies")]
    pub fn earliest(&self) -> (usize, f64) {
        let (mut place, mut time) = (0, f64::INFINITY);
        for level in self.levels.iter().rev() {
            let block = &level[place * CHILDREN..(place + 1) * CHILDREN];
            time = least(block.first_chunk().expect("a block"));
            place = place * CHILDREN + block.iter().position(|&t| t == time).expect("a block has its minimum");
        }
        (place, time)
    }

    pub fn rebase(&mut self, origin: f64) {
        self.levels.iter_mut().flatten().for_each(|t| *t -= origin);
    }
}

#[inline]
fn least(t: &[f64; CHILDREN]) -> f64 {
    let min = |a: f64, b: f64| if b < a { b } else { a };
    let four: [f64; 4] = std::array::from_fn(|k| min(t[k], t[k + 4]));
    min(min(four[0], four[2]), min(four[1], four[3]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use domain::Random;

    #[test]
    fn the_earliest_is_that_of_a_plain_search() {
        for entries in [1, 7, 8, 9, 64, 65, 1000] {
            let mut queue = Queue::new(entries);
            let mut times = vec![f64::INFINITY; entries];
            let mut random = Random::new(1, entries as u64);
            for _ in 0..2000 {
                let entry = (random.uniform() * entries as f64) as usize;
                times[entry] = (random.uniform() * 50.0).floor();
                queue.set(entry, times[entry]);
                let first = times.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1)).unwrap();
                assert_eq!(queue.earliest(), (first.0, *first.1));
            }
        }
    }
}
