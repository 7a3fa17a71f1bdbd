//! States with positions or radii changed by the user.

use crate::columns::{ANGULAR_VELOCITY, BROWNIAN, STRESSLET, VELOCITY, clear_history};
use crate::evaluation::initial_guess::WarmStart;
use crate::forces::Forces;
use crate::forces::user::{APPLIED, APPLIED_MOMENT};
use crate::model::box_axes::UserAxes;
use crate::{bodies, rotation};
use domain::{Particles, Quaternion, Vector};
use simulation::{Rearrangement, RearrangementError, State};
use std::collections::HashSet;

/// Changes orientations, each to the rotation of a quaternion of any length.
fn turn(particles: &mut Particles, to: &[(u64, Quaternion)], axes: &UserAxes) -> Result<(), RearrangementError> {
    if to.is_empty() {
        return Ok(());
    }
    if let Some((id, none)) = to.iter().find(|(_, q)| !(q.length() > 0.0 && q.length().is_finite())) {
        return Err(RearrangementError::NoRotation(*id, none.to_array()));
    }
    let without = without_orientation(particles);
    if let Some((id, _)) = to.iter().find(|(id, _)| without.contains(id)) {
        return Err(RearrangementError::NoOrientation(*id));
    }
    if !rotation::is_oriented(particles) {
        return Ok(());
    }
    let inside: Vec<(u64, Quaternion)> = to.iter().map(|&(id, q)| (id, axes.orientation_in(q.normalized()))).collect();
    let ids = particles.ids.clone();
    Rearrangement::put(&inside, &ids, rotation::orientations(particles));
    Ok(())
}

/// Ids of this rank's particles without orientation.
fn without_orientation(particles: &mut Particles) -> HashSet<u64> {
    if !rotation::is_oriented(particles) {
        return particles.ids.iter().copied().collect();
    }
    let ids = particles.ids.clone();
    let all = ids.into_iter().zip(rotation::orientations(particles));
    all.filter(|(_, orientation)| !orientation.is_some()).map(|(id, _)| id).collect()
}

/// The state with some values changed, without velocities, history and previous solutions.
pub fn rearranged(mut state: State, change: &Rearrangement, axes: &UserAxes) -> Result<State, RearrangementError> {
    if !(change.velocities.is_empty() && change.angular_velocities.is_empty()) {
        return Err(RearrangementError::NoInertia);
    }
    if bodies::exist(&state.particles) && !change.is_empty() {
        return Err(RearrangementError::RigidBodies);
    }
    if let Some(&(id, radius)) = change.radii.iter().find(|(_, radius)| !(radius.is_finite() && *radius > 0.0)) {
        return Err(RearrangementError::Radius(id, radius));
    }
    turn(&mut state.particles, &change.orientations, axes)?;
    let particles = &mut state.particles;
    let places: Vec<(u64, Vector)> = change.positions.iter().map(|&(id, place)| (id, axes.place_in(place))).collect();
    Rearrangement::put(&places, &particles.ids, &mut particles.positions);
    Rearrangement::put(&change.radii, &particles.ids, &mut particles.radii);
    WarmStart::clear_all(particles);
    clear_history(particles);
    let motion = [VELOCITY, ANGULAR_VELOCITY, STRESSLET, BROWNIAN, APPLIED_MOMENT];
    let computed = |name: &str| [&motion[..], &APPLIED].concat().contains(&name);
    particles.columns.retain(|column| !(computed(&column.name) || Forces::is_mark(&column.name)));
    Ok(state)
}
