//! Rigid bodies against exact functions of two spheres, a dense solve and free spheres.

use super::*;
use crate::ambient::Poiseuille;
use crate::bodies::{GivenMotion, RigidBodies};
use domain::Boundaries;
use lubrication::two_sphere::{Function, TwoSphere};

/// Spheres of bodies with the centres of the bodies at `centres`.
struct Bodies {
    plan: Plan,
    particles: Particles,
    of: Vec<Option<u32>>,
    arms: Vec<Vector>,
}

impl Bodies {
    fn solver(&self) -> CoupledSolver {
        let partition = Partition::new(&Comm::alone(), [self.plan.grid[1], self.plan.grid[2]]);
        CoupledSolver::new(&self.plan, &partition, lubricated_at(Some(LubricationRange::default()))).unwrap()
    }

    fn rigid(&self) -> RigidBodies {
        RigidBodies::new(&Comm::alone(), &self.of, &self.arms)
    }

    fn solve(&self, loads: &Loads, strain: Traceless) -> Solution {
        let rigid = self.rigid();
        let acting = SolveInput { bodies: Some(&rigid), ..acting(loads, strain) };
        self.solver().solve(&self.plan.cell(), &self.particles, &acting, Guess::default()).unwrap()
    }

    /// Motion of the only body under a force and a torque at its centre.
    fn moved(&self, [force, torque]: [Vector; 2]) -> [Vector; 2] {
        let count = self.particles.len() as f64;
        let each = |place: usize| {
            let arm = self.arms[place];
            [force / count, torque / count - arm.cross(force / count)]
        };
        let [forces, torques] = [0, 1].map(|k| (0..self.particles.len()).map(|place| each(place)[k]).collect());
        let solved = self.solve(&Loads { forces, torques, stresslets: Vec::new() }, Traceless::ZERO);
        let of_body = self.rigid().body_motions(&solved.motion);
        [of_body.velocities[0], of_body.angular_velocities[0]]
    }
}

/// A body in unbounded fluid, with the mean of the centres of its spheres as its centre.
fn alone(mut arms: Vec<Vector>, radii: &[f64], tolerance: f64) -> Bodies {
    let mean = arms.iter().sum::<Vector>() / arms.len() as f64;
    for arm in &mut arms {
        *arm -= mean;
    }
    let edge = 2.0 * arms.iter().zip(radii).map(|(arm, radius)| arm.length() + radius).fold(0.0, f64::max);
    let mut problem = problem(edge, radii, tolerance, 0.1 * tolerance);
    problem.boundaries = Boundaries::Open;
    let plan = Plan::choose(&problem).unwrap();
    let positions: Vec<Vector> = arms.iter().map(|&arm| Vector::splat(0.5 * edge) + arm).collect();
    Bodies { particles: placed(&positions, radii), plan, of: vec![Some(3); radii.len()], arms }
}

/// A doublet along z.
fn doublet(gap: f64, radii: [f64; 2], tolerance: f64) -> Bodies {
    alone(vec![Vector::ZERO, Vector::Z * (radii[0] + radii[1] + gap)], &radii, tolerance)
}

/// Resistance of a doublet to motion along and across, to spin, and to turning end over end, in units of single unit
/// spheres, and its rate of turning in shear.
#[test]
fn a_touching_doublet_moves_as_the_exact_one() {
    let body = doublet(1e-6, [1.0; 2], 1e-4);
    let [force, torque] = [6.0 * PI, 8.0 * PI];
    let found = [
        1.0 / body.moved([force * Vector::Z, Vector::ZERO])[0].z,
        1.0 / body.moved([force * Vector::X, Vector::ZERO])[0].x,
        1.0 / body.moved([Vector::ZERO, torque * Vector::Z])[1].z,
        1.0 / body.moved([Vector::ZERO, torque * Vector::X])[1].x,
    ];
    for (found, exact) in found.into_iter().zip([2.0 * 0.64514, 2.0 * 0.72466, 2.0 * 0.90154, 3.7401]) {
        assert!((found / exact - 1.0).abs() < 2e-3, "{found}, exact {exact}");
    }
    // In the flow u = z/2 x and w = x/2, a rod along z turns towards x.
    let solved = body.solve(&Loads::default(), Traceless([0.0, 0.0, 0.5, 0.0, 0.0]));
    let turned = body.rigid().body_motions(&solved.motion).angular_velocities[0].y;
    assert!((turned / (0.5 * 0.59406) - 1.0).abs() < 1e-3, "{turned}");
}

