//! Random motions whose covariance is the mobility.

use domain::{Boundaries, Bytes, Comm, PeriodicBox, Traceless, Vector};
use fcm::{Loads, Method, Multipoles, Precision};
use lubrication::LubricationRange;
use solver::BackgroundFlow;
use suspension::{Mobility, MobilityParameters};

/// Three near spheres of two sizes in a sheared box.
fn parameters(edge: f64, tolerance: f64) -> MobilityParameters {
    let cell = PeriodicBox::sheared(Vector::splat(edge), 0.2).unwrap();
    MobilityParameters { tolerance, ..MobilityParameters::new(cell, 1.3, vec![1.0, 1.0, 1.6]) }
}

fn places() -> Vec<Vector> {
    vec![Vector::new(1.0, 2.0, 2.0), Vector::new(3.1, 2.4, 2.2), Vector::new(2.0, 4.8, 3.0)]
}

/// The same spheres in a box that is not fully periodic; with walls, near them.
fn bounded(boundaries: Boundaries) -> MobilityParameters {
    let cell = PeriodicBox::new(Vector::new(9.0, 10.0, 5.0)).unwrap().with_boundaries(boundaries).unwrap();
    MobilityParameters { cell, ..parameters(9.0, 1e-3) }
}

fn mobility(parameters: MobilityParameters, comm: &Comm) -> Mobility {
    let mut mobility = Mobility::new(parameters, Bytes::default(), comm).unwrap();
    mobility.place(&places()).unwrap();
    mobility
}

/// Mobility matrix, column by column: from forces and torques to velocities and angular velocities, or from forces,
/// torques and first moments `-S` in an orthonormal basis to all motions.
fn dense(mobility: &mut Mobility, width: usize) -> Vec<Vec<f64>> {
    let count = places().len();
    let column = |k: usize| {
        let (sphere, component) = (k % count, k / count);
        let mut loads =
            Loads { forces: vec![Vector::ZERO; count], torques: vec![Vector::ZERO; count], ..Loads::default() };
        if width == 11 {
            loads.stresslets = vec![Traceless::ZERO; count];
        }
        match component {
            0..3 => loads.forces[sphere][component] = 1.0,
            3..6 => loads.torques[sphere][component - 3] = 1.0,
            _ => loads.stresslets[sphere] = -basis(component - 6),
        }
        flat(&mobility.apply(&loads, &BackgroundFlow::NONE).unwrap().motion, width)
    };
    (0..width * count).map(column).collect()
}

fn basis(k: usize) -> Traceless {
    let (half, sixth) = (0.5_f64.sqrt(), (1.0_f64 / 6.0).sqrt());
    [
        [-sixth, 0.0, 0.0, -sixth, 0.0],
        [half, 0.0, 0.0, -half, 0.0],
        [0.0, half, 0.0, 0.0, 0.0],
        [0.0, 0.0, half, 0.0, 0.0],
        [0.0, 0.0, 0.0, 0.0, half],
    ]
    .map(Traceless)[k]
}

fn flat(motion: &fcm::Motion, width: usize) -> Vec<f64> {
    let count = motion.velocities.len();
    let of = |k: usize, sphere: usize| match k {
        0..3 => motion.velocities[sphere][k],
        3..6 => motion.angular_velocities[sphere][k - 3],
        _ => motion.strain_rates[sphere].contract(basis(k - 6)),
    };
    (0..width * count).map(|k| of(k / count, k % count)).collect()
}

/// Cholesky factor: the lower triangular `L` with `L L^T` the matrix.
fn cholesky(matrix: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let count = matrix.len();
    let mut root = vec![vec![0.0; count]; count];
    for i in 0..count {
        for j in 0..=i {
            let rest = matrix[i][j] - (0..j).map(|k| root[i][k] * root[j][k]).sum::<f64>();
            root[i][j] = if i == j { rest.sqrt() } else { rest / root[j][j] };
        }
    }
    root
}

/// `L^-1` times a vector.
fn whitened(root: &[Vec<f64>], vector: &[f64]) -> Vec<f64> {
    let mut white = Vec::new();
    for (row, value) in root.iter().zip(vector) {
        let before: f64 = row.iter().zip(&white).map(|(l, w): (&f64, &f64)| l * w).sum();
        white.push((value - before) / row[white.len()]);
    }
    white
}

