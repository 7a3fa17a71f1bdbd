//! Sites of a lattice, of which each rank makes those of its own spheres.

use crate::model::Lattice;
use domain::{PeriodicBox, Random, Vector};
use std::ops::Range;

/// Sites of spheres on the coarsest lattice of roughly cubic cells with enough sites; vacancies are random.
pub struct Sites<'a> {
    cell: &'a PeriodicBox,
    basis: &'static [[f64; 3]],
    /// Numbers of cells along the axes.
    cells: Vector,
    /// Number of spheres on sites before each vacancy, in ascending order.
    vacancies: Vec<usize>,
}

impl<'a> Sites<'a> {
    /// Sites for `count` spheres.
    pub fn new(cell: &'a PeriodicBox, lattice: Lattice, count: usize, seed: u64) -> Self {
        let basis: &[[f64; 3]] = match lattice {
            Lattice::SimpleCubic => &[[0.5, 0.5, 0.5]],
            Lattice::FaceCentredCubic => {
                &[[0.25, 0.25, 0.25], [0.75, 0.75, 0.25], [0.75, 0.25, 0.75], [0.25, 0.75, 0.75]]
            }
        };
        let edges = cell.edges();
        let mut cells = (edges / spacing(cell, basis.len() as f64, count as f64)).round().max(Vector::ONE);
        while (cells.element_product() as usize) * basis.len() < count {
            let widths = edges / cells;
            let widest = (0..3).max_by(|&a, &b| widths[a].total_cmp(&widths[b])).expect("three axes");
            cells[widest] += 1.0;
        }
        let sites = cells.element_product() as usize * basis.len();
        let vacant = Random::new(seed, u64::MAX - 1).shuffled_beyond(count, sites);
        Self { cell, basis, cells, vacancies: vacant.into_iter().enumerate().map(|(k, site)| site - k).collect() }
    }

    /// Positions of the spheres with these numbers. Sites are counted along x first, then y, then z.
    pub fn positions(&self, spheres: Range<usize>) -> Vec<Vector> {
        spheres.map(|sphere| self.site(sphere + self.vacancies.partition_point(|&before| before <= sphere))).collect()
    }

    fn site(&self, number: usize) -> Vector {
        let ([nx, ny, _], corner) = (self.cells.to_array().map(|n| n as usize), number / self.basis.len());
        let corner = Vector::from_array([corner % nx, corner / nx % ny, corner / nx / ny].map(|c| c as f64));
        let within = Vector::from_array(self.basis[number % self.basis.len()]);
        self.cell.position((corner + within) / self.cells * self.cell.edges())
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    fn on_lattice(cell: &PeriodicBox, lattice: Lattice, count: usize, seed: u64) -> Vec<Vector> {
        Sites::new(cell, lattice, count, seed).positions(0..count)
    }

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

    /// The sites of all spheres are those of a shuffled list of all sites.
    #[test]
    fn vacancies_are_those_of_a_shuffled_list() {
        let cell = PeriodicBox::new(Vector::new(9.0, 7.0, 11.0)).unwrap();
        for (lattice, count) in [(Lattice::SimpleCubic, 300), (Lattice::FaceCentredCubic, 333)] {
            let sites = Sites::new(&cell, lattice, count, 5);
            let all = sites.cells.element_product() as usize * sites.basis.len();
            assert!(all > count);
            let mut chosen: Vec<usize> = (0..all).collect();
            Random::new(5, u64::MAX - 1).shuffle(&mut chosen);
            chosen.truncate(count);
            chosen.sort_unstable();
            let listed: Vec<Vector> = chosen.into_iter().map(|number| sites.site(number)).collect();
            assert_eq!([sites.positions(0..100), sites.positions(100..count)].concat(), listed);
        }
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
