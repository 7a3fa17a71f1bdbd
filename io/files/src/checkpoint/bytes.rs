//! Binary format of a checkpoint: a line that names the format, the length of a JSON header, the header, the arrays
//! one after another, all little-endian, and the XXH3 checksum of everything before it. At most one block of an
//! array is in memory at a time.

use super::SceneRecord;
use bytemuck::Pod;
use domain::{ById, Column, Comm, Particles, Scalar, Scalars, Vector, block};
use serde::{Deserialize, Serialize};
use simulation::State;
use std::fs::File;
use std::io::{BufReader, BufWriter, Read, Seek, SeekFrom, Write};
use xxhash_rust::xxh3::Xxh3;

const MAGIC: &[u8] = b"fcm-solve checkpoint 1\n";

/// Number of values that are read at a time.
const BLOCK: usize = 1 << 16;

/// Header before the arrays.
#[derive(Serialize, Deserialize)]
pub(super) struct CheckpointHeader {
    step: u64,
    /// Bits of the number, which text would not preserve.
    strain: u64,
    plan: String,
    particles: usize,
    columns: Vec<(String, usize)>,
    /// Names and bits of the scalars.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    scalars: Vec<(String, Vec<u64>)>,
    #[serde(default)]
    statistics: usize,
    /// Lengths of the pieces of the statistics, unless there is exactly one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pieces: Vec<usize>,
    /// `None` in files of versions before 0.3.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    scene: Option<SceneRecord>,
}

impl CheckpointHeader {
    fn of<'a>(
        state: &State,
        scene: &SceneRecord,
        columns: impl Iterator<Item = (&'a str, usize)>,
        particles: usize,
        pieces: &[usize],
    ) -> Self {
        Self {
            step: state.step,
            strain: state.strain.to_bits(),
            plan: state.plan.clone(),
            particles,
            columns: columns.map(|(name, width)| (name.to_owned(), width)).collect(),
            scalars: state.particles.scalars.iter().map(bits).collect(),
            statistics: pieces.iter().sum(),
            pieces: if pieces.len() > 1 { pieces.to_vec() } else { Vec::new() },
            scene: Some(scene.clone()),
        }
    }

    fn text(&self) -> Vec<u8> {
        serde_json::to_vec(self).expect("a header is JSON")
    }

    /// Lengths of the pieces of the statistics.
    fn lengths(&self) -> Vec<usize> {
        match (&self.pieces[..], self.statistics) {
            ([], 0) => Vec::new(),
            ([], all) => vec![all],
            (pieces, _) => pieces.to_vec(),
        }
    }

    /// Bytes of the arrays; `None` if they are too many to count.
    fn arrays(&self) -> Option<usize> {
        let width = |sum: usize, column: &(String, usize)| sum.checked_add(column.1);
        let numbers = self.columns.iter().try_fold(0, width)?.checked_mul(8)?;
        numbers.checked_add(8 + 24 + 12 + 8 + 4)?.checked_mul(self.particles)?.checked_add(self.statistics)
    }
}

fn bits(scalar: &Scalar) -> (String, Vec<u64>) {
    (scalar.name.clone(), scalar.values.iter().map(|value| value.to_bits()).collect())
}

fn of_bits(scalars: Vec<(String, Vec<u64>)>) -> Scalars {
    let scalar = |(name, bits): (String, Vec<u64>)| {
        let values = bits.into_iter().map(f64::from_bits).collect();
        Scalar { name, values }
    };
    scalars.into_iter().map(scalar).collect()
}

/// Bytes of a checkpoint of a state that is entirely on this rank.
pub(super) fn count(state: &State, scene: &SceneRecord) -> usize {
    let columns = state.particles.columns.iter().map(|column| (column.name.as_str(), column.width));
    let pieces: Vec<usize> = state.statistics.iter().map(Vec::len).collect();
    let header = CheckpointHeader::of(state, scene, columns, state.particles.len(), &pieces);
    MAGIC.len() + 8 + header.text().len() + header.arrays().unwrap_or(usize::MAX) + 8
}

