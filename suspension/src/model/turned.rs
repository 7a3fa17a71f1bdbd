//! Suspensions in boxes whose special axis is not z for their user.

use super::{Axis, Centres, Parameters, Start};
use domain::{Turn, Vector};

impl Parameters {
    /// The same suspension in the axes of its box, where the box is in them already and all else, as vectors, places and whatever is
    /// said of each axis, is in those of a user, which the turn makes those of the box. What is observed of a run is in the axes
    /// of the user again.
    ///
    /// A shear flow and that of a pressure gradient are along the axis that becomes x.
    #[must_use]
    pub fn turned(mut self, turn: Turn) -> Self {
        if turn.is_none() {
            return self;
        }
        self.turn = turn;
        let axes = self.user_axes();
        self.gravity = axes.vector_in(self.gravity);
        for species in &mut self.species {
            (species.force, species.torque) = (axes.vector_in(species.force), axes.vector_in(species.torque));
        }
        let inside = |places: &mut [Vector]| places.iter_mut().for_each(|place| *place = axes.place_in(*place));
        if let Start::Positions(places) = &mut self.start {
            inside(places);
        }
        for traps in &mut self.traps {
            match &mut traps.centres {
                Centres::AtStart => {}
                Centres::One(centre) => *centre = axes.place_in(*centre),
                Centres::Each(list) => inside(list),
            }
        }
        self.hydrodynamics.grid = self.hydrodynamics.grid.map(|points| turn.list(points));
        if let Some(statistics) = &mut self.statistics {
            let all = [Axis::X, Axis::Y, Axis::Z];
            statistics.axis = statistics.axis.map(|axis| all[axes.list([0, 1, 2])[axis as usize]]);
        }
        self
    }
}
