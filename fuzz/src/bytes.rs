//! Edits of a file as bytes.

use proptest::prelude::*;
use proptest::sample::Index;

/// An edit.
#[derive(Debug, Clone)]
pub enum ByteEdit {
    /// Flips one bit.
    Flip(Index, u8),
    /// Sets one byte.
    Set(Index, u8),
    /// Removes everything from here on.
    Cut(Index),
    /// Removes a number of bytes.
    Remove(Index, usize),
    /// Inserts bytes.
    Insert(Index, Vec<u8>),
    /// Copies a number of bytes from one position to another.
    Copy(Index, Index, usize),
    /// Replaces the eight bytes of a number or a length.
    Number(Index, u64),
}

/// One to five edits.
pub fn edits() -> impl Strategy<Value = Vec<ByteEdit>> {
    let index = any::<Index>;
    let lengths = prop_oneof![any::<u64>(), Just(u64::MAX), Just(0), Just(1 << 40), Just(f64::NAN.to_bits())];
    prop::collection::vec(
        prop_oneof![
            4 => (index(), 0..8u8).prop_map(|(at, bit)| ByteEdit::Flip(at, bit)),
            2 => (index(), any::<u8>()).prop_map(|(at, byte)| ByteEdit::Set(at, byte)),
            1 => index().prop_map(ByteEdit::Cut),
            1 => (index(), 1..64usize).prop_map(|(at, length)| ByteEdit::Remove(at, length)),
            1 => (index(), prop::collection::vec(any::<u8>(), 1..16))
                .prop_map(|(at, bytes)| ByteEdit::Insert(at, bytes)),
            1 => (index(), index(), 1..256usize).prop_map(|(from, to, length)| ByteEdit::Copy(from, to, length)),
            2 => (index(), lengths).prop_map(|(at, number)| ByteEdit::Number(at, number)),
        ],
        1..6,
    )
}

/// Applies an edit.
pub fn apply(bytes: &mut Vec<u8>, edit: &ByteEdit) {
    if bytes.is_empty() {
        return;
    }
    let count = bytes.len();
    let end = |start: usize, length: usize| (start + length).min(count);
    match edit {
        ByteEdit::Flip(at, bit) => bytes[at.index(count)] ^= 1 << bit,
        ByteEdit::Set(at, byte) => bytes[at.index(count)] = *byte,
        ByteEdit::Cut(at) => bytes.truncate(at.index(count)),
        ByteEdit::Remove(at, length) => drop(bytes.drain(at.index(count)..end(at.index(count), *length))),
        ByteEdit::Insert(at, more) => drop(bytes.splice(at.index(count)..at.index(count), more.iter().copied())),
        ByteEdit::Copy(from, to, length) => {
            let copied = bytes[from.index(count)..end(from.index(count), *length)].to_vec();
            bytes.splice(to.index(count)..to.index(count), copied);
        }
        ByteEdit::Number(at, number) => {
            let start = at.index(count);
            let stop = end(start, 8);
            bytes[start..stop].copy_from_slice(&number.to_le_bytes()[..stop - start]);
        }
    }
}