/// Resistance to translation along and across the line of centres and to spin of spheres that are held apart.
#[test]
fn spheres_held_apart_move_as_the_exact_ones() {
    for (ratio, gap) in [(1.0, 1e-4), (1.0, 0.1), (1.0, 1.0), (2.0, 1e-4), (2.0, 0.1), (4.0, 1e-2)] {
        let body = doublet(gap, [1.0, ratio], 1e-4);
        let exact = TwoSphere::with_ratio(ratio).unwrap().resistance(gap).unwrap();
        // The sum over both spheres of a function, with its units.
        let total = |function: Function, unit: fn(f64) -> f64| {
            let [[first, mutual], [_, second]] = exact[function];
            unit(2.0) * first + 2.0 * unit(1.0 + ratio) * mutual + unit(2.0 * ratio) * second
        };
        let across = [body.moved([Vector::X, Vector::ZERO]), body.moved([Vector::ZERO, Vector::Y])];
        let [[uf, of], [ut, ot]] = across.map(|[velocity, angular]| [velocity.x, angular.y]);
        assert!((of - ut).abs() < 1e-3 * (uf * ot).sqrt(), "ratio {ratio} gap {gap}: {of} {ut}");
        let found = [
            1.0 / body.moved([Vector::Z, Vector::ZERO])[0].z,
            ot / (uf * ot - of * ut),
            1.0 / body.moved([Vector::ZERO, Vector::Z])[1].z,
        ];
        let by_velocity = |s: f64| 3.0 * PI * s;
        let exact = [
            total(Function::XA, by_velocity),
            total(Function::YA, by_velocity),
            total(Function::XC, |s| PI * s.powi(3)),
        ];
        for (k, (found, exact)) in found.into_iter().zip(exact).enumerate() {
            assert!((found / exact - 1.0).abs() < 5e-3, "ratio {ratio} gap {gap}, {k}: {found}, exact {exact}");
        }
    }
}

/// The four spheres of [`cluster`], of which the first three are a body, about the centre of the first.
fn cluster_of_body() -> Bodies {
    let (plan, particles) = cluster();
    let centre = particles.positions[0];
    let arms = particles.positions.iter().map(|&position| position - centre).collect();
    Bodies { plan, particles, of: vec![Some(0), Some(0), Some(0), None], arms }
}

/// Part of the lubrication of a pair, from sums over the pairs of the first three spheres.
fn share(bodies: &Bodies, [i, j]: [usize; 2]) -> f64 {
    if j > 2 {
        return 1.0;
    }
    let (a, at) = (&bodies.particles.radii, &bodies.arms);
    let over = |term: &dyn Fn(usize, usize) -> f64| {
        (0..3).flat_map(|k| (0..3).map(move |l| (k, l))).filter(|(k, l)| k != l).map(|(k, l)| term(k, l)).sum::<f64>()
    };
    let products = over(&|k, l| a[k] * a[l]);
    let mean_square = over(&|k, l| a[k] * a[l] * (at[k] - at[l]).length_squared()) / products;
    let screened = 1.0 + products / (a[0] + a[1] + a[2]) / mean_square.sqrt();
    (1.0 + 2.0 * a[i] * a[j] / (a[i] + a[j]) / (at[i] - at[j]).length()) / screened
}

/// `K`: motions of the spheres by those of the body and of the last sphere.
fn rigid_columns(bodies: &Bodies) -> Vec<Vec<f64>> {
    let column = |k: usize| {
        let of_sphere = |sphere: usize| {
            let mut own = [0.0; 6];
            if (k >= 6) != bodies.of[sphere].is_none() {
                return own;
            }
            own[k % 6] = 1.0;
            let turned = Vector::from_slice(&own[3..]).cross(bodies.arms[sphere]);
            if k < 6 {
                (0..3).for_each(|i| own[i] += turned[i]);
            }
            own
        };
        (0..bodies.of.len()).flat_map(of_sphere).collect()
    };
    (0..12).map(column).collect()
}

