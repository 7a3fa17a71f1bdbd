//! Displacements of particles without the flow.

use domain::Vector;
use statistics::{State, Store, TrackedMotion};

/// Displacement of each particle since the first sample, without the contribution of the flow along its path. Along
/// axes without a flow it is exactly that of the unwrapped position; along the flow, the integral of the relative
/// velocity, by the trapezoidal rule over the samples.
#[derive(Debug, Default)]
pub struct Paths {
    time: f64,
    places: Vec<Vector>,
    velocities: Vec<Vector>,
    walked: Vec<Vector>,
}

impl Paths {
    /// Advances to a time, with unwrapped positions and with velocities relative to the flow, which moves the particles
    /// along the axes that `advects` marks.
    pub fn follow(
        &mut self,
        time: f64,
        places: Vec<Vector>,
        velocities: Vec<Vector>,
        advects: [bool; 3],
    ) -> Vec<TrackedMotion> {
        if self.walked.is_empty() {
            self.walked = vec![Vector::ZERO; places.len()];
        } else {
            let elapsed = time - self.time;
            for (row, path) in self.walked.iter_mut().enumerate() {
                let moved = places[row] - self.places[row];
                let integral = 0.5 * elapsed * (self.velocities[row] + velocities[row]);
                for axis in 0..3 {
                    path[axis] += if advects[axis] { integral[axis] } else { moved[axis] };
                }
            }
        }
        (self.time, self.places, self.velocities) = (time, places, velocities);
        self.velocities.iter().zip(&self.walked).map(|(&velocity, &path)| TrackedMotion { velocity, path }).collect()
    }

    /// Whether it has this number of particles, or none yet.
    pub fn fits(&self, particles: usize) -> bool {
        let lengths = [&self.places, &self.velocities, &self.walked].map(Vec::len);
        lengths == [0; 3] || lengths == [particles; 3]
    }
}

impl State for Paths {
    fn visit(&mut self, store: &mut dyn Store) {
        store.number(&mut self.time);
        for vectors in [&mut self.places, &mut self.velocities, &mut self.walked] {
            let mut numbers: Vec<f64> = bytemuck::cast_slice(vectors).to_vec();
            store.numbers(&mut numbers);
            *vectors = numbers.chunks_exact(3).map(Vector::from_slice).collect();
        }
    }
}
