//! Division of a range into consecutive blocks of nearly equal sizes.

use std::ops::Range;

/// The `index`-th of `parts` consecutive blocks of `0..count`, of sizes as equal as possible; empty if there are more
/// parts than elements.
pub fn block(count: usize, parts: usize, index: usize) -> Range<usize> {
    count * index / parts..count * (index + 1) / parts
}

/// Index of the block that holds `element`: the inverse of [`block`].
pub fn block_of(count: usize, parts: usize, element: usize) -> usize {
    (parts * (element + 1) - 1) / count
}
