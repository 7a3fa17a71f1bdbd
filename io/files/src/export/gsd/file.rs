//! Layout of GSD files: a header, chunks of numbers, an index of the chunks, and the names of the chunks.

use bytemuck::{Pod, Zeroable, bytes_of, cast_slice};
use std::io::{Result, Seek, SeekFrom, Write};

const MAGIC: u64 = 0x65DF_65DF_65DF_65DF;
const FORMAT: u32 = 2 << 16;
const SCHEMA: u32 = (1 << 16) | 4;
/// Bytes of an entry in the list of names.
const NAME: usize = 64;

/// Header of a file.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct GsdHeader {
    magic: u64,
    index_location: u64,
    index_entries: u64,
    names_location: u64,
    names_entries: u64,
    schema_version: u32,
    format_version: u32,
    application: [u8; NAME],
    schema: [u8; NAME],
    reserved: [u8; 80],
}

/// Index entry of a chunk. Entries are ordered by frame, then by the id of the name.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct IndexEntry {
    frame: u64,
    rows: u64,
    location: i64,
    columns: u32,
    name: u16,
    kind: u8,
    flags: u8,
}

/// A named array of rows of numbers.
pub(super) struct Chunk {
    name: String,
    rows: usize,
    columns: usize,
    /// Type id of the format.
    kind: u8,
    bytes: Vec<u8>,
}

impl Chunk {
    fn new<T: Pod>(name: &str, kind: u8, columns: usize, values: &[T]) -> Self {
        Self { name: name.to_owned(), rows: values.len() / columns, columns, kind, bytes: cast_slice(values).to_vec() }
    }

    pub(super) fn u32s(name: &str, values: &[u32]) -> Self {
        Self::new(name, 3, 1, values)
    }

    pub(super) fn u64s(name: &str, values: &[u64]) -> Self {
        Self::new(name, 4, 1, values)
    }

    pub(super) fn f64s(name: &str, values: &[f64]) -> Self {
        Self::new(name, 10, 1, values)
    }

    pub(super) fn i32s(name: &str, values: &[[i32; 3]]) -> Self {
        Self::new(name, 7, 3, values.as_flattened())
    }

    /// Numbers in single precision, `columns` per row.
    pub(super) fn f32s(name: &str, columns: usize, values: &[f64]) -> Self {
        let values: Vec<f32> = values.iter().map(|&value| value as f32).collect();
        Self::new(name, 9, columns, &values)
    }

    /// One zero-terminated row of characters per name.
    pub(super) fn names(name: &str, names: &[String]) -> Self {
        let columns = 1 + names.iter().map(String::len).max().unwrap_or(0);
        let padded = |name: &String| [name.as_bytes(), &vec![0; columns - name.len()]].concat();
        Self::new(name, 5, columns, &names.iter().flat_map(padded).collect::<Vec<u8>>())
    }
}

/// A file that is being written.
pub(super) struct GsdFile<W> {
    out: W,
    index: Vec<IndexEntry>,
    /// Names in the order of their ids.
    names: Vec<String>,
    frames: u64,
    end: u64,
}

impl<W: Write + Seek> GsdFile<W> {
    /// Starts a file, with space for the header.
    pub(super) fn begin(mut out: W) -> Result<Self> {
        let header = GsdHeader::zeroed();
        out.write_all(bytes_of(&header))?;
        Ok(Self { out, index: Vec::new(), names: Vec::new(), frames: 0, end: size_of::<GsdHeader>() as u64 })
    }

    /// Adds a frame.
    pub(super) fn frame(&mut self, chunks: &[Chunk]) -> Result<()> {
        let first = self.index.len();
        chunks.iter().filter(|chunk| !chunk.bytes.is_empty()).try_for_each(|chunk| self.chunk(chunk))?;
        self.index[first..].sort_by_key(|entry| entry.name);
        self.frames += 1;
        Ok(())
    }

    fn chunk(&mut self, chunk: &Chunk) -> Result<()> {
        self.out.write_all(&chunk.bytes)?;
        let name = self.number_of(&chunk.name);
        let (rows, columns, location) = (chunk.rows as u64, chunk.columns as u32, self.end as i64);
        self.index.push(IndexEntry { frame: self.frames, rows, location, columns, name, kind: chunk.kind, flags: 0 });
        self.end += chunk.bytes.len() as u64;
        Ok(())
    }

    fn number_of(&mut self, name: &str) -> u16 {
        let number = self.names.iter().position(|known| known == name).unwrap_or_else(|| {
            self.names.push(name.to_owned());
            self.names.len() - 1
        });
        number as u16
    }

    /// Writes the index, the names and the header.
    pub(super) fn end(mut self) -> Result<()> {
        let mut names: Vec<u8> = self.names.iter().flat_map(|name| [name.as_bytes(), &[0]].concat()).collect();
        names.resize((names.len() / NAME + 1) * NAME, 0);
        self.out.write_all(cast_slice(&self.index))?;
        self.out.write_all(&names)?;
        let header = GsdHeader {
            magic: MAGIC,
            index_location: self.end,
            index_entries: self.index.len() as u64,
            names_location: self.end + size_of_val(&self.index[..]) as u64,
            names_entries: (names.len() / NAME) as u64,
            schema_version: SCHEMA,
            format_version: FORMAT,
            application: text(concat!("fcm-solve ", env!("CARGO_PKG_VERSION"))),
            schema: text("hoomd"),
            reserved: [0; 80],
        };
        self.out.seek(SeekFrom::Start(0))?;
        self.out.write_all(bytes_of(&header))?;
        self.out.flush()
    }
}

/// Zero-terminated text of fewer than 64 bytes.
fn text(text: &str) -> [u8; NAME] {
    let mut padded = [0; NAME];
    padded[..text.len()].copy_from_slice(text.as_bytes());
    padded
}
