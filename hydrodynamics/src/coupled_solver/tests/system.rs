//! The coupled system as a dense matrix, column by column.

use super::*;
use crate::ambient::StrainRate;
use crate::pairs::search::Pairs;
use crate::preconditioner::Preconditioner;
use crate::system::{CoupledSystem, SingleSpheres, SystemStart};
use crate::unknowns::{MotionsWithLoads, Residual, Unknowns, resisted};
use fcm::{Linear, System};
use std::f64::consts::FRAC_1_SQRT_2;

/// Traceless tensors that are orthonormal under contraction.
fn orthonormal() -> [Traceless; 5] {
    let (half, sixth) = (FRAC_1_SQRT_2, 6.0_f64.sqrt().recip());
    [
        Traceless([half, 0.0, 0.0, -half, 0.0]),
        Traceless([sixth, 0.0, 0.0, sixth, 0.0]),
        Traceless([0.0, half, 0.0, 0.0, 0.0]),
        Traceless([0.0, 0.0, half, 0.0, 0.0]),
        Traceless([0.0, 0.0, 0.0, 0.0, half]),
    ]
}

/// A random bidisperse suspension at 30%, with one pair near contact.
fn suspension() -> (Plan, Particles) {
    let radii = [1.0, 1.5, 1.0, 1.5, 1.0];
    let volume: f64 = radii.iter().map(|a| 4.0 / 3.0 * PI * a * a * a).sum();
    let edge = (volume / 0.3).cbrt();
    let cell = cube(edge);
    let mut positions = random_packing(&cell, &radii, 0.0, 3).unwrap();
    let line = cell.nearest_image(positions[1] - positions[0]).normalize();
    positions[1] = positions[0] + line * (2.5 + 1e-3);
    let mut particles = placed(&positions, &radii);
    particles.wrap(&cell);
    (plan(edge, &radii[..2], 1e-3, 1e-3), particles)
}

/// A suspension on one rank, with the ingredients of its system.
struct Setting {
    mobility: Mobility,
    near: NearPairs,
    spheres: SingleSpheres,
}

impl Setting {
    fn new() -> Self {
        let (plan, particles) = suspension();
        let (cell, partition) = (plan.cell(), Partition::new(&Comm::alone(), [plan.grid[1], plan.grid[2]]));
        let force = PairForce::new(&plan.radii, 1.0, LubricationRange::default()).unwrap();
        let alone: Vec<SixVector> = plan.radii.iter().map(|&a| single(1.0, a)).collect();
        let (reach, radii) = (force.reach(), plan.radii.clone());
        let (lubrication, lists) = (Some(PairLubrication::new(force, &alone)), NearLists::new(reach, &partition));
        let mut field = NearField { lubrication, at_walls: None, lists, precision: plan.precision, radii };
        let near = NearPairs::find(
            &mut field,
            Connections::default(),
            &particles,
            DomainView { cell: &cell, partition: &partition },
            StrainRate::default(),
        );
        let mut mobility = Mobility::new(&plan, &partition);
        mobility.arrange(&cell, &particles);
        Self { mobility, near, spheres: SingleSpheres::new(1.0, &particles.radii) }
    }

    fn spheres(&self) -> usize {
        self.spheres.motion.len()
    }

    /// A unit vector of unknowns: motions for stiff pairs, motions for soft pairs, or moments in an orthonormal basis,
    /// scaled by the square roots of the single-sphere resistances.
    fn unit(&self, k: usize) -> Unknowns {
        let n = self.spheres();
        let mut motions = [SixVectors(vec![SixVector::default(); n]), SixVectors(vec![SixVector::default(); n])];
        let mut moments = vec![Traceless::ZERO; n];
        if k < 12 * n {
            motions[k / (6 * n)].0[k / 6 % n].0[k % 6] = 1.0;
        } else {
            let (particle, component) = ((k - 12 * n) / 5, (k - 12 * n) % 5);
            moments[particle] = orthonormal()[component] * self.spheres.strain[particle].sqrt();
        }
        let [stiff, soft] = motions;
        let stiff = resisted(&self.near, Pairs::Stiff, &stiff);
        Unknowns { stiff, soft: resisted(&self.near, Pairs::Soft, &soft), moments }
    }

