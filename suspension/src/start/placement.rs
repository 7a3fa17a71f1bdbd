//! Initial positions of the particles.

use crate::error::PlacingError;
use crate::model::{Model, Species, Start};
use crate::rotation;
use crate::start::lattice::Sites;
use crate::start::{bodies, orientations};
use domain::{
    Comm, Failure, GivenPositions, Particles, Partition, Quaternion, Random, block, random_cloud, random_packing,
    shared_random_packing,
};
use std::ops::Range;

/// Particles of a model at the start, each on any rank, with a partition if the scene gives their numbers. The ranks
/// make equal parts of a lattice and of random positions at low volume fractions; of others, which the first rank makes
/// or has from elsewhere, each rank gets its part at once. With bodies or filaments the first rank has all. Collective.
pub fn particles(
    model: &Model,
    placed: Option<GivenPositions>,
    partition: Option<&Partition>,
    comm: &Comm,
) -> Result<Particles, Failure> {
    if !model.placed_together().is_empty() {
        return comm.agree(if comm.is_first() { bodies::particles(model, placed) } else { Ok(Particles::default()) });
    }
    let shared = partition.map(|partition| shared(model, partition)).transpose();
    if let Some(particles) = comm.agree(shared.map(Option::flatten))? {
        return Ok(particles);
    }
    let counted: usize = model.species.iter().map(count).sum();
    let rows = block(counted, comm.size(), comm.rank());
    match &model.start {
        Start::Lattice(lattice) => {
            let positions = Sites::new(&model.cell, *lattice, counted, model.seed).positions(rows.clone());
            let species = Some(mixed_species(model, rows.clone()));
            Ok(store(model, GivenPositions { positions, species, ..GivenPositions::default() }, rows.start))
        }
        Start::Positions(positions) => {
            let positions = positions[rows.clone()].to_vec();
            Ok(store(model, GivenPositions { positions, ..GivenPositions::default() }, rows.start))
        }
        _ => {
            let first = || if comm.is_first() { on_first(model, placed) } else { Ok(GivenPositions::default()) };
            let (own, all) = comm.agree(first())?.divided(comm);
            Ok(store(model, own, block(all, comm.size(), comm.rank()).start))
        }
    }
}

/// Random placement that the ranks share, at low volume fractions: the spheres of a model with random positions, each
/// on the rank that owns it. `None` if the first rank has to place all of them. Collective.
fn shared(model: &Model, partition: &Partition) -> Result<Option<Particles>, PlacingError> {
    let Start::Random { minimum_gap } = model.start else { return Ok(None) };
    let groups: Vec<(f64, usize)> = model.species.iter().map(|kind| (kind.radius, count(kind))).collect();
    let placed = shared_random_packing(&model.cell, &groups, minimum_gap, model.seed, partition)?;
    let ends = ends(model);
    Ok(placed.map(|spheres| {
        let mut particles = Particles::default();
        for (id, place) in spheres {
            let species = ends.partition_point(|&end| end <= id as usize);
            particles.push(id, place, groups[species].0, species as u32);
        }
        particles
    }))
}

/// Number of spheres up to the end of each species, in the order of the model's counts.
fn ends(model: &Model) -> Vec<usize> {
    let next = |end: &mut usize, kind: &Species| {
        *end += count(kind);
        Some(*end)
    };
    model.species.iter().scan(0, next).collect()
}

/// All positions of a model, of which the first rank makes or has all.
fn on_first(model: &Model, placed: Option<GivenPositions>) -> Result<GivenPositions, PlacingError> {
    if model.start == Start::Given {
        return given(model, placed.unwrap_or_default());
    }
    let radii = model.species.iter().flat_map(|kind| std::iter::repeat_n(kind.radius, count(kind)));
    let radii: Vec<f64> = radii.collect();
    let positions = match model.start {
        Start::Random { minimum_gap } => random_packing(&model.cell, &radii, minimum_gap, model.seed)?,
        Start::Cloud { radius, minimum_gap } => random_cloud(radius, &radii, minimum_gap, model.seed)?,
        Start::Lattice(_) | Start::Positions(_) | Start::Given => unreachable!("taken above"),
    };
    Ok(GivenPositions { positions, ..GivenPositions::default() })
}

/// Species of all spheres of these rows, in the order of the model's counts.
fn counted_species(model: &Model, rows: Range<usize>) -> impl Iterator<Item = u32> {
    let ends = ends(model);
    let mut species = ends.partition_point(|&end| end <= rows.start);
    rows.map(move |row| {
        while ends.get(species).is_some_and(|&end| end <= row) {
            species += 1;
        }
        species as u32
    })
}

