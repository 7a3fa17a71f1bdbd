//! The same particles have the same answers in other units.

use crate::common::{Suspension, error, tensors, vectors};
use domain::{Comm, Number, Partition, PeriodicBox, Traceless, Vector};
use fcm::{Fixed, Loads, Method, Motion, Multipoles, Output, Plan, PlanError, Precision, Problem, StressletSolver};

/// Units of length, viscosity and force as numbers in other units.
#[derive(Debug, Clone, Copy)]
struct Scales {
    length: f64,
    viscosity: f64,
    force: f64,
}

impl Scales {
    fn velocity(self) -> f64 {
        self.force / (self.viscosity * self.length)
    }

    fn rate(self) -> f64 {
        self.velocity() / self.length
    }

    fn suspension(self, one: &Suspension) -> Suspension {
        Suspension {
            cell: PeriodicBox::sheared(one.cell.edges() * self.length, one.cell.strain()).unwrap(),
            viscosity: one.viscosity * self.viscosity,
            positions: one.positions.iter().map(|&x| x * self.length).collect(),
            radii: one.radii.iter().map(|&a| a * self.length).collect(),
        }
    }

    fn loads(self, one: &Loads) -> Loads {
        let torque = self.force * self.length;
        Loads {
            forces: one.forces.iter().map(|&f| f * self.force).collect(),
            torques: one.torques.iter().map(|&t| t * torque).collect(),
            stresslets: one.stresslets.iter().map(|&s| s * torque).collect(),
        }
    }

    /// Converts a motion in these units back.
    fn back(self, motion: &Motion) -> Motion {
        let (velocity, rate) = (1.0 / self.velocity(), 1.0 / self.rate());
        Motion {
            velocities: motion.velocities.iter().map(|&v| v * velocity).collect(),
            angular_velocities: motion.angular_velocities.iter().map(|&w| w * rate).collect(),
            strain_rates: motion.strain_rates.iter().map(|&e| e * rate).collect(),
        }
    }
}

/// Thirty systems of units from 1e-30 to 1e30, with all digits.
fn systems() -> Vec<Scales> {
    let extremes = [-30, 0, 30];
    let corners = (0..27).map(|n| [extremes[n % 3], extremes[n / 3 % 3], extremes[n / 9]]);
    let others = [[-6, -3, -12], [7, 0, 1], [-13, 22, 5]];
    let scale = |exponent: i32, digits: f64| digits * 10_f64.powi(exponent);
    corners
        .chain(others)
        .map(|[l, mu, f]| Scales { length: scale(l, 1.37), viscosity: scale(mu, 0.83), force: scale(f, 2.71) })
        .collect()
}

/// Systems of units that differ by powers of two.
fn powers() -> Vec<Scales> {
    let two = |k: i32| 2_f64.powi(k);
    [[100, 0, 0], [-99, 0, 0], [0, 91, 0], [0, 0, -77], [-17, -10, -40], [97, -98, 99], [-3, 1, 2]]
        .map(|[l, mu, f]| Scales { length: two(l), viscosity: two(mu), force: two(f) })
        .to_vec()
}

/// Kind of evaluation.
#[derive(Debug, Clone, Copy)]
struct Kind {
    multipoles: Multipoles,
    rigid: bool,
    method: Method,
    precision: Precision,
    strain: f64,
}

fn kinds() -> Vec<Kind> {
    let mut kinds = Vec::new();
    for (multipoles, rigid) in [(Multipoles::Monopole, false), (Multipoles::Dipole, false), (Multipoles::Dipole, true)]
    {
        for method in [Method::Direct, Method::Split] {
            for (precision, strain) in [(Precision::Single, 0.0), (Precision::Double, 0.0), (Precision::Double, 0.3)] {
                kinds.push(Kind { multipoles, rigid, method, precision, strain });
            }
        }
    }
    kinds
}

const BACKGROUND: Traceless = Traceless([0.1, 0.5, -0.2, -0.3, 0.05]);

