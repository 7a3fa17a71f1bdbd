//! Axes of spheres with orientations.

use base64::prelude::{BASE64_STANDARD, Engine};
use domain::{Particles, Quaternion};

/// Bytes of the axis of a particle in a frame.
pub(super) const EACH: usize = 3;

/// The axis of each particle of each frame in turn, zeros for particles without orientation.
#[derive(Default)]
pub(super) struct Axes {
    components: Vec<i8>,
}

/// Whether particles have orientations.
pub(super) fn are_in(particles: &Particles) -> bool {
    particles.columns.iter().any(|column| column.name == "orientation")
}

impl Axes {
    /// Adds the particles of a frame; all frames have orientations, or none has.
    pub(super) fn see(&mut self, particles: &Particles) {
        let Some(column) = particles.columns.iter().find(|column| column.name == "orientation") else { return };
        let axis = |q: &[f64; 4]| Quaternion::from_array(*q).axis().to_array().map(|part| (part * 127.0).round() as i8);
        self.components.extend(column.values.as_chunks().0.iter().flat_map(axis));
    }

    pub(super) fn is_empty(&self) -> bool {
        self.components.is_empty()
    }

    /// The list of bytes with the name of its element, if there are axes.
    pub(super) fn list(&self) -> Option<(String, String)> {
        let bytes: Vec<u8> = self.components.iter().map(|part| part.cast_unsigned()).collect();
        (!self.is_empty()).then(|| ("axes".to_owned(), BASE64_STANDARD.encode(bytes)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use domain::{Column, Vector};

    #[test]
    fn axes_are_directions_in_units_of_an_127th() {
        let mut particles = Particles::default();
        particles.push(0, Vector::ZERO, 1.0, 0);
        particles.push(1, Vector::ZERO, 1.0, 0);
        let mut axes = Axes::default();
        axes.see(&particles);
        assert!(axes.is_empty() && axes.list().is_none() && !are_in(&particles));
        let along = Quaternion::between(Vector::Z, Vector::new(0.6, 0.0, -0.8));
        let values = [along, Quaternion::NONE].map(Quaternion::to_array).concat();
        particles.columns.push(Column { name: "orientation".into(), width: 4, values: values.into() });
        axes.see(&particles);
        assert_eq!(axes.components, [76, 0, -102, 0, 0, 0]);
        assert_eq!(axes.list().unwrap().1, BASE64_STANDARD.encode([76, 0, 154, 0, 0, 0]));
    }
}
