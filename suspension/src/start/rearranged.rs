//! States with positions or radii changed by the user.

use crate::columns::{ANGULAR_VELOCITY, BROWNIAN, STRESSLET, VELOCITY, clear_history};
use crate::evaluation::initial_guess::WarmStart;
use crate::forces::Forces;
use crate::forces::user::{APPLIED, APPLIED_MOMENT};
use crate::model::box_axes::UserAxes;
use domain::Vector;
use simulation::{Rearrangement, RearrangementError, State};

/// The state with some values changed, without velocities, history and previous solutions.
pub fn rearranged(mut state: State, change: &Rearrangement, axes: &UserAxes) -> Result<State, RearrangementError> {
    if !(change.velocities.is_empty() && change.angular_velocities.is_empty()) {
        return Err(RearrangementError::NoInertia);
    }
    if let Some(&(id, radius)) = change.radii.iter().find(|(_, radius)| !(radius.is_finite() && *radius > 0.0)) {
        return Err(RearrangementError::Radius(id, radius));
    }
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