/// Random motions whitened by the dense matrix are independent with unit variance: their mean square is within three
/// standard errors of 1, and so are all elements of their covariance.
#[test]
#[ignore = "heavy"]
fn random_motions_have_the_covariance_of_the_mobility() {
    let lubricated = |p: MobilityParameters| MobilityParameters {
        lubrication: Some(LubricationRange::new(2.5, LubricationRange::MINIMUM_GAP).unwrap()),
        ..p
    };
    let free = |p: MobilityParameters| MobilityParameters { rigid: false, ..p };
    let radii = vec![0.7, 1.0, 1.6];
    let [direct, split] = [Method::Direct, Method::Split].map(Some);
    let cases = [
        ("raw, in f32", free(parameters(14.0, 1e-3)), 11),
        ("raw, in f64", free(parameters(9.0, 1e-7)), 11),
        ("raw, direct", free(MobilityParameters { method: direct, ..parameters(9.0, 1e-3) }), 11),
        ("raw, three radii, split", free(MobilityParameters { radii, method: split, ..parameters(9.0, 1e-3) }), 11),
        ("rigid", parameters(14.0, 1e-3), 6),
        ("lubricated", lubricated(parameters(14.0, 1e-3)), 6),
        ("lubricated, with images", lubricated(parameters(7.5, 1e-3)), 6),
        ("raw, between walls", free(bounded(Boundaries::Walls)), 11),
        ("rigid, above a wall", bounded(Boundaries::Wall), 6),
        ("lubricated, between walls", lubricated(bounded(Boundaries::Walls)), 6),
        ("lubricated, above a wall", lubricated(bounded(Boundaries::Wall)), 6),
        ("lubricated, in unbounded fluid", lubricated(bounded(Boundaries::Open)), 6),
    ];
    let mut kinds = Vec::new();
    for (name, parameters, width) in cases {
        let mut mobility = mobility(parameters, &Comm::alone());
        kinds.push((mobility.plan().method == Method::Direct, mobility.plan().precision == Precision::Single));
        let root = cholesky(&dense(&mut mobility, width));
        // With walls each draw takes the square root of the whole mobility.
        let draws = if mobility.plan().boundaries == Boundaries::Periodic { 1200 } else { 300 };
        let (motions, drawn) = mobility.noise(7, 0..draws).unwrap();
        let white: Vec<Vec<f64>> = motions.iter().map(|motion| whitened(&root, &flat(motion, width))).collect();
        let count = root.len();
        let (mut energy, mut worst) = (0.0, 0.0_f64);
        for i in 0..count {
            for j in 0..=i {
                let mean = white.iter().map(|w| w[i] * w[j]).sum::<f64>() / draws as f64;
                let expected = if i == j { 1.0 } else { 0.0 };
                let error = ((1.0 + expected) / draws as f64).sqrt();
                worst = worst.max(((mean - expected) / error).abs());
                energy += if i == j { mean / count as f64 } else { 0.0 };
            }
        }
        let error = (2.0 / (draws as f64 * count as f64)).sqrt();
        assert!(((energy - 1.0) / error).abs() < 3.0, "{name}: energy {energy}, error {error}, {drawn:?}");
        assert!(worst < 4.5 && drawn.clipped == 0.0, "{name}: {worst} {drawn:?}");
    }
    let has = |kind: &dyn Fn((bool, bool)) -> bool| kinds.iter().any(|&one| kind(one));
    assert!(has(&|(direct, _)| direct) && has(&|(direct, _)| !direct), "both methods: {kinds:?}");
    assert!(has(&|(_, single)| single) && has(&|(_, single)| !single), "both precisions: {kinds:?}");
}

