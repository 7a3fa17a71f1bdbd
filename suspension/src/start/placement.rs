//! Initial positions of the particles.

use crate::error::PlacingError;
use crate::model::{Lattice, Model, Species, Start};
use crate::start::orientations;
use domain::{
    Comm, GivenPositions, Particles, Partition, PeriodicBox, Random, Vector, random_cloud, random_packing,
    shared_random_packing,
};

/// Random placement that the ranks share, at low volume fractions: the spheres of a model with random positions, each
/// on the rank that owns it. `None` if the first rank has to place all of them. Collective.
pub fn shared(model: &Model, partition: &Partition) -> Result<Option<Particles>, PlacingError> {
    let Start::Random { minimum_gap } = model.start else { return Ok(None) };
    let groups: Vec<(f64, usize)> = model.species.iter().map(|kind| (kind.radius, count(kind))).collect();
    let placed = shared_random_packing(&model.cell, &groups, minimum_gap, model.seed, partition)?;
    let ends: Vec<u64> = groups.iter().scan(0, |end, group| Some(next(end, group.1))).collect();
    Ok(placed.map(|spheres| {
        let mut particles = Particles::default();
        for (id, place) in spheres {
            let species = ends.partition_point(|&end| end <= id);
            particles.push(id, place, groups[species].0, species as u32);
        }
        particles
    }))
}

/// Running total of the number of spheres.
fn next(end: &mut u64, count: usize) -> u64 {
    *end += count as u64;
    *end
}

/// All particles of a model, in the order of their ids.
pub fn particles(model: &Model, placed: Option<GivenPositions>) -> Result<Particles, PlacingError> {
    if model.start == Start::Given {
        let placed = placed.unwrap_or_default();
        let name = placed.name.clone();
        return given(model, placed).map_err(|message| PlacingError::Given { name, message });
    }
    let mut species = counted(model);
    if let Start::Lattice(_) = &model.start {
        Random::new(model.seed, u64::MAX).shuffle(&mut species);
    }
    let radii: Vec<f64> = species.iter().map(|&s| model.species[s as usize].radius).collect();
    let positions = match &model.start {
        Start::Random { minimum_gap } => &random_packing(&model.cell, &radii, *minimum_gap, model.seed)?,
        Start::Cloud { radius, minimum_gap } => &random_cloud(*radius, &radii, *minimum_gap, model.seed)?,
        Start::Lattice(lattice) => &on_lattice(&model.cell, *lattice, species.len(), model.seed),
        Start::Positions(positions) => positions,
        Start::Given => unreachable!("taken above"),
    };
    Ok(store(positions, &radii, &species))
}

/// Species of each sphere, in the order of the model's counts.
fn counted(model: &Model) -> Vec<u32> {
    let mut species = Vec::with_capacity(model.species.iter().map(count).sum());
    for (number, kind) in (0..).zip(&model.species) {
        species.extend(std::iter::repeat_n(number, count(kind)));
    }
    species
}

fn count(kind: &Species) -> usize {
    kind.count.unwrap_or(0) as usize
}

fn store(positions: &[Vector], radii: &[f64], species: &[u32]) -> Particles {
    let mut particles = Particles::default();
    for (id, &position) in positions.iter().enumerate() {
        particles.push(id as u64, position, radii[id], species[id]);
    }
    particles
}

/// Positions on the coarsest lattice of roughly cubic cells with enough sites; vacancies are random.
fn on_lattice(cell: &PeriodicBox, lattice: Lattice, count: usize, seed: u64) -> Vec<Vector> {
    let basis: &[[f64; 3]] = match lattice {
        Lattice::SimpleCubic => &[[0.5, 0.5, 0.5]],
        Lattice::FaceCentredCubic => &[[0.25, 0.25, 0.25], [0.75, 0.75, 0.25], [0.75, 0.25, 0.75], [0.25, 0.75, 0.75]],
    };
    let edges = cell.edges();
    let mut cells = (edges / spacing(cell, basis.len() as f64, count as f64)).round().max(Vector::ONE);
    while (cells.element_product() as usize) * basis.len() < count {
        let widths = edges / cells;
        let widest = (0..3).max_by(|&a, &b| widths[a].total_cmp(&widths[b])).expect("three axes");
        cells[widest] += 1.0;
    }
    let [nx, ny, nz] = cells.to_array().map(|n| n as usize);
    let corners = (0..nz).flat_map(|z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z])));
    let site = |corner: [usize; 3]| {
        let corner = Vector::from_array(corner.map(|c| c as f64));
        basis.iter().map(move |&b| cell.position((corner + Vector::from_array(b)) / cells * edges))
    };
    let sites: Vec<Vector> = corners.flat_map(site).collect();
    let mut chosen: Vec<usize> = (0..sites.len()).collect();
    Random::new(seed, u64::MAX - 1).shuffle(&mut chosen);
    chosen.truncate(count);
    chosen.sort_unstable();
    chosen.into_iter().map(|i| sites[i]).collect()
}

