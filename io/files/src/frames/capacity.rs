//! Number of frames that a file has room for, and chunk sizes of its datasets.

use super::Element;

/// Largest number of chunks of a dataset: the list of their addresses is then within a page of memory.
const MOST_CHUNKS: usize = 500;
/// Bytes of the chunks of all datasets together that are begun and not filled, or this fraction of the written bytes.
const UNFILLED: usize = 28 << 20;
const UNFILLED_SHARE: usize = 200;
/// Bytes of a chunk below which it would cost more space and time than it saves.
const SMALL: usize = 64 << 10;
/// Largest number of bytes of a chunk in HDF5.
const LARGEST: usize = u32::MAX as usize;

/// Number of frames that a file has room for. Storage is allocated chunk by chunk, except for
/// the steps, eight bytes each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Capacity {
    pub frames: usize,
}

impl Capacity {
    /// Capacity for the frames of a run, `written` of which are there already; less if chunks would become too large.
    pub fn new(elements: &[Element], planned: u64, written: usize) -> Self {
        // Apart from the values there are step, time and checksums.
        let largest = elements.iter().map(Element::bytes).max().unwrap_or(0);
        let frame = elements.iter().map(Element::bytes).sum::<usize>() + 3 * size_of::<u64>();
        let unfilled = UNFILLED.max(written.saturating_mul(frame) / UNFILLED_SHARE);
        let chunk = (unfilled / frame).min(LARGEST / largest.max(1)).max(1);
        let most = (MOST_CHUNKS * chunk).min(written + unfilled / size_of::<u64>());
        let planned = usize::try_from(planned).unwrap_or(usize::MAX).max(2 * written).max(1);
        Self { frames: planned.min(most).max(written + 1) }
    }

    /// Number of frames in a chunk of a dataset with `bytes` bytes per frame.
    pub fn chunk(self, bytes: usize) -> usize {
        let small = (SMALL / bytes.max(1)).clamp(1, self.frames);
        self.frames.div_ceil(MOST_CHUNKS).max(small)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of_spheres(count: usize) -> Vec<Element> {
        let element = |columns| Element { path: String::new(), shape: Some([count, columns]), whole: false, unit: "" };
        [3, 3, 3, 3, 5].map(element).to_vec()
    }

    #[test]
    fn runs_of_usual_length_fit_at_once() {
        for (count, planned) in [(1, 1), (1, 1000), (25, 7), (3200, 1000), (100_000, 500), (1_000_000, 500)] {
            assert_eq!(Capacity::new(&of_spheres(count), planned, 0).frames, planned as usize, "{count} {planned}");
        }
    }

    /// For any number of planned frames, space begun and not filled is below 64 MB or a hundredth of the written
    /// bytes, lists of chunks fit into a page, and each larger file has room for at least a tenth more frames.
    #[test]
    fn what_is_not_filled_is_bounded() {
        for count in [1, 10, 1000, 300_000, 10_000_000] {
            let elements = of_spheres(count);
            let frame: usize = elements.iter().map(Element::bytes).sum();
            let mut written = 0;
            // Chunks of 4 GB are the largest that HDF5 supports.
            while written * frame < 1_000_000_000_000 {
                let capacity = Capacity::new(&elements, 1_000_000_000, written);
                let chunks = elements.iter().map(|e| (capacity.chunk(e.bytes()), e.bytes()));
                let begun: usize = chunks.clone().map(|(frames, bytes)| frames * bytes).sum();
                let hole = begun.saturating_sub(frame) + 8 * (capacity.frames - written);
                assert!(hole < (64_000_000).max(written * frame / 100), "{count} {written}: {hole}");
                for (frames, bytes) in chunks {
                    assert!(frames * bytes <= LARGEST.max(bytes) && capacity.frames.div_ceil(frames) <= MOST_CHUNKS);
                }
                assert!(capacity.frames > written + written / 10, "{count}: {written}");
                written = capacity.frames;
            }
        }
    }
}
