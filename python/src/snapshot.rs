//! Snapshots of the states of simulations, and changes to them.

use crate::arrays::{Rows, list_of};
use domain::{Comm, Quaternion, Vector};
use pyo3::prelude::*;
use scene::{Kind, Scene};
use simulation::{Rearrangement, State};
use std::mem::{Discriminant, discriminant};

/// The state of a simulation at a step, with the particles of this rank.
#[pyclass(frozen, name = "Snapshot", module = "fcm_solve._core")]
pub struct PySnapshot {
    state: State,
    kind: Discriminant<Kind>,
    /// Number of particles on all ranks.
    count: u64,
    has_inertia: bool,
}

impl PySnapshot {
    /// Snapshot of a state of a scene. Collective.
    pub fn of(state: State, scene: &Scene, comm: &Comm) -> Self {
        let count = count(&state, comm);
        let has_inertia = !matches!(scene.kind(), Kind::Suspension(_));
        Self { state, kind: discriminant(scene.kind()), count, has_inertia }
    }

    /// The state, if it fits a scene of its kind with `count` particles.
    pub fn state_for(&self, scene: &Scene, count: u64) -> Result<State, String> {
        if self.kind != discriminant(scene.kind()) {
            return Err("the snapshot is of a scene of another kind; take one of this simulation".to_owned());
        }
        if self.count != count {
            return Err(format!("the snapshot has {} particles; this simulation has {count}", self.count));
        }
        Ok(self.state.clone())
    }
}

/// Number of particles of a state on all ranks. Collective.
pub fn count(state: &State, comm: &Comm) -> u64 {
    let mut count = [state.particles.len() as f64];
    comm.sum(&mut count);
    count[0] as u64
}

#[pymethods]
impl PySnapshot {
    /// Whether velocities are a part of the state, and not a consequence of the positions.
    #[getter]
    fn has_inertia(&self) -> bool {
        self.has_inertia
    }
}

/// Ids of particles, and new values of a vector.
pub type Moved<'py> = (Vec<u64>, Rows<'py>);

/// Changes by the user of the first rank: of positions, velocities, angular velocities and orientations, and of radii,
/// each with ids.
pub fn rearrangement(
    moved: (Moved<'_>, Moved<'_>, Moved<'_>, Moved<'_>),
    radii: (Vec<u64>, Vec<f64>),
) -> PyResult<Rearrangement> {
    let (positions, velocities, angular_velocities, (rotated, orientations)) = moved;
    let orientations: Vec<Quaternion> = list_of(Some(orientations))?;
    let vectors = |(ids, rows): Moved<'_>| -> PyResult<Vec<(u64, Vector)>> {
        Ok(ids.into_iter().zip(list_of(Some(rows))?).collect())
    };
    Ok(Rearrangement {
        positions: vectors(positions)?,
        radii: radii.0.into_iter().zip(radii.1).collect(),
        velocities: vectors(velocities)?,
        angular_velocities: vectors(angular_velocities)?,
        orientations: rotated.into_iter().zip(orientations).collect(),
    })
}

/// The changes of the first rank, on all ranks. Collective.
pub fn shared(change: Rearrangement, comm: &Comm) -> Rearrangement {
    let Rearrangement { positions, radii, velocities, angular_velocities, orientations } = change;
    Rearrangement {
        positions: of_first(positions, comm),
        radii: of_first(radii, comm),
        velocities: of_first(velocities, comm),
        angular_velocities: of_first(angular_velocities, comm),
        orientations: of_first(orientations, comm),
    }
}

fn of_first<T: bytemuck::Pod>(list: Vec<(u64, T)>, comm: &Comm) -> Vec<(u64, T)> {
    let (mut ids, mut values): (Vec<u64>, Vec<T>) = list.into_iter().unzip();
    comm.broadcast(&mut ids);
    comm.broadcast(&mut values);
    ids.into_iter().zip(values).collect()
}