/// Plan, motion, and stresslets of the solution.
fn motion(kind: Kind, one: &Suspension, scales: Scales) -> (Plan, Motion, Vec<Traceless>) {
    let suspension = scales.suspension(one);
    let fixed = Fixed { method: Some(kind.method), precision: Some(kind.precision), ..Fixed::default() };
    let problem = Problem { multipoles: kind.multipoles, rigid: kind.rigid, fixed, ..suspension.problem(1e-3) };
    let plan = Plan::choose(&problem).unwrap();
    let loads = scales.loads(&one.loads(5));
    if kind.rigid {
        let partition = Partition::new(&Comm::alone(), [plan.grid[1], plan.grid[2]]);
        let background = BACKGROUND * scales.rate();
        let mut fluid = StressletSolver::new(&plan, &partition);
        let solved = fluid.solve(&suspension.cell, &suspension.particles(), &loads, background, &[]).unwrap();
        let over = 1.0 / (scales.force * scales.length);
        return (plan, scales.back(&solved.motion), solved.stresslets.iter().map(|&s| s * over).collect());
    }
    let loads = if kind.multipoles == Multipoles::Monopole {
        Loads { forces: loads.forces, ..Loads::default() }
    } else {
        loads
    };
    let wanted = if kind.multipoles == Multipoles::Monopole { Output::Velocities } else { Output::All };
    let found = suspension.mobility(&plan).apply(&loads, wanted);
    (plan, scales.back(&found), Vec::new())
}

const ONE: Scales = Scales { length: 1.0, viscosity: 1.0, force: 1.0 };

fn spheres(strain: f64) -> Suspension {
    Suspension::random(8, 1.6, PeriodicBox::sheared(Vector::new(9.0, 10.0, 8.0), strain).unwrap(), 3)
}

/// Eight spheres in thirty systems of units: equal to 1e-6 with the grid in `f32`, the limit of its precision, and to
/// 1e-12 in `f64`.
#[test]
#[ignore = "heavy"]
fn answers_have_the_same_digits_in_any_units() {
    for kind in kinds() {
        let one = spheres(kind.strain);
        let (plan, exact, stresslets) = motion(kind, &one, ONE);
        let allowed = if kind.precision == Precision::Single { 1e-6 } else { 1e-12 };
        for scales in systems() {
            let (other, found, resisting) = motion(kind, &one, scales);
            assert_eq!((plan.grid, plan.support.support), (other.grid, other.support.support));
            let errors = [
                error(&vectors(&found.velocities), &vectors(&exact.velocities)),
                error(&vectors(&found.angular_velocities), &vectors(&exact.angular_velocities)),
                error(&tensors(&found.strain_rates), &tensors(&exact.strain_rates)),
                error(&tensors(&resisting), &tensors(&stresslets)),
            ];
            println!("{:.1e} {kind:?}", errors.into_iter().fold(0.0, f64::max));
            assert!(errors.iter().all(|&e| e < allowed), "{errors:?} for {kind:?} in {scales:?}");
        }
    }
}

#[test]
fn powers_of_two_keep_every_bit() {
    for kind in kinds() {
        let one = spheres(kind.strain);
        let (_, exact, stresslets) = motion(kind, &one, ONE);
        for scales in powers() {
            let (_, found, resisting) = motion(kind, &one, scales);
            assert!((&found, &resisting) == (&exact, &stresslets), "{kind:?} in {scales:?}");
        }
    }
}

/// A torque alone, and loads of particles most of which have none.
#[test]
fn any_kind_of_load_sets_the_unit_of_force() {
    let one = spheres(0.0);
    let all = one.loads(7);
    let mut few = vec![Vector::ZERO; all.forces.len()];
    few[3] = all.forces[3];
    for loads in [
        Loads { torques: all.torques.clone(), ..Loads::default() },
        Loads { stresslets: all.stresslets.clone(), ..Loads::default() },
        Loads { forces: few, ..Loads::default() },
    ] {
        let exact = one.evaluate(&one.plan(1e-3, Fixed::default()), &loads);
        for scales in systems() {
            let other = scales.suspension(&one);
            let found = scales.back(&other.evaluate(&other.plan(1e-3, Fixed::default()), &scales.loads(&loads)));
            let error = error(&vectors(&found.velocities), &vectors(&exact.velocities));
            assert!(error < 1e-6, "{error:e} in {scales:?}");
        }
    }
}

