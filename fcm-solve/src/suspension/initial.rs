//! Where the particles start.

use anyhow::{Context, bail, ensure};
use domain::{Comm, Particles, PeriodicBox, Random, Vector, random_packing};
use io::{Lattice, Placed, Start, SuspensionScene};

/// All particles of a scene, in the order of their ids.
pub fn particles(scene: &SuspensionScene) -> anyhow::Result<Particles> {
    let species: Vec<u32> = (0..).zip(&scene.species).flat_map(|(s, kind)| vec![s; count(kind)]).collect();
    let radius = |s: &u32| scene.species[*s as usize].radius;
    let radii: Vec<f64> = species.iter().map(radius).collect();
    match &scene.start {
        Start::Random { minimum_gap } => {
            let positions = random_packing(&scene.cell, &radii, *minimum_gap, scene.seed);
            Ok(store(&positions.context("can't place the spheres of [[species]] at random")?, &radii, &species))
        }
        Start::Lattice(lattice) => {
            let mut species = species;
            Random::new(scene.seed, u64::MAX).shuffle(&mut species);
            let radii: Vec<f64> = species.iter().map(radius).collect();
            Ok(store(&on_lattice(&scene.cell, *lattice, (species.len(), scene.seed)), &radii, &species))
        }
        Start::Positions(positions) => Ok(store(positions, &radii, &species)),
        Start::File(path) => placed(scene, Placed::read(path)?).with_context(|| format!("{}", path.display())),
    }
}

fn count(kind: &io::Species) -> usize {
    kind.count.unwrap_or(0) as usize
}

fn store(positions: &[Vector], radii: &[f64], species: &[u32]) -> Particles {
    let mut particles = Particles::default();
    for (id, &position) in positions.iter().enumerate() {
        particles.push(id as u64, position, radii[id], species[id]);
    }
    particles
}

/// Places on the coarsest lattice of about cubic cells that has enough sites; sites that are left over are vacant at
/// random.
fn on_lattice(cell: &PeriodicBox, lattice: Lattice, (count, seed): (usize, u64)) -> Vec<Vector> {
    let basis: &[[f64; 3]] = match lattice {
        Lattice::SimpleCubic => &[[0.5, 0.5, 0.5]],
        Lattice::FaceCentredCubic => &[[0.25, 0.25, 0.25], [0.75, 0.75, 0.25], [0.75, 0.25, 0.75], [0.25, 0.75, 0.75]],
    };
    let edges = cell.edges();
    let spacing = (cell.volume() * basis.len() as f64 / count as f64).cbrt();
    let mut cells = (edges / spacing).round().max(Vector::ONE);
    while (cells.element_product() as usize) * basis.len() < count {
        let widths = edges / cells;
        let widest = (0..3).max_by(|&a, &b| widths[a].total_cmp(&widths[b])).expect("three axes");
        cells[widest] += 1.0;
    }
    let [nx, ny, nz] = cells.to_array().map(|n| n as usize);
    let corners = (0..nz).flat_map(|z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z])));
    let site = |corner: [usize; 3]| {
        let corner = Vector::from_array(corner.map(|c| c as f64));
        basis.iter().map(move |&b| (corner + Vector::from_array(b)) / cells * edges)
    };
    let sites: Vec<Vector> = corners.flat_map(site).collect();
    let mut chosen: Vec<usize> = (0..sites.len()).collect();
    Random::new(seed, u64::MAX - 1).shuffle(&mut chosen);
    chosen.truncate(count);
    chosen.sort_unstable();
    chosen.into_iter().map(|i| sites[i]).collect()
}

/// Particles from a file: species as the file says, or in the order of the scene's counts; radii likewise.
fn placed(scene: &SuspensionScene, placed: Placed) -> anyhow::Result<Particles> {
    let count_here = placed.positions.len();
    let counted: Vec<u32> = (0..).zip(&scene.species).flat_map(|(s, kind)| vec![s; count(kind)]).collect();
    let species = match placed.species {
        Some(species) => species,
        None if scene.species.len() == 1 => vec![0; count_here],
        None => counted,
    };
    ensure!(
        species.len() == count_here,
        "has {count_here} positions, but the scene counts {} spheres; leave out the species' counts, or make them fit",
        species.len()
    );
    for (index, kind) in scene.species.iter().enumerate() {
        let found = species.iter().filter(|&&s| s as usize == index).count();
        if kind.count.is_some_and(|count| count as usize != found) {
            bail!("has {found} spheres of species \"{}\", but the scene counts {}", kind.name, count(kind));
        }
        ensure!(found > 0, "has no sphere of species \"{}\"; leave that species out, or bring some of it", kind.name);
    }
    if let Some(unknown) = species.iter().find(|&&s| s as usize >= scene.species.len()) {
        bail!("has a sphere of species {unknown}; the scene has {} species, from 0", scene.species.len());
    }
    let radii = placed.radii.unwrap_or_else(|| species.iter().map(|&s| scene.species[s as usize].radius).collect());
    Ok(store(&placed.positions, &radii, &species))
}

/// Gives every rank the columns, empty so far, that the first rank has. Collective.
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

    #[test]
    fn a_lattice_has_one_distance() {
        let cell = PeriodicBox::new(Vector::new(8.0, 8.0, 16.0)).unwrap();
        for (lattice, count, nearest) in
            [(Lattice::SimpleCubic, 128, 2.0), (Lattice::FaceCentredCubic, 64, 4.0 / 2.0_f64.sqrt())]
        {
            let sites = on_lattice(&cell, lattice, (count, 1));
            assert_eq!(sites.len(), count);
            for (i, &site) in sites.iter().enumerate() {
                let others = sites.iter().enumerate().filter(|(j, _)| *j != i);
                let least = others.map(|(_, &s)| cell.nearest_image(s - site).length()).fold(f64::INFINITY, f64::min);
                assert!((least - nearest).abs() < 1e-12);
            }
        }
        assert_eq!(on_lattice(&cell, Lattice::SimpleCubic, (100, 1)).len(), 100);
    }
}