/// Species of the spheres of these rows after those of all spheres are mixed at random. Each rank mixes a list with a
/// byte for each sphere, if there are up to 256 species.
fn mixed_species(model: &Model, rows: Range<usize>) -> Vec<u32> {
    let all = 0..model.species.iter().map(count).sum();
    if model.species.len() == 1 {
        return vec![0; rows.len()];
    }
    let mut random = Random::new(model.seed, u64::MAX);
    if u8::try_from(model.species.len() - 1).is_ok() {
        let mut species: Vec<u8> = counted_species(model, all).map(|species| species as u8).collect();
        random.shuffle(&mut species);
        species[rows].iter().map(|&species| u32::from(species)).collect()
    } else {
        let mut species: Vec<u32> = counted_species(model, all).collect();
        random.shuffle(&mut species);
        species[rows].to_vec()
    }
}

fn count(kind: &Species) -> usize {
    kind.count.unwrap_or(0) as usize
}

/// Particles numbered from `first`. Species that are not given are those of the model's counts.
fn store(model: &Model, part: GivenPositions, first: usize) -> Particles {
    let rows = first..first + part.positions.len();
    let species = part.species.unwrap_or_else(|| match model.species.len() {
        1 => vec![0; rows.len()],
        _ => counted_species(model, rows.clone()).collect(),
    });
    let radii = part.radii.unwrap_or_else(|| species.iter().map(|&s| model.species[s as usize].radius).collect());
    let ids = rows.map(|row| row as u64).collect();
    let mut particles = Particles { ids, ..Particles::numbered(part.positions, radii, species) };
    if let Some(given) = part.orientations {
        rotation::orientations(&mut particles).copy_from_slice(&given);
    }
    particles
}

/// Positions and orientations from elsewhere, in the axes of the model, with the species of all spheres: those
/// provided, or else those of the model's counts. Orientations that no species needs are left out.
pub fn given(model: &Model, placed: GivenPositions) -> Result<GivenPositions, PlacingError> {
    let name = placed.name.clone();
    checked(model, placed).map_err(|message| PlacingError::Given { name, message })
}

fn checked(model: &Model, placed: GivenPositions) -> Result<GivenPositions, String> {
    let count_here = placed.positions.len();
    let count_asked: usize = model.species.iter().map(count).sum();
    let is_told = placed.species.is_some() || model.species.len() == 1;
    if !is_told && count_asked != count_here {
        return Err(format!(
            "has {count_here} positions, but the scene counts {count_asked} spheres; leave out the species' counts, or \
             make them fit"
        ));
    }
    let species = match placed.species {
        Some(species) => species,
        None if is_told => vec![0; count_here],
        None => counted_species(model, 0..count_here).collect(),
    };
    check_species(model, &species)?;
    let has_orientations = orientations::check_given(placed.orientations.as_deref(), &species, model)?;
    let axes = model.user_axes();
    let positions = placed.positions.into_iter().map(|place| axes.place_in(place)).collect();
    let inside = |list: Vec<Quaternion>| list.into_iter().map(|q| axes.orientation_in(q.normalized())).collect();
    let orientations = placed.orientations.filter(|_| has_orientations).map(inside);
    Ok(GivenPositions { positions, species: Some(species), orientations, ..placed })
}

/// Checks that the species of provided spheres match those of the model.
fn check_species(model: &Model, species: &[u32]) -> Result<(), String> {
    for (index, kind) in model.species.iter().enumerate() {
        let found = species.iter().filter(|&&s| s as usize == index).count();
        let name = &kind.name;
        if kind.count.is_some_and(|count| count as usize != found) {
            return Err(format!("has {found} spheres of species \"{name}\", but the scene counts {}", count(kind)));
        }
        if found == 0 {
            return Err(format!("has no sphere of species \"{name}\"; leave that species out, or bring some of it"));
        }
    }
    match species.iter().find(|&&s| s as usize >= model.species.len()) {
        Some(unknown) => {
            Err(format!("has a sphere of species {unknown}; the scene has {} species, from 0", model.species.len()))
        }
        None => Ok(()),
    }
}

/// Gives every rank the columns of the first rank, empty if they are missing. Collective.
pub fn share_columns(particles: &mut Particles, comm: &Comm) {
    let names: Vec<String> = particles.columns.iter().map(|c| format!("{} {}", c.width, c.name)).collect();
    for line in comm.broadcast_text(&names.join("\n")).lines() {
        let (width, name) = line.split_once(' ').expect("written above");
        particles.column(name, width.parse().expect("written above"));
    }
}

#[cfg(test)]
mod tests;
