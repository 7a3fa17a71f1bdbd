//! Checks of particles restored from a saved state.

use crate::columns::{self, ANGULAR_VELOCITY, STRESSLET, VELOCITY_COLUMNS};
use crate::evaluation::initial_guess::WarmStart;
use crate::forces::user::{APPLIED, APPLIED_MOMENT};
use crate::scalars::{AGES, CONSTANT_FLUX, NEXT_SUBSTEP, OLDEST_AGE, STRESS_CONTROL, STRESS_CONTROL_NUMBERS};
use domain::Particles;

/// Refuses particles of an unknown species, and columns whose width differs from that of a run.
pub fn check(particles: &Particles, species: usize, coupled: bool) -> Result<(), String> {
    if let Some(unknown) = particles.species.iter().find(|&&s| s as usize >= species) {
        return Err(format!("a sphere is of species {unknown}; the scene has {species}, from 0"));
    }
    let known = widths(coupled);
    for column in &particles.columns {
        let width = known.iter().find(|(name, _)| *name == column.name).map(|(_, width)| *width);
        if let Some(width) = width.filter(|&width| width != column.width) {
            return Err(format!("\"{}\" has {} numbers for each particle, not {width}", column.name, column.width));
        }
    }
    Ok(())
}

/// Names and widths of the columns of a run.
fn widths(coupled: bool) -> Vec<(String, usize)> {
    let velocities = VELOCITY_COLUMNS.map(|name| (name.to_owned(), 3));
    let of_steps = [(AGES, 2), (OLDEST_AGE, 1), (NEXT_SUBSTEP, 1)];
    let others = [(ANGULAR_VELOCITY, 3), (STRESSLET, 5), (STRESS_CONTROL, STRESS_CONTROL_NUMBERS), (CONSTANT_FLUX, 1)];
    let others = others.into_iter().chain(of_steps).map(|(name, width)| (name.to_owned(), width));
    let applied = APPLIED.map(|name| (name.to_owned(), 3)).into_iter().chain([(APPLIED_MOMENT.to_owned(), 9)]);
    let of_orientations = columns::of_orientations().map(|(name, width)| (name.to_owned(), width));
    velocities
        .into_iter()
        .chain(others)
        .chain(of_orientations)
        .chain(columns::of_bodies().map(|(name, width)| (name.to_owned(), width)))
        .chain(applied)
        .chain(WarmStart::new(coupled).kept())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use domain::Vector;

    #[test]
    fn columns_of_another_width_are_refused() {
        for (name, width) in widths(true) {
            let mut particles = Particles::default();
            particles.push(0, Vector::ONE, 1.0, 0);
            particles.column("another", 7);
            particles.column(&name, width);
            assert_eq!(check(&particles, 1, true), Ok(()), "{name}");
            particles.columns[1].width += 1;
            let message = check(&particles, 1, true).unwrap_err();
            assert!(message.contains(&format!("{name}\" has {} numbers", width + 1)), "{message}");
        }
        assert!(widths(false).len() < widths(true).len());
    }

    #[test]
    fn spheres_of_no_species_are_refused() {
        let mut particles = Particles::default();
        particles.push(0, Vector::ONE, 1.0, 2);
        assert_eq!(check(&particles, 3, false), Ok(()));
        assert!(check(&particles, 2, false).unwrap_err().contains("species 2"));
    }
}
