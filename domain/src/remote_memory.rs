//! A memory on the host that stands for a remote one in tests.

use crate::{RemoteAdvance, RemoteDisplacement, RemoteFrame, RemoteHolder, RemoteList, Tensor, Vector};
use std::cell::{Cell, RefCell};

/// Lists, and the number of copies that were made of them.
#[derive(Default)]
pub struct RemoteMemory {
    pub lists: RefCell<Vec<(RemoteList, Vec<f64>)>>,
    pub copies: Cell<usize>,
}

impl RemoteMemory {
    fn values(&self, list: &RemoteList) -> Vec<f64> {
        self.lists.borrow().iter().find(|(known, _)| known == list).unwrap().1.clone()
    }

    fn vectors(&self, list: &RemoteList) -> Vec<Vector> {
        self.values(list).as_chunks().0.iter().map(|&vector| Vector::from_array(vector)).collect()
    }
}

impl RemoteHolder for RemoteMemory {
    fn copies(&self, lists: &[&RemoteList]) -> Vec<Vec<f64>> {
        self.copies.set(self.copies.get() + lists.len());
        lists.iter().map(|list| self.values(list)).collect()
    }

    fn hold(&self, values: &[f64]) -> RemoteList {
        let list = RemoteList::new();
        self.lists.borrow_mut().push((list.clone(), values.to_vec()));
        list
    }

    fn advance(&self, displaced: &RemoteDisplacement) -> Option<RemoteAdvance> {
        let &RemoteDisplacement { positions, steps, terms, velocities, frame } = displaced;
        let RemoteFrame { cell, gradient, deformation, renaming, farthest } = frame;
        let mut places = self.vectors(positions);
        for (term, weight) in terms {
            places.iter_mut().zip(self.vectors(term)).for_each(|(place, vector)| *place += vector * *weight);
        }
        if !places.iter().all(|&place| (place / cell.edges()).abs().max_element() < farthest) {
            return None;
        }
        let (wrapped, taken): (Vec<_>, Vec<_>) = places.into_iter().map(|place| cell.wrap(deformation * place)).unzip();
        let renaming = Tensor::from_cols_array_2d(&renaming.map(|row| row.map(f64::from))).transpose();
        let count = |(before, taken): (Vector, &[i32; 3])| renaming * before + Vector::from_array(taken.map(f64::from));
        let steps: Vec<Vector> = self.vectors(steps).into_iter().zip(&taken).map(count).collect();
        let carried = |list: &RemoteList| {
            let jump = |(before, taken): (Vector, &[i32; 3])| deformation * before - gradient * cell.lattice(*taken);
            let vectors: Vec<Vector> = self.vectors(list).into_iter().zip(&taken).map(jump).collect();
            self.hold(bytemuck::cast_slice(&vectors))
        };
        Some(RemoteAdvance {
            positions: self.hold(bytemuck::cast_slice(&wrapped)),
            steps: self.hold(bytemuck::cast_slice(&steps)),
            velocities: velocities.iter().map(carried).collect(),
        })
    }
}