/// Edge of a lattice cell with the given number of sites, such that the box has as many sites as spheres. Along edges
/// of the box that are shorter than that, the box is one cell wide.
fn spacing(cell: &PeriodicBox, sites: f64, spheres: f64) -> f64 {
    let mut spacing = (cell.volume() * sites / spheres).cbrt();
    for _ in 0..2 {
        let long: Vec<f64> = cell.edges().to_array().into_iter().filter(|&edge| edge >= 0.5 * spacing).collect();
        if let 1 | 2 = long.len() {
            spacing = (long.iter().product::<f64>() * sites / spheres).powf(1.0 / long.len() as f64);
        }
    }
    spacing
}

/// Particles at positions from elsewhere. Species and radii are those provided, or else follow from the model's counts.
fn given(model: &Model, placed: GivenPositions) -> Result<Particles, String> {
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
        None => counted(model),
    };
    check_species(model, &species)?;
    let radii = placed.radii.unwrap_or_else(|| species.iter().map(|&s| model.species[s as usize].radius).collect());
    let axes = model.user_axes();
    let positions: Vec<Vector> = placed.positions.into_iter().map(|place| axes.place_in(place)).collect();
    let mut particles = store(&positions, &radii, &species);
    orientations::store(&mut particles, placed.orientations.as_deref(), model)?;
    Ok(particles)
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
mod tests {
    use super::*;

    /// Two cells along each edge would be too few, three along each too many.
    #[test]
    fn a_lattice_has_sites_enough() {
        let cell = PeriodicBox::new(Vector::splat(10.0)).unwrap();
        let sites = on_lattice(&cell, Lattice::SimpleCubic, 11, 1);
        assert_eq!(sites.len(), 11);
        let halved = (0..3).filter(|&d| sites.iter().all(|site| [2.5, 7.5].contains(&site[d]))).count();
        assert_eq!(halved, 2, "{sites:?}");
    }

    #[test]
    fn a_lattice_has_one_distance() {
        let cell = PeriodicBox::new(Vector::new(8.0, 8.0, 16.0)).unwrap();
        for (lattice, count, nearest) in
            [(Lattice::SimpleCubic, 128, 2.0), (Lattice::FaceCentredCubic, 64, 4.0 / 2.0_f64.sqrt())]
        {
            let sites = on_lattice(&cell, lattice, count, 1);
            assert_eq!(sites.len(), count);
            for (i, &site) in sites.iter().enumerate() {
                let others = sites.iter().enumerate().filter(|(j, _)| *j != i);
                let least = others.map(|(_, &s)| cell.nearest_image(s - site).length()).fold(f64::INFINITY, f64::min);
                assert!((least - nearest).abs() < 1e-12);
            }
        }
        assert_eq!(on_lattice(&cell, Lattice::SimpleCubic, 100, 1).len(), 100);
    }

    #[test]
    fn a_lattice_in_a_long_or_flat_box_has_about_as_many_sites_as_spheres() {
        let cells = |edges: [f64; 3], cells: f64| {
            let cell = PeriodicBox::new(Vector::from_array(edges)).unwrap();
            (cell.edges() / spacing(&cell, 1.0, cells)).round()
        };
        assert_eq!(cells([8.0, 1e20, 8.0], 4.0), Vector::new(0.0, 4.0, 0.0));
        assert_eq!(cells([1.0, 300.0, 300.0], 9.0), Vector::new(0.0, 3.0, 3.0));
        assert_eq!(cells([8.0, 8.0, 16.0], 16.0), Vector::new(2.0, 2.0, 4.0));
        let line = PeriodicBox::new(Vector::new(8.0, 1e20, 8.0)).unwrap();
        let sites = on_lattice(&line, Lattice::FaceCentredCubic, 8, 1);
        assert_eq!(sites.len(), 8);
        assert!(sites.iter().any(|site| site.y > 0.5e20) && sites.iter().any(|site| site.y < 0.5e20));
    }
}
