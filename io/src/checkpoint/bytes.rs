//! A checkpoint as bytes: a line that names the format, the length of a JSON header, the header, the arrays one after
//! another, all little-endian, and the XXH3 checksum of everything before it.

use bytemuck::Pod;
use domain::{Column, Particles};
use serde::{Deserialize, Serialize};
use simulation::State;
use xxhash_rust::xxh3::xxh3_64;

const MAGIC: &[u8] = b"fcm-solve checkpoint 1\n";

#[derive(Serialize, Deserialize)]
struct Header {
    step: u64,
    /// The bits of the number, which text would not keep.
    strain: u64,
    plan: String,
    particles: usize,
    columns: Vec<(String, usize)>,
    #[serde(default)]
    statistics: usize,
}

/// The bytes of a state.
pub(super) fn of(state: &State) -> Vec<u8> {
    let p = &state.particles;
    let header = Header {
        step: state.step,
        strain: state.strain.to_bits(),
        plan: state.plan.clone(),
        particles: p.len(),
        columns: p.columns.iter().map(|c| (c.name.clone(), c.width)).collect(),
        statistics: state.statistics.len(),
    };
    let header = serde_json::to_vec(&header).expect("a header is JSON");
    let numbers: usize = p.columns.iter().map(|c| c.values.len()).sum();
    let arrays = p.len() * (8 + 24 + 12 + 8 + 4) + 8 * numbers + state.statistics.len();
    let mut bytes = Vec::with_capacity(MAGIC.len() + 8 + header.len() + arrays + 8);
    bytes.extend(MAGIC);
    bytes.extend((header.len() as u64).to_le_bytes());
    bytes.extend(header);
    bytes.extend(bytemuck::cast_slice::<_, u8>(&p.ids));
    bytes.extend(bytemuck::cast_slice::<_, u8>(&p.positions));
    bytes.extend(bytemuck::cast_slice::<_, u8>(&p.steps));
    bytes.extend(bytemuck::cast_slice::<_, u8>(&p.radii));
    bytes.extend(bytemuck::cast_slice::<_, u8>(&p.species));
    for column in &p.columns {
        bytes.extend(bytemuck::cast_slice::<_, u8>(&column.values));
    }
    bytes.extend(&state.statistics);
    bytes.extend(xxh3_64(&bytes).to_le_bytes());
    bytes
}

/// The state of bytes, or what is wrong with them.
pub(super) fn state(bytes: &[u8]) -> Result<State, String> {
    let (content, sum) = bytes.split_last_chunk::<8>().map(|(c, s)| (c, *s)).ok_or("it is empty or cut short")?;
    let rest = content.strip_prefix(MAGIC).ok_or("it does not start as a checkpoint of this version")?;
    if xxh3_64(content) != u64::from_le_bytes(sum) {
        return Err("its checksum does not fit its content".into());
    }
    let mut rest = Rest(rest);
    let length = rest.take::<u64>(1)?[0] as usize;
    let header: Header = serde_json::from_slice(&rest.take::<u8>(length)?).map_err(|e| e.to_string())?;
    let count = header.particles;
    let mut particles = Particles {
        ids: rest.take(count)?,
        positions: rest.take(count)?,
        steps: rest.take(count)?,
        radii: rest.take(count)?,
        species: rest.take(count)?,
        columns: Vec::new(),
    };
    for (name, width) in header.columns {
        particles.columns.push(Column { name, width, values: rest.take(width.saturating_mul(count))? });
    }
    if !particles.positions.iter().all(|position| position.is_finite()) {
        return Err("it has a position that is not finite".into());
    }
    if !particles.radii.iter().all(|&radius| radius > 0.0 && radius.is_finite()) {
        return Err("it has a radius that is not a finite number above 0".into());
    }
    let (step, strain, plan) = (header.step, f64::from_bits(header.strain), header.plan);
    Ok(State { step, strain, plan, particles, statistics: rest.take(header.statistics)? })
}

struct Rest<'a>(&'a [u8]);

impl Rest<'_> {
    fn take<T: Pod>(&mut self, count: usize) -> Result<Vec<T>, String> {
        let (values, rest) = self.0.split_at_checked(count.saturating_mul(size_of::<T>())).ok_or("it is cut short")?;
        self.0 = rest;
        Ok(bytemuck::allocation::pod_collect_to_vec(values))
    }
}
