//! Extent of filaments.

use super::observable::{Observable, measure};
use crate::model::{Filaments, Model};
use crate::suspension::Suspension;
use domain::Vector;
use simulation::Quantity;

/// The mean extent of the filaments of each kind; `None` without filaments.
pub fn filaments(model: &Model) -> Option<Box<dyn Observable>> {
    if model.filaments.is_empty() {
        return None;
    }
    let names = model.filaments.iter().map(|one| one.rods.name.clone()).collect();
    let table = Some((names, vec!["end_to_end".to_owned()]));
    let chains: Vec<FilamentEnds> = FilamentEnds::of(model);
    Some(measure(Quantity { name: "filaments".into(), unit: "", table }, move |present| {
        chains.iter().map(|chains| chains.mean_extent(present.suspension())).collect()
    }))
}

/// The filaments of one kind.
struct FilamentEnds {
    /// Id of the first sphere.
    first: u64,
    spheres: u64,
    count: u64,
    /// Distance of the centres at the ends of a straight filament without load.
    length: f64,
}

impl FilamentEnds {
    fn of(model: &Model) -> Vec<Self> {
        let mut first = model.free_spheres();
        let chains = |one: &Filaments| {
            let (spheres, count) = (one.rods.spheres.len() as u64, one.rods.count);
            let ends = [0, spheres as usize - 1].map(|k| one.rods.spheres[k].position);
            let chains = Self { first, spheres, count, length: ends[0].distance(ends[1]) };
            first += spheres * count;
            chains
        };
        model.filaments.iter().map(chains).collect()
    }

    /// Mean distance of the ends over the length. Each sum over ranks has one addend from each of the two ends.
    /// Collective.
    fn mean_extent(&self, suspension: &Suspension) -> f64 {
        let (particles, cell) = (suspension.particles(), suspension.cell());
        let mut between = vec![Vector::ZERO; self.count as usize];
        for (row, id) in particles.ids.iter().enumerate() {
            let Some(place) = id.checked_sub(self.first).filter(|place| *place < self.spheres * self.count) else {
                continue;
            };
            let end = place % self.spheres;
            let sign = f64::from(u8::from(end == self.spheres - 1)) - f64::from(u8::from(end == 0));
            if sign != 0.0 {
                let unwrapped = particles.positions[row] + cell.lattice(particles.steps[row]);
                between[(place / self.spheres) as usize] += sign * unwrapped;
            }
        }
        suspension.comm().sum(bytemuck::cast_slice_mut(&mut between));
        between.iter().map(|vector| vector.length()).sum::<f64>() / (self.count as f64 * self.length)
    }
}
