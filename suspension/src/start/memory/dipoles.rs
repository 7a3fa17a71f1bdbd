//! Memory of the fields of magnetic and electric moments.

use super::Share;
use domain::{Bytes, Particles};
use fcm::{Footprint, Plan};

impl Share<'_> {
    /// Fields of moments with their particles arranged, and an evaluation.
    pub(super) fn dipoles(&self) -> Bytes {
        let of_plan = |plan: &Plan| {
            let place = self.far.place_of(plan);
            let field = Footprint::new(plan, &place, self.threads, self.expected);
            let moved = Particles::bytes(self.expected.owned(), 16);
            field.mobility().then(moved.then(field.evaluation()).freed())
        };
        self.dipoles.iter().fold(Bytes::default(), |sum, plan| sum.then(of_plan(plan)))
    }
}