/// Writes a state with all its particles.
pub(super) fn write(file: &mut File, of: (&State, &SceneRecord), rows: &ById) -> std::io::Result<()> {
    let mut out = Summed { file: BufWriter::new(file), sum: Xxh3::new() };
    let header = CheckpointHeader::of(of.0, of.1, rows.columns(), rows.count(), rows.lengths()).text();
    out.write(MAGIC)?;
    out.write(&(header.len() as u64).to_le_bytes())?;
    out.write(&header)?;
    rows.ids(|values| out.write(bytemuck::cast_slice(values)))?;
    rows.positions(|values| out.write(bytemuck::cast_slice(values)))?;
    rows.steps(|values| out.write(bytemuck::cast_slice(values)))?;
    rows.radii(|values| out.write(bytemuck::cast_slice(values)))?;
    rows.species(|values| out.write(bytemuck::cast_slice(values)))?;
    for place in 0..rows.columns().count() {
        rows.column(place, |values| out.write(bytemuck::cast_slice(values)))?;
    }
    rows.pieces(|bytes| out.write(bytes))?;
    let sum = out.sum.digest();
    out.write(&sum.to_le_bytes())?;
    out.file.flush()
}

/// A file and the checksum of everything written to it.
struct Summed<'a> {
    file: BufWriter<&'a mut File>,
    sum: Xxh3,
}

impl Summed<'_> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<()> {
        self.sum.update(bytes);
        self.file.write_all(bytes)
    }
}

/// A checkpoint whose checksum and values have been verified, positioned at the start of its arrays.
pub(super) struct VerifiedCheckpoint {
    file: BufReader<File>,
    header: CheckpointHeader,
}

impl VerifiedCheckpoint {
    /// Reads a checkpoint once; `Err` says what is wrong with it.
    pub fn open(file: File) -> Result<Self, String> {
        let length = file.metadata().map_err(|e| e.to_string())?.len() as usize;
        let mut file = BufReader::new(file);
        check_sum(&mut file, length)?;
        file.seek(SeekFrom::Start(MAGIC.len() as u64)).map_err(|e| e.to_string())?;
        let left = length - MAGIC.len() - 8;
        let size = values::<u64>(&mut file, 1, left)?[0] as usize;
        let text = values::<u8>(&mut file, size, left - 8)?;
        let header: CheckpointHeader = serde_json::from_slice(&text).map_err(|e| e.to_string())?;
        if header.arrays().is_none_or(|arrays| arrays > left - 8 - size) {
            return Err("it is cut short".into());
        }
        if header.scene.as_ref().is_some_and(|scene| !scene.is_whole()) {
            return Err("the digest of its scene does not fit the scene".into());
        }
        let mut pieces = header.lengths().into_iter();
        if pieces.try_fold(0_usize, usize::checked_add) != Some(header.statistics) {
            return Err("its pieces of the statistics do not add up".into());
        }
        let mut whole = Self { file, header };
        let start = whole.file.stream_position().map_err(|e| e.to_string())?;
        whole.check_values()?;
        whole.file.seek(SeekFrom::Start(start)).map_err(|e| e.to_string())?;
        Ok(whole)
    }

    fn check_values(&mut self) -> Result<(), String> {
        let count = self.header.particles;
        let mut id = 0..;
        self.check::<u64>("its ids are not 0, 1, 2 and so on", |&found| id.next() == Some(found))?;
        self.check::<Vector>("it has a position that is not finite", |position| position.is_finite())?;
        self.skip(12 * count)?;
        let is_radius = |radius: &f64| *radius > 0.0 && radius.is_finite();
        self.check("it has a radius that is not a finite number above 0", is_radius)
    }

    fn skip(&mut self, bytes: usize) -> Result<(), String> {
        self.file.seek_relative(bytes as i64).map_err(|e| e.to_string())
    }

    fn check<T: Pod>(&mut self, wrong: &str, mut is_right: impl FnMut(&T) -> bool) -> Result<(), String> {
        let count = self.header.particles;
        for start in (0..count).step_by(BLOCK) {
            let values = values::<T>(&mut self.file, BLOCK.min(count - start), usize::MAX)?;
            if !values.iter().all(&mut is_right) {
                return Err(wrong.into());
            }
        }
        Ok(())
    }
}

/// Refuses content that does not match the checksum at its end.
fn check_sum(file: &mut BufReader<File>, length: usize) -> Result<(), String> {
    let content = length.checked_sub(8).ok_or("it is empty or cut short")?;
    let (mut sum, mut start, mut left) = (Xxh3::new(), Vec::new(), content);
    while left > 0 {
        let bytes = values::<u8>(file, left.min(8 * BLOCK), left)?;
        left -= bytes.len();
        sum.update(&bytes);
        if start.is_empty() {
            start = bytes;
            start.truncate(MAGIC.len());
        }
    }
    if start != MAGIC {
        return Err("it does not start as a checkpoint of this version".into());
    }
    if content < MAGIC.len() + 8 {
        return Err("it is cut short".into());
    }
    let stored = values::<u64>(file, 1, 8)?[0];
    if sum.digest() == stored { Ok(()) } else { Err("its checksum does not fit its content".into()) }
}