    fn system(&mut self) -> CoupledSystem<'_> {
        let nothing = SixVectors(vec![SixVector::default(); self.spheres()]);
        let resisted = MotionsWithLoads { motions: nothing.clone(), loads: nothing.clone() };
        let moments = vec![Traceless::ZERO; self.spheres()];
        let start = Unknowns { stiff: resisted.clone(), soft: resisted, moments };
        let matrix = Some(Preconditioner::new(&Comm::alone(), &self.near, &self.spheres.motion, 0.1));
        let mobility = Scaled { mobility: &mut self.mobility, units: Units::ONE };
        CoupledSystem::new(
            mobility,
            &self.near,
            matrix,
            &self.spheres,
            SystemStart {
                loads: &nothing,
                ambient: &NO_AMBIENT,
                quadrupoles: None,
                strain_rate: Traceless::ZERO,
                unknowns: &start,
            },
        )
        .0
    }
}

/// Whether all eigenvalues of a symmetric matrix exceed a bound: whether the Cholesky factorisation of the shifted
/// matrix succeeds.
fn eigenvalues_exceed(bound: f64, matrix: &[Vec<f64>]) -> bool {
    let mut root = vec![vec![0.0; matrix.len()]; matrix.len()];
    for i in 0..matrix.len() {
        for j in 0..=i {
            let known: f64 = (0..j).map(|k| root[i][k] * root[j][k]).sum();
            let rest = matrix[i][j] - if i == j { bound } else { 0.0 } - known;
            if i == j && rest <= 0.0 {
                return false;
            }
            root[i][j] = if i == j { rest.sqrt() } else { rest / root[j][j] };
        }
    }
    true
}

/// Products of all unit vectors with their images under the system, and with themselves in the metric of pairs and
/// single spheres.
#[test]
fn the_system_is_symmetric_and_positive_definite() {
    let mut setting = Setting::new();
    let strain_resistance = setting.spheres.strain.clone();
    let units: Vec<Unknowns> = (0..17 * setting.spheres()).map(|k| setting.unit(k)).collect();
    let mut system = setting.system();
    let (mut matrix, mut measure) = (vec![Vec::new(); units.len()], vec![Vec::new(); units.len()]);
    for unit in &units {
        let (image, itself) = (system.apply(unit), as_residual(unit, &strain_resistance));
        for (k, other) in units.iter().enumerate() {
            matrix[k].push(system.product(&image, other));
            measure[k].push(system.product(&itself, other));
        }
    }
    let diagonal = |i: usize| matrix[i][i];
    for (i, j) in (0..matrix.len()).flat_map(|i| (0..i).map(move |j| (i, j))) {
        let (difference, size) = (matrix[i][j] - matrix[j][i], (diagonal(i) * diagonal(j)).sqrt());
        assert!(difference.abs() < 1e-12 * size, "{i}, {j}: {} and {}", matrix[i][j], matrix[j][i]);
    }
    let largest = (0..matrix.len()).map(diagonal).fold(0.0, f64::max);
    assert!(largest > 1e5, "no pair is near");
    // Pairs do not resist rigid-body motion of the whole, for which both products vanish.
    for (row, measures) in matrix.iter_mut().zip(&measure) {
        row.iter_mut().zip(measures).for_each(|(value, measure)| *value -= 0.2 * measure);
    }
    assert!(eigenvalues_exceed(-1e-12 * largest, &matrix));
    assert!(!eigenvalues_exceed(1e-12 * largest, &matrix));
}