#[test]
fn bodies_move_as_the_dense_matrix_says() {
    let bodies = cluster_of_body();
    let (n, strain) = (bodies.of.len(), Traceless([0.2, 0.5, -0.1, 0.3, 0.0]));
    let forces: Vec<Vector> = (0..n).map(|i| Vector::new(1.0, i as f64, -2.0)).collect();
    let resistance = dense_with(&bodies.plan, &bodies.particles, |pair| share(&bodies, pair));
    let (moving, straining): (Vec<usize>, Vec<usize>) = (0..11 * n).partition(|k| k % 11 < 6);
    // Motions relative to the flow when the body rests, and minus its strain rate.
    let mut given = vec![0.0; 11 * n];
    for sphere in 0..n {
        straining.iter().filter(|&&k| k / 11 == sphere).for_each(|&k| given[k] = -strain.0[k % 11 - 6]);
        if bodies.of[sphere].is_some() {
            let passed = strain.tensor().mul_vec3(bodies.arms[sphere]);
            (0..3).for_each(|i| given[11 * sphere + i] = -passed[i]);
        }
    }
    let times = |row: usize, x: &[f64]| (0..11 * n).map(|k| resistance[row][k] * x[k]).sum::<f64>();
    let wide = |column: &[f64]| {
        let mut all = vec![0.0; 11 * n];
        moving.iter().zip(column).for_each(|(&k, &x)| all[k] = x);
        all
    };
    let columns: Vec<Vec<f64>> = rigid_columns(&bodies).iter().map(|column| wide(column)).collect();
    let over = |column: &[f64], x: &dyn Fn(usize) -> f64| moving.iter().map(|&k| column[k] * x(k)).sum::<f64>();
    let matrix = columns.iter().map(|a| columns.iter().map(|b| over(a, &|k| times(k, b))).collect()).collect();
    let load = |k: usize| if k % 11 < 3 { forces[k / 11][k % 11] } else { 0.0 };
    let right = columns.iter().map(|a| vec![over(a, &|k| load(k) - times(k, &given))]).collect();
    let motions = eliminated(matrix, right);
    let mut exact = given.clone();
    for (column, motion) in columns.iter().zip(&motions) {
        (0..11 * n).for_each(|k| exact[k] += motion[0] * column[k]);
    }
    let solved = bodies.solve(&Loads { forces: forces.clone(), ..Loads::default() }, strain);
    let found = flat(&solved.motion.velocities, &solved.motion.angular_velocities, &solved.stresslets);
    let held = flat(&solved.constraint_loads.forces, &solved.constraint_loads.torques, &vec![Traceless::ZERO; n]);
    for &k in &moving {
        assert!((found[k] - exact[k]).abs() < 1e-6, "motion {k}: {}, dense {}", found[k], exact[k]);
        let needed = times(k, &exact) - load(k);
        assert!((held[k] - needed).abs() < 1e-4, "constraint {k}: {}, dense {needed}", held[k]);
    }
    for &k in &straining {
        let stresslet = -times(k, &exact);
        assert!((found[k] - stresslet).abs() < 1e-5 * 20.0, "stresslet {k}: {}, dense {stresslet}", found[k]);
    }
    let totals = bodies.rigid().total_loads(&solved.constraint_loads);
    assert!(totals.forces[0].length() < 1e-6 && totals.torques[0].length() < 1e-5, "{totals:?}");
}

/// Doublets at random places, each next to the other spheres, solved on ranks that are threads: velocities in the
/// order of the spheres, and the number of iterations.
fn doublets_on_ranks(ranks: usize) -> (Vec<f64>, usize) {
    let (count, edge) = (12, 10.0);
    let cell = cube(edge);
    let centres = random_packing(&cell, &vec![2.0; count], 1e-3, 7).unwrap();
    let mut random = domain::Random::new(3, 0);
    let axes: Vec<Vector> = (0..count).map(|_| (random.point() - Vector::splat(0.5)).normalize()).collect();
    let sphere = |k: usize| (centres[k / 2], axes[k / 2] * if k.is_multiple_of(2) { 1.0 } else { -1.0 });
    let positions: Vec<Vector> = (0..2 * count).map(|k| sphere(k).0 + sphere(k).1).collect();
    let plan = plan(edge, &[1.0], 1e-3, 1e-8);
    let all = Comm::threads(ranks, |comm| {
        let partition = Partition::new(&comm, [plan.grid[1], plan.grid[2]]);
        let mut particles =
            if comm.is_first() { placed(&positions, &vec![1.0; 2 * count]) } else { Particles::default() };
        particles.wrap(&cell);
        particles.migrate(&partition, &cell);
        let of: Vec<Option<u32>> = particles.ids.iter().map(|&id| Some(id as u32 / 2)).collect();
        let arms: Vec<Vector> = particles.ids.iter().map(|&id| sphere(id as usize).1).collect();
        let rigid = RigidBodies::new(&comm, &of, &arms);
        let mut fluid =
            CoupledSolver::new(&plan, &partition, lubricated_at(Some(LubricationRange::default()))).unwrap();
        let loads = Loads { forces: vec![Vector::Z; particles.len()], ..Loads::default() };
        let acting = SolveInput { bodies: Some(&rigid), ..acting(&loads, Traceless([0.0, 0.5, 0.0, 0.0, 0.0])) };
        let solved = fluid.solve(&cell, &particles, &acting, Guess::default()).unwrap();
        particles.vectors("velocity").copy_from_slice(&solved.motion.velocities);
        let velocities: Vec<f64> =
            particles.gathered(&partition).vectors("velocity").iter().flat_map(Vector::to_array).collect();
        (velocities, solved.iterations)
    });
    all.into_iter().next().unwrap()
}

