//! Edits of a checkpoint with a correct checksum.

use crate::tree;
use proptest::sample::Index;
use toml::Value;
use xxhash_rust::xxh3::xxh3_64;

/// Edits of a checkpoint: of its header's keys, and of numbers in its arrays.
pub struct Edits {
    /// Edits of the header.
    pub header: Vec<tree::TreeEdit>,
    /// Index of eight aligned bytes, and the number that replaces them.
    pub numbers: Vec<(Index, f64)>,
}

/// The edited checkpoint with a correct checksum: a line, the length of the header, the header,
/// arrays, and the checksum.
pub fn changed(bytes: &[u8], edits: &Edits) -> Option<Vec<u8>> {
    let start = bytes.iter().position(|&byte| byte == b'\n')? + 1;
    let length = u64::from_le_bytes(bytes.get(start..start + 8)?.try_into().ok()?) as usize;
    let arrays = start + 8 + length;
    let header: serde_json::Value = serde_json::from_slice(bytes.get(start + 8..arrays)?).ok()?;
    let mut header = Value::try_from(header).ok()?;
    edits.header.iter().for_each(|edit| tree::apply(&mut header, edit));
    let header = tree::to_json(&header);
    let mut content = bytes[..start].to_vec();
    content.extend((header.len() as u64).to_le_bytes());
    content.extend(header.as_bytes());
    let mut data = bytes.get(arrays..bytes.len() - 8)?.to_vec();
    for (at, number) in &edits.numbers {
        let place = at.index((data.len() / 8).max(1));
        if let Some(word) = data.chunks_exact_mut(8).nth(place) {
            word.copy_from_slice(&number.to_le_bytes());
        }
    }
    content.extend(data);
    let sum = xxh3_64(&content);
    content.extend(sum.to_le_bytes());
    Some(content)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use proptest::strategy::ValueTree;
    use proptest::test_runner::TestRunner;

    #[test]
    fn the_checksum_fits_again() {
        let mut bytes = b"a format\n".to_vec();
        bytes.extend(9u64.to_le_bytes());
        bytes.extend(br#"{"a": 12}"#);
        bytes.extend([0; 32]);
        let sum = xxh3_64(&bytes);
        bytes.extend(sum.to_le_bytes());
        let at = any::<Index>().new_tree(&mut TestRunner::deterministic()).unwrap().current();
        let changed = changed(&bytes, &Edits { header: vec![], numbers: vec![(at, 1.5)] }).unwrap();
        let (content, sum) = changed.split_last_chunk::<8>().unwrap();
        assert_eq!(xxh3_64(content).to_le_bytes(), *sum);
        assert_eq!(content.windows(8).filter(|word| *word == 1.5f64.to_le_bytes()).count(), 1);
    }
}
