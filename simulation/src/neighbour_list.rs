//! Particles near each other, as users see them.

use domain::{Number, Pairs, Particles, PeriodicBox, Vector};

/// All pairs of particles whose centres are nearer than a cutoff, each once over all images; a particle and its own
/// image are a pair too. Ordered by the first particle.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct NeighbourList {
    /// Rows of both among the particles in the order of their ids.
    pub pairs: Vec<[u32; 2]>,
    /// From the centre of the first to that of the second, as near as it is.
    pub separations: Vec<Vector>,
    /// Between the surfaces, negative where they overlap.
    pub gaps: Vec<f64>,
}

/// The error of a cutoff within which there are too many images.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "the cutoff is {}; it needs to be at most {}, the shortest edge along which the box repeats",
    Number(self.cutoff),
    Number(self.most)
)]
pub struct CutoffError {
    cutoff: f64,
    most: f64,
}

/// Edges of a box within the cutoff along an axis that its particles do not repeat along.
const MOST_EDGES: f64 = 100.0;

impl NeighbourList {
    /// The pairs of particles in the order of their ids, in a box that repeats along some axes.
    pub fn find(
        particles: &Particles,
        cell: &PeriodicBox,
        periodic: [bool; 3],
        cutoff: f64,
    ) -> Result<Self, CutoffError> {
        let farthest = |axis: usize| cell.edges()[axis] * if periodic[axis] { 1.0 } else { MOST_EDGES };
        let repeating = (0..3).filter(|&axis| cell.is_periodic(axis));
        let most = repeating.map(farthest).fold(f64::INFINITY, f64::min);
        if cutoff > most {
            return Err(CutoffError { cutoff, most });
        }
        let Particles { positions, radii, ids, .. } = particles;
        let all = Pairs::find(cell, positions, ids, positions.len(), cutoff);
        let mut found = Self::default();
        for pair in all.list() {
            if pair.steps.iter().zip(periodic).any(|(&steps, repeats)| steps != 0 && !repeats) {
                continue;
            }
            let separation = pair.separation(cell, positions);
            found.pairs.push([pair.i, pair.j]);
            found.separations.push(separation);
            found.gaps.push(separation.length() - radii[pair.i as usize] - radii[pair.j as usize]);
        }
        Ok(found)
    }

    /// The same as seen from other axes.
    #[must_use]
    pub fn turned(self, vector: impl Fn(Vector) -> Vector) -> Self {
        Self { separations: self.separations.into_iter().map(vector).collect(), ..self }
    }
}
