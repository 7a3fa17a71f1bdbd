//! The same lubricated spheres in other units.

use super::*;

/// Units of length, viscosity and force.
type Scales = [f64; 3];

/// Eight squirmers of two sizes in a sheared box, most of them with near neighbours, under forces and torques and in a
/// strain, solved in the given units. The results are converted back.
fn solved([length, viscosity, force]: Scales, precision: Precision) -> [Vec<f64>; 3] {
    let cell = PeriodicBox::sheared(Vector::splat(5.4 * length), 0.2).unwrap();
    let one = PeriodicBox::sheared(Vector::splat(5.4), 0.2).unwrap();
    let radii: Vec<f64> = (0..8).map(|i| if i % 2 == 0 { 1.0 } else { 1.3 }).collect();
    let positions = random_packing(&one, &radii, 0.02, 3).unwrap();
    let place = |list: &[f64]| list.iter().map(|&a| a * length).collect::<Vec<_>>();
    let positions: Vec<Vector> = positions.iter().map(|&x| x * length).collect();
    let given = |name: u64, unit: f64| -> Vec<Vector> {
        (0..8).map(|i| (domain::Random::new(name, i).point() - Vector::splat(0.5)) * unit).collect()
    };
    let plan = Plan::choose(&Problem {
        edges: cell.edges(),
        volume: cell.edges().element_product(),
        shortest_vector: cell.edges().min_element(),
        boundaries: cell.boundaries(),
        largest_strain: 0.5,
        viscosity,
        fixed: Fixed { precision: Some(precision), ..Fixed::default() },
        ..problem(length, &place(&radii), 1e-3, 1e-6)
    })
    .unwrap();
    let partition = Partition::new(&Comm::alone(), [plan.grid[1], plan.grid[2]]);
    let mut fluid = CoupledSolver::new(&plan, &partition, lubricated_at(Some(LubricationRange::default()))).unwrap();
    let (forces, torques) = (given(1, force), given(2, force * length));
    let rate = force / (viscosity * length * length);
    let strain = Traceless([0.1, 0.5, -0.2, -0.3, 0.05]) * rate;
    let loads = Loads { forces, torques, ..Loads::default() };
    let swimming = rate * length;
    let second = given(4, swimming).into_iter().map(|v| Traceless([v.x, v.y, v.z, -v.x, v.y])).collect();
    let squirming = Squirming { first: given(3, swimming), second };
    let acting = SolveInput { squirming: Some(&squirming), ..acting(&loads, strain) };
    let found = fluid.solve(&cell, &placed(&positions, &place(&radii)), &acting, Guess::default()).unwrap();
    assert!(found.iterations > 0);
    let vectors = |list: &[Vector], unit: f64| list.iter().flat_map(|v| (*v / unit).to_array()).collect();
    let stresslets = found.stresslets.iter().flat_map(|s| s.0.map(|c| c / (force * length))).collect();
    let Motion { velocities, angular_velocities, .. } = &found.motion;
    [vectors(velocities, rate * length), vectors(angular_velocities, rate), stresslets]
}

fn worst(found: &[Vec<f64>; 3], exact: &[Vec<f64>; 3]) -> f64 {
    let norm = |list: &[f64]| list.iter().map(|x| x * x).sum::<f64>().sqrt();
    let error =
        |(a, b): (&Vec<f64>, &Vec<f64>)| norm(&a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<_>>()) / norm(b);
    found.iter().zip(exact).map(error).fold(0.0, f64::max)
}

/// Thirty systems of units from 1e-30 to 1e30 agree to all digits: 1e-6 on single-precision grids, 1e-12 in double
/// precision.
#[test]
fn answers_have_the_same_digits_in_any_units() {
    let extremes = [-30, 0, 30];
    let corners = (0..27).map(|n| [extremes[n % 3], extremes[n / 3 % 3], extremes[n / 9]]);
    let systems: Vec<_> = corners.chain([[-6, -3, -12], [7, 0, 1], [-13, 22, 5]]).collect();
    for (precision, allowed) in [(Precision::Single, 1e-6), (Precision::Double, 1e-12)] {
        let exact = solved([1.0; 3], precision);
        for &[l, mu, f] in &systems {
            let scales = [1.37 * 10_f64.powi(l), 0.83 * 10_f64.powi(mu), 2.71 * 10_f64.powi(f)];
            let worst = worst(&solved(scales, precision), &exact);
            assert!(worst < allowed, "{worst:e} in {precision:?} in units of {scales:?}");
        }
    }
}

#[test]
fn powers_of_two_keep_every_bit() {
    let two = |k: i32| 2_f64.powi(k);
    for precision in [Precision::Single, Precision::Double] {
        let exact = solved([1.0; 3], precision);
        for [l, mu, f] in [[100, 0, 0], [0, 91, 0], [0, 0, -77], [-17, -10, -40], [97, -98, 99], [-4, 1, 2]] {
            assert_eq!(solved([l, mu, f].map(two), precision), exact, "{l} {mu} {f} in {precision:?}");
        }
    }
}
