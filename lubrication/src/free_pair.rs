//! Two spheres in free space: FCM with lubrication against the exact answer.

use domain::{Traceless, Vector};

use crate::dense::{Square, inverse, solve};
use crate::far_field;
use crate::two_sphere::TwoSphere;
use crate::two_sphere::blocks::ResistanceBlocks;
use crate::{LubricationRange, PairForce, PairMotion};

/// Axial and transverse blocks.
type PairBlocks = (Square<4>, Square<6>);

/// Unit tensors of the axial and transverse rates of strain.
fn strain(axial: bool) -> Traceless {
    let third = (2.0_f64 / 3.0).sqrt() / 2.0;
    Traceless(if axial { [-third, 0.0, 0.0, -third, 0.0] } else { [0.0, 0.0, 0.5_f64.sqrt(), 0.0, 0.0] })
}

/// Blocks of the lubrication resistance for spheres on the z axis, from loads by unit motions.
fn lubrication(force: &PairForce, distance: f64) -> PairBlocks {
    let motion = |kind: usize, sphere: usize, axial: bool| {
        let mut motion = PairMotion::default();
        match kind {
            0 => motion.velocity[sphere] = if axial { Vector::Z } else { Vector::X },
            1 => motion.angular_velocity[sphere] = Vector::Y,
            _ => motion.strain_rate[sphere] = strain(axial),
        }
        motion
    };
    let entry = |row: (usize, usize), column: (usize, usize), axial: bool| {
        let loads = force.loads(Vector::Z * distance, [0, 1], &motion(column.0, column.1, axial));
        loads.map_or(0.0, |loads| motion(row.0, row.1, axial).power(&loads))
    };
    let axial = |i: usize| (2 * (i / 2), i % 2);
    let transverse = |i: usize| (i / 2, i % 2);
    (
        std::array::from_fn(|i| std::array::from_fn(|j| entry(axial(i), axial(j), true))),
        std::array::from_fn(|i| std::array::from_fn(|j| entry(transverse(i), transverse(j), false))),
    )
}

/// Velocities under a force on sphere 1, under one on sphere 2, and in strain; stresslets in strain.
fn answers<const N: usize, const M: usize>(block: &Square<N>) -> Vec<f64> {
    let motions: Square<M> = std::array::from_fn(|i| std::array::from_fn(|j| block[i][j]));
    let right: [[f64; 1]; M] = std::array::from_fn(|i| [block[i][M] + block[i][M + 1]]);
    let moved = solve(motions, right);
    let stresslet = |k: usize| block[k][M] + block[k][M + 1] - (0..M).map(|i| block[k][i] * moved[i][0]).sum::<f64>();
    let mobility = inverse(motions);
    let forced = (0..2).flat_map(|i| [mobility[i][0], mobility[i][1]]);
    forced.chain(moved.iter().map(|line| line[0])).chain([stresslet(M), stresslet(M + 1)]).collect()
}

/// Answers of FCM with lubrication, and exact ones, by block.
fn compared(ratio: f64, gap: f64, force: &PairForce) -> [(Vec<f64>, Vec<f64>); 2] {
    let exact = ResistanceBlocks::exact(&TwoSphere::with_ratio(ratio).unwrap().at(gap), [1.0, ratio]);
    let far = far_field::resistance([1.0, ratio], 1.0 + ratio + gap);
    let (axial, transverse) = lubrication(force, 1.0 + ratio + gap);
    let sum4: Square<4> = std::array::from_fn(|i| std::array::from_fn(|j| far.axial[i][j] + axial[i][j]));
    let sum6: Square<6> = std::array::from_fn(|i| std::array::from_fn(|j| far.transverse[i][j] + transverse[i][j]));
    [
        (answers::<4, 2>(&sum4), answers::<4, 2>(&exact.axial)),
        (answers::<6, 4>(&sum6), answers::<6, 4>(&exact.transverse)),
    ]
}

/// Compares at gaps up to 4 radii; `slack` is an absolute error allowed for the small motions of distant pairs.
fn check(ratios: &[f64], range: LubricationRange, slack: f64) {
    for &ratio in ratios {
        let force = PairForce::new(&[1.0, ratio], 1.0, range).unwrap();
        for gap in [1e-4, 1e-3, 0.01, 0.05, 0.1, 0.2, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0] {
            let blocks = compared(ratio, gap, &force);
            for (block, (found, wanted)) in blocks.iter().enumerate() {
                // Only relative translations in strain matter, see below.
                for (k, (f, w)) in found.iter().zip(wanted).enumerate().filter(|(k, _)| !matches!(k, 4 | 5)) {
                    let allowed = 0.01 * w.abs() + slack;
                    assert!(
                        (f - w).abs() < allowed,
                        "ratio {ratio} gap {gap} block {block} answer {k}: {f}, exact {w}"
                    );
                }
            }
            // Batchelor & Green's A and B are these over the distance.
            for (found, wanted) in &blocks {
                let (f, w) = (found[5] - found[4], wanted[5] - wanted[4]);
                assert!(
                    (f - w).abs() < 0.01 * w.abs() + 2.0 * slack,
                    "ratio {ratio} gap {gap}: relative motion {f}, exact {w}"
                );
            }
        }
    }
}

#[test]
fn every_motion_is_within_a_percent_of_exact_if_lubrication_reaches_far() {
    check(&[1.0, 2.0, 4.0], LubricationRange::new(6.0, 1e-6).unwrap(), 0.0);
}

#[test]
fn the_default_range_is_within_a_percent_of_the_motion_of_a_sphere() {
    // Unit strain rates move distant pairs across their line by less than a hundredth of a radius, which FCM has to a
    // few percent; so does a unit force rotate a sphere ten times as large.
    check(&[1.0, 2.0], LubricationRange::default(), 2e-4);
    check(&[1.0, 2.0, 4.0, 10.0], LubricationRange::default(), 1e-3);
}
