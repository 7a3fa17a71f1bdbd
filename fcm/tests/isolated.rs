//! One sphere in a periodic box, for which there are exact answers.

use crate::common::Suspension;
use domain::{Comm, Partition, Traceless, Vector};
use fcm::{Fixed, Loads, Method, Motion, Multipoles, Plan, Problem, StressletSolver};
use std::f64::consts::PI;

/// Constant of the simple cubic lattice: Hasimoto (1959), eq. (31), to more digits.
const HASIMOTO: f64 = 2.837_297_479_480_62;
/// Half of the library's tightest tolerance, 1e-12; the sum over wavevectors has a truncation error of 2e-15 and
/// round-off.
const EXACT: f64 = 5e-13;

/// A direction that is not along any axis of the lattice.
fn direction() -> Vector {
    Vector::new(0.48, -0.6, 0.64)
}

/// Motions by each method of the library, and by the sum over wavevectors.
fn answers(edge: f64, loads: &Loads) -> Vec<Motion> {
    let single = Suspension::single(edge);
    let by = |method| single.evaluate(&single.plan(1e-12, Fixed { method: Some(method), ..Fixed::default() }), loads);
    vec![by(Method::Direct), by(Method::Split), single.motion(loads)]
}

/// `6 pi mu a V / F = 1 - 2.837 a/L + 4 (a/L)^3`; overlapping envelopes of the images add a relative
/// `exp(-pi (L/2a)^2)`, 3e-14 at `L = 6.3 a`.
#[test]
fn drag_follows_hasimoto() {
    for edge in [6.5, 9.0, 13.0] {
        let loads = Loads { forces: vec![direction()], ..Loads::default() };
        let exact = direction() * ((1.0 - HASIMOTO / edge + 4.0 / edge.powi(3)) / (6.0 * PI * 0.7));
        for motion in answers(edge, &loads) {
            let error = (motion.velocities[0] - exact).length() / exact.length();
            assert!(error < EXACT, "L = {edge} a: error {error:e}");
            // By symmetry a force causes neither rotation nor strain.
            assert!(motion.angular_velocities[0].length() < EXACT);
        }
    }
}

/// `8 pi mu a^3 Omega / T = 1 - phi`; the narrower dipole envelopes do not overlap from `L = 5.2 a`.
#[test]
fn torque_loses_the_volume_fraction() {
    for edge in [5.5, 8.0, 12.0] {
        let loads = Loads { torques: vec![direction()], ..Loads::default() };
        let fraction = 4.0 / 3.0 * PI / f64::powi(edge, 3);
        let exact = direction() * ((1.0 - fraction) / (8.0 * PI * 0.7));
        for motion in answers(edge, &loads) {
            let error = (motion.angular_velocities[0] - exact).length() / exact.length();
            assert!(error < EXACT, "L = {edge} a: error {error:e}");
            assert!(motion.velocities[0].length() < EXACT);
        }
    }
}

/// Rates of strain along the axes and at 45 degrees to them.
const STRAINS: [Traceless; 2] = [Traceless([1.0, 0.0, 0.0, -1.0, 0.0]), Traceless([0.0, 0.6, 0.0, 0.0, -0.8])];

/// The stresslet over `20/3 pi mu a^3 E` of a rigid sphere.
fn stresslets(edge: f64) -> [f64; 2] {
    let single = Suspension::single(edge);
    let plan = single.plan(1e-10, Fixed::default());
    let mut hydrodynamics = StressletSolver::new(&plan, &Partition::new(&Comm::alone(), [plan.grid[1], plan.grid[2]]));
    STRAINS.map(|strain| {
        let solved = hydrodynamics.solve(&single.cell, &single.particles(), &Loads::default(), strain, &[]).unwrap();
        let stresslet = solved.stresslets[0];
        let factor = stresslet.contract(strain) / strain.contract(strain);
        let rest = stresslet - strain * factor;
        assert!(rest.contract(rest).sqrt() < 1e-9 * factor, "the stresslet is along the rate of strain");
        factor / (20.0 / 3.0 * PI * 0.7)
    })
}

/// Coefficient `c` of the expansion below: the far fields `u = -3/(8 pi mu) x (x.S.x) / r^5` of the stresslets at all
/// other points of a simple cubic lattice of edge 1 add to the rate of strain at one of them `(c - 1) phi` times
/// `-S / (20/3 pi mu a^3)`, where the 1 is the uniform back flow. The sum converges conditionally: it ends in a
/// smooth sphere, whose radius changes the seventh digit.
fn lattice_sum(strain: Traceless) -> f64 {
    let (tensor, mut sum) = (strain.tensor(), 0.0);
    for index in 0..27_i32.pow(3) {
        let x = Vector::new(f64::from(index % 27), f64::from(index / 27 % 27), f64::from(index / 729)) - 13.0;
        let (square, sx) = (x.length_squared(), tensor * x);
        if square > 0.0 {
            let xsx = x.dot(sx);
            let terms = 2.0 * sx.length_squared() - 5.0 * xsx * xsx / square;
            sum += (-(square / 64.0).powi(4)).exp() * terms / square.powf(2.5);
        }
    }
    1.0 - 15.0 / (8.0 * PI) * sum / strain.contract(strain)
}

/// In a simple cubic lattice of spheres the stresslet is `20/3 pi mu a^3 E / (1 - c phi + O(phi^(5/3)))`, with
/// different `c` for rates of strain along the axes and at 45 degrees to them (Zuzovsky, Adler & Brenner 1983).
#[test]
fn stresslets_in_a_lattice_see_their_far_fields() {
    let edges = [8.0, 16.0, 32.0];
    let found = edges.map(stresslets);
    for (kind, strain) in STRAINS.into_iter().enumerate() {
        let fraction = |edge: f64| 4.0 / 3.0 * PI / edge.powi(3);
        let slope: [f64; 3] = std::array::from_fn(|i| (1.0 - 1.0 / found[i][kind]) / fraction(edges[i]));
        // Slopes approach c like (a/L)^2, which the extrapolation removes. Errors of 1e-10 are 1e-6 of phi = 1.3e-4.
        let (limit, c) = ((4.0 * slope[2] - slope[1]) / 3.0, lattice_sum(strain));
        assert!((limit - c).abs() < 5e-6, "slope {limit}, not {c}; from {slope:?}");
        let order = ((slope[1] - slope[0]) / (slope[2] - slope[1])).log2();
        assert!((order - 2.0).abs() < 0.01, "order {order}");
        let deviation = |i: usize| (found[i][kind] - 1.0).abs();
        let order = (deviation(1) / deviation(2)).log2();
        assert!((order - 3.0).abs() < 0.1, "order {order}");
    }
}

/// Far from its images a sphere with a monopole alone has Stokes' drag, to first order in `a/L`.
#[test]
fn drag_comes_near_stokes_with_the_first_order() {
    let deviation = [20.0, 40.0].map(|edge| {
        let single = Suspension::single(edge);
        let problem = Problem { multipoles: Multipoles::Monopole, ..single.problem(1e-8) };
        let plan = Plan::choose(&problem).unwrap();
        let mut hydrodynamics =
            StressletSolver::new(&plan, &Partition::new(&Comm::alone(), [plan.grid[1], plan.grid[2]]));
        let loads = Loads { forces: vec![Vector::X], ..Loads::default() };
        let solved = hydrodynamics.solve(&single.cell, &single.particles(), &loads, Traceless::ZERO, &[]).unwrap();
        1.0 - 6.0 * PI * 0.7 * solved.motion.velocities[0].x
    });
    assert!(((deviation[0] / deviation[1]).log2() - 1.0).abs() < 0.01);
}