#[test]
fn ranks_agree_on_bodies() {
    let (one, iterations) = doublets_on_ranks(1);
    assert!(iterations < 25, "{iterations}");
    let scale = one.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    for ranks in [2, 3] {
        let worst = one.iter().zip(doublets_on_ranks(ranks).0).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(worst < 1e-10 * scale, "{ranks} ranks: {worst} of {scale}");
    }
}

/// A body of one sphere is a free sphere. The preconditioner of free spheres couples those that are pressed together.
#[test]
fn bodies_of_single_spheres_are_free() {
    let (plan, particles) = cluster();
    let n = particles.len();
    let bodies = Bodies { plan, particles, of: (0..n as u32).map(Some).collect(), arms: vec![Vector::ZERO; n] };
    let loads = Loads { forces: vec![Vector::Z; n], ..Loads::default() };
    let strain = Traceless([0.0, 0.5, 0.0, 0.0, 0.0]);
    let together = bodies.solve(&loads, strain);
    let free = bodies.solver();
    let free =
        { free }.solve(&bodies.plan.cell(), &bodies.particles, &acting(&loads, strain), Guess::default()).unwrap();
    assert!(free.iterations <= together.iterations, "{} {}", free.iterations, together.iterations);
    for (a, b) in together.motion.velocities.iter().zip(&free.motion.velocities) {
        assert!((*a - *b).length() < 1e-8, "{a} {b}");
    }
}

/// Without lubrication, and with spheres that overlap.
#[test]
fn bodies_need_no_near_pairs() {
    let body = doublet(-0.5, [1.0; 2], 1e-3);
    let partition = Partition::new(&Comm::alone(), [body.plan.grid[1], body.plan.grid[2]]);
    let loads = Loads { forces: vec![3.0 * PI * Vector::Z; 2], ..Loads::default() };
    let rigid = body.rigid();
    let acting = SolveInput { bodies: Some(&rigid), ..acting(&loads, Traceless::ZERO) };
    let speed = |range| {
        let mut solver = CoupledSolver::new(&body.plan, &partition, lubricated_at(range)).unwrap();
        let solved = solver.solve(&body.plan.cell(), &body.particles, &acting, Guess::default()).unwrap();
        rigid.body_motions(&solved.motion).velocities[0].z
    };
    let [alone, lubricated] = [None, Some(LubricationRange::default())].map(speed);
    // Between one sphere and two that touch.
    assert!(alone < 1.0 && alone > 1.0 / (2.0 * 0.64514), "{alone}");
    assert!((alone - lubricated).abs() < 1e-3 * alone, "{alone} {lubricated}");
}

/// A doublet with a given velocity across its axis and a given spin takes the loads that cause them, and turns freely.
#[test]
fn a_given_motion_takes_the_loads_that_cause_it() {
    let body = doublet(0.1, [1.0, 2.0], 1e-4);
    let wanted = [Vector::new(0.3, 0.0, 0.0), Vector::new(0.0, 0.0, -0.7)];
    let given =
        GivenMotion { velocity: wanted[0].to_array().map(Some), angular_velocity: [None, None, Some(wanted[1].z)] };
    let rigid = body.rigid().with_given_motions(vec![Some(given)]);
    let loads = Loads::default();
    let acting = SolveInput { bodies: Some(&rigid), ..acting(&loads, Traceless::ZERO) };
    let solved = body.solver().solve(&body.plan.cell(), &body.particles, &acting, Guess::default()).unwrap();
    let found = rigid.body_motions(&solved.motion);
    assert!((found.velocities[0] - wanted[0]).length() < 1e-12, "{found:?}");
    assert!((found.angular_velocities[0].z - wanted[1].z).abs() < 1e-12, "{found:?}");
    let taken = rigid.total_loads(&solved.constraint_loads);
    assert!(taken.torques[0].x.abs() + taken.torques[0].y.abs() < 1e-8 * taken.torques[0].length(), "{taken:?}");
    let [velocity, angular] = body.moved([taken.forces[0], taken.torques[0]]);
    assert!((velocity - wanted[0]).length() < 1e-3 * wanted[0].length(), "{velocity}");
    assert!((angular - found.angular_velocities[0]).length() < 1e-3 * wanted[1].length(), "{angular}");
}

