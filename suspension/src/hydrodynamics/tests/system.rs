//! The coupled system as a matrix, column by column.

use super::*;
use fcm::System;
use std::f64::consts::FRAC_1_SQRT_2;

/// Traceless tensors that are orthonormal by contraction.
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

/// Unknowns as numbers: amplitudes of modes, then moments in an orthonormal basis, over the roots of single spheres'
/// resistance.
struct Basis<'a> {
    pairs: usize,
    strain_resistance: &'a [f64],
}

impl Basis<'_> {
    fn size(&self) -> usize {
        PairFactor::MODES * self.pairs + 5 * self.strain_resistance.len()
    }

    fn unit(&self, k: usize) -> PairsAndMoments {
        let mut x = PairsAndMoments {
            modes: vec![[0.0; PairFactor::MODES]; self.pairs],
            moments: vec![Traceless::ZERO; self.strain_resistance.len()],
        };
        let amplitudes = PairFactor::MODES * self.pairs;
        if k < amplitudes {
            x.modes.as_flattened_mut()[k] = 1.0;
        } else {
            let (particle, component) = ((k - amplitudes) / 5, (k - amplitudes) % 5);
            x.moments[particle] = orthonormal()[component] * self.strain_resistance[particle].sqrt();
        }
        x
    }

    /// All rows of a linear function, whose columns are its images of the units.
    fn matrix(&self, mut image: impl FnMut(&PairsAndMoments) -> PairsAndMoments) -> Vec<Vec<f64>> {
        let units: Vec<_> = (0..self.size()).map(|k| self.unit(k)).collect();
        let mut rows = vec![Vec::new(); self.size()];
        for unit in &units {
            let image = image(unit);
            rows.iter_mut().zip(&units).for_each(|(row, unit)| row.push(unit.dot(&image)));
        }
        rows
    }
}

/// Whether all eigenvalues of a symmetric matrix are above a bound: whether Cholesky's rule goes through without it.
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

/// Two sizes at random at 30%, with one pair near contact.
fn suspension() -> (Plan, Particles) {
    let radii = [1.0, 1.5, 1.0, 1.5, 1.0];
    let volume: f64 = radii.iter().map(|a| 4.0 / 3.0 * PI * a * a * a).sum();
    let edge = (volume / 0.3).cbrt();
    let cell = cube(edge);
    let mut positions = random_packing(&cell, &radii, 0.0, 3).unwrap();
    let line = cell.nearest_image(positions[1] - positions[0]).normalize();
    positions[1] = positions[0] + line * (2.5 + 1e-3);
    (plan(edge, &radii[..2], (1e-3, 1e-3)), placed(&positions, &radii))
}

/// The near pairs of a suspension on one rank.
fn near_pairs(plan: &Plan, particles: &mut Particles, partition: &Partition) -> NearPairs {
    let cell = plan.cell();
    particles.wrap(&cell);
    let force = PairForce::new(&plan.radii, 1.0, Range::default()).unwrap();
    let alone: Vec<Screw> = plan.radii.iter().map(|&a| super::super::single(1.0, a)).collect();
    let stiffness = Stiffness::new(&force, &alone);
    NearPairs::find((&force, &stiffness), particles, &cell, partition)
}

#[test]
fn the_system_is_symmetric_and_positive_definite() {
    let (plan, mut particles) = suspension();
    let comm = Comm::alone();
    let partition = Partition::new(&comm, [plan.grid[1], plan.grid[2]]);
    let near = near_pairs(&plan, &mut particles, &partition);
    let mut mobility = Mobility::new(&plan, &partition);
    mobility.arrange(&plan.cell(), &particles);
    let single: Vec<Screw> = particles.radii.iter().map(|&a| single(1.0, a)).collect();
    let strain_resistance: Vec<f64> = particles.radii.iter().map(|a| 20.0 / 3.0 * PI * a.powi(3)).collect();
    let basis = Basis { pairs: near.list().len(), strain_resistance: &strain_resistance };
    let start = basis.unit(0);
    let matrix = Some(ParticleMatrix::new(&comm, &near, &single));
    let mut system = Coupled::new(
        Scaled { mobility: &mut mobility, units: Units::ONE },
        &near,
        matrix,
        (&single, &strain_resistance),
        (&Loads::default(), &start),
    );

    let matrix = basis.matrix(|x| system.apply(x));
    let diagonal = |i: usize| matrix[i][i];
    for (i, j) in (0..matrix.len()).flat_map(|i| (0..i).map(move |j| (i, j))) {
        let (difference, size) = (matrix[i][j] - matrix[j][i], (diagonal(i) * diagonal(j)).sqrt());
        assert!(difference.abs() < 1e-12 * size, "{i}, {j}: {} and {}", matrix[i][j], matrix[j][i]);
    }
    assert!((0..matrix.len()).any(|i| diagonal(i) > 100.0), "no pair is near");
    assert!(eigenvalues_exceed(0.2, &matrix));
}

/// The motions of the stiff pairs by themselves are more exact each time, until they are as exact as they can be; where
/// there is no preconditioner, there is nothing to be made more exact.
#[test]
fn a_preconditioner_is_made_more_exact_until_it_cannot_be() {
    let (plan, mut particles) = suspension();
    let comm = Comm::alone();
    let partition = Partition::new(&comm, [plan.grid[1], plan.grid[2]]);
    let near = near_pairs(&plan, &mut particles, &partition);
    let single: Vec<Screw> = particles.radii.iter().map(|&a| single(1.0, a)).collect();
    let mut matrix = ParticleMatrix::new(&comm, &near, &single);
    let modes = vec![[1.0; PairFactor::MODES]; near.list().len()];
    let loads = near.loads(&modes[..near.stiff()]);
    let error = |matrix: &mut ParticleMatrix| {
        let motions = matrix.relieve(&mut modes.clone());
        let mut residual = loads.clone();
        residual.add(-1.0, &matrix.apply(&motions));
        (residual.dot(&matrix.precondition(&residual)) / matrix.size(&motions)).sqrt()
    };
    let mut errors = vec![error(&mut matrix)];
    while errors.len() < 9 && matrix.sharpen() {
        errors.push(error(&mut matrix));
    }
    assert!(near.stiff() > 1 && errors[0] > 1e-9, "{errors:?}");
    assert!((4..=5).contains(&errors.len()), "{errors:?}");
    assert!(errors[..4].windows(2).all(|two| two[1] < 0.1 * two[0]), "{errors:?}");

    let strain_resistance: Vec<f64> = particles.radii.iter().map(|a| 20.0 / 3.0 * PI * a.powi(3)).collect();
    let start = Basis { pairs: near.list().len(), strain_resistance: &strain_resistance }.unit(0);
    let sharpened = |matrix| {
        let mut mobility = Mobility::new(&plan, &partition);
        mobility.arrange(&plan.cell(), &particles);
        let known = (&Loads::default(), &start);
        let mobility = Scaled { mobility: &mut mobility, units: Units::ONE };
        Coupled::new(mobility, &near, matrix, (&single, &strain_resistance), known).sharpen()
    };
    assert!(sharpened(Some(ParticleMatrix::new(&comm, &near, &single))));
    assert!(!sharpened(Some(matrix)) && !sharpened(None));
}