/// The residual whose products with unknowns are those of the given unknowns.
fn as_residual(unknowns: &Unknowns, strain_resistance: &[f64]) -> Residual {
    let strain_rates = unknowns.moments.iter().zip(strain_resistance).map(|(&d, r)| d * (1.0 / r)).collect();
    Residual { stiff: unknowns.stiff.motions.clone(), soft: unknowns.soft.motions.clone(), strain_rates }
}

/// Inner solves for the stiff pairs become more accurate each time, down to a limit; without a preconditioner there is
/// nothing to tighten.
#[test]
fn a_preconditioner_is_made_more_exact_until_it_cannot_be() {
    let mut setting = Setting::new();
    let (near, single) = (&setting.near, &setting.spheres.motion);
    let mut matrix = Preconditioner::new(&Comm::alone(), near, single, 0.1);
    let loads = SixVectors(vec![SixVector([1.0, -2.0, 0.5, 1.0, 3.0, -1.0]); single.len()]);
    let error = |matrix: &mut Preconditioner| {
        let motions = matrix.solve(|row| loads.0[row]).motions;
        let mut residual = loads.clone();
        residual.add(-1.0, &matrix.apply(&motions));
        (matrix.error(&residual, &motions) / matrix.size(&motions)).sqrt()
    };
    let mut errors = vec![error(&mut matrix)];
    while errors.len() < 9 && matrix.refine_preconditioner() {
        errors.push(error(&mut matrix));
    }
    assert!(errors[0] > 1e-6, "{errors:?}");
    assert!((4..=7).contains(&errors.len()), "{errors:?}");
    assert!(errors[..4].windows(2).all(|two| two[1] < 0.1 * two[0]), "{errors:?}");
    assert!(setting.system().refine_preconditioner());
    let mut system = setting.system();
    system.matrix = None;
    assert!(!system.refine_preconditioner());
}

/// A solve returns the pair loads as well as the motions.
#[test]
fn what_stiff_pairs_resist_is_known_from_the_solve() {
    let setting = Setting::new();
    let (near, single) = (&setting.near, &setting.spheres.motion);
    let loads = SixVectors(vec![SixVector([1.0, -2.0, 0.5, 1.0, 3.0, -1.0]); single.len()]);
    let solved = Preconditioner::new(&Comm::alone(), near, single, 0.1).solve(|row| loads.0[row]);
    let mut difference = near.times(&[Pairs::Stiff], &solved.motions);
    let size = difference.dot(&difference).sqrt();
    difference.add(-1.0, &solved.loads);
    let error = difference.dot(&difference).sqrt();
    // Round-off of resistances of up to 1e5.
    assert!(error < 1e-9 * size, "{error:e} of {size}");
}

/// Errors of pair loads and of moments both count, and they add up.
#[test]
fn loads_and_moments_count_as_errors() {
    let mut setting = Setting::new();
    let n = setting.spheres();
    // Unknowns of a sphere with stiff pairs, and of a moment.
    let stiff = (0..6 * n).find(|&k| setting.unit(k).stiff.loads.0.iter().any(|load| load.0[0].abs() > 0.1)).unwrap();
    let [load, moment] = [stiff, 12 * n].map(|k| setting.unit(k));
    let mut both = load.clone();
    both.add(1.0, &moment);
    let residual = as_residual(&both, &setting.spheres.strain);
    let single = setting.spheres.motion.clone();
    let system = setting.system();
    let [by_load, by_moment, by_both] = [&load, &moment, &both].map(|z| system.error(&residual, z));
    let loads = load.stiff.loads.0.iter().zip(&single);
    let exact: f64 = loads.map(|(load, one)| (0..6).map(|k| load.0[k].powi(2) / one.0[k]).sum::<f64>()).sum();
    assert!((by_load - exact).abs() < 1e-12 * exact && (by_moment - 1.0).abs() < 1e-12, "{by_load} {by_moment}");
    assert!((by_both - by_load - by_moment).abs() < 1e-12 * by_both);
}
