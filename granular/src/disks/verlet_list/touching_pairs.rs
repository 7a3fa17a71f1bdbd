//! Set of the pairs in contact when the list was rebuilt.

/// Hash table of the pairs in contact, each in one of the slots of its earlier row, or after them.
#[derive(Debug)]
pub(super) struct TouchingPairs {
    /// Two rows, the earlier first, or [`NOTHING`].
    slots: Vec<u64>,
}

const NOTHING: u64 = u64::MAX;

impl Default for TouchingPairs {
    fn default() -> Self {
        Self { slots: vec![NOTHING; 2] }
    }
}

impl TouchingPairs {
    /// The table for pairs of `rows` rows.
    pub(super) fn of(pairs: impl Iterator<Item = [u32; 2]> + Clone, rows: usize) -> Self {
        let slots = (4 * rows).max(2 * pairs.clone().count());
        let mut table = Self { slots: vec![NOTHING; slots.next_power_of_two()] };
        for [i, j] in pairs {
            let key = key(i, j);
            let slot = table.slot(key);
            table.slots[slot] = key;
        }
        table
    }

    /// Whether two disks were in contact.
    pub(super) fn holds(&self, i: u32, j: u32) -> bool {
        let key = key(i, j);
        self.slots[self.slot(key)] == key
    }

    /// Slot of a pair: the one that holds it, or the first free one.
    fn slot(&self, key: u64) -> usize {
        let last = self.slots.len() - 1;
        // Four slots per row: pairs are looked up row by row, so their slots are in cache.
        let mut slot = ((key >> 30) | (key & 3)) as usize & last;
        while self.slots[slot] != key && self.slots[slot] != NOTHING {
            slot = (slot + 1) & last;
        }
        slot
    }
}

fn key(i: u32, j: u32) -> u64 {
    (u64::from(i.min(j)) << 32) | u64::from(i.max(j))
}