/// Spheres of a body at different heights and with different radii, in a parabolic flow.
#[test]
fn bodies_are_rigid_in_a_curved_flow() {
    let bodies = cluster_of_body();
    let (flow, rigid, loads) = (Poiseuille { curvature: 0.02, height: 22.0 }, bodies.rigid(), Loads::default());
    let acting =
        SolveInput { strain_rate: flow.strain_rate(), bodies: Some(&rigid), ..acting(&loads, Traceless::ZERO) };
    let cell = bodies.plan.cell();
    let motion = bodies.solver().solve(&cell, &bodies.particles, &acting, Guess::default()).unwrap().motion;
    let moving = |k: usize| {
        let (z, radius) = (bodies.particles.positions[k].z, bodies.particles.radii[k]);
        let velocity = motion.velocities[k] + flow.velocity_of(z, radius);
        [velocity, motion.angular_velocities[k] + flow.angular_velocity(z)]
    };
    let [velocity, angular] = moving(0);
    for k in 1..3 {
        let [other, turning] = moving(k);
        assert!((turning - angular).length() < 1e-13, "{turning} {angular}");
        let expected = velocity + angular.cross(bodies.arms[k]);
        assert!((other - expected).length() < 1e-12, "{other} {expected}");
    }
}

/// Spheres that overlap have random loads if they are free, and none as parts of a body.
#[test]
fn spheres_of_a_body_that_overlap_have_no_random_loads() {
    let body = doublet(-0.5, [1.0; 2], 1e-3);
    let (mut solver, rigid, stream) = (body.solver(), body.rigid(), fcm::Stream::new(1, 1));
    let mut drawn = |bodies| solver.pair_noise(&body.plan.cell(), &body.particles, bodies, stream).forces[0].length();
    assert!(drawn(Some(&rigid)) < 1e-14 && drawn(None) > 0.1);
}

/// Rods of touching spheres along their axis against collocation of all spheres, over the drag of spheres far apart.
#[test]
fn rods_move_as_the_exact_ones() {
    for (count, exact) in [(3, 0.51380), (5, 0.39731), (10, 0.29447)] {
        let arms = (0..count).map(|k| Vector::Z * (2.000_001 * f64::from(k))).collect();
        let body = alone(arms, &vec![1.0; count as usize], 1e-4);
        let found = 1.0 / (6.0 * PI * f64::from(count) * body.moved([Vector::Z, Vector::ZERO])[0].z);
        assert!((found / exact - 1.0).abs() < 8e-3, "{count} spheres: {found}, exact {exact}");
    }
}

/// A shell of spheres around the unit sphere drags as a sphere between that one and its own outside.
#[test]
fn a_shell_of_spheres_moves_as_a_sphere() {
    let (count, radius) = (100, 0.15);
    // Points along a spiral.
    let arm = |k: i32| {
        let (height, turn) = (1.0 - f64::from(2 * k + 1) / f64::from(count), f64::from(k) * PI * (3.0 - 5f64.sqrt()));
        let across = (1.0 - height * height).sqrt();
        Vector::new(across * turn.cos(), across * turn.sin(), height)
    };
    let body = alone((0..count).map(arm).collect(), &vec![radius; count as usize], 1e-3);
    let by_force = 1.0 / body.moved([6.0 * PI * Vector::Z, Vector::ZERO])[0].z;
    let by_torque = (1.0 / body.moved([Vector::ZERO, 8.0 * PI * Vector::X])[1].x).cbrt();
    for found in [by_force, by_torque] {
        assert!(found > 1.0 && found < 1.0 + radius, "{by_force} {by_torque}");
    }
}