/// Reads `count` values, which must take no more than the `left` remaining bytes.
fn values<T: Pod>(file: &mut impl Read, count: usize, left: usize) -> Result<Vec<T>, String> {
    if count.saturating_mul(size_of::<T>()) > left {
        return Err("it is cut short".into());
    }
    let mut values = vec![T::zeroed(); count];
    file.read_exact(bytemuck::cast_slice_mut(&mut values)).map_err(|e| e.to_string())?;
    Ok(values)
}

/// State and scene of a checkpoint that the first rank has opened, on each rank with its share of the particles;
/// shares are of equal size. Collective.
pub(super) fn dealt(whole: Option<VerifiedCheckpoint>, comm: &Comm) -> Result<(State, Option<SceneRecord>), String> {
    let header = whole.as_ref().map_or_else(Vec::new, |whole| whole.header.text());
    let header = comm.broadcast_text(&String::from_utf8(header).expect("JSON is text"));
    let header: CheckpointHeader = serde_json::from_str(&header).map_err(|e| e.to_string())?;
    let lengths = header.lengths();
    let CheckpointHeader { step, strain, plan, particles: count, columns, scalars, scene, .. } = header;
    let mut deal = ArrayDistribution { file: whole.map(|whole| whole.file), count, comm, failed: None };
    let mut particles = Particles {
        ids: deal.rows(1),
        positions: deal.rows(1).into(),
        steps: deal.rows(1).into(),
        radii: deal.rows(1),
        species: deal.rows(1),
        scalars: of_bits(scalars),
        ..Particles::default()
    };
    for (name, width) in columns {
        particles.columns.push(Column { name, width, values: deal.rows(width).into() });
    }
    let statistics = deal.pieces(&lengths);
    match deal.failed {
        Some(reason) => Err(reason),
        None => Ok((State { step, strain: f64::from_bits(strain), plan, particles, statistics }, scene)),
    }
}

/// Distribution to all ranks of the arrays that the first rank reads.
struct ArrayDistribution<'a> {
    file: Option<BufReader<File>>,
    count: usize,
    comm: &'a Comm,
    failed: Option<String>,
}

impl ArrayDistribution<'_> {
    /// This rank's rows of the next array. Collective.
    fn rows<T: Pod>(&mut self, width: usize) -> Vec<T> {
        let ranks = self.comm.size();
        let shares: Vec<usize> = (0..ranks).map(|rank| block(self.count, ranks, rank).len()).collect();
        self.distribute(&shares, width)
    }

    /// This rank's pieces out of pieces of these lengths in bytes; piece `k` goes to rank `k mod ranks`. Collective.
    fn pieces(&mut self, lengths: &[usize]) -> Vec<Vec<u8>> {
        let own = self.distribute(lengths, 1);
        let (mut rest, mut pieces) = (own.as_slice(), Vec::new());
        for &length in lengths.iter().skip(self.comm.rank()).step_by(self.comm.size()) {
            let (piece, after) = rest.split_at(length);
            pieces.push(piece.to_vec());
            rest = after;
        }
        pieces
    }

    /// This rank's rows out of parts with so many rows, of which part `k` goes to rank `k mod ranks`. An exchange has
    /// the rows of as many ranks as fit in a block. Collective.
    fn distribute<T: Pod>(&mut self, parts: &[usize], width: usize) -> Vec<T> {
        let (ranks, mut own) = (self.comm.size(), Vec::new());
        let (mut send, mut room) = (vec![Vec::new(); ranks], BLOCK);
        for (number, &rows) in parts.iter().enumerate() {
            let mut left = rows;
            while left > 0 {
                let taken = left.min(room);
                send[number % ranks].extend(self.next::<T>(width * taken));
                (left, room) = (left - taken, room - taken);
                if room == 0 {
                    own.extend(self.comm.exchange(&send).swap_remove(0));
                    send.iter_mut().for_each(Vec::clear);
                    room = BLOCK;
                }
            }
        }
        own.extend(self.comm.exchange(&send).swap_remove(0));
        own
    }

    /// The next values of the file, on the first rank; zeros after a failure.
    fn next<T: Pod>(&mut self, count: usize) -> Vec<T> {
        let Some(file) = &mut self.file else { return Vec::new() };
        let zeros = || vec![T::zeroed(); count];
        if self.failed.is_some() {
            return zeros();
        }
        values(file, count, usize::MAX).unwrap_or_else(|reason| {
            self.failed = Some(reason);
            zeros()
        })
    }
}
