//! Rotations of spheres with orientations: correlation of their axes and mean square rotation.

use crate::columns::ORIENTATION;
use domain::{Particles, Quaternion, Vector};
use simulation::Table;
use statistics::{Diffusivity, Estimate, LagSums, Lagrangian, State, Store, TrackedMotion};

/// Rotation of each particle of a block since the first sample, and its averages over all starting times.
///
/// The rotation vector is the sum of those from sample to sample, each at most half a turn, in the axes of space; so it
/// grows without bound, like a displacement. For a rotational diffusivity `D` its mean square along each axis is
/// `2 D t`, less a fraction `D h / 6` for samples at intervals `h`, and the axes have `<p(0) . p(t)> = exp(-2 D t)`.
pub struct Rotations {
    last: Vec<Quaternion>,
    rotated: Vec<Vector>,
    lagrangian: Lagrangian,
}

impl Rotations {
    /// Without samples, for particles of these species after others, whose numbers are `before`.
    pub fn after(before: Vec<u64>, species: &[u32]) -> Self {
        Self { last: Vec::new(), rotated: Vec::new(), lagrangian: Lagrangian::after(before, species) }
    }

    /// Adds the orientations of the particles at a time, zero for those without.
    pub fn add(&mut self, time: f64, orientations: &[Quaternion]) {
        if self.last.is_empty() {
            self.rotated = vec![Vector::ZERO; orientations.len()];
        } else {
            for ((rotated, last), now) in self.rotated.iter_mut().zip(&self.last).zip(orientations) {
                *rotated += (*now * last.inverse()).log();
            }
        }
        self.last = orientations.to_vec();
        let motion = |(q, &path): (&Quaternion, &Vector)| TrackedMotion { velocity: q.axis(), path };
        let motions: Vec<TrackedMotion> = orientations.iter().zip(&self.rotated).map(motion).collect();
        self.lagrangian.add(time, &motions);
    }

    /// Passes over missing samples.
    pub fn skip_missing(&mut self, missing: u64) {
        self.lagrangian.skip_missing(missing);
    }

    /// Sums over the particles.
    pub fn sums(&self) -> LagSums {
        self.lagrangian.sums()
    }

    /// Whether a restored state is for the same number of particles.
    pub fn fits(&self) -> bool {
        let lengths = [self.last.len(), self.rotated.len()];
        self.lagrangian.fits() && (lengths == [0; 2] || lengths == [self.lagrangian.particles(); 2])
    }
}

impl State for Rotations {
    fn visit(&mut self, store: &mut dyn Store) {
        let mut numbers: Vec<f64> = bytemuck::cast_slice(&self.last).to_vec();
        store.numbers(&mut numbers);
        self.last = numbers.chunks_exact(4).map(|q| Quaternion::from_array([q[0], q[1], q[2], q[3]])).collect();
        let mut numbers: Vec<f64> = bytemuck::cast_slice(&self.rotated).to_vec();
        store.numbers(&mut numbers);
        self.rotated = numbers.chunks_exact(3).map(Vector::from_slice).collect();
        self.lagrangian.visit(store);
    }
}

/// The orientations of particles; `None` if they have none.
pub fn orientations(particles: &Particles) -> Option<&[Quaternion]> {
    let column = particles.columns.iter().find(|column| column.name == ORIENTATION)?;
    Some(bytemuck::cast_slice(&column.values))
}

/// Correlation of the axes and mean square rotation of each species, at all lags.
pub fn table(lags: &LagSums, species: &[(usize, String)]) -> Table {
    let columns = [("time", "time"), ("correlation", ""), ("rotation_x", ""), ("rotation_y", ""), ("rotation_z", "")];
    let mut table = Table::new("rotations", &["species"], &columns);
    for (index, name) in species {
        for lag in lags.lags(Some(*index)) {
            let correlation = lag.product.x + lag.product.y + lag.product.z;
            let [x, y, z] = lag.mean_square_displacement.to_array();
            table.add(&[name], &[lag.time, correlation, x, y, z]);
        }
    }
    table
}

/// Rotational diffusivity of a species: half the slope of its mean square rotation in a window of lags, the mean over
/// the axes, see [`Diffusivity`].
pub fn diffusivity(lags: &LagSums, species: usize, window: [f64; 2]) -> Estimate {
    lags.estimate(Some(species), |lags| Diffusivity::mean_slope(lags, window))
}

#[cfg(test)]
mod tests {
    use super::*;
    use domain::Random;

    /// Brownian rotations with a known diffusivity: the estimate is that within three errors, which are small, and the
    /// correlation of the axes decays as it should.
    #[test]
    fn the_diffusivity_of_random_rotations_is_found() {
        let (diffusivity, step, count, steps) = (0.5, 0.02, 400, 400);
        let species = vec![0; count];
        let mut rotations = Rotations::after(vec![0], &species);
        let random = |id: u64, step: u64| {
            let mut random = Random::new(step, id);
            let [x, y] = random.normal();
            Vector::new(x, y, random.normal()[0])
        };
        let mut orientations = vec![Quaternion::IDENTITY; count];
        for number in 0..steps {
            rotations.add(number as f64 * step, &orientations);
            for (id, q) in orientations.iter_mut().enumerate() {
                *q = Quaternion::exp(random(id as u64, number) * (2.0 * diffusivity * step).sqrt()) * *q;
            }
        }
        let sums = rotations.sums();
        let found = super::diffusivity(&sums, 0, [0.0, 1.0]);
        assert!((found.mean - diffusivity).abs() < 3.0 * found.error && found.error < 0.02, "{found:?}");
        let table = table(&sums, &[(0, "one".to_owned())]);
        let values: Vec<[f64; 2]> = table.rows.iter().map(|(_, row)| [row[0], row[1]]).collect();
        for [time, correlation] in values.into_iter().filter(|[time, _]| *time < 1.5) {
            assert!((correlation - (-2.0 * diffusivity * time).exp()).abs() < 0.05, "{correlation} after {time}");
        }
    }

    /// A steady rotation by many turns has no diffusivity, and is one of many turns.
    #[test]
    fn a_steady_rotation_is_followed_for_many_turns() {
        let mut rotations = Rotations::after(vec![0], &[0, 0]);
        let at = |time: f64| [Quaternion::exp(Vector::Y * time), Quaternion::NONE];
        (0..200).for_each(|step| rotations.add(f64::from(step), &at(f64::from(step))));
        assert!((rotations.rotated[0] - 199.0 * Vector::Y).length() < 1e-11);
        assert_eq!(rotations.rotated[1], Vector::ZERO);
        let mut again = Rotations::after(vec![0], &[0, 0]);
        assert!(again.load(&rotations.save()) && again.fits());
        assert_eq!(again.save(), rotations.save());
    }
}