/// Two spheres four radii apart in a box of a billion radii, on a grid that is coarse for them, move as in unbounded
/// fluid: by Stokes' drag, and along the line of centres by `2 F / (8 pi mu r) (1 - 2 a^2 / 3 r^2)`. Periodic images
/// and the counterflow of the box are negligible.
#[test]
fn a_box_of_a_billion_radii_is_computed() {
    let edge = 1e9;
    let positions = vec![Vector::splat(0.4 * edge), Vector::splat(0.4 * edge) + Vector::new(4.0, 0.0, 0.0)];
    let cell = PeriodicBox::new(Vector::splat(edge)).unwrap();
    let far = Suspension { cell, viscosity: 1.0, positions, radii: vec![1.0, 1.0] };
    let loads = Loads { forces: vec![Vector::X, Vector::ZERO], ..Loads::default() };
    for precision in [Precision::Single, Precision::Double] {
        let found = far.evaluate(&far.plan(1e-3, Fixed { precision: Some(precision), ..Fixed::default() }), &loads);
        let pi = std::f64::consts::PI;
        let expected = [1.0 / (6.0 * pi), 2.0 / (8.0 * pi * 4.0) * (1.0 - 2.0 / (3.0 * 16.0))];
        for (velocity, expected) in found.velocities.iter().zip(expected) {
            assert!((velocity.x / expected - 1.0).abs() < 5e-3, "{velocity} in {precision:?}, not {expected}");
        }
    }
}

/// Radii up to 1:1000 and beyond, boxes up to a billion radii and fixed grids of any size are planned or refused; an
/// exhaustive search would not end.
#[test]
fn anything_is_planned_or_refused() {
    let problem = |radii: &[f64], edges: [f64; 3], fixed: Fixed| {
        let suspension = Suspension {
            cell: PeriodicBox::new(Vector::from_array(edges)).unwrap(),
            viscosity: 1.0,
            positions: vec![],
            radii: radii.to_vec(),
        };
        Problem { fixed, ..suspension.problem(1e-3) }
    };
    let direct = Fixed { method: Some(Method::Direct), ..Fixed::default() };
    for radius in [1e-1, 1e-2, 1e-3, 1e-5, 1e-9] {
        assert!(Plan::choose(&problem(&[radius, 1.0], [10.0; 3], Fixed::default())).is_ok());
        let refused =
            matches!(Plan::choose(&problem(&[radius, 1.0], [10.0; 3], direct)), Err(PlanError::TooFine { .. }));
        assert_eq!(refused, radius < 1e-4, "{radius}");
    }
    for edges in [[1e9; 3], [1e9, 10.0, 10.0], [10.0, 1e9, 1e6], [1e5; 3]] {
        let plan = Plan::choose(&problem(&[1.0], edges, Fixed::default())).unwrap();
        assert!(plan.cutoff() <= 60.0 * plan.edges.min_element(), "{}", plan.in_short());
    }
    for points in [8, 1000, 8192, 65536] {
        let fixed = Fixed { grid: Some([points; 3]), ..direct };
        let plan = problem(&[1.0], [10.0; 3], fixed);
        let infeasible = Plan::choose(&plan).unwrap().infeasible(&plan);
        assert_eq!(infeasible.is_some(), points > 8000, "{points}: {infeasible:?}");
        assert!(infeasible.is_none_or(|why| why.contains("leave it out, or take fewer")));
    }
    let huge = Fixed { grid: Some([1 << 40, 8, 8]), ..Fixed::default() };
    assert!(matches!(Plan::choose(&problem(&[1.0], [10.0; 3], huge)), Err(PlanError::Grid(_))));
}

/// The cause of an infeasible plan is named.
#[test]
fn hopeless_plans_say_what_makes_them_so() {
    let infeasible = |radii: &[(f64, usize)], edge: f64, method: Option<Method>| {
        let suspension = Suspension::single(edge);
        let radii = radii.to_vec();
        let problem = Problem { radii, fixed: Fixed { method, ..Fixed::default() }, ..suspension.problem(1e-3) };
        Plan::choose(&problem).unwrap().infeasible(&problem)
    };
    let of = |radii: &[(f64, usize)], edge, method| infeasible(radii, edge, method).expect("hopeless");
    assert_eq!(infeasible(&[(1.0, 1000)], 40.0, None), None);
    let direct = Some(Method::Direct);
    assert!(of(&[(1.0, 2)], 2e4, direct).contains("the box is 20000 of the smallest radii long along x; leave hydro"));
    assert!(of(&[(1.0, 1), (0.01, 10_000)], 10.0, direct).contains("the largest radius is 100 times the smallest"));
    let many = [(1.0, 1), (0.001, 10_000_000)];
    let why = of(&many, 10.0, None);
    let problem = Problem { radii: many.to_vec(), ..Suspension::single(10.0).problem(1e-3) };
    let within = Number(Plan::choose(&problem).unwrap().cutoff().powi(3) * 4.19 * 1e4);
    assert!(why.contains(&format!("particles with {within:.2} others each within the cutoff")), "{why}");
    assert!(!["e-1 ", "e0 ", "e1 "].iter().any(|power| why.contains(power)), "{why}");
}
