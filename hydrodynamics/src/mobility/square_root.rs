//! Square root of the mobility.

use super::{Mobility, MobilityError, ROOT};
use domain::{Vector, sphere};
use fcm::{DrawDiagnostics, LanczosLimits, Loads, Motion, square_root_times};
use solver::BackgroundFlow;

/// Largest number of applications of the mobility; hundreds of nearly touching spheres need about forty.
const MOST_APPLICATIONS: usize = 200;

/// Six numbers per sphere: for force or velocity, and for torque or angular velocity.
type RigidComponents = [f64; 6];

impl Mobility {
    /// `B z`, or `B^T z`, for a vector `z` of six numbers per sphere, with a square root `B B^T = M` of the mobility
    /// from forces and torques to velocities and angular velocities, stresslets and lubrication included, in boxes of
    /// any kind:
    ///
    /// ```text
    /// B = S (S^-1 M S^-1)^{1/2},       S = diag((6 pi mu a)^{-1/2}, (8 pi mu a^3)^{-1/2})
    /// ```
    ///
    /// where `S` are the square roots of single-sphere mobilities, so that `z` is dimensionless. With forces alone, the
    /// last three numbers of each sphere are ignored. Lanczos iteration on the whole mobility; each application is a
    /// solve to the mobility's tolerance. The numbers are those of the first rank, which has the result.
    pub fn root(
        &mut self,
        numbers: &[RigidComponents],
        transposed: bool,
    ) -> Result<(Vec<RigidComponents>, DrawDiagnostics), MobilityError> {
        self.parameters.check_noise()?;
        let driven = std::mem::take(&mut self.pressure_gradient);
        let found = self.root_at_rest(numbers, transposed);
        self.pressure_gradient = driven;
        found
    }

    fn root_at_rest(
        &mut self,
        numbers: &[RigidComponents],
        transposed: bool,
    ) -> Result<(Vec<RigidComponents>, DrawDiagnostics), MobilityError> {
        let comm = self.partition.comm().clone();
        let spheres = if comm.is_first() { self.parameters.radii.len() } else { 0 };
        let scales: Vec<[f64; 2]> = self.parameters.radii[..spheres].iter().map(|&a| self.scales(a)).collect();
        let mut start = numbers[..spheres].to_vec();
        if self.parameters.multipoles == fcm::Multipoles::Monopole {
            for numbers in &mut start {
                numbers[3..].fill(0.0);
            }
        }
        if transposed {
            start = times(&start, &scales, |number, scale| number * scale);
        }
        let tolerance = self.parameters.tolerance;
        let limits = LanczosLimits { tolerance: ROOT * tolerance, iterations: MOST_APPLICATIONS };
        let apply = |scaled: &[RigidComponents]| {
            self.unless_interrupted()?;
            let own = times(scaled, &scales, |number, scale| number / scale);
            let loads = Loads { forces: of(&own, 0), torques: of(&own, 3), stresslets: Vec::new() };
            let motion = self.apply(&loads, &BackgroundFlow::NONE)?.motion;
            Ok::<_, MobilityError>(times(&numbers_of(&motion), &scales, |number, scale| number / scale))
        };
        let (mut root, drawn) = square_root_times(&comm, &start, limits, apply)?;
        if drawn.change > tolerance {
            return Err(MobilityError::Root { applications: drawn.iterations, change: drawn.change, tolerance });
        }
        if !transposed {
            root = times(&root, &scales, |number, scale| number * scale);
        }
        Ok((root, drawn))
    }

    /// Square roots of the mobilities of a single sphere.
    fn scales(&self, radius: f64) -> [f64; 2] {
        let resistances = [sphere::drag(1.0, radius), sphere::rotational_drag(1.0, radius)];
        resistances.map(|resistance| (self.parameters.viscosity * resistance).sqrt().recip())
    }
}

fn times(list: &[RigidComponents], scales: &[[f64; 2]], by: impl Fn(f64, f64) -> f64) -> Vec<RigidComponents> {
    let one = |(numbers, scales): (&RigidComponents, &[f64; 2])| std::array::from_fn(|k| by(numbers[k], scales[k / 3]));
    list.iter().zip(scales).map(one).collect()
}

fn of(list: &[RigidComponents], first: usize) -> Vec<Vector> {
    list.iter().map(|numbers| Vector::from_slice(&numbers[first..])).collect()
}

fn numbers_of(motion: &Motion) -> Vec<RigidComponents> {
    let pairs = motion.velocities.iter().zip(&motion.angular_velocities);
    pairs.map(|(v, w)| [v.x, v.y, v.z, w.x, w.y, w.z]).collect()
}
