//! Selection of frames for a page.

/// Largest number of bytes of positions and colours; as text they take a third more.
const BYTES: usize = 27_000_000;
/// Bytes of a particle in a frame: three coordinates and two colours.
const EACH: usize = 3 * 2 + 2;
/// Largest number of frames on a page.
const MOST: usize = 1000;

/// Equally spaced frames, including the first and the last; all frames if there is room, with `more` bytes of a
/// particle in a frame than usual.
pub(super) fn chosen(frames: usize, particles: usize, more: usize) -> Vec<usize> {
    let room = (BYTES / ((EACH + more) * particles.max(1))).min(MOST);
    match room.min(frames) {
        all if all == frames => (0..frames).collect(),
        0 => Vec::new(),
        1 => vec![frames - 1],
        count => (0..count).map(|k| (k * (frames - 1) + (count - 1) / 2) / (count - 1)).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_evenly_apart_and_fit() {
        assert_eq!(chosen(5, 10, 0), [0, 1, 2, 3, 4]);
        for (frames, particles) in [(1001, 1), (5000, 20), (300, 100_000), (34, 100_000), (3, 1_500_000)] {
            let few = chosen(frames, particles, 0);
            let (first, last) = (few[0], few[few.len() - 1]);
            assert!((first, last) == (0, frames - 1) && few.len() * particles * EACH <= BYTES, "{few:?}");
            let steps: Vec<usize> = few.windows(2).map(|pair| pair[1] - pair[0]).collect();
            let (least, most) = (steps.iter().min().unwrap(), steps.iter().max().unwrap());
            assert!(*least > 0 && most - least <= 1, "{few:?}");
        }
        assert_eq!(
            (chosen(300, 100_000, 0).len(), chosen(9, 3_000_000, 0), chosen(9, 5_000_000, 0)),
            (33, vec![8], vec![])
        );
        assert_eq!(chosen(0, 10, 0), [0; 0]);
        assert_eq!(chosen(300, 100_000, 3).len(), 24);
    }
}
