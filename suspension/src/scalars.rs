//! Scalars of a suspension's state: their names, and their form in saved states.

use domain::{Comm, Particles};

/// State of the stress control: strain; present, past and mean rate; slope.
pub const STRESS_CONTROL: &str = "driven flow";

/// Number of numbers of [`STRESS_CONTROL`].
pub const STRESS_CONTROL_NUMBERS: usize = 5;

/// Curvature of the flow that keeps the flux.
pub const CONSTANT_FLUX: &str = "curvature of the flow";

/// State of the stiffness adaptation: stiffness, strain so far, and whether the adaptation is over.
pub const ADAPTATION: &str = "contact stiffness";

/// Number of numbers of [`ADAPTATION`].
pub const ADAPTATION_NUMBERS: usize = 3;

/// Ages of the past velocities and solutions; 0 for none.
pub const AGES: &str = "past ages";

/// Age of the third past velocities; 0 for none. It does not exist for integrators that use at most two.
pub const OLDEST_AGE: &str = "oldest past age";

/// Length of the next substep that the error allows.
pub const NEXT_SUBSTEP: &str = "next substep";

/// Weight of the parabola in the extrapolation of each column of the previous solutions.
pub const BLEND: &str = "curvature of the past";

/// Scalars that saved states store as columns, equal for all particles, so that versions before scalars can read them.
/// All others are scalars in saved states as well.
const AS_COLUMNS: [&str; 7] = [STRESS_CONTROL, CONSTANT_FLUX, ADAPTATION, AGES, OLDEST_AGE, NEXT_SUBSTEP, BLEND];

/// Turns the columns of a saved state that stand for scalars into these, and gives all ranks the scalars of the first.
/// All ranks have the same columns. Collective.
pub fn restore(particles: &mut Particles, comm: &Comm) {
    particles.scalars.share(comm);
    for name in AS_COLUMNS {
        let Some(place) = particles.columns.iter().position(|column| column.name == name) else { continue };
        let column = particles.columns.remove(place);
        let own = column.values.get(..column.width).unwrap_or_default();
        let known = comm.all_gather(own);
        if let Some(values) = known.get(..column.width) {
            particles.scalars.set(name, values);
        }
    }
}

/// Turns scalars into the columns that stand for them in saved states.
pub fn save(particles: &mut Particles) {
    for name in AS_COLUMNS {
        let Some(values) = particles.scalars.get(name).map(<[f64]>::to_vec) else { continue };
        let count = particles.len();
        particles.column(name, values.len()).values = values.repeat(count).into();
    }
    particles.scalars.retain(|name| !AS_COLUMNS.contains(&name));
}

#[cfg(test)]
mod tests {
    use super::*;
    use domain::{Scalars, Vector};

    /// Saved states have the columns of former versions, and from these the scalars are restored on all ranks,
    /// whichever of them have particles.
    #[test]
    fn scalars_survive_as_columns_and_as_scalars() {
        let mut scalars = Scalars::default();
        scalars.set(NEXT_SUBSTEP, &[1.0 / 3.0]);
        scalars.set("strokes of a pump", &[4.0, -0.0]);
        scalars.set(STRESS_CONTROL, &[0.5, -1.0, -2.0, -3.0, 7.0]);
        for owner in 0..3 {
            let found = Comm::threads(3, |comm| {
                let mut particles = Particles::default();
                if comm.rank() == owner {
                    (0..2).for_each(|id| particles.push(id, Vector::ZERO, 1.0, 0));
                }
                particles.column("another", 1);
                particles.scalars = scalars.clone();
                save(&mut particles);
                assert_eq!(particles.check(), Ok(()));
                let names: Vec<&str> = particles.columns.iter().map(|column| &column.name[..]).collect();
                assert_eq!(names, ["another", STRESS_CONTROL, NEXT_SUBSTEP]);
                let of_all = [0.5, -1.0, -2.0, -3.0, 7.0].repeat(particles.len());
                assert_eq!((&*particles.columns[1].values, particles.columns[1].width), (&of_all, 5));
                assert_eq!(particles.scalars.iter().count(), 1);
                if !comm.is_first() {
                    particles.scalars = Scalars::default();
                }
                restore(&mut particles, &comm);
                assert_eq!(particles.columns.len(), 1);
                particles.scalars
            });
            for found in found {
                assert_eq!(found.iter().count(), 3);
                assert!(scalars.iter().all(|scalar| found.get(&scalar.name) == Some(&scalar.values)), "{found:?}");
            }
        }
    }
}
