//! Suspensions in boxes whose special axis is not the user's z axis.

use super::{Axis, BodyOrientation, Centres, FieldVariation, Orientation, Parameters, Start};
use domain::{AxisRotation, Vector};

impl Parameters {
    /// The same suspension with all vectors, positions and per-axis parameters rotated from the user's axes to those of
    /// the box. The box itself is already in its own axes. Results of a run are rotated back to the user's axes.
    ///
    /// Shear flows and pressure-driven flows are along the axis that becomes x.
    #[must_use]
    pub fn turned(mut self, turn: AxisRotation) -> Self {
        if turn.is_none() {
            return self;
        }
        self.turn = turn;
        let axes = self.user_axes();
        self.gravity = axes.vector_in(self.gravity);
        for species in &mut self.species {
            (species.force, species.torque) = (axes.vector_in(species.force), axes.vector_in(species.torque));
            if let Some(Orientation::Aligned(axis)) = &mut species.orientation {
                *axis = axes.vector_in(*axis);
            }
        }
        for field in self.magnetic.iter_mut().chain(&mut self.electric) {
            field.amplitude = axes.vector_in(field.amplitude);
            if let FieldVariation::Rotating { axis, .. } = &mut field.variation {
                *axis = axes.vector_in(*axis);
            }
        }
        let filaments = self.filaments.iter_mut().map(|filaments| &mut filaments.rods);
        for bodies in self.bodies.iter_mut().chain(filaments) {
            (bodies.force, bodies.torque) = (axes.vector_in(bodies.force), axes.vector_in(bodies.torque));
            let motion = &mut bodies.motion;
            motion.velocity = turn.components(motion.velocity);
            motion.angular_velocity = turn.components(motion.angular_velocity);
            if let BodyOrientation::Aligned(axis) = &mut bodies.orientation {
                *axis = axes.vector_in(*axis);
            }
        }
        let inside = |places: &mut [Vector]| places.iter_mut().for_each(|place| *place = axes.place_in(*place));
        if let Start::Positions(places) = &mut self.start {
            inside(places);
        }
        let filaments = self.filaments.iter_mut().map(|filaments| &mut filaments.rods);
        let groups = self.bodies.iter_mut().chain(filaments);
        groups.filter_map(|bodies| bodies.positions.as_mut()).for_each(|places| inside(places));
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
