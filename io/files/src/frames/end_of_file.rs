//! End of an HDF5 file according to its superblock.
//!
//! The library writes the superblock last, after lists with chunks beyond the end that the superblock states. A
//! program that is killed in between would leave a file that readers refuse. So the end is moved first.

use std::fs::File;
use std::io;
use std::os::unix::fs::FileExt;

/// Bytes of a superblock of version 2 or 3 with 8-byte addresses, and offsets of the end address and the checksum.
const LENGTH: usize = 48;
const END: usize = 28;
const CHECKSUM: usize = 44;
const SIGNATURE: &[u8; 8] = b"\x89HDF\r\n\x1a\n";

/// Extends the file to at least `end` bytes, and updates the superblock.
pub(super) fn extend_to(file: &File, end: u64) -> io::Result<()> {
    let mut block = superblock(file)?;
    lengthen(file, end)?;
    if said_by(&block) >= end {
        return Ok(());
    }
    block[END..END + 8].copy_from_slice(&end.to_le_bytes());
    let sum = checksum(&block[..CHECKSUM]);
    block[CHECKSUM..].copy_from_slice(&sum.to_le_bytes());
    file.write_all_at(&block, 0)
}

/// Extends the file to the end that its superblock states; it may be shorter if the program
/// was killed while cutting it.
pub(super) fn restore(file: &File) -> io::Result<()> {
    superblock(file).and_then(|block| lengthen(file, said_by(&block)))
}

fn superblock(file: &File) -> io::Result<[u8; LENGTH]> {
    let mut block = [0; LENGTH];
    file.read_exact_at(&mut block, 0)?;
    if block[..8] != *SIGNATURE || !(2..=3).contains(&block[8]) || block[9] != 8 {
        return Err(io::Error::other("its superblock is none of this program"));
    }
    Ok(block)
}

fn said_by(block: &[u8; LENGTH]) -> u64 {
    u64::from_le_bytes(block[END..END + 8].try_into().expect("eight bytes"))
}

fn lengthen(file: &File, end: u64) -> io::Result<()> {
    if file.metadata()?.len() < end { file.set_len(end) } else { Ok(()) }
}

/// Jenkins' lookup3 ("hashlittle", seed 0), the checksum of HDF5 metadata.
fn checksum(bytes: &[u8]) -> u32 {
    let word = |part: &[u8], at: usize| {
        let mut word = [0; 4];
        let part = &part[part.len().min(at)..part.len().min(at + 4)];
        word[..part.len()].copy_from_slice(part);
        u32::from_le_bytes(word)
    };
    let mut state = [0xdead_beef_u32.wrapping_add(bytes.len() as u32); 3];
    let mut parts = bytes.chunks(12).peekable();
    while let Some(part) = parts.next() {
        for (k, sum) in state.iter_mut().enumerate() {
            *sum = sum.wrapping_add(word(part, 4 * k));
        }
        if parts.peek().is_some() { mix(&mut state) } else { finish(&mut state) }
    }
    state[2]
}

fn mix([a, b, c]: &mut [u32; 3]) {
    let step = |from: &mut u32, with: &mut u32, add: u32, turn: u32| {
        *from = from.wrapping_sub(*with) ^ with.rotate_left(turn);
        *with = with.wrapping_add(add);
    };
    step(a, c, *b, 4);
    step(b, a, *c, 6);
    step(c, b, *a, 8);
    step(a, c, *b, 16);
    step(b, a, *c, 19);
    step(c, b, *a, 4);
}

fn finish([a, b, c]: &mut [u32; 3]) {
    let step = |to: &mut u32, from: u32, turn: u32| *to = (*to ^ from).wrapping_sub(from.rotate_left(turn));
    step(c, *b, 14);
    step(a, *c, 11);
    step(b, *a, 25);
    step(c, *b, 16);
    step(a, *c, 4);
    step(b, *a, 14);
    step(c, *b, 24);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Published values of the author of the function.
    #[test]
    fn checksums_are_those_published() {
        assert_eq!(checksum(b""), 0xdead_beef);
        assert_eq!(checksum(b"Four score and seven years ago"), 0x1777_0551);
    }

    #[test]
    fn the_library_reads_a_file_whose_end_was_moved() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.h5");
        hdf5::File::with_options()
            .with_fapl(|f| f.libver_bounds(hdf5::file::LibraryVersion::V18, hdf5::file::LibraryVersion::V18))
            .create(&path)
            .unwrap()
            .new_dataset::<u8>()
            .shape(100)
            .create("a")
            .unwrap();
        let before = std::fs::read(&path).unwrap();
        assert_eq!(checksum(&before[..CHECKSUM]).to_le_bytes(), before[CHECKSUM..LENGTH]);
        let file = File::options().read(true).write(true).open(&path).unwrap();
        extend_to(&file, 10).unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), before);
        extend_to(&file, 100_000).unwrap();
        assert_eq!(file.metadata().unwrap().len(), 100_000);
        let read = hdf5::File::open(&path).unwrap();
        assert_eq!((read.size(), read.member_names().unwrap()), (100_000, vec!["a".to_owned()]));
        drop(read);
        std::fs::write(&path, [7; 1000]).unwrap();
        assert!(extend_to(&file, 2000).unwrap_err().to_string().contains("superblock"));
    }
}
