//! Verlet lists on two levels: a wide list from a cell search, and a narrow one selected from it.

use super::super::{
    CellModel, Grains,
    grains::{periodic_box, wrap},
};
use domain::{Pair, Pairs, PeriodicBox, Vector};

/// Largest gap, over the diameter, of the pairs in the wide and in the narrow list.
const SKINS: [f64; 2] = [0.4, 0.06];

/// Pairs closer than a diameter and a skin, valid until a grain may have moved by half the skin
/// relative to the common motion.
#[derive(Default)]
pub struct GrainPairs {
    wide: Vec<(u32, u32, Vector)>,
    /// Pairs inside the box.
    pub within: Vec<(u32, u32)>,
    /// Pairs across periodic faces, with the shift of the second grain.
    pub across: Vec<(u32, u32, Vector)>,
    /// Common velocity relative to which displacements are counted: a common translation changes no pair.
    pub reference: Vector,
    travelled: [f64; 2],
}

impl GrainPairs {
    /// Adds an upper bound of the grains' displacements relative to the reference.
    pub fn moved(&mut self, distance: f64) {
        for travelled in &mut self.travelled {
            *travelled += distance;
        }
    }

    /// Rebuilds the lists if some grain may have moved by half the skin.
    pub fn refresh(&mut self, model: &CellModel, grains: &mut Grains, height: f64) {
        let half = SKINS.map(|skin| 0.5 * skin * model.parameters().diameter);
        if self.travelled[0] > half[0] - half[1] {
            self.search(model, grains, height);
        } else if self.travelled[1] > half[1] {
            self.narrow(model, grains);
        }
    }

    /// Wraps the positions and finds all pairs.
    pub fn search(&mut self, model: &CellModel, grains: &mut Grains, height: f64) {
        wrap(model, &mut grains.positions);
        let reach = model.parameters().diameter * (1.0 + SKINS[0]);
        let cell: PeriodicBox = periodic_box(model, 1.5 * reach, height);
        let ids: Vec<u64> = (0..grains.len() as u64).collect();
        let pairs = Pairs::find(&cell, &grains.positions, &ids, grains.len(), reach);
        let shifted = |p: &Pair| (p.i, p.j, cell.lattice(p.steps.map(i32::from)));
        self.wide.clear();
        self.wide.extend(pairs.list().iter().map(shifted));
        self.travelled[0] = 0.0;
        self.narrow(model, grains);
    }

    fn narrow(&mut self, model: &CellModel, Grains { positions, motions }: &Grains) {
        let reach = model.parameters().diameter * (1.0 + SKINS[1]);
        self.within.clear();
        self.across.clear();
        for &(i, j, shift) in &self.wide {
            let separation = positions[j as usize] + shift - positions[i as usize];
            if separation.length_squared() > reach * reach {
            } else if shift == Vector::ZERO {
                self.within.push((i, j));
            } else {
                self.across.push((i, j, shift));
            }
        }
        self.travelled[1] = 0.0;
        self.reference = motions.iter().map(|motion| motion.velocity).sum::<Vector>() / motions.len().max(1) as f64;
    }
}