#[test]
fn ranks_and_the_order_of_draws_do_not_matter() {
    let lubrication = Some(LubricationRange::new(2.5, LubricationRange::MINIMUM_GAP).unwrap());
    let draw = |ranks: usize, draws: std::ops::Range<u64>| {
        let all = Comm::threads(ranks, |comm| {
            let tight = MobilityParameters { lubrication, ..parameters(9.0, 1e-7) };
            mobility(tight, &comm).noise(3, draws.clone()).unwrap().0
        });
        all.into_iter().next().unwrap()
    };
    let alone = draw(1, 0..3);
    assert_eq!(draw(1, 2..3)[0], alone[2]);
    for ranks in [2, 7] {
        let together = draw(ranks, 0..1);
        let error =
            flat(&together[0], 6).iter().zip(flat(&alone[0], 6)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(error < 1e-6, "{ranks} ranks: {error}");
    }
}

/// Draws on 2 and 7 ranks, whitened by the dense matrix of one rank, equal those of one rank: they are independent with
/// unit variance, in single and double precision, and agree up to round-off on the grid and the tolerance of the solve.
#[test]
#[ignore = "heavy"]
fn whitened_draws_are_the_same_on_any_ranks() {
    let lubrication = Some(LubricationRange::new(2.5, LubricationRange::MINIMUM_GAP).unwrap());
    let draws = 8;
    let walls = bounded(Boundaries::Walls);
    let cases = [
        (parameters(9.0, 1e-3), Precision::Single, 1e-4),
        (parameters(9.0, 1e-7), Precision::Double, 1e-6),
        (walls.clone(), Precision::Single, 1e-3),
        (MobilityParameters { tolerance: 1e-7, ..walls }, Precision::Double, 1e-6),
    ];
    for (parameters, precision, allowed) in cases {
        let trimer = MobilityParameters { lubrication, ..parameters };
        let mut alone = mobility(trimer.clone(), &Comm::alone());
        assert_eq!(alone.plan().precision, precision);
        let root = cholesky(&dense(&mut alone, 6));
        let [one, two, seven] = [1, 2, 7].map(|ranks| {
            let all = Comm::threads(ranks, |comm| mobility(trimer.clone(), &comm).noise(7, 0..draws).unwrap().0);
            all[0].iter().flat_map(|motion| whitened(&root, &flat(motion, 6))).collect::<Vec<f64>>()
        });
        let energy = one.iter().map(|w| w * w).sum::<f64>() / one.len() as f64;
        assert!((energy - 1.0).abs() < 3.5 * (2.0 / one.len() as f64).sqrt(), "{precision:?}: {energy}");
        for other in [two, seven] {
            let error = one.iter().zip(&other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(error < allowed, "{precision:?}: {error}");
        }
    }
}

/// Matrix of the square root, column by column, with the numbers in the order of [`flat`].
fn root_columns(mobility: &mut Mobility, transposed: bool) -> Vec<Vec<f64>> {
    let count = places().len();
    let column = |k: usize| {
        let mut numbers = vec![[0.0; 6]; count];
        numbers[k % count][k / count] = 1.0;
        let (root, drawn) = mobility.root(&numbers, transposed).unwrap();
        assert!(drawn.clipped < 1e-12);
        (0..6 * count).map(|k| root[k % count][k / count]).collect()
    };
    (0..6 * count).map(column).collect()
}

/// `B B^T` is the dense matrix and `B^T` the transpose; with and without lubrication, between walls, and for forces
/// alone.
#[test]
#[ignore = "heavy"]
fn the_root_times_its_transpose_is_the_mobility() {
    let tight = parameters(14.0, 1e-6);
    let walls = PeriodicBox::new(Vector::splat(12.0)).unwrap().with_boundaries(Boundaries::Walls).unwrap();
    let range = Some(LubricationRange::new(2.5, LubricationRange::MINIMUM_GAP).unwrap());
    let cases = [
        MobilityParameters { lubrication: range, ..tight.clone() },
        MobilityParameters { cell: walls, tolerance: 1e-3, ..tight.clone() },
        MobilityParameters { multipoles: Multipoles::Monopole, ..tight },
    ];
    for parameters in cases {
        let (tolerance, is_point) = (parameters.tolerance, parameters.multipoles == Multipoles::Monopole);
        let mut mobility = mobility(parameters, &Comm::alone());
        let width = if is_point { 9 } else { 18 };
        let matrix = dense(&mut mobility, if is_point { 3 } else { 6 });
        let [columns, rows] = [false, true].map(|transposed| root_columns(&mut mobility, transposed));
        let size = matrix.iter().flatten().fold(0.0, |most: f64, entry| most.max(entry.abs()));
        for i in 0..width {
            for j in 0..width {
                let product: f64 = columns.iter().map(|column| column[i] * column[j]).sum();
                assert!(
                    (product - matrix[i][j]).abs() < 4.0 * tolerance * size,
                    "{i} {j}: {product}, not {}",
                    matrix[i][j]
                );
                let (one, other) = (columns[j][i], rows[i][j]);
                assert!((one - other).abs() < 4.0 * tolerance * size.sqrt(), "{i} {j}: {one}, transposed {other}");
            }
        }
        assert_eq!(mobility.root(&[[0.0; 6]; 3], false).unwrap().0, [[0.0; 6]; 3]);
    }
}

#[test]
fn ranks_agree_about_the_root() {
    let numbers = [[0.3, -1.0, 0.2, 0.7, 0.1, -0.4], [1.1, 0.5, -0.6, 0.0, 0.9, 0.2], [-0.2, 0.4, 0.8, -1.3, 0.1, 0.6]];
    let roots = [1, 3].map(|ranks| {
        let root = |comm: Comm| mobility(parameters(9.0, 1e-6), &comm).root(&numbers, false).unwrap().0;
        let all = Comm::threads(ranks, root);
        assert!(all[1..].iter().all(Vec::is_empty));
        all[0].clone()
    });
    let pairs = roots[0].as_flattened().iter().zip(roots[1].as_flattened());
    assert!(pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) < 3e-6, "{roots:?}");
}

/// Velocities and angular velocities as one list.
fn flat_drift(drift: &suspension::Drift) -> Vec<f64> {
    let suspension::Drift { velocities, angular_velocities, .. } = drift;
    velocities.iter().chain(angular_velocities).flat_map(Vector::to_array).collect()
}

/// The divergence of the mobility by central differences. The mean of the draws, projected on it, equals its norm
/// within three and a half standard errors. Without drift the mean would be zero, many standard errors away.
#[test]
fn draws_of_the_drift_have_the_mean_that_the_mobility_has_as_its_divergence() {
    let lubrication = Some(LubricationRange::new(2.5, LubricationRange::MINIMUM_GAP).unwrap());
    let mut mobility = mobility(MobilityParameters { lubrication, ..parameters(14.0, 1e-4) }, &Comm::alone());
    let length = 0.02;
    let mut divergence = [0.0; 18];
    for (sphere, axis) in (0..3).flat_map(|sphere| (0..3).map(move |axis| (sphere, axis))) {
        for sign in [1.0, -1.0] {
            let mut moved = places();
            moved[sphere][axis] += sign * length;
            mobility.place(&moved).unwrap();
            let mut forces = vec![Vector::ZERO; 3];
            forces[sphere][axis] = 1.0;
            let loads = Loads { forces, ..Loads::default() };
            let motion = mobility.apply(&loads, &BackgroundFlow::NONE).unwrap().motion;
            let numbers = motion.velocities.iter().chain(&motion.angular_velocities).flat_map(Vector::to_array);
            divergence.iter_mut().zip(numbers).for_each(|(sum, number)| *sum += sign * number / (2.0 * length));
        }
    }
    mobility.place(&places()).unwrap();
    let size: f64 = divergence[..9].iter().map(|d| d * d).sum();
    let along =
        |drift: &suspension::Drift| flat_drift(drift)[..9].iter().zip(divergence).map(|(a, b)| a * b).sum::<f64>();
    let found: Vec<f64> = mobility.drift(5, 0..120).unwrap().iter().map(|drift| along(drift) / size).collect();
    let count = found.len() as f64;
    let mean = found.iter().sum::<f64>() / count;
    let error = (found.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (count * (count - 1.0))).sqrt();
    assert!((mean - 1.0).abs() < 3.5 * error && error < 0.2, "{mean} +- {error}");
}

#[test]
fn ranks_agree_on_the_drift() {
    let lubrication = Some(LubricationRange::new(2.5, LubricationRange::MINIMUM_GAP).unwrap());
    let draw = |ranks: usize| {
        let all = Comm::threads(ranks, |comm| {
            let tight = MobilityParameters { lubrication, ..parameters(9.0, 1e-7) };
            mobility(tight, &comm).drift(3, 0..1).unwrap()
        });
        all.into_iter().next().unwrap()
    };
    let alone = flat_drift(&draw(1)[0]);
    let size = alone.iter().map(|x| x.abs()).fold(0.0, f64::max);
    for ranks in [2, 7] {
        let together = flat_drift(&draw(ranks)[0]);
        let error = together.iter().zip(&alone).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(error < 0.03 * size, "{ranks} ranks: {error} of {size}");
    }
}

#[test]
fn draws_for_which_there_is_no_memory_are_refused() {
    let refused = mobility(parameters(9.0, 1e-3), &Comm::alone()).noise(1, 0..1 << 50).unwrap_err().to_string();
    assert!(refused.contains("fewer draws at a time"), "{refused}");
}

/// The second check of the interrupt, before the second draw, ends the draws.
#[test]
fn draws_are_interrupted() {
    use domain::Interrupt;
    use std::sync::atomic::{AtomicUsize, Ordering};
    for rigid in [true, false] {
        let looks = AtomicUsize::new(0);
        let mut mobility = mobility(MobilityParameters { rigid, ..parameters(9.0, 1e-3) }, &Comm::alone());
        mobility.listen(Interrupt::when(move || looks.fetch_add(1, Ordering::Relaxed) > 0));
        let ended = mobility.noise(1, 0..1000).unwrap_err().to_string();
        assert!(ended.contains("interrupted"), "{ended}");
    }
}
